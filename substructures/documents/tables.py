"""Measured curves of a document: CSV text by name under ``tables``, used in expressions as ``table(q1; bump)``.

The names are replaced by their points when the document is read, ``table(q1; 0: 0, 0.1: 5)``, so that what is stored,
and its digest, are those of a document that was written so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from substructures.documents.fields import LONGEST
from substructures.documents.numbers import REAL, RefusedNumberError, decimal, plain_text
from substructures.documents.text import escape
from substructures.errors import InvalidDocument, among

TABLES = "tables"
#: of a table: bytes of its text, and rows
MOST_BYTES, MOST_ROWS = 2**20, 10_000
#: characters of points in all expressions of a document
MOST_OF_DOCUMENT = 2**22
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}", re.ASCII)
#: the name of a table in an expression: after its argument, before its kind or its end
_USED = re.compile(r"(;\s*)([A-Za-z]\w*)(?=\s*[;)])", re.ASCII)
#: words of the grammar at the same place
_KINDS = ("monotone", "smooth")
#: members that are words, and no expressions
_WORDS = frozenset(("name", "title", "description", "tags", "license", "source", "unit", "note", "message"))


def with_points(document: Any) -> Any:
    """A document with the points of its tables in the place of their names; any other as it is.

    Raises InvalidDocument: ``/tables/name`` (``bad-table``, with the line), and where a table is named that is not
    there (``unknown-table``), or with which an expression becomes too long (``too-large``).
    """
    if not isinstance(document, Mapping) or TABLES not in document:
        return document
    given = document[TABLES]
    if not isinstance(given, Mapping):
        raise InvalidDocument.at(f"/{TABLES}", "object-expected", "an object of CSV texts by name is needed")
    points = {name: _points(str(name), text) for name, text in given.items()}
    return _Reading(points).replaced({name: x for name, x in document.items() if name != TABLES}, "")


def with_tables(document: Any, folder: Path) -> Any:
    """A document that was read from a file in ``folder``, with the texts of files in the place of
    ``tables: {bump: {file: bump.csv}}``, also in the definitions of its instances.

    Raises InvalidDocument (``/tables/name/file``, ``bad-file``) for what is no file in the folder or below, is too
    large, or no text.
    """
    if not isinstance(document, Mapping):
        return document
    found = dict(document)
    if isinstance(found.get(TABLES), Mapping):
        found[TABLES] = {name: _text(x, f"/{TABLES}/{escape(name)}", folder) for name, x in found[TABLES].items()}
    if isinstance(found.get("instances"), list):
        found["instances"] = [_instance(x, i, folder) for i, x in enumerate(found["instances"])]
    return found


def _instance(given: Any, i: int, folder: Path) -> Any:
    if not isinstance(given, Mapping) or "definition" not in given:
        return given
    try:
        return {**given, "definition": with_tables(given["definition"], folder)}
    except InvalidDocument as error:
        raise error.moved(lambda pointer: f"/instances/{i}/definition{pointer}") from None


def _text(given: Any, pointer: str, folder: Path) -> Any:
    """The text of a file; what names none as it is."""
    if not isinstance(given, Mapping) or set(given) != {"file"}:
        return given
    place, name = f"{pointer}/file", given["file"]
    if not isinstance(name, str) or "\0" in name:
        raise InvalidDocument.at(place, "bad-file", "the name of a file is a text")
    file = (folder / name).resolve()
    if not file.is_relative_to(folder.resolve()):
        raise InvalidDocument.at(place, "bad-file", f"'{name[:80]}' is not in the folder of the document")
    if file.exists() and not file.is_file():
        raise InvalidDocument.at(place, "bad-file", f"'{name[:80]}' cannot be read: it is no file")
    try:
        with file.open("rb") as opened:
            data = opened.read(MOST_BYTES + 1)
    except OSError as error:
        raise InvalidDocument.at(place, "bad-file", f"'{name[:80]}' cannot be read: {error.strerror}") from None
    if len(data) > MOST_BYTES:
        raise InvalidDocument.at(place, "bad-file", f"'{name[:80]}' has more than {MOST_BYTES:,} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InvalidDocument.at(place, "bad-file", f"'{name[:80]}' is no text in UTF-8") from None


def _points(name: str, text: Any) -> str:
    """The knots of a table as expressions have them. Raises InvalidDocument."""
    pointer = f"/{TABLES}/{escape(name)}"
    if not NAME.fullmatch(name) or name in _KINDS:
        raise InvalidDocument.at(pointer, "bad-name", f"'{name[:80]}' cannot be the name of a table")
    if not isinstance(text, str):
        raise InvalidDocument.at(pointer, "bad-table", "a table is CSV text with two columns: 'x,y\\n0,0\\n0.1,5'")
    if len(text) > MOST_BYTES:
        raise InvalidDocument.at(pointer, "bad-table", f"a table has at most {MOST_BYTES:,} characters")
    rows = list(_rows(text, pointer))
    if not 2 <= len(rows) <= MOST_ROWS:
        raise InvalidDocument.at(pointer, "bad-table", f"{len(rows):,} rows; 2 to {MOST_ROWS:,} are needed")
    for (_, before, _), (line, x, _) in pairwise(rows):
        if decimal(x) <= decimal(before):
            raise InvalidDocument.at(pointer, "bad-table", f"line {line}: {x} is not above {before} before it")
    return ", ".join(f"{x}: {y}" for _, x, y in rows)


def _rows(text: str, pointer: str) -> Iterator[tuple[int, str, str]]:
    """Line, x and y of every row; the first line that is not empty may be a head."""
    lines = [(k, line) for k, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1) if line.strip()]
    separator = next((s for s in ("\t", ";", ",") if lines and s in lines[-1][1]), ",")
    for place, (k, line) in enumerate(lines):
        cells = [cell.strip() for cell in line.split(separator)]
        wrong = [cell for cell in cells if not REAL.fullmatch(cell)]
        if place == 0 and len(wrong) == len(cells):
            continue
        if len(cells) != 2:
            raise InvalidDocument.at(pointer, "bad-table", f"line {k}: {len(cells)} columns, x and y are needed")
        if wrong:
            message = f"line {k}: '{wrong[0][:40]}' is no number, as 0.5 or -1.2e-3"
            raise InvalidDocument.at(pointer, "bad-table", message)
        try:
            x, y = (plain_text(decimal(cell)) for cell in cells)
        except RefusedNumberError as error:
            raise InvalidDocument.at(pointer, "bad-table", f"line {k}: {error}") from None
        yield k, x, y


@dataclass
class _Reading:
    """A document whose tables are known; ``left``: so many characters of points may still be put in."""

    points: Mapping[str, str]
    left: int = MOST_OF_DOCUMENT

    def replaced(self, given: Any, pointer: str) -> Any:
        """What stands at a place, with points in the place of names."""
        if isinstance(given, Mapping):
            return {
                name: x if _is_apart(name, x) else self.replaced(x, f"{pointer}/{escape(name)}")
                for name, x in given.items()
            }
        if isinstance(given, list | tuple):
            return [self.replaced(x, f"{pointer}/{i}") for i, x in enumerate(given)]
        # what is longer is refused as an expression
        return self._expression(given, pointer) if isinstance(given, str) and len(given) <= LONGEST else given

    def _expression(self, text: str, pointer: str) -> str:
        size = len(text)

        def knots(found: re.Match[str]) -> str:
            """The points of a table, or the word of the grammar that it is."""
            nonlocal size
            name = found[2]
            if name in _KINDS:
                return found[0]
            if name not in self.points:
                message = f"there is no table '{name[:80]}'{among(name, self.points)}"
                raise InvalidDocument.at(pointer, "unknown-table", message)
            size, self.left = size + len(self.points[name]), self.left - len(self.points[name])
            if size > LONGEST or self.left < 0:
                message = f"with its tables this has more than {LONGEST:,} characters, or the document too many: "
                raise InvalidDocument.at(pointer, "too-large", f"{message}take fewer points")
            return f"{found[1]}{self.points[name]}"

        return _USED.sub(knots, text)


def _is_apart(name: str, given: Any) -> bool:
    """Whether a member has no expressions of this document: words, and definitions, which have tables of their own."""
    return (name == "definition") if isinstance(given, Mapping) else name in _WORDS
