"""A fit as it is handed out: values with their uncertainties, the runs, and the command that predicts."""

from collections.abc import Mapping, Sequence
from math import hypot
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.rounding import as_typed
from ..arrays.tables import Column
from ..derivation.typeset import wrapped
from ..model import physics
from ..model.scene import Input
from .fitting import FOUND, Fit, as_data
from .least_squares import Data
from .numbers import SYMBOLS, UNITS, cut, published
from .runs import Run

Inputs = Mapping[str, Input]


class Result(NamedTuple):
    """A value, its standard uncertainty, and its interval of 95 %."""

    value: float
    uncertainty: float
    interval: tuple[float, float]


class Results(NamedTuple):
    """All of a fit by name, as JSON has it; None where the runs do not tell.

    ``rim_mass`` (kg) is the pulley's inertia as a mass at its rim, c = I/R², and ``axle`` (N) the friction
    of its axle as a force there; ``gravity`` (m/s²) is found only if asked for. ``pulley_mass`` (kg) needs
    the pulley's shape, ``moment_of_inertia`` (kg m²) its radius. ``uncertainty`` and ``interval`` (95 %) are
    those of what was found, by name; ``between_runs`` (kg) is the standard deviation between runs that their
    own uncertainties do not explain, as a mass; ``chi2`` is χ² by these uncertainties, ``dof`` the number of
    degrees of freedom. ``runs`` are rows as ``--csv`` has them, and ``notes`` name options of the command:
    its ``--without 5`` is ``without=[5]`` here. As text it is the table, with the notes below.
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
        found = {x: Result(getattr(self, x), u, ends[x]) for x, u in self.uncertainty.items()}
        table = [COLUMNS, *rows_of(found)] if found else []
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]
        return "\n".join([*lines, *(line for note in self.notes for line in wrapped(note, WIDTH))])


def found(fit: Fit, inputs: Inputs) -> dict[str, Result]:
    """What was found, with R the moment of inertia before it, with the shape the pulley's mass behind it.

    What no pulley, no axle and no gravity can be is no result, nor is anything beside such a pulley.
    """

    def result(value: float, u: float) -> Result:
        return Result(value, u, (value - fit.times * u, value + fit.times * u))

    names = [] if fit.void else [x for x in FOUND if x in fit.values and x not in fit.impossible]
    results = {name: result(fit.values[name], fit.uncertainty(name)) for name in names}
    if c := results.get("rim_mass"):
        R, beta = inputs["R"], inputs["inertia"]
        if R.value is not None:
            r, u = float(R.value), float(R.uncertainty)
            spread = hypot(c.uncertainty * r * r, 2 * c.value * r * u)
            results = {"moment_of_inertia": result(physics.moment_of_inertia(c.value, r), spread)} | results
        if beta.value is not None:
            mass, share = c.value / float(beta.value), float(beta.uncertainty / beta.value)
            results["pulley_mass"] = result(mass, hypot(c.uncertainty / float(beta.value), mass * share))
    return results


WIDTH = 80
"""Characters of a line of text, at most."""
COLUMNS = ("Quantity", "Value", "Unit", "Symbol", "95 % interval")


def rows_of(values: Mapping[str, Result], digits: int | None = None) -> list[tuple[str, ...]]:
    """The table of what was found, a row a quantity."""
    written = {name: published(*one, digits) for name, one in values.items()}
    return [(name, value, UNITS[name], SYMBOLS[name], ends) for name, (value, ends) in written.items()]


def results(fit: Fit, inputs: Inputs, notes: Sequence[str]) -> Results:
    """All of a fit, with sentences on it."""
    values, correlation = found(fit, inputs), fit.correlation
    said = {name: values[name].value if name in values else None for name in Results._fields[:5]}
    return Results(
        **said,
        uncertainty={name: one.uncertainty for name, one in values.items()},
        interval={name: list(one.interval) for name, one in values.items()},
        correlation=correlation and correlation[2],
        chi2=fit.chi2,
        dof=fit.dof,
        between_runs=fit.between_runs,
        runs=lines(fit),
        notes=notes,
    )


def lines(fit: Fit) -> list[dict[str, Any]]:
    """The runs, as JSON and CSV have them; the residual is in standard uncertainties."""
    return [
        {
            "rows": " ".join(map(str, line.run.rows)),
            **line.run.labels,
            "m1": float(line.run.m1.value),
            "m2": float(line.run.m2.value),
            **({} if line.run.drop is None else {"drop": float(line.run.drop.value)}),
            fit.runs.kind: line.measured,
            "u": line.uncertainty,
            "expected": line.expected,
            "residual": line.residual,
        }
        for line in fit.lines
    ]


class Points(NamedTuple):
    """Runs as points (a, T_h - T_l) of a straight line, with standard uncertainties; c is its slope.

    Those of ``y`` come from those of ``x``, so that the residuals, y less the line, have their own.
    """

    x: Column
    y: Column
    u_x: Column
    u_y: Column
    residual: Column
    u_residual: Column
    slope: float
    intercept: float


def points(fit: Fit) -> Points:
    """The runs that were used, as points."""
    data, values, u = fit.data, fit.estimate.values, fit.sigma
    a, y = _as_points(data, values["gravity"])
    if data.kind == "time":
        u = u * 2 * a / data.measured
    c, f = values["rim_mass"], values["axle"]
    line: Any = physics.difference_of_a_pulley(np.float64(c), a, np.float64(f))
    masses = data.l + data.h
    return Points(a, y, u, masses * u, y - line, (masses + c) * u, c, f)


def left_out(fit: Fit) -> tuple[Sequence[Run], Column, Column]:
    """The runs that were left out as asked, as points (a, T_h - T_l)."""
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


def prediction(fit: Fit, inputs: Inputs) -> str:
    """The command that solves a scene with what was found; empty if that is no scene."""
    values = found(fit, inputs)
    if any(fit.values[name] < 0 for name in fit.values):
        return ""
    run = fit.used[0]
    words = {"m1": as_typed(run.m1.value), "m2": as_typed(run.m2.value)}
    words |= {x: str(one.given) for x, one in inputs.items() if one.given is not None}
    if "rim_mass" in values:
        if inputs["inertia"].given is not None:
            words["M"] = cut(*values["pulley_mass"][:2])
        elif inputs["R"].given is not None:
            words["I"] = cut(*values["moment_of_inertia"][:2])
        else:
            words |= {"M": cut(*values["rim_mass"][:2]), "inertia": "hoop"}
    words |= {x: cut(*values[name][:2]) for x, name in (("axle", "axle"), ("g", "gravity")) if name in values}
    options = (f"--{x.replace('_', '-')} {_quoted(word)}" for x, word in words.items())
    return f"atwood solve {' '.join(options)}"


def _quoted(word: str) -> str:
    from shlex import quote

    return quote(word)
