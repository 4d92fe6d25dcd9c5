"""The Python interface to one scene: `solve`, and the `Solution` that it returns."""

from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from inspect import Parameter, Signature
from math import isinf
from typing import TYPE_CHECKING, Any, Generic, TypedDict, TypeVar, Unpack, overload

from .explain.given import VERSION
from .explain.messages import notes
from .numbers.digits import SHOWN_DIGITS
from .numbers.text import nearest
from .reading.inputs import read_digits
from .reading.names import input_meant
from .reading.scenes import read_answers
from .solver.answers import Answers
from .solver.quantities import MEASURED_NAMES, QUANTITIES, STANDARD, Regime
from .solver.scene import DRIVE, Given, Scene


class Inputs(TypedDict, total=False):
    """The inputs of `solve` other than masses and ``digits``. One that is None or left out is not given."""

    M: Given | None
    mu: Given | None
    mu_k: Given | None
    g: Given | None
    inertia: Given | None
    I: Given | None
    R: Given | None
    wrap: Given | None
    axle: Given | None
    a: Given | None
    drop: Given | None
    time: Given | None
    speed: Given | None
    find: Given | None  # a name; more, so that solve(**given) takes a dictionary of numbers


T = TypeVar("T", float, Decimal)


def _described() -> str:
    """Return lines on the quantities for a docstring: name, meaning, unit, equation."""
    lines = []
    for name, about in QUANTITIES.items():
        unit = f" [{about.unit}]" if about.unit else ""
        equation = f", {about.equation}" if about.equation else ""
        lines.append(f"    {name:<{max(map(len, QUANTITIES))}}  {about.meaning}{unit}{equation}")
    return "\n".join(lines)


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Solution(Generic[T]):
    __doc__ = f"""The state of a scene: floats, or Decimals if digits were asked for; None if undetermined.

    ``scene`` has the inputs, exact and in SI units; `solve` takes its fields but ``motion`` and ``terms``
    again. ``regime`` is "no-slip", "verge" or "slip". ``notes`` give the reasons for it, and for each field
    that is None. ``uncertainty`` has the standard uncertainty of every quantity by name, to at most 15
    digits, and is empty if all inputs are exact; an uncertainty is None, with a note, if the value is missing
    with an input an uncertainty off. Each field is computed when it is first read.

    Forces are on the pulley, with x from the axle to the place where m1's string meets it, and y up.
    Accelerations, torque and angles are positive when m2 descends. The quantities, with their units, which
    ``atwood_cli.QUANTITIES[name].unit`` gives, too, and the paper's equations; those from
    ``{MEASURED_NAMES[0]}`` on follow from a measured motion, else are None, as those that are inputs:

{_described()}
    """

    scene: Scene
    notes: tuple[str, ...]
    regime: Regime | None
    acceleration: T | None
    tension_1: T | None
    tension_2: T | None
    tension_difference: T | None
    mu_verge: T | None
    safety_factor: T | None
    tension_ratio: T | None
    capstan_ratio: T | None
    friction_force: T | None
    friction_force_min: T | None
    friction_force_max: T | None
    friction_force_x: T | None
    friction_force_y: T | None
    axle_force: T | None
    torque: T | None
    rim_acceleration: T | None
    angular_acceleration: T | None
    critical_pulley_mass: T | None
    critical_heavier_mass: T | None
    critical_lighter_mass: T | None
    least_heavier_mass: T | None
    least_pulley_mass: T | None
    least_wrap: T | None
    pulley_mass: T | None
    moment_of_inertia: T | None
    gravity: T | None
    m1: T | None
    m2: T | None
    mu_k: T | None
    axle: T | None
    axle_torque: T | None
    drive_force: T | None
    drive_torque: T | None
    drive_power: T | None
    drop: T | None
    fall_time: T | None
    final_speed: T | None
    final_angular_speed: T | None
    kinetic_energy: T | None
    uncertainty: Mapping[str, T | None]

    def __init__(self, answers: Answers) -> None:
        object.__setattr__(self, "_answers", answers)

    if TYPE_CHECKING:
        _answers: Answers  # no field
    else:  # a type checker would take any name for a field

        def __getattr__(self, name: str) -> Any:
            """Compute a field that was not read yet, and keep it."""
            if name not in self.__dataclass_fields__:
                return object.__getattribute__(self, name)  # raises the usual error
            answers = self._answers
            match name:
                case "scene":
                    value = answers.decided.scene
                case "uncertainty":
                    names = answers.names[1:] if answers.uncertain else ()
                    value = {name: answers.uncertainty(name) for name in names}
                case "notes":
                    value = tuple(notes(answers, answers.names))
                case _:
                    value = answers[name] if name in answers.names else None
            object.__setattr__(self, name, value)
            return value

    def __dir__(self) -> list[str]:
        """Return all names, as a field has none in Python before it is read."""
        return [*object.__dir__(self), *self.__dataclass_fields__]

    def to_dict(self, budget: bool = False) -> dict[str, Any]:
        """Return the record of ``--json`` (and ``--budget``): Decimals are text, infinite values None."""
        from json import loads

        from .output.scene_page import record
        from .output.text import as_json

        def number(typed: str) -> Any:
            return typed if self._answers.digits or isinf(float(typed)) else float(typed)

        text = "".join(as_json(record(self._answers, budget=budget)))
        return {**loads(text, parse_float=number, parse_int=number), "version": VERSION}

    def __str__(self) -> str:
        """Return the page that ``atwood solve`` prints, without colours."""
        from .output.scene_page import page_as_text

        return page_as_text(self._answers)

    def __repr__(self) -> str:
        """Return the regime, and the usual quantities to six digits, or with their uncertainties."""
        from .output.scene_page import quantity_in_words

        answers = self._answers.rounded_to(SHOWN_DIGITS)
        shown: list[str] = [
            quantity_in_words(answers, name) for name in STANDARD[1:] if answers[name] is not None
        ]
        return f"<Solution {'; '.join([*filter(None, [self.regime]), *shown])}>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(str(self))}</pre>"

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        one, two = ((x.decided.scene, x.digits, x.uncertain) for x in (self._answers, other._answers))
        return one == two

    def __hash__(self) -> int:
        return hash(self.scene)

    def __reduce__(self) -> tuple[Any, ...]:
        answers = self._answers
        return _again, (type(answers), answers.decided.scene, answers.digits, answers.inputs)


