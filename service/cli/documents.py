"""Documents in files that commands read."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from errno import EACCES, EISDIR, ENOENT
from io import BytesIO
from pathlib import Path
from typing import IO, Any

from service.schemas.entries import PartEntry
from substructures.client.problems import ProblemError
from substructures.documents import DOCUMENTS, located, read_json, read_yaml, require_object
from substructures.documents.tables import with_tables
from substructures.errors import Fault, InvalidInput
from substructures.part.definition import Definition


def is_document(given: str) -> bool:
    """Whether a tree or part is given as a file."""
    return given.endswith(DOCUMENTS)


def read_document(path: Path, content: bytes | None = None) -> Any:
    """A document in JSON or YAML, which is an object; ``content``: of the file, where it was read already, since a pipe
    is read only once. Raises InvalidDocument naming the file.
    """
    content = path.read_bytes() if content is None else content
    with named(path):
        document = read_from(path, BytesIO(content)) if content else None
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
    found = located(faults, path.read_bytes()) if path.suffix in DOCUMENTS else faults
    return [
        replace(each, pointer=f"{path}#{each.pointer}" if each.pointer.startswith("/") else each.pointer or str(path))
        for each in found
    ]


def require_place(out: Path | None) -> None:
    """Raise OSError where a file cannot be written: told before anything is computed for it, not afterwards."""
    if out is None:
        return
    if out.is_dir():
        raise IsADirectoryError(EISDIR, "a folder", str(out))
    if not out.absolute().parent.is_dir():
        raise FileNotFoundError(ENOENT, "no folder", str(out))
    if not os.access(out if out.exists() else out.absolute().parent, os.W_OK):
        raise PermissionError(EACCES, os.strerror(EACCES), str(out))
