"""Runs of a laboratory: the pulley's inertia and its axle's friction, by least squares. The door is `fit`."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from ..output.text import naming_the_extra
from ..reading.inputs import read_input
from ..reading.names import divided
from ..solver.scene import INPUTS, MASSES, Given, Input, SceneError
from ..tables.sources import Unreadable
from .results import Fit as Fit
from .results import in_python

if TYPE_CHECKING:
    from typing import Protocol

    import polars as pl

    from .estimate import Fitted

    class Frame(Protocol):
        """A frame of pandas, whose types need not be installed."""

        def items(self) -> Iterable[tuple[Any, Any]]: ...

    Table = str | PathLike[str] | Mapping[str, Iterable[object]] | pl.DataFrame | Frame


def fit(
    runs: Table,
    *,
    drop: Given | None = None,
    m1: Given | None = None,
    m2: Given | None = None,
    hanger: Given | None = None,
    g: Given | None = None,
    M: Given | None = None,
    inertia: Given | None = None,
    I: Given | None = None,
    R: Given | None = None,
    axle: Given | None = None,
    find: str | Sequence[str] | None = None,
    without: str | int | Collection[int | str] = (),
    columns: str | Sequence[str] | None = None,
    sheet: str | None = None,
) -> Fit:
    """Fit the pulley's inertia and its axle's friction to runs of a laboratory, by T_h - T_l = c a + f.

    Args:
        runs: A table with a row for each run: the path of a CSV or .tsv file, a mapping of columns of equal
            length, or a frame of polars or pandas. Columns are named as in a file: m1, m2, and a, or t (t1,
            t2 and so on for repeats). They are in kg, m/s² and s unless the name has a unit, as "m1 (g)"; a
            cell may be text, as "2.05(2)". A missing value, as None or NaN, is an empty cell.
        drop: The height of fall of all runs, in m, for times.
        m1, m2: A mass that all runs share, in kg; 0 if nothing hangs there.
        hanger: The mass of the hangers, in kg, which is added to m1 and to m2.
        g, M, inertia, I, R, axle: Inputs that all runs share, as `solve` takes them: numbers in SI units, or
            text with a unit or an uncertainty. M, I, axle and g are not fitted if given. R gives the moment
            of inertia, ``inertia`` the pulley's mass.
        find: The quantities to fit, of "rim_mass", "axle", "gravity" and "delay"; if None, the first two
            unless given. Of these two, each must be given or fitted.
        columns: What each column is, from the left, as "m1:g,m2:g,-,t,t": a name, perhaps with a unit, t_err
            for the uncertainties of t, - for a column that is not read, m1:g+ where a blank cell has what
            stands above it, "?" for an error that lists the columns. If None, headings say it.
        sheet: The sheet of a workbook, .xlsx or .ods; the first if None.
        without: Rows to leave out, by their numbers from 1, and cells, as "8:t2"; or one of them, or a text,
            as "5,8:t2".

    Returns:
        `Fit`: values by name in SI units, their standard uncertainties and intervals of 95 %, the runs,
        and ``notes``, which also name outliers. As text it has a line for each result, and the notes.

    Raises:
        SceneError: A parameter is not valid (a ValueError).
        ValueError: The columns are no table of runs.
        OSError: The file cannot be read, or is no table of runs.
        ImportError: SciPy is missing.
        ArithmeticError: The runs do not determine the quantities, or no pulley explains them.
    """
    from ..tables.places import NotUnderstood
    from ..tables.sources import cannot_read

    with naming_the_extra():
        from .report import results_of

    given = {"g": g, "M": M, "inertia": inertia, "I": I, "R": R, "axle": axle, "drop": drop}
    given |= {"m1": m1, "m2": m2, "hanger": hanger}
    names = [find] if isinstance(find, str) else find or ()
    left_out = divided([str(without)]) if isinstance(without, str | int) else without
    try:
        return results_of(fit_of(runs, given, names, left_out, columns or (), sheet=sheet))
    except Unreadable as error:
        why = f"{error}; give columns={error.typed!r}" if isinstance(error, NotUnderstood) else str(error)
        if isinstance(runs, str | PathLike):
            raise cannot_read(fspath(runs), Unreadable(why)) from None
        raise ValueError(f"cannot read the runs: {why}") from None


def fit_of(
    table: Table,
    given: Mapping[str, Given | None],
    find: Sequence[str],
    without: Collection[int | str] = (),
    columns: str | Sequence[str] = (),
    named: Sequence[str] = (),
    labels: Sequence[str] = (),
    sheet: str | None = None,
    option: Callable[..., str] = in_python,
) -> Fitted:
    """Return the fit of a table, which may be "-" for stdin. Raises SceneError, Unreadable, CannotSeparate.

    ``columns`` are words by place, ``named`` words NAME=HEADING, ``labels`` headings that belong to no run.
    ``option`` returns an option as the user types it.
    """
    from ..tables.headings import OPEN, read_naming
    from .columns import VOCABULARY
    from .fitting import conditions_of, fitted, read_find
    from .runs import read_runs

    shared = {x: _read_given(x, value) for x, value in given.items() if value not in (None, OPEN)}
    inputs: dict[str, Input] = {x: read_input(x, None) for x in INPUTS}
    inputs |= {x: read for x, read in shared.items() if x not in (*MASSES, "hanger")}
    if not {"g", "gravity"} & {*divided(find)}:
        shared.setdefault("g", inputs["g"])
    runs = read_runs(table, read_naming(columns, named, labels, VOCABULARY), shared, without, sheet)
    conditions = conditions_of({**inputs, **runs.same}, option)
    return fitted(runs, conditions, read_find(find, conditions))


def _read_given(name: str, value: Given) -> Input:
    """Read what all runs share; a hanger is a mass. Raises SceneError."""
    try:
        return read_input("m1" if name == "hanger" else name, value)
    except SceneError as error:
        raise SceneError(name, value, error.rule) from None