def _again(kind: type[Answers], *given: Any) -> Solution[Any]:
    """Make a copied or pickled solution, which is computed anew when it is read."""
    return Solution(kind(*given))


Mass = Given | None


@overload
def solve(
    m1: Mass = ..., m2: Mass = ..., *, digits: None = None, **given: Unpack[Inputs]
) -> Solution[float]: ...
@overload
def solve(
    m1: Mass = ..., m2: Mass = ..., *, digits: int | str, **given: Unpack[Inputs]
) -> Solution[Decimal]: ...
@overload
def solve(
    m1: Mass = ..., m2: Mass = ..., *, digits: Given | None = ..., **given: Unpack[Inputs]
) -> Solution[Any]: ...
def solve(m1: Mass = None, m2: Mass = None, *, digits: Any = None, **given: Unpack[Inputs]) -> Any:
    """Solve Atwood's machine: m1 and m2 on a rough string over a pulley.

    The inputs decide the model. Without M the pulley is massless; with mu and without M it is the pulley that
    brings the string to the verge of slipping. An input is a number in the unit below, or a text, which may
    have a unit ("250g", "5cm", "9.81m/s2"), a name (g="moon", inertia="hoop") or a standard uncertainty
    ("1.000(2)", "1.000±0.002", "(250±1)g").

    Args:
        m1, m2: The masses, in kg.
        M: The pulley's mass, in kg; "inf" locks it.
        mu, mu_k: The coefficients of static and of kinetic friction; mu_k is mu unless given.
        g: Gravity, in m/s²; standard gravity unless given.
        inertia: I/(M R²); 1/2, that of a disk, unless given.
        I, R: The moment of inertia, in kg m², and the radius, in m.
        axle: The friction of the axle as a force at the rim, in N, or as text a torque ("0.4mNm"); 0 unless
            given.
        wrap: The angle that the string wraps, in degrees; 180 unless given.
        a: A measured acceleration, in m/s². Without M it finds M. Beside M it finds the mass or the g that
            is not given, or mu_k if the string slips, as it must on M="inf".
        drop, time, speed: Of a fall from rest the height, in m, the time, in s, and the speed at its end, in
            m/s. Two stand for the acceleration ``a`` that they imply; one gives the others. Where a mass is
            to be found, m2 falls, and rises if the height or the speed is below 0.
        find: The input that the motion gives, "m1", "m2", "M", "g", "mu_k" or "axle", or the
            "drive": a motor or a brake that moves the masses so.
        digits: The number of significant digits of Decimals; None gives floats.

    Returns:
        `Solution`: the quantities by name, in SI units. A float is the double nearest to the exact value;
        a Decimal is correctly rounded. Its ``uncertainty`` combines half the range of a value over the
        uncertainty of each input, as the root of the sum of squares (Kragten, 1994).

    Raises:
        SceneError: An input is not valid; it names the input, the value and the rule (a ValueError).
        TypeError: There is no such input.
    """
    for name in given.keys() - Inputs.__annotations__.keys():
        meant = input_meant(name).replace(DRIVE, "find='drive'")
        hint = f"; did you mean {meant}?" if meant else nearest(name, Inputs.__annotations__)
        raise TypeError(f"solve() got an unexpected keyword argument {name!r}{hint}")
    inputs: dict[str, Any] = {"m1": m1, "m2": m2, **given}
    return Solution(read_answers(inputs, read_digits(digits)))


_kinds = dict.fromkeys(("m1", "m2"), Parameter.POSITIONAL_OR_KEYWORD)
_types = {"find": "str | None", "digits": "int | str | None"}
_parameters = [
    Parameter(
        x, _kinds.get(x, Parameter.KEYWORD_ONLY), default=None, annotation=_types.get(x, "Given | None")
    )
    for x in (*_kinds, *Inputs.__annotations__, "digits")
]
# help() and editors show the inputs by this attribute, which type checkers do not know of a function.
solve.__dict__["__signature__"] = Signature(_parameters, return_annotation="Solution")
