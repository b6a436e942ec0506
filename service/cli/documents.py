"""Documents in files that commands read."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import IO, Any

from service.schemas.entries import PartEntry
from substructures.client.problems import ProblemError
from substructures.documents import places, read_json, read_yaml, require_object
from substructures.documents.tables import with_tables
from substructures.errors import Fault, InvalidInput
from substructures.part.definition import Definition

#: endings of documents, in which places are found by line and column
DOCUMENTS = (".yaml", ".yml", ".json")
_TOLD = re.compile(r"\(line \d+, column \d+\)$")


def is_document(given: str) -> bool:
    """Whether a tree or part is given as a file."""
    return given.endswith(DOCUMENTS)


def read_document(path: Path) -> Any:
    """A document in JSON or YAML, which is an object. Raises InvalidDocument naming the file."""
    with path.open("rb") as file, named(path):
        document = read_from(path, file) if path.stat().st_size else None
        require_object(document)
        return with_tables(document, path.parent)


def read_from(path: Path, file: IO[bytes]) -> Any:
    """A document in JSON or YAML, by the ending of its name. Raises InvalidDocument."""
    return read_json(file.read()) if path.suffix == ".json" else read_yaml(file.read())


def definition_of(document: Any) -> Definition:
    """The definition in a document, which may say beside it what it is submitted with. Raises InvalidDocument."""
    return Definition.read(PartEntry.parted(document)[1])


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Put the name of the file before the pointers of its faults, unless these name another one already, and line and
    column behind what they say, also where a server that was sent the document tells of them. Raises InvalidDocument,
    ProblemError.
    """
    try:
        yield
    except InvalidInput as error:
        raise type(error)(_placed(path, error.faults)) from None
    except ProblemError as error:
        found = error.problem.get("errors") if error.status == 422 else None
        if not found:
            raise
        faults = _placed(path, [Fault(each["pointer"], each["code"], each["message"]) for each in found])
        told = {"detail": faults[0].message, "errors": [asdict(fault) for fault in faults]}
        raise ProblemError(error.status, {**error.problem, **told}) from None


def _placed(path: Path, faults: Sequence[Fault]) -> list[Fault]:
    known = places(path.read_bytes()) if path.suffix in DOCUMENTS else {}
    return [
        replace(
            fault,
            pointer=f"{path}#{fault.pointer}" if fault.pointer.startswith("/") else fault.pointer or str(path),
            message=fault.message + _where(fault, known),
        )
        for fault in faults
    ]


def _where(fault: Fault, known: Mapping[str, tuple[int, int]]) -> str:
    """Line and column of the innermost place there is of a pointer; nothing where the fault says it itself."""
    pointer = fault.pointer
    while pointer and pointer not in known:
        pointer = pointer.rpartition("/")[0]
    if _TOLD.search(fault.message) or not fault.pointer or pointer not in known:
        return ""
    return " (line {}, column {})".format(*known[pointer])
