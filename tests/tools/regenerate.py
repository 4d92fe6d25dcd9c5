"""The outputs that are kept in files, and what prints each: python -m tests.tools.regenerate brings them up to date.

It stops if a value of one scene is not the oracle's.
`python -m tests.tools.regenerate measured` measures the table and the picture of `examples/tradeoff.md` anew, in minutes.
"""

import re
import shlex
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, chdir
from decimal import Decimal
from functools import partial
from importlib.util import find_spec
from itertools import chain, pairwise, takewhile
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory
from typing import NamedTuple

from atwood_cli.cli import COMMANDS
from atwood_cli.cli.solve import implied
from atwood_cli.reading.names import read_names
from atwood_cli.reading.scenes import read_answers
from atwood_cli.solver.quantities import QUANTITIES
from atwood_cli.solver.scene import INPUTS, MEASURED, SceneError

from . import oracle
from .running import TOP, called, labels, pages_seen, process, words_on

EXAMPLES = TOP / "examples"
PAGES = [TOP / "README.md", *sorted(EXAMPLES.glob("*.md"))]
SCRIPTS = sorted(EXAMPLES.glob("*.sh"))
ENGINES = {EXAMPLES / "dask_tables.py": "distributed", EXAMPLES / "polars_lazy.py": "polars"}
"""Examples that another package runs."""
CASES = sorted((TOP / "tests" / "cases").glob("*.md"))
UNSEEN = "[\0-\x09\x0b-\x1f\x7f\xa0\u2009\u2028\ufeff]"
SCENE = "--m1 1 --m2 3 --M 10 --mu 0.3"

HANDOUT = "atwood solve --m1 1 --m2 3 --M 10 --explain --only a --markdown"
PICTURES = {
    "contact.svg": f"contact {SCENE}",
    "tensions.svg": "sweep --m1 1 --m2 3 --mu 0.3 --M 0:60:4 --only T1,T2",
}


class Kept(NamedTuple):
    """A text that is a part of a file or all of it, what it is today, and the package or program that this needs."""

    file: Path
    text: str
    today: Callable[[], str]
    needs: str = ""

    @property
    def lacks(self) -> str:
        """What is needed and not installed."""
        return "" if not self.needs or find_spec(self.needs) or which(self.needs) else self.needs


def printed(line: str, stdin: str = "") -> str:
    """What a line of bash prints at the top of the project, without an error."""
    ran = process(shell=f"set -eu; cd '{TOP}'; {line}", stdin=stdin, PYTHONIOENCODING="utf-8")
    assert (ran.status, ran.err) == (0, ""), ran
    return ran.out


def transcript(block: str) -> str:
    """The block as running its commands gives it, stderr where a terminal would show it."""
    return "".join(f"$ {line}\n{shown(line)}" for line in re.findall(r"^\$ (.*)", block, re.MULTILINE))


def shown(line: str) -> str:
    """What a line of bash shows, its first command called here if that is a call of the program."""
    found = re.fullmatch(r"atwood ?([^|;<>$&*?(){}~`]*)(?:\|((?:(?!atwood).)*))?", line)
    if not found:
        return printed(f"{{ {line}; }} 2>&1 || true")
    with chdir(TOP):
        ran = called(shlex.split(found[1]))
    return (printed(found[2], ran.out) if found[2] else ran.out) + ran.err


