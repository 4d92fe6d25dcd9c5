"""From runs to a result: values, uncertainties, outliers and causes, or why there is none."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from math import hypot

import numpy as np

from ..numbers.digits import half_range
from ..numbers.text import counted
from ..reading.names import read_names
from ..solver import physics
from ..solver.scene import MASSES, Input, Scene, SceneError, parameter_of
from .diagnosis import (
    CHECK,
    MOST_SHARE,
    columns_in_doubt,
    contradiction,
    diagnosed,
    impossible,
    is_negative,
    unseen_delay,
)
from .estimate import Conditions, Fitted, best_fit, data_of, estimate, moves, rough_fit, separates
from .results import FITTED, QUANTITIES, RESULTS, SYMBOLS, USUAL, Result, as_determined, equation, in_python
from .runs import OUT_OF_RANGE, Runs, Selection, behind_an_error, in_range
from .statistics import CannotSeparate

GIVE = {"rim_mass": "M (or I and R)", "axle": "axle (0 if it has no friction)"}
"""What to give for a quantity that is neither given nor fitted."""
NO_FIT = "no pulley explains these runs, whatever its inertia and its axle's friction"


# What is given, and what is to be fitted


def conditions_of(inputs: Mapping[str, Input], option: Callable[..., str] = in_python) -> Conditions:
    """Return the conditions that inputs give. Raises SceneError."""
    for x, typed in inputs.items():
        if typed.given is not None and not in_range(typed):
            raise SceneError(x, typed.given, OUT_OF_RANGE)
        if not parameter_of(x).may_be_zero and 0 < (typed.number or 0) <= typed.uncertainty:
            raise SceneError(x, typed.given, "has an uncertainty that reaches 0")
    masses = {f"m{i}": Input(Fraction(i), Fraction(0), None) for i in (1, 2)}  # any would do
    return Conditions(inputs, Scene.of({**inputs, **masses}), option)


def read_find(words: Sequence[str], shared: Conditions) -> list[str]:
    """Return the quantities to fit, by names or symbols; both usual ones unless given. Raises SceneError.

    None may be given, and of the usual ones none may be neither given nor fitted.
    """
    names = list(dict.fromkeys(read_names("find", words, FITTED, "quantity to fit", SYMBOLS)))
    for name in names:
        for known in QUANTITIES[name].given_by:
            if shared.inputs[known].given is not None:
                rule = f"conflicts with {known}, which gives it; leave one of them out"
                raise SceneError("find", name, rule)
    for x, terms in shared.scene.terms if "gravity" in names else ():
        if terms.by == "g":
            rule = f"is {terms.words}, and gravity is to be found; give it in kg"
            raise SceneError(x, shared.inputs[x].given, rule)
    left = [x for x in USUAL if x not in names and x not in shared.values]
    if names and left:
        what, give = (" and ".join(words[x] for x in left) for words in (RESULTS, GIVE))
        rule = f"needs {what}: give {give}, or find {' and '.join(left)}, too"
        raise SceneError("find", ",".join(names), rule)
    return names or left


# From runs to a result


@np.errstate(all="ignore")  # what a step tries may be 0, or beyond doubles
def fitted(runs: Runs, shared: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of these quantities, with outliers and causes. Raises SceneError, CannotSeparate."""
    if "delay" in names and runs.kind != "time":
        raise SceneError("find", "delay", "needs times; the table has accelerations")
    difference = runs.given["m2"] - runs.given["m1"]
    held = 0.0 if "gravity" in names else shared.values.get("axle", 0.0) / shared.values["gravity"]
    unusable = {
        "the masses are equal": difference == 0,
        "nothing moved": runs.mean == 0,
        "the lighter side falls": runs.sign * runs.mean < 0,
        "an axle with the friction given holds the masses": abs(difference) <= held,
    }
    shown, unused = np.ones(len(runs.rows), dtype=bool), [*runs.unused]
    for reason, holds in unusable.items():
        if (shown & holds).any():
            unused.append(f"{runs.rows_in_words(*np.flatnonzero(shown & holds))}: not used, as {reason}.")
        shown = shown & ~holds
    used = shown & ~runs.left_out
    columns = columns_in_doubt(runs, used)
    runs, doubt = runs._replace(unused=unused, doubts=[*runs.doubts, *columns]), ""
    try:
        if not used.any():
            raise CannotSeparate("no run can be used")
        data = data_of(runs, used)
        what = " and ".join(QUANTITIES[x].words for x in names)
        needed = len(names) + int(data.varying == "value" and not data.uncertain)
        if len(data.l) < needed:
            few = counted(len(data.l), "run")
            raise CannotSeparate(f"{few} cannot determine {what}: give {needed} or more")
        doubt, share = impossible(runs, used, shared, names, MOST_SHARE)
        if share > 0.5:
            raise CannotSeparate
        if not separates(data, shared.values, names):
            give = "".join(f", or give {GIVE[x]}" for x in names if x in GIVE)
            vary = f"vary both m2 - m1 and m1 + m2 more{give}"
            raise CannotSeparate(f"the runs do not determine {what}: {vary}")
        fit = _with_results(runs, used, shared, names)
    except CannotSeparate as error:
        how = behind_an_error([*runs.remarks, *unused, *runs.doubts])
        raise CannotSeparate(f"{doubt or error}{how}") from None
    fit = fit._replace(shown=shown) if columns else diagnosed(fit._replace(shown=shown))
    more = [f"{doubt}."] if doubt and not fit.outliers else []
    cause = fit.cause if fit.cause or fit.outliers or columns else unseen_delay(fit)
    return fit._replace(runs=runs._replace(doubts=[*runs.doubts, *more]), cause=cause)


