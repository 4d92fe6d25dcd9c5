"""The door for Python: `solve`."""

from decimal import Decimal
from typing import TYPE_CHECKING, Any, overload

from .model.quantities import NAMES, Solution
from .model.scene import Given, read_digits
from .solver.answers import read_answers
from .solver.messages import notes

if TYPE_CHECKING:
    from typing import TypedDict, Unpack

    class Inputs(TypedDict, total=False):
        m1: Given
        m2: Given
        M: Given | None
        mu: Given | None
        mu_k: Given | None
        g: Given
        inertia: Given | None
        I: Given | None
        R: Given | None
        wrap: Given
        a: Given | None
        drop: Given | None
        time: Given | None


@overload
def solve(*, digits: None = None, **given: "Unpack[Inputs]") -> Solution[float]: ...
@overload
def solve(*, digits: int | str, **given: "Unpack[Inputs]") -> Solution[Decimal]: ...
def solve(
    *,
    m1: Given | None = None,
    m2: Given | None = None,
    M: Given | None = None,
    mu: Given | None = None,
    mu_k: Given | None = None,
    g: Given | None = None,
    inertia: Given | None = None,
    I: Given | None = None,
    R: Given | None = None,
    wrap: Given | None = None,
    a: Given | None = None,
    drop: Given | None = None,
    time: Given | None = None,
    digits: int | str | None = None,
) -> Any:
    """The state of Atwood's machine: m1 and m2 on a rough string over a pulley.

    Masses in kg, R in m, I in kg m², g in m/s², wrap in degrees; text may carry a unit ("250g",
    "5cm") or name a body or shape (g="moon", inertia="hoop"). What is given decides the model:
    no M, a massless pulley, or with mu the one that brings the string to the verge of slipping.
    Defaults: g standard gravity, inertia that of a disk (1/2), wrap 180, mu_k = mu.

    ``a``, a measured acceleration, stands in place of M, or beside M of g, and finds it; ``drop``, a
    height, gives the time and speed of the fall, and with ``time`` stands for the ``a`` it implies. A
    MeasuredSolution comes back, which has these results too.

    Text may carry a standard uncertainty, as "1.000(2)", "1.000±0.002" or "(250±1)g"; the solution's
    ``uncertainty`` then has those of the quantities by name, to first order.

    Floats come back, each the double nearest to the exact value; with ``digits=N`` Decimals, each
    correctly rounded to N significant digits. Raises SceneError (a ValueError) on bad input.
    """
    given = {key: value for key, value in locals().items() if key != "digits"}
    answers, uncertain = read_answers(given, read_digits(digits))
    values = {name: answers[name] for name in answers.names}
    remarks, spreads = notes(answers), {}
    if uncertain:
        from .solver.uncertainty import propagate

        found = propagate(answers.case, uncertain, answers.names)
        remarks, spreads = [*remarks, *found.notes], found.rounded(answers)
    kind: type[Solution[Any]] = Solution
    if answers.names != NAMES:
        from .model.motion import MeasuredSolution

        kind = MeasuredSolution
    return kind(scene=answers.case.scene, notes=tuple(remarks), uncertainty=spreads, **values)