def picture(line: str) -> str:
    """The picture that a command line draws."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "a.svg")
        called([*line.split(), "--figure", str(file)])
        return file.read_text(encoding="utf-8")


def answered(block: str) -> str:
    """The block as its command gives it, called here: stdout, stderr, the words of pictures, and a status but 0.

    A filter behind a bar, as `| grep sum`, is given stdout: what others show need not stand here again.
    """
    line = block.splitlines()[0]
    found = re.fullmatch(r"\$ (?:printf '(.*)' \| )?atwood ?((?:'[^']*'|[^|'])*?)(?: \| (.*))?", line)
    assert found, line
    content = (found[1] or "").replace("%%", "%").encode().decode("unicode_escape").encode("latin-1")
    draws = "--figure" in line and find_spec("matplotlib")
    with TemporaryDirectory() as folder, chdir(folder), ExitStack() as stack:
        pages = stack.enter_context(pages_seen()) if draws else []
        ran = called(shlex.split(found[2]), content)
    out = printed(found[3], ran.out) if found[3] else ran.out
    shown = re.sub(UNSEEN, lambda seen: "".join(f"\\x{x:02x}" for x in seen[0].encode()), out + ran.err)
    end = "" if not shown or shown.endswith("\n") else "\n"
    words = "".join(f"| {words}\n" for page in pages for words in words_on(page))
    return f"{line}\n{shown}{end}{words}" + (f"[{ran.status}]\n" if ran.status else "")


def help_pages() -> str:
    """The pages of help, each behind its command."""
    commands = ["atwood -h", *(f"atwood {command} -h" for command in COMMANDS)]
    return "".join(f"$ {line}\n{shown(line)}\n" for line in commands)


def whole(file: Path, today: Callable[[], str] | str, needs: str = "") -> Kept:
    """A whole file, and what makes it: a function, or a line of bash that prints it."""
    today = partial(printed, today) if isinstance(today, str) else today
    return Kept(file, file.read_text(encoding="utf-8") if file.exists() else "", today, needs)


KEPT = [
    whole(EXAMPLES / "help.txt", help_pages),
    *(
        Kept(page, command, partial(answered, command), "matplotlib" if page.stem == "pictures" else "")
        for page in CASES
        for command in re.findall(r"^\$ .*\n(?:(?!\$ |```).*\n)*", page.read_text("utf-8"), re.MULTILINE)
    ),
    *(
        Kept(page, block, partial(transcript, block), "jq" if "| jq" in block else "")
        for page in PAGES
        for block in re.findall(r"```console\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    ),
    # The scripts call `atwood` and `python3`; both are this interpreter here.
    *(whole(one.with_suffix(".txt"), f'python3() {{ "$PYTHON" "$@"; }}; . "{one}"') for one in SCRIPTS),
    # On a busy machine dask says on stderr that a port is taken, or a heartbeat late.
    *(
        whole(engine.with_suffix(".txt"), f'"$PYTHON" "{engine}" 2> /dev/null', needs)
        for engine, needs in ENGINES.items()
    ),
    whole(EXAMPLES / "handout.md", partial(shown, HANDOUT)),
    *(whole(EXAMPLES / name, partial(picture, words), "matplotlib") for name, words in PICTURES.items()),
]


def essence(text: str) -> object:
    """What must stay the same for each version of a library: of a picture the words."""
    if "<svg" in text:
        return labels(text)
    return text.replace("argument(s)", "arguments")  # as typer words it, by its version


def denied(text: str) -> Iterator[str]:
    """Values that transcripts of `atwood solve` print of a scene, and the oracle denies, also where none exists."""
    for line, out in re.findall(r"^\$ atwood solve (.*)\n((?:(?!\$ ).*\n)*)", text, re.MULTILINE):
        words = takewhile("|".__ne__, shlex.split(line))
        parts = [word.split("=", 1) if word.startswith("--") else [word] for word in words]
        options = [*pairwise(chain.from_iterable(parts))]
        inputs = {x: dict(options).get(f"--{x.replace('_', '-')}") for x in (*INPUTS, *MEASURED, "find")}
        try:
            only = read_names("only", [names for option, names in options if option == "--only"], QUANTITIES)
            inputs["find"] = inputs["find"] or implied({*only}, inputs)
            truth = oracle.expected(read_answers(inputs, None).decided.scene)
        except SceneError:  # as the transcript says
            continue
        out += "".join(f'  "{name}": {bare}\n' for name, bare in zip(only, out.splitlines(), strict=False))
        for name in (name for name in QUANTITIES if name not in oracle.BOUNDS and not inputs.get(name)):
            number, unit = r"(-?\d+(?:[.]\d+)?(?:e[-+]?\d+)?)(?:\s±\s\S+)?", QUANTITIES[name].unit
            in_table = rf"[│|] {name}\b[^│|]*[│|] +{number} *[│|] {unit} *[│|]"
            said = rf'^  "{name}": {number},?$|\b{name}\s=\s{number}\s{unit}(?!\w)'
            for numbers in re.findall(f"{in_table}|{said}", out, re.MULTILINE):
                number = "".join(numbers)
                if truth[name] is None:
                    yield f"{name} has no value, and not {number}: {line}"
                    continue
                digits = len(Decimal(number).as_tuple().digits)
                rounded = [oracle.correctly_rounded(truth[name], n) for n in (None, digits)]
                if float(number) != rounded[0] and Decimal(number) != rounded[1]:
                    yield f"{name} is {rounded[0]} and not {number}: {line}"


def measure() -> None:
    """Write what `atwood tradeoff` measures on this machine into its page and its picture."""
    page = EXAMPLES / "tradeoff.md"
    ran = called(["tradeoff", "--figure", str(page.with_suffix(".svg")), "--force"])
    before, after = re.split(r"(?<=```text\n)[^`]*", page.read_text(encoding="utf-8"), maxsplit=1)
    page.write_text(f"{before}$ atwood tradeoff\n{ran.out}{after}", encoding="utf-8", newline="\n")


def regenerate() -> None:
    """Write what has changed, which is then to be looked at. Exits if the oracle denies a value."""
    today = [(kept, kept.today()) for kept in KEPT if not kept.lacks]
    if wrong := [words for _, fresh in today for words in denied(fresh)]:
        sys.exit("\n".join([*wrong, "Mend the program, or the oracle."]))
    for kept, fresh in today:
        if essence(fresh) == essence(kept.text):
            continue
        page = kept.file.read_text(encoding="utf-8") if kept.file.exists() else ""
        kept.file.write_text(page.replace(kept.text, fresh, 1), encoding="utf-8", newline="\n")
        print(kept.file.relative_to(TOP))
    for file, lacks in {kept.file: kept.lacks for kept in KEPT if kept.lacks}.items():
        print(f"{file.relative_to(TOP)}: left as it was, without {lacks}")


if __name__ == "__main__":
    if sys.argv[1:] == ["measured"]:
        measure()
    else:
        regenerate()
