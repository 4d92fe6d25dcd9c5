"""The rim mass c and the axle's friction f that fit runs best, by least squares: T_h - T_l = c a + f."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from math import inf, sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..solver import physics
from ..solver.decisions import Decisions
from ..solver.scene import Input, Scene
from .results import FITTED, Result
from .runs import Column, Places, Runs, Selection
from .statistics import NORMAL_DOF, CannotSeparate, Line, fit_line, sum_of_squares

SLOWEST = 0.01
"""Below this share of the measured acceleration an expected time goes on along its tangent."""
NEAR, ENOUGH, CLOSE, MOST_STEPS, MOST_SEARCHES = 1e-2, 1e-6, 1e-11, 100, 10
"""Shares of what is expected. A step below ``NEAR`` is linear, and one below ``CLOSE`` is the last.

Linear steps lead away from some least squares of rough runs; then a step below ``ENOUGH`` is the last, too.
After ``MOST_SEARCHES`` steps that are not linear none will be.
"""
ROUNDING = 1e-12
"""The least standard uncertainty of a measured number, as a share of it."""
LEAST_SINGULAR = 4e-4
"""Below this singular value of its slopes, each of length 1, a design does not separate the quantities."""
TINY = 1e-100


Varying = Literal["value", "time", "force"]
"""What an unknown variance is of: single values, if nothing shows that, or the times or forces of runs."""


class Data(NamedTuple):
    """Runs as a fit sees them (n): light and heavy masses apart, and what was measured, positive.

    ``drop`` is None for accelerations. ``measured`` are means of so many values as ``counts`` says.
    ``scatter`` is the standard uncertainty of a mean, ``stated`` or by its repeats, 0 without either.
    Its variance has ``known_dof`` degrees of freedom. ``uncertain`` has the uncertainties of other columns.
    Beyond these runs scatter by what is ``varying``.
    """

    l: Column
    h: Column
    drop: Column | None
    measured: Column
    counts: Places
    scatter: Column
    stated: bool
    known_dof: float
    uncertain: Mapping[str, Column]
    varying: Varying


def data_of(runs: Runs, used: Selection) -> Data:
    """Return the runs that are ``used``."""
    here = used[runs.run]
    run = (np.cumsum(used) - 1)[runs.run[here]]
    values, u = (runs.sign[runs.run] * runs.values)[here], runs.u_values[here]
    stated = bool(u.any())
    weight = np.where(u > 0, u, 1.0) ** -2  # a run that is left out may have none
    total, counts = np.bincount(run, weight), np.bincount(run)
    measured = np.bincount(run, weight * values) / total
    chi2 = sum_of_squares(np.sqrt(weight) * (values - measured[run]))
    dof = len(values) - len(counts)
    rounding = runs.step**2 / 12
    if stated:
        variance, known_dof = max(chi2 / max(dof, 1), 1.0) / total, NORMAL_DOF
    elif chi2:
        variance, known_dof = chi2 / dof / total + rounding, float(dof)
    else:  # few repeats that are equal may be rows copied
        variance, known_dof = np.full(len(total), rounding * (dof >= len(counts))), NORMAL_DOF
    columns = {x: np.stack([runs.given[x][used], runs.u[x][used]]) for x in runs.given}
    m1, m2 = columns["m1"], columns["m2"]
    (l, u_l), (h, u_h) = np.where(m1[0] > m2[0], (m2, m1), (m1, m2))
    drop, u_drop = columns.get("drop", (None, 0 * l))
    uncertain = {x: u for x, u in (("l", u_l), ("h", u_h), ("drop", u_drop)) if u.any()}
    of_runs: Varying = "force" if drop is None else "time"
    varying = of_runs if variance.any() else "value"
    return Data(l, h, drop, measured, counts, np.sqrt(variance), stated, known_dof, uncertain, varying)


# What is expected of runs


def expected(data: Data, values: Mapping[str, Any]) -> Any:
    """Return the acceleration of the heavier mass, or the time of its fall with the delay, for each run.

    ``values`` are rim_mass, axle, gravity and delay, and may replace columns. If next to nothing would
    move, the time goes on along its tangent, so that a fit finds its way back.
    """
    x: dict[str, Any] = {**data._asdict(), **values}
    drive = physics.drive(x["l"], x["h"], physics.axle_mass(x["axle"], x["gravity"]))
    a = physics.acceleration(drive, physics.load(x["l"], x["h"], x["rim_mass"]), x["gravity"])
    if data.drop is None:
        return a
    least = SLOWEST * accelerations(data, data.measured)
    root: Any = np.sqrt
    moving = np.where(np.real(a) < least, least, a)
    return physics.fall_time(x["drop"], moving, root) * (1 + (moving - a) / (2 * moving)) + x["delay"]


def accelerations(data: Data, measured: Any, delay: float = 0.0) -> Any:
    """Convert fall times, less the delay, to accelerations; measured accelerations stay as they are."""
    return measured if data.drop is None else physics.acceleration_of_fall(data.drop, measured - delay)


Residual = Callable[[Data, Mapping[str, Any]], Any]
"""Return for each run what is left of an equation that holds; ``values`` may replace columns of the data."""


def of_measured(data: Data, values: Mapping[str, Any]) -> Any:
    """Return what is measured less what is expected."""
    return values.get("measured", data.measured) - expected(data, values)


def of_forces(data: Data, values: Mapping[str, Any]) -> Any:
    """Return T_h - T_l less c a + f by the accelerations measured: c, f and gravity are linear in it."""
    x: dict[str, Any] = {**data._asdict(), **values}
    a = accelerations(data._replace(drop=x["drop"]), x["measured"], x["delay"])
    tensions = physics.difference_of_moving_masses(x["l"], x["h"], a, x["gravity"])
    return tensions - x["rim_mass"] * a - x["axle"]


def slope(residual: Residual, data: Data, values: Mapping[str, Any], name: str) -> Any:
    """Return the derivative by a value or a column, to the last digit: the imaginary part by a small one."""
    x = {**data._asdict(), **values}[name]
    return residual(data, {**values, name: x + 1j * TINY}).imag / TINY


def slopes(residual: Residual, data: Data, values: Mapping[str, float], names: Sequence[str]) -> Any:
    """Return the derivatives of what is expected, or of c a + f, by the values of these names: (n, p)."""
    columns = [-slope(residual, data, values, name) for name in names]
    return np.stack(columns, 1) if names else np.zeros((len(data.l), 0))


def line_of(residual: Residual, data: Data, values: Mapping[str, float], names: Sequence[str]) -> Line:
    """Return the linear fit of changes of the ``names``, at these values. Raises CannotSeparate."""
    by_measured = slope(residual, data, values, "measured")
    known = (by_measured * data.scatter) ** 2
    known = known + float(np.square(ROUNDING * by_measured * data.measured).max())  # no weight has no bound
    for name, u in data.uncertain.items():
        known = known + (slope(residual, data, values, name) * u) ** 2
    root = slope(residual, data, values, "axle") if data.varying == "force" else by_measured
    scale = root**2 / data.counts if data.varying == "value" else root**2
    J = slopes(residual, data, values, names)
    return fit_line(J, residual(data, values), known, scale, data.known_dof)


def separates(data: Data, known: Mapping[str, float], names: Sequence[str]) -> bool:
    """Decide if runs with these masses and heights determine the quantities, whatever was measured.

    The singular values of the slopes at a plausible pulley tell, each slope scaled to the length 1.
    """
    design = data._replace(measured=np.full_like(data.l, inf))
    least = float((data.h - data.l).min()) * known["gravity"]
    values = {"rim_mass": 0.1 * float(np.median(data.l + data.h)), "delay": 0.0, **known}
    values["axle"] = min(known.get("axle", least), 0.1 * least)  # with which each run moves
    J: Any = slopes(of_measured, design, values, names) / expected(design, values)[:, None]
    singular = np.linalg.svd(J / np.linalg.norm(J, axis=0), compute_uv=False)
    return bool(singular.min(initial=1.0) > LEAST_SINGULAR)


# Least squares


def by_forces(data: Data, known: Mapping[str, float], names: Sequence[str]) -> dict[str, float]:
    """Return the values with the least squares of forces, by which others start, and the given ones."""
    values = {**dict.fromkeys(FITTED, 0.0), **known}
    rest = of_forces(data, values)
    changes = np.linalg.lstsq(slopes(of_forces, data, values, names), rest, rcond=None)[0]
    return values | {x: values[x] + float(change) for x, change in zip(names, changes, strict=True)}


def estimate(
    data: Data, known: Mapping[str, float], names: Sequence[str], near: Mapping[str, float] | None = None
) -> tuple[dict[str, float], Line]:
    """Weighted least squares for ``names``, starting at ``near``. Raises CannotSeparate.

    Return the values, given ones too, and the linear fit at these. Variances follow the values (effective
    variance), and least squares the variances.
    """
    first = {**(near or by_forces(data, known, names)), **known}
    lightest = -(1 - 1e-9) * float((data.l + data.h).min())  # with less, nothing is left to move
    least = [lightest if name == "rim_mass" else -inf for name in names]
    exactly: Any = {"ftol": 1e-15, "xtol": 1e-12, "gtol": None, "jac": "cs", "x_scale": "jac"}

    def at(x: Any) -> dict[str, Any]:
        return {**first, **dict(zip(names, x, strict=True))}

    def rest(x: Any, sigma: Column) -> Any:
        return of_measured(data, at(x)) / sigma

    x, size = np.array([first[name] for name in names]), inf
    for step in range(MOST_STEPS):
        line = line_of(of_measured, data, at(x), names)
        share = line.J @ line.coefficients / data.measured
        before, size = size, sqrt(sum_of_squares(share) / len(share))
        if size < NEAR:
            x = x + line.coefficients
        elif step < MOST_SEARCHES:
            x = np.maximum(x, np.divide(least, 2))
            x = least_squares(rest, x, args=(line.sigma,), bounds=(least, inf), max_nfev=100, **exactly).x
        else:
            break
        if size < CLOSE or before < size < ENOUGH:
            return at(x.tolist()), line
    raise CannotSeparate


def moves(data: Data, values: Mapping[str, float]) -> Selection:
    """Decide for each run if the heavier mass would descend."""
    return np.asarray(expected(data._replace(drop=None), values) > 0)


class Conditions(NamedTuple):
    """The inputs that all runs share, perhaps ``drop``, and how the user types an ``option``."""

    inputs: Mapping[str, Input]
    scene: Scene
    option: Callable[..., str]

    @property
    def values(self) -> dict[str, float]:
        """Return the quantities of a fit that are given, and the height of fall."""
        scene, has_pulley = self.scene, self.scene.M is not None or self.scene.I is not None
        values = {"gravity": scene.g, "drop": scene.motion.drop, "axle": scene.axle}
        values |= {"rim_mass": Decisions(scene).rim_mass} if has_pulley else {}
        return {x: float(value) for x, value in values.items() if value is not None}


class Fitted(NamedTuple):
    """The fit of the runs that are ``used``: ``values`` of all quantities, of which ``names`` are fitted.

    ``line`` is the linear fit of the measurements at these values. Something can be expected of all runs that
    are ``shown``; the others of these are left out. ``outliers`` are runs, with a message on each, and
    ``cause`` says what may be wrong in all runs.
    """

    runs: Runs
    used: Selection
    shown: Selection
    shared: Conditions
    names: Sequence[str]
    data: Data
    values: Mapping[str, float]
    line: Line
    results: Mapping[str, Result] = {}
    outliers: Sequence[tuple[int, str]] = ()
    cause: str = ""


def rough_fit(runs: Runs, used: Selection, shared: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit by forces, which needs no steps. Raises CannotSeparate."""
    data = data_of(runs, used)
    values = by_forces(data, shared.values, names)
    line = line_of(of_forces, data, values, names)
    return Fitted(runs, used, used, shared, names, data, values, line)


def best_fit(runs: Runs, used: Selection, shared: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit with the likelier scatter between runs. Raises CannotSeparate.

    Where repeats, or stated uncertainties, show the scatter of times, that between runs is one of times or of
    forces: with the greater restricted likelihood, or of times if both are as likely. A fit whose axle would
    hold a run that moved loses.
    """
    data, fits = data_of(runs, used), list[Fitted]()
    either: tuple[Varying, ...] = ("time", "force") if data.varying == "time" else (data.varying,)
    for varying in either:
        with suppress(CannotSeparate, ZeroDivisionError):  # a gravity of 0 holds no axle
            shaped = data._replace(varying=varying)
            fits.append(
                Fitted(runs, used, used, shared, names, shaped, *estimate(shaped, shared.values, names))
            )
    if not fits:
        raise CannotSeparate
    return max(fits, key=lambda fit: (moves(fit.data, fit.values).all(), round(fit.line.likelihood, 6)))
