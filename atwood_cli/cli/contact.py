"""`atwood contact`: the forces along the arc, as a table, JSON, CSV or a figure."""

from collections.abc import Mapping
from typing import Annotated

from ..explain import contact as balance
from ..output.forms import Destination, Picture, Report, show
from ..output.scene_page import contact_record, print_contact
from ..output.text import say
from ..reading.inputs import read_digits, read_exactly
from ..reading.names import read_results
from ..solver.answers import Answers
from ..solver.scene import INPUTS, Scene, SceneError
from .options import DONE, FIGURE, OUTPUT, SCENE, Digits, option, with_options

HELP = """Show the forces along the arc of contact and their sum.

\b
Examples:
  atwood contact --m1 1 --m2 3 --mu 0.3
  atwood contact --m1 1 --m2 3 --M 10 --mu 0.3 --figure arc.svg
  atwood contact --m1 1 --m2 200 --M inf --mu 0.2 --wrap 2.5turn --csv

Angles count from m1's end of the arc. x points from the axle to where m1's string meets the pulley. m1's
string hangs straight down; m2's string does so, too, if the wrap is half a turn, and else goes to a guide.
Normal force n and friction f are per metre of string; nR = T and fR = dT/dθ, with the radius R, are per
radian. --figure replaces the table.
"""


@with_options(SCENE, OUTPUT, FIGURE)
def contact(
    given: Mapping[str, str | None],
    target: Destination,
    picture: Picture | None,
    *,
    only: Annotated[
        list[str] | None,
        option("Arc", metavar="NAME", help="Only this column, as tension, or 'tension in lbf'; repeatable."),
    ] = None,
    points: Annotated[
        str | None,
        option(
            "Arc",
            metavar="N",
            help=f"Angles of the arc, 2 to {balance.MAX_POINTS}; {balance.USUAL_POINTS} if not given.",
        ),
    ] = None,
    digits: Digits = None,
) -> int:
    names, units = read_results("only", only or [], balance.POINT, "column")
    inputs = {name: read_exactly(name, given.get(name)) for name in INPUTS}
    answers = Answers(Scene.of(inputs), read_digits(digits), inputs)
    if inputs["R"].number is None and (per_metre := [x for x in names if x.endswith("per_metre")]):
        raise SceneError("only", per_metre[0], "needs the radius R as well")
    if not target.form:
        answers = answers.to_six_digits
    if points is not None and picture is not None and not target.form and target.file is None:
        raise SceneError("points", points, "has no effect on a picture; leave it out")
    at = balance.USUAL_POINTS if points is None else points
    arc = balance.contact(answers.in_units(units), at, dict.fromkeys(names) or balance.POINT)
    if picture is not None:
        from ..output.scene_figure import save_scene

        save_scene(answers, picture, curves=True)
    # What is drawn is not printed, too, but to a file that is asked for.
    tables = picture is None or target.file is not None
    report = Report(
        json=lambda: contact_record(answers, arc),
        records=lambda: arc.points,
        page=lambda page: print_contact(page, answers, arc, tables),
        notes=lambda: arc.notes,
    )
    say(*show(report, target))
    return DONE
