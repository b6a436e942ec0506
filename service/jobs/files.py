"""Robot files, read by workers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from service.content.integrity import digest_of
from service.jobs.worker import Worker
from substructures.interchange.files.wanted import Options, text_of_file

DEFAULT = Options()


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a file is to become: of which kind it has to be, how its part is called, what is told of its source, the
    links that begin parts of their own."""

    options: Options = DEFAULT
    kind: str | None = None
    name: str | None = None
    file: str = ""
    license: str = ""
    cut: Sequence[str] = ()


def read(worker: Worker, data: bytes, wanted: Wanted, unpacked: int = 0) -> Mapping[str, Any]:
    """What is in a file, or in a zip of at most so many bytes ``unpacked``: ``definition`` or ``tree``, and the report.
    Raises InvalidDocument, Refused 422, TimeoutError."""
    digest, item = digest_of(data), asdict(wanted.options) | {"cut": list(wanted.cut)}
    item |= {"kind": wanted.kind, "name": wanted.name, "called": wanted.file, "license": wanted.license}
    return worker("import", {"file": digest, "unpacked": unpacked, **item}, {digest: data}).summary


def document_of(worker: Worker, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The definition or tree in ``{"file": text, "kind": ...}``. Raises InvalidDocument, TimeoutError."""
    found = read(worker, text_of_file(given), Wanted(kind=given.get("kind")))
    document: Mapping[str, Any] = found["tree"] if "tree" in found else found["definition"]
    return document
