"""Runs of a laboratory: the pulley's inertia and its axle's friction, by least squares. The door is `fit`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Protocol

from ..files import Unreadable
from ..model.scene import INPUTS, Given, Input, read_input

if TYPE_CHECKING:
    from .fitting import Fitted
    from .results import Fit


class Frame(Protocol):
    """A data frame of pandas or polars."""

    @property
    def columns(self) -> Any: ...


Table = str | PathLike[str] | Mapping[str, Iterable[object]] | Frame


def fit(
    runs: Table,
    *,
    drop: Given | None = None,
    g: Given | None = None,
    M: Given | None = None,
    inertia: Given | None = None,
    I: Given | None = None,
    R: Given | None = None,
    axle: Given | None = None,
    mu: Given | None = None,
    wrap: Given | None = None,
    find: str | Sequence[str] | None = None,
    without: Collection[int] = (),
) -> Fit:
    """The pulley's inertia and its axle's friction, from runs of a laboratory, by T_h - T_l = c a + f.

    Args:
        runs: A row a run: the path of a CSV or .tsv file, a mapping of columns of equal length, or a data
            frame. Columns are named as in a file: m1, m2, and a, or time (t1, t2 and so on for repeats).
            They are in kg, m/s² and s unless the name has a unit, as "m1 (g)"; a cell may be text, as
            "2.05(2)". None and NaN are empty cells.
        drop: The height of fall (m) of all runs, for times.
        g, M, inertia, I, R, axle, mu, wrap: What is the same in all runs, as `solve` takes it: numbers in
            SI units (wrap in degrees), or text with a unit or an uncertainty. M, I, axle and g are not
            fitted if given. R gives the moment of inertia, ``inertia`` the pulley's mass; with ``mu``, runs
            are named in which the string would slip.
        find: The quantities to fit alone, of "rim_mass", "axle" and "gravity". If None, the first two
            unless given; the axle is taken to be free where the runs do not determine it, and ``notes``
            say so.
        without: Numbers of rows to leave out, from 1.

    Returns:
        `Fit`: values by name in SI units, their standard uncertainties and intervals of 95 %, the runs,
        and ``notes``, which also name what is odd. As text, the table and the notes.

    Raises:
        SceneError: A parameter is not valid (a ValueError).
        ValueError: The columns are no table of runs.
        OSError: The file cannot be read, or is no table of runs.
        ArithmeticError: The runs are too few, or too alike, to determine what is to be fitted.
    """
    from .results import results_of

    given = {"g": g, "M": M, "inertia": inertia, "I": I, "R": R, "axle": axle, "mu": mu, "wrap": wrap}
    inputs = {name: read_input(name, given.get(name)) for name in INPUTS}
    height = None if drop is None else read_input("drop", drop)
    words = [find] if isinstance(find, str) else find or ()
    return results_of(fit_of(runs, inputs, height, words, without=without))


def fit_of(
    table: Table,
    inputs: Mapping[str, Input],
    drop: Input | None,
    find: Sequence[str],
    labels: Collection[str] = (),
    without: Collection[int] = (),
) -> Fitted:
    """The fit of a table, which may be "-" for stdin. Raises as `fit` does."""
    from ..batch.formats import cannot_read
    from .fitting import conditions_of, fitted, read_find
    from .runs import read_runs

    names = read_find(find, inputs)
    try:
        runs = read_runs(table, labels, drop, without)
        return fitted(runs, conditions_of(inputs, runs), names)
    except Unreadable as error:
        if not isinstance(table, str | PathLike):
            raise ValueError(f"cannot read the runs: {error}") from None
        raise cannot_read(fspath(table), error) from None
