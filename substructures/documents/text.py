"""What the readers share about text: decoding, places, pointers, the limit of nesting."""

from __future__ import annotations

import codecs
from collections.abc import Iterable

from substructures.errors import InvalidDocument

MAX_DEPTH = 64
#: endings of files that are documents
DOCUMENTS = (".yaml", ".yml", ".json")
TOO_DEEP = f"nested deeper than {MAX_DEPTH} levels"
SURROGATE = "a string holds a lone surrogate"


def escape(key: object) -> str:
    """The text of one step of an RFC 6901 pointer."""
    return str(key).replace("~", "~0").replace("/", "~1")


def pointer_step(key: str | int) -> str:
    """One step of an RFC 6901 pointer, with its slash."""
    return "/" + escape(key)


def pointer_to(steps: Iterable[str | int | None]) -> str:
    """The RFC 6901 pointer of a path; ``None`` stands for a key that is not known yet."""
    return "".join(pointer_step(step) for step in steps if step is not None)


def fault_at(line: int, column: int, code: str, message: str, pointer: str = "") -> InvalidDocument:
    """The exception for one fault at a place in the text, both counted from 1."""
    return InvalidDocument.at(pointer, code, f"{message} (line {line}, column {column})")


def decoded(data: bytes) -> str:
    """UTF-8 text, without the mark that some editors put before it. Raises :class:`InvalidDocument` with the position
    of the first bad byte."""
    try:
        return data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        utf_16 = "; this is UTF-16: save it as UTF-8" if data[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE) else ""
        message = f"byte {error.start} is not UTF-8: {error.reason}{utf_16}"
        raise InvalidDocument.at("", "encoding", message) from None


def encodes(text: str) -> bool:
    """Whether the text can be written as UTF-8, that is, holds no lone surrogate."""
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True