def _with_results(runs: Runs, used: Selection, shared: Conditions, names: Sequence[str]) -> Fitted:
    """Return the fit of the runs that are used. Raises CannotSeparate if no pulley explains them."""
    fit, results, what = None, dict[str, Result](), NO_FIT
    try:
        fit = best_fit(runs, used, shared, names)
        pairs = [*_at_ends(fit)]
        spread = _with_derived(dict(zip(names, fit.line.u, strict=True)), names, shared)
        for x, value in _with_derived(fit.values, names, shared).items():
            u = hypot(spread[x], *(half_range([value, *(end[x] for end in pair)]) for pair in pairs))
            half = fit.line.times * u
            y, u_y, *ends = (as_determined(number, u) for number in (value, u, value - half, value + half))
            results[x] = Result(y, u_y, (ends[0], ends[1]))
            if x in names and is_negative(x, value, u, fit.line.times):
                what = f"{equation(x, value, u)} is negative"
                raise CannotSeparate
        if runs.kind == "time" and not moves(fit.data, fit.values).all():
            raise CannotSeparate
    except (CannotSeparate, ZeroDivisionError):  # a gravity of 0 holds no axle
        why = impossible(runs, used, shared, names)[0] or CHECK
        with suppress(CannotSeparate):
            why = contradiction(fit or rough_fit(runs, used, shared, names))
        raise CannotSeparate(f"{what}: {why}") from None
    return fit._replace(results=results)


def _at_ends(fit: Fitted) -> Iterator[list[dict[str, float]]]:
    """Yield results with each uncertain input of all runs at both ends. Raises CannotSeparate."""

    def at(runs: Runs, shared: Conditions) -> dict[str, float]:
        data = data_of(runs, fit.used)._replace(varying=fit.data.varying)
        return _with_derived(estimate(data, shared.values, fit.names, fit.values)[0], fit.names, shared)

    runs, shared = fit.runs, fit.shared
    for x, typed in shared.inputs.items():
        if u := typed.uncertainty:
            size = shared.scene.as_given(x)
            scenes = [shared.scene.with_number(x, end) for end in (size - u, size + u)]
            yield [at(runs, shared._replace(scene=scene)) for scene in scenes]
    for name, spread in runs.common.items():
        shifted = MASSES if name == "hanger" else (name,)
        for_ends = [{**runs.given, **{x: runs.given[x] + u for x in shifted}} for u in (-spread, spread)]
        yield [at(runs._replace(given=end), shared) for end in for_ends]


def _with_derived(values: Mapping[str, float], names: Sequence[str], shared: Conditions) -> dict[str, float]:
    """Return the fitted values, with what follows from the rim mass by R and by the shape, if given."""
    results, scene = {x: values[x] for x in FITTED if x in names}, shared.scene
    if "rim_mass" in results:
        if shared.inputs["inertia"].number is not None:
            results["pulley_mass"] = results["rim_mass"] / float(scene.inertia or 0)
        if scene.R is not None:
            results["moment_of_inertia"] = physics.moment_of_inertia(results["rim_mass"], float(scene.R))
    return results
