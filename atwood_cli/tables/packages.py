"""The parts of a workbook: an archive of XML, of which no more is read than memory and patience can bear.

Elements come one by one, so that a sheet may be long. Parts are found by the links from one to another.
"""

import zlib
from collections.abc import Iterator
from functools import lru_cache
from posixpath import basename, dirname, join, normpath
from xml.parsers.expat import ExpatError, ParserCreate
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

from .sources import LONGEST_RECORD, TOO_LONG, Unreadable

READ_BYTES = 64 << 10
PACKED = (ZIP_STORED, ZIP_DEFLATED)
"""The methods of packing that workbooks have. Others unpack any number of bytes at once."""
MOST = 4 << 20
"""The most cells of a workbook, empty ones included; as much as a cell counts an element of its XML, or four
attributes, 16 characters of a cell, 128 bytes of XML. 100,000 rows can have 100 MB."""
MOST_NESTED = 100
TOO_LARGE = "it has too many or too long cells for a workbook; save the sheet as CSV"
BLANKS = {"s": " ", "tab": "\t", "line-break": "\n"}
"""What elements within a text of .ods stand for."""
UNFIT = "it is damaged, has a password, or is no workbook"
DAMAGE = (
    *(BadZipFile, zlib.error, EOFError, OSError, RuntimeError),  # of the archive
    *(ExpatError, LookupError, ValueError),  # of what a part holds
)
"""What is raised for a part that is lacking or damaged."""
WITH_TEXT = ("v", "f", "t", "p")
"""The elements whose text counts: values, formulas and texts of .xlsx, paragraphs of .ods."""

Element = tuple[str, str, dict[str, str], str]
"""The name of an element's parent, its own, both without a prefix, its attributes, and its text."""


class Package:
    """The parts of a workbook, by their paths in small letters. All that is read of them is counted."""

    def __init__(self, archive: ZipFile) -> None:
        self._archive, self._counted = archive, 0
        self.parts = {x.filename.replace("\\", "/").strip("/").lower(): x for x in archive.infolist()}

    def count(self, things: int, text: str = "") -> None:
        """Count what takes memory or time. Raises Unreadable for too much."""
        self._counted += things * (1 + len(text) // 16)
        if self._counted > MOST:
            raise Unreadable(TOO_LARGE)

    def elements(self, path: str) -> Iterator[Element]:
        """Yield the elements of a part as they end, none if it is lacking.

        Raises Unreadable, and what stands in `DAMAGE`.
        """
        if not (part := self.parts.get(path.lower())):
            return
        if part.compress_type not in PACKED:
            raise BadZipFile
        found, texts, text_depth, read = list[Element](), list[str](), 0, 0
        open_: list[tuple[str, dict[str, str]]] = [("", {})]
        parser = ParserCreate()
        parser.buffer_text = True

        def started(tag: str, attributes: dict[str, str]) -> None:
            nonlocal text_depth
            self.count(1 + len(attributes) // 4)
            name = _local(tag)
            if text_depth:
                texts.append(BLANKS.get(name, ""))
            elif ":" in "".join(attributes):  # of those with the same name the first counts
                attributes = {_local(key): value for key, value in reversed(attributes.items())}
            open_.append((name, attributes))
            if len(open_) > MOST_NESTED:
                raise Unreadable(TOO_LARGE)
            if name in WITH_TEXT and not text_depth:
                text_depth, parser.CharacterDataHandler = len(open_), texts.append
                texts.clear()

        def ended(_: str) -> None:
            nonlocal text_depth
            text = ""
            if text_depth == len(open_):
                text, text_depth, parser.CharacterDataHandler = "".join(texts), 0, None
            name, attributes = open_.pop()
            if not text_depth:
                found.append((open_[-1][0], name, attributes, text))

        def refuse(*_: object) -> None:
            raise ValueError  # the entities of a document type may be of any size

        parser.StartElementHandler, parser.EndElementHandler = started, ended
        parser.StartDoctypeDeclHandler = refuse
        with self._archive.open(part) as file:
            while block := file.read(READ_BYTES):
                read += len(block)
                parser.Parse(block)
                self.count(len(block) // 128)
                if max(read - parser.CurrentByteIndex, sum(map(len, texts))) > LONGEST_RECORD:
                    raise Unreadable(f"a cell of {path} {TOO_LONG}")
                yield from found
                found.clear()
        parser.Parse(b"", True)
        yield from found

    def links(self, path: str) -> dict[str, tuple[str, str]]:
        """Return the kinds and the paths of the parts that a part, or the package, refers to."""
        folder = dirname(path)
        relations = f"{folder}/_rels/{basename(path)}.rels".strip("/")
        links = (link for *_, link, _ in self.elements(relations) if "Target" in link)
        kinds = {link["Id"]: (link.get("Type", ""), _resolved(folder, link["Target"])) for link in links}
        return {name: (kind.rpartition("/")[2], target) for name, (kind, target) in kinds.items()}


@lru_cache(1024)
def _local(name: str) -> str:
    return name.rpartition(":")[2]


def _resolved(folder: str, target: str) -> str:
    return normpath(join("/", folder, target.replace("\\", "/"))).strip("/")
