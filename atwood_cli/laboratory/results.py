"""A fit as it is handed out: values with their uncertainties, the runs, and the command that predicts."""

from collections.abc import Mapping, Sequence
from shlex import quote
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.rounding import as_typed
from ..arrays.tables import Column
from ..derivation.typeset import wrapped
from ..model import physics
from .fitting import Fitted, as_data
from .least_squares import Data
from .numbers import COLUMNS, Result, cut, rows_of
from .quantities import QUANTITIES
from .runs import Run
from .sentences import head, notes

WIDTH = 80
"""Characters of a line of text, at most."""


class Fit(NamedTuple):
    """All of a fit by name; None where the runs do not determine it.

    ``rim_mass`` (kg) is the pulley's inertia as a mass at its rim, c = I/R², and ``axle`` (N) the friction
    of its axle as a force there; ``gravity`` (m/s²) is fitted only if asked for. ``pulley_mass`` (kg) needs
    the pulley's shape, ``moment_of_inertia`` (kg m²) its radius. ``uncertainty`` and ``interval`` (95 %) are
    those of these values, by name; ``between_runs`` (kg) is the standard deviation between runs that their
    own uncertainties do not explain, as a mass; ``chi2`` is χ² by these uncertainties, ``dof`` the number of
    degrees of freedom. ``runs`` are the rows of ``--csv``. As text it is the table, with the notes below.
    """

    rim_mass: float | None
    axle: float | None
    gravity: float | None
    pulley_mass: float | None
    moment_of_inertia: float | None
    uncertainty: Mapping[str, float]
    interval: Mapping[str, Sequence[float]]
    correlation: float | None
    chi2: float | None
    dof: int
    between_runs: float | None
    runs: Sequence[Mapping[str, Any]]
    notes: Sequence[str]

    def __str__(self) -> str:
        ends = {name: (low, high) for name, (low, high) in self.interval.items()}
        values = {x: Result(getattr(self, x), u, ends[x]) for x, u in self.uncertainty.items()}
        table = [COLUMNS, *rows_of(values)] if values else []
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]
        return "\n".join([*lines, *(line for note in self.notes for line in wrapped(note, WIDTH))])


def results_of(fit: Fitted) -> Fit:
    """All of a fit, with its sentences."""
    values, correlation = fit.results, fit.correlation
    return Fit(
        **{name: values[name].value if name in values else None for name in QUANTITIES},
        uncertainty={name: one.uncertainty for name, one in values.items()},
        interval={name: list(one.interval) for name, one in values.items()},
        correlation=correlation and correlation[2],
        chi2=fit.chi2,
        dof=fit.dof,
        between_runs=fit.between_runs,
        runs=_lines(fit),
        notes=[*head(fit), *notes(fit)],
    )


def _lines(fit: Fitted) -> list[dict[str, Any]]:
    """The runs, as JSON and CSV have them; the residual is in standard uncertainties."""
    columns = (fit.data.measured, fit.estimate.expected, fit.sigma)
    used = {run.rows: one for run, *one in zip(fit.used, *(c.tolist() for c in columns), strict=True)}
    lines = []
    for run in fit.runs.runs:
        sign = -1 if run.sign < 0 else 1
        measured, expected, u = used.get(run.rows, (abs(run.mean), None, None))
        lines.append(
            {
                "rows": " ".join(map(str, run.rows)),
                **run.labels,
                "m1": float(run.m1.value),
                "m2": float(run.m2.value),
                **({} if run.drop is None else {"drop": float(run.drop.value)}),
                fit.runs.kind: sign * measured,
                "u": u,
                "expected": None if expected is None else sign * expected,
                "residual": sign * (measured - expected) / u if u and expected is not None else None,
            }
        )
    return lines


class Points(NamedTuple):
    """Runs as points (a, T_h - T_l) of a straight line, with standard uncertainties; c is its slope.

    The uncertainties of ``y`` come from those of ``x``, so those of the residuals, y less the line, differ.
    """

    x: Column
    y: Column
    u_x: Column
    u_y: Column
    residual: Column
    u_residual: Column
    slope: float
    intercept: float


def points(fit: Fitted) -> Points:
    """The runs that were used, as points."""
    data, values, u = fit.data, fit.estimate.values, fit.sigma
    a, y = _as_points(data, values["gravity"])
    if data.kind == "time":
        u = u * 2 * a / data.measured
    c, f = values["rim_mass"], values["axle"]
    line: Any = physics.difference_of_a_pulley(np.float64(c), a, np.float64(f))
    masses = data.l + data.h
    return Points(a, y, u, masses * u, y - line, (masses + c) * u, c, f)


def left_out(fit: Fitted) -> tuple[Sequence[Run], Column, Column]:
    """The runs that the user left out, as points (a, T_h - T_l)."""
    runs = [run for run in fit.runs.runs if run.left_out and run.mean]
    none = np.empty(0)
    points = _as_points(as_data(fit.runs, runs), fit.estimate.values["gravity"]) if runs else (none, none)
    return runs, *points


def _as_points(data: Data, gravity: float) -> tuple[Column, Column]:
    a: Column = data.measured
    if data.kind == "time" and data.drop is not None:
        a = physics.acceleration_of_fall(data.drop, data.measured)
    y: Any = physics.difference_of_moving_masses(data.l, data.h, a, np.float64(gravity))
    return a, y


def prediction(fit: Fitted) -> str:
    """The command that solves a scene with the results; empty if that is no scene."""
    if any(fit.values[name] < 0 for name in fit.values):
        return ""
    run, inputs = fit.used[0], fit.given.inputs
    values = {name: cut(*one[:2]) for name, one in fit.results.items()}
    words = {"m1": as_typed(run.m1.value), "m2": as_typed(run.m2.value)}
    words |= {x: str(one.given) for x, one in inputs.items() if one.given is not None}
    if "rim_mass" in values:
        if inputs["inertia"].given is not None:
            words["M"] = values["pulley_mass"]
        elif inputs["R"].given is not None:
            words["I"] = values["moment_of_inertia"]
        else:
            words |= {"M": values["rim_mass"], "inertia": "hoop"}
    words |= {x: values[name] for x, name in (("axle", "axle"), ("g", "gravity")) if name in values}
    options = (f"--{x.replace('_', '-')} {quote(word)}" for x, word in words.items())
    return f"atwood solve {' '.join(options)}"
