"""Read the names of quantities, as they are typed."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from ..numbers.text import nearest
from ..solver.quantities import MEASURED_NAMES, QUANTITIES, STANDARD, TABLE_NAMES
from ..solver.scene import DRIVE, FINDABLE, INPUTS, MEASURED, SceneError, Unit
from .units import Malformed, read_unit_of_result

SPELLED = dict(zip("μµφβταωχ₁₂²", "mu mu phi beta tau alpha omega chi 1 2 2".split(), strict=True))
"""What to type for characters of symbols."""
PLAIN = str.maketrans(SPELLED | dict.fromkeys(" _-", ""))
"""Makes a symbol or a name plain, so that Fmin and F_min are the same as F min."""


NAMES_BY_SYMBOL = {
    typed.translate(PLAIN): name for name, about in QUANTITIES.items() for typed in (name, about.symbol)
}

MEANT = {
    **dict.fromkeys("mu mumin leastmu mucrit coefficient frictioncoefficient".split(), "mu_verge"),
    **dict.fromkeys("mcrit criticalmass".split(), "critical_pulley_mass"),
    **{"wrap": "least_wrap", "time": "fall_time", "speed": "final_speed", "rimmass": "moment_of_inertia"},
}
"""The quantities that other words probably mean, in plain small letters."""


MASS_WORDS = "m mass masse masa massa масса".split()
WORDS_FOR_INPUTS = {
    "M": "mp m_pulley pulley pulley_mass mass_pulley mass_of_pulley",
    "mu": "mu_s mu_static static_friction friction coefficient coeff friction_coefficient friction_coeff"
    " coefficient_of_friction",
    "mu_k": "mu_kinetic kinetic_friction",
    "g": "gravity",
    "inertia": "beta inertia_factor",
    "I": "moment_of_inertia",
    "axle": "axle_friction bearing_friction",
    "R": "r radius pulley_radius",
    "wrap": "wrap_angle angle phi",
    "a": "acceleration",
    "drop": "h height distance s",
    "time": "t",
    "speed": "v velocity v_final vf final_speed final_velocity",
    DRIVE: "drive motor brake",
}
"""Other words for inputs, for what is measured, and for a drive: hints, which only `find` takes."""
OTHER_NAMES = {
    **{f"{word}{number}": f"m{number}" for word in MASS_WORDS for number in (1, 2)},
    **dict.fromkeys(("m", "mass"), "M"),
    **{word.replace("_", ""): name for name, words in WORDS_FOR_INPUTS.items() for word in words.split()},
    **{name.lower().replace("_", ""): name for name in (*reversed(INPUTS), *MEASURED) if name != "I"},
}
"""The inputs by their other names, in small letters and without underscores; i may count rows."""


def input_meant(word: str) -> str:
    """Return the input that a word may mean, whatever its letters, "" if it is none."""
    return OTHER_NAMES.get(re.sub("[ _-]", "", word.lower()), "")


def read_names(
    parameter: str,
    typed: Iterable[str],
    known: Collection[str] = TABLE_NAMES,
    kind: str = "quantity",
    symbols: Mapping[str, str] = NAMES_BY_SYMBOL,
) -> list[str]:
    """Read names; a word may hold several with commas between. Raises SceneError."""
    return [read_name(parameter, word, known, kind, symbols) for word in divided(typed)]


def read_results(
    parameter: str, typed: Iterable[str], known: Mapping[str, str], kind: str = "quantity"
) -> tuple[list[str], dict[str, Unit]]:
    """Read names, and the units that they are to be in: T2 in lbf. Raises SceneError.

    ``known`` has the names' own units. Quantities may be named by their symbols.
    """
    symbols = NAMES_BY_SYMBOL if kind == "quantity" else {}
    names, units = list[str](), dict[str, Unit | None]()
    for words in divided(typed):
        word, _, unit = map(str.strip, words.partition(" in "))
        names.append(name := read_name(parameter, word, known, kind, symbols))
        try:
            read = read_unit_of_result(unit, known[name]) if unit else None
        except Malformed as error:
            raise SceneError(parameter, words, str(error)) from None
        if units.setdefault(name, read) != read:
            raise SceneError(parameter, words, f"asks for {name} in two units; take one")
    return names, {name: unit for name, unit in units.items() if unit}


def read_quantities(words: Sequence[str] | None) -> list[str]:
    """Read the quantities that a program names, each once; by default the usual ones. Raises SceneError."""
    if words is None:
        return list(STANDARD)
    typed = [words] if isinstance(words, str) else map(str, words)
    return list(dict.fromkeys(read_names("quantities", typed)))


def read_name(
    parameter: str, word: str, known: Collection[str], kind: str, symbols: Mapping[str, str]
) -> str:
    """Read one of the names ``known``, or its symbol as tables show it. Raises SceneError."""
    if word in known:
        return word
    if (name := symbols.get(word.translate(PLAIN), "")) in known:
        return name
    small = word.translate(PLAIN).lower()
    alike = [x for symbol, x in symbols.items() if len(small) > 1 and symbol.lower() == small and x in known]
    meant = MEANT.get(small, alike[0] if len(alike) == 1 else "")
    hint = f"; did you mean {meant}?" if meant in known else ""
    known_names = "; see atwood quantities" if kind == "quantity" else f"; there are {', '.join(known)}"
    a_kind = f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"
    result = NAMES_BY_SYMBOL.get(word.translate(PLAIN)) or MEANT.get(small)
    if known is FINDABLE and result in TABLE_NAMES:
        hint = f"; leave find out: {result} is a result (--only {result})"
    if kind == "quantity" and " in " in word:
        raise SceneError(parameter, word, "has a unit, which batch and arrays do not take; leave it out")
    if kind == "quantity" and word in MEASURED_NAMES and word not in INPUTS:
        raise SceneError(parameter, word, "follows from a measured motion, which only solve takes")
    raise SceneError(parameter, word, f"is not {a_kind}{hint or nearest(word, known) or known_names}")


def divided(typed: Iterable[str], whole: Collection[str] = ()) -> list[str]:
    """Return the words of a repeatable option, which may hold several with commas, but not ``whole`` ones."""
    return [word.strip() for words in typed for word in ([words] if words in whole else words.split(","))]
