"""A fit as it is handed out: values with their uncertainties, the runs, and the command that predicts."""

from collections.abc import Mapping
from fractions import Fraction
from math import sqrt
from typing import Any, NamedTuple

from ..arithmetic.rounding import as_typed, text, to_digits, to_place
from ..model import physics
from ..model.scene import Input
from .fitting import FOUND, Fit

Inputs = Mapping[str, Input]


class Result(NamedTuple):
    """A value and its standard uncertainty."""

    value: float
    uncertainty: float


def results(fit: Fit, inputs: Inputs) -> dict[str, Result]:
    """What was found, and what follows: with R the moment of inertia, with the shape the pulley's mass."""
    found = {name: Result(fit.values[name], fit.uncertainty(name)) for name in FOUND if name in fit.values}
    if "rim_mass" in found and found["rim_mass"].value > 0:
        c, R, beta = found["rim_mass"], inputs["R"], inputs["inertia"]
        if R.value is not None:
            value = physics.moment_of_inertia(c.value, float(R.value))
            found["moment_of_inertia"] = Result(value, _of_product(value, c, R, 2))
        if beta.value is not None:
            value = c.value / float(beta.value)
            found["pulley_mass"] = Result(value, _of_product(value, c, beta, 1))
    return found


def _of_product(value: float, one: Result, other: Input, power: int) -> float:
    """The uncertainty of a product, or quotient, of a result and a power of an input."""
    shares = one.uncertainty / one.value, power * float(other.uncertainty / other.value)
    return abs(value) * sqrt(sum(share**2 for share in shares))


def record(fit: Fit, inputs: Inputs, notes: list[str]) -> dict[str, Any]:
    """All of a fit by name, as JSON has it."""
    found = results(fit, inputs)
    values: dict[str, Any] = {name: found[name].value if name in found else None for name in FOUND}
    values |= {name: one.value for name, one in found.items()}
    correlation = fit.correlation
    return {
        **values,
        "uncertainty": {name: one.uncertainty for name, one in found.items()},
        "correlation": correlation and correlation[2],
        "chi2": fit.chi2,
        "dof": fit.dof,
        "runs": lines(fit),
        "notes": notes,
    }


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


def prediction(fit: Fit, inputs: Inputs) -> str:
    """The command that solves a scene with what was found; empty if that is no scene."""
    found = results(fit, inputs)
    if any(found[name].value < 0 for name in FOUND if name in found):
        return ""
    run = fit.used[0]
    words = {"m1": as_typed(run.m1.value), "m2": as_typed(run.m2.value)}
    words |= {x: str(one.given) for x, one in inputs.items() if one.given is not None}
    if "rim_mass" in found:
        c, beta, R = found["rim_mass"], inputs["inertia"], inputs["R"]
        if beta.given is not None:
            words["M"] = _rounded(found["pulley_mass"])
        elif R.given is not None:
            words["I"] = _rounded(found["moment_of_inertia"])
        else:
            words |= {"M": _rounded(c), "inertia": "hoop"}
    words |= {x: _rounded(found[name]) for x, name in (("axle", "axle"), ("g", "gravity")) if name in found}
    options = (f"--{x.replace('_', '-')} {_quoted(word)}" for x, word in words.items())
    return f"atwood solve {' '.join(options)}"


def _quoted(word: str) -> str:
    from shlex import quote

    return quote(word)


def _rounded(one: Result) -> str:
    """A value to the second digit of its uncertainty."""
    exact = Fraction(one.value)
    if not one.uncertainty:
        return text(to_digits(6)(exact))
    return text(to_place(to_digits(2)(Fraction(one.uncertainty)).adjusted() - 1)(exact))
