"""Scenes inside a polars lazy query: solve_arrays is a function of arrays, so a query maps it.

The query streams: polars feeds batches of rows, and never holds more than some of them.
"""

import polars as pl

from atwood_cli import REGIMES, solve_arrays

NAMES = ("regime", "acceleration")


def solve(scenes: pl.DataFrame) -> pl.DataFrame:
    """A batch of rows with the results as columns, null where a row is no scene: -1 is the last name.

    What is null is not given: without mu, for example, the string holds. A NaN is an error of its row.
    """
    results = solve_arrays(*(scenes[name] for name in ("m1", "m2", "M", "mu")), quantities=NAMES)
    return scenes.with_columns(
        regime=pl.Series([*REGIMES, None]).gather(results["regime"]),
        acceleration=pl.Series(results["acceleration"], nan_to_null=True),
    )


def by_regime(scenes: pl.LazyFrame) -> pl.LazyFrame:
    """How many scenes there are of each regime, from which pulley on, and the least acceleration."""
    return (
        scenes.map_batches(solve, schema=result, streamable=True)
        .group_by("regime")
        .agg(pl.len(), pl.col("M").min().alias("from M"), pl.col("acceleration").min().round(6))
        .sort("from M")
    )


schema = dict.fromkeys(("m1", "m2", "M", "mu"), pl.Float64)
result = {**schema, "regime": pl.String, "acceleration": pl.Float64}
scenes = pl.LazyFrame(
    {"m1": 1.0, "m2": 3.0, "M": [i / 1000 for i in range(100_000)], "mu": 0.3}, schema=schema
)
print(by_regime(scenes).collect(engine="streaming").write_csv(), end="")
