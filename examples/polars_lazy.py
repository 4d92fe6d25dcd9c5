"""Scenes inside a polars lazy query: solve_table appends what batch does to a data frame, a lazy one too.

The query streams: polars feeds batches of rows, and never holds more than some of them.
"""

import polars as pl

from atwood_cli import solve_table


def by_regime(scenes: pl.LazyFrame) -> pl.LazyFrame:
    """How many scenes there are of each regime, from which pulley on, and the least acceleration."""
    return (
        solve_table(scenes, ["regime", "acceleration"])
        .group_by("regime")
        .agg(pl.len(), pl.col("M").min().alias("from M"), pl.col("acceleration").min().round(6))
        .sort("from M")
    )


scenes = pl.LazyFrame({"m1": 1.0, "m2": 3.0, "M": [i / 1000 for i in range(100_000)], "mu": 0.3})
print(by_regime(scenes).collect(engine="streaming").write_csv(), end="")
