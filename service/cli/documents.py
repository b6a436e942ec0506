"""Documents in files that commands read."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

from substructures.documents import places, read_json, read_yaml
from substructures.errors import Fault, InvalidInput

#: endings of documents, in which places are found by line and column
DOCUMENTS = (".yaml", ".yml", ".json")
_TOLD = re.compile(r"\(line \d+, column \d+\)$")


def is_document(given: str) -> bool:
    """Whether a tree or part is given as a file."""
    return given.endswith(DOCUMENTS)


def read_document(path: Path) -> Any:
    """A document in JSON or YAML. Raises InvalidDocument naming the file."""
    with path.open("rb") as file, named(path):
        return read_from(path, file)


def read_from(path: Path, file: IO[bytes]) -> Any:
    """A document in JSON or YAML, by the ending of its name. Raises InvalidDocument."""
    return read_json(file.read()) if path.suffix == ".json" else read_yaml(file.read())


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Put the name of the file before the pointers of its faults, and line and column behind what they say. Raises
    InvalidDocument.
    """
    try:
        yield
    except InvalidInput as error:
        known = places(path.read_bytes()) if path.suffix in DOCUMENTS else {}
        faults = [replace(fault, message=fault.message + _where(fault, known)) for fault in error.faults]
        moved = type(error)(faults)
        raise moved.moved(lambda pointer: f"{path}#{pointer}" if pointer else str(path)) from None


def _where(fault: Fault, known: Mapping[str, tuple[int, int]]) -> str:
    """Line and column of the innermost place there is of a pointer; nothing where the fault says it itself."""
    pointer = fault.pointer
    while pointer and pointer not in known:
        pointer = pointer.rpartition("/")[0]
    if _TOLD.search(fault.message) or not fault.pointer or pointer not in known:
        return ""
    return " (line {}, column {})".format(*known[pointer])
