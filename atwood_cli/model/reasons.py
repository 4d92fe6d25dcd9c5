"""Why the scene does not determine a quantity, and what to give."""


class Undetermined(Exception):
    """The scene does not determine the quantity; the reason says why and what to give.

    What a page of mathematics writes in another way stands between backticks: names of inputs and of
    quantities, and the word "give". `solver.messages` says who takes the backticks out.
    """


NEEDS_MU = "`give` `mu`, the friction coefficient"
NEEDS_M = "`give` `M`, the pulley's mass, which decides here"
NEEDS_R = "`give` `R`, the pulley's radius"
UNKNOWN_SHAPE = "`give` `M`, the pulley's mass, beside `I`"
FREE_END = "not defined for a free end: the string is fixed to the pulley and no friction holds it"
NOT_BOUNDED = "not one number while the string grips with friction to spare"
NOT_DEFINITE = (
    "between `friction_force_min` and `friction_force_max` while the string grips"
    " (atwood quantities says when)"
)
DEFINITE = "bounds are for a string that grips with friction to spare; here `friction_force` is definite"
LONG_WRAP = "bounds are known for up to half a turn of wrap (180 degrees)"
NO_CRITICAL_MASS = "does not exist, as the string holds on any pulley, however heavy"
NO_CRITICAL_HEAVIER_MASS = "does not exist, as the string holds under any heavier mass"
AXLE_HOLDS = "does not exist, as the axle holds the difference on any pulley"
ALWAYS_SLIPS = "does not exist, as for the friction of the axle the string slips on any pulley, however light"
AXLE_ENOUGH = "no condition here, as the friction of the axle is enough to make the string slip on any pulley"
NO_NEED = "does not exist, as no friction is needed"
NO_WRAP = "does not exist, as without friction no wrap holds"
NOT_APPLICABLE = "conditions (36) do not apply without friction"
LOCKED_AXLE = "not defined for a locked pulley: `M` = `inf` is not its weight"
ONE_SIDED = "defined for half a turn of wrap (and whole turns more), where both ends pull downwards"
NEEDS_A = "`give` `a`, a measured acceleration, in place of `M`"
NEEDS_A_BESIDE_M = "`give` `a`, a measured acceleration, beside `M` and in place of `g`"
NEEDS_A_AND_M = "`give` `a`, a measured acceleration, and `M` in place of `{}`"
NEEDS_A_OF_A_SLIDE = (
    "`give` `a`, a measured acceleration, beside `M` = `inf`, or beside `M` and a `mu` that is too small"
)
NEEDS_DROP = "`give` `drop`, the height that the heavier mass falls from rest"
AT_REST = "does not exist, as nothing moves"
