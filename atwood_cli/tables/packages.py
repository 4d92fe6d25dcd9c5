"""The parts of a workbook: an archive of XML, of which no more is read than memory and patience can bear.

Elements come one by one, so that a sheet may be long. Parts are found by the links from one to another.
"""

import zlib
from collections.abc import Collection, Iterator
from functools import lru_cache
from posixpath import basename, dirname, join, normpath
from xml.parsers.expat import ExpatError, ParserCreate
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

from .sources import LONGEST_RECORD, TOO_LONG, Unreadable

MOST_BYTES = 64 << 20
"""The most bytes of a table of runs, unpacked, and characters of a sheet."""
MOST_UNPACKED = 256 << 20
"""The most bytes that are read of a workbook: 100,000 rows can have 100 MB."""
READ_BYTES = 64 << 10
PACKED = (ZIP_STORED, ZIP_DEFLATED)
"""The methods of packing that workbooks have. Others unpack any number of bytes at once."""
MOST_CELLS = 4 << 20
"""The most cells of a sheet, empty ones included: few bytes can stand for very many."""
MOST_NODES, MOST_NESTED = 6 << 20, 100
"""The most attributes of a workbook, of which an element counts as two, and elements within each other."""
BLANKS = {"s": " ", "tab": "\t", "line-break": "\n"}
"""What elements within a text of .ods stand for."""
TOO_MUCH_TEXT = f"its texts are longer than {MOST_BYTES >> 20} MB"
UNFIT = "it is damaged, has a password, or is no workbook"
DAMAGE = (
    *(BadZipFile, zlib.error, EOFError, OSError, RuntimeError),  # of the archive
    *(ExpatError, LookupError, ValueError),  # of what a part holds
)
"""What is raised for a part that is lacking or damaged."""
WITH_TEXT = ("v", "f", "t", "p")
"""The elements whose text counts: values, formulas and texts of .xlsx, paragraphs of .ods."""

Element = tuple[str, str, dict[str, str], str | None]
"""The name of an element's parent, its own, both without a prefix, its attributes, and its text."""


class Package:
    """The parts of a workbook, by their paths in small letters. All that is read of them is counted."""

    def __init__(self, archive: ZipFile) -> None:
        self._archive, self._bytes, self._nodes, self._characters = archive, 0, 0, 0
        self.parts = {x.filename.replace("\\", "/").strip("/").lower(): x for x in archive.infolist()}

    def elements(self, path: str, begins: Collection[str] = ()) -> Iterator[Element]:
        """Yield the elements of a part as they end, those named also as they begin, without text.

        There are none of a part that is lacking. Raises Unreadable, and what stands in `DAMAGE`.
        """
        part, read = self.parts.get(path.lower()), 0
        if not part:
            return
        if part.flag_bits & 1:
            raise Unreadable("it is encrypted; password required")
        if part.compress_type not in PACKED:
            raise Unreadable(f"{UNFIT}: {path} is packed in another way than workbooks are")
        found, names, given, texts, text_depth = list[Element](), [""], [dict[str, str]()], list[str](), 0
        parser = ParserCreate()
        parser.buffer_text = True

        def started(tag: str, attributes: dict[str, str]) -> None:
            nonlocal text_depth
            names.append(name := _local(tag))
            self._nodes += 2 + len(attributes)
            if len(names) > MOST_NESTED or self._nodes > MOST_NODES:
                raise Unreadable("its XML has too many elements, or is nested too deeply")
            if text_depth:
                texts.append(BLANKS.get(name, ""))
            elif ":" in "".join(attributes):  # of those with the same name the first counts
                attributes = {_local(key): value for key, value in reversed(attributes.items())}
            given.append(attributes)
            if name in begins:
                found.append((names[-2], name, attributes, None))
            if name in WITH_TEXT and not text_depth:
                text_depth, parser.CharacterDataHandler = len(names), texts.append
                texts.clear()

        def ended(_: str) -> None:
            nonlocal text_depth
            text, attributes = "", given.pop()
            if text_depth == len(names):
                text, text_depth, parser.CharacterDataHandler = "".join(texts), 0, None
                self._characters += len(text) if names[-1] != "f" else 0  # formulas are not kept
            if not text_depth:
                found.append((names[-2], names[-1], attributes, text))
            names.pop()

        def refuse(*_: object) -> None:
            raise Unreadable(f"{path} has a document type")  # whose entities may be of any size

        parser.StartElementHandler, parser.EndElementHandler = started, ended
        parser.StartDoctypeDeclHandler = refuse
        with self._archive.open(part) as file:
            while block := file.read(READ_BYTES):
                read += len(block)
                self._bytes += len(block)
                parser.Parse(block)
                if self._bytes > MOST_UNPACKED:
                    raise Unreadable(f"it is larger than {MOST_UNPACKED >> 20} MB, unpacked")
                if max(read - parser.CurrentByteIndex, sum(map(len, texts))) > LONGEST_RECORD:
                    raise Unreadable(f"a cell of {path} {TOO_LONG}")
                if self._characters > MOST_BYTES:
                    raise Unreadable(TOO_MUCH_TEXT)
                yield from found
                found.clear()
        parser.Parse(b"", True)
        yield from found

    def links(self, path: str) -> dict[str, tuple[str, str]]:
        """Return the kinds and the paths of the parts that a part, or the package, refers to."""
        folder = dirname(path)
        relations = f"{folder}/_rels/{basename(path)}.rels".strip("/")
        links = (link for *_, link, _ in self.elements(relations) if "Target" in link)
        kinds = {link["Id"]: (link.get("Type", ""), resolved(folder, link["Target"])) for link in links}
        return {name: (kind.rpartition("/")[2], target) for name, (kind, target) in kinds.items()}


@lru_cache(1024)
def _local(name: str) -> str:
    return name.rpartition(":")[2]


def resolved(folder: str, target: str) -> str:
    return normpath(join("/", folder, target.replace("\\", "/"))).strip("/")
