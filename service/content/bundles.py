"""Bundles: parts with their programs and certificates as one zip, the same bytes for the same parts.

::

    bundle.json                           format, version, and of every part name, number of its version, digest,
                                          program, folder, files
    puma560@0123456789ab/definition.json  canonical bytes, whose SHA-256 is the digest
    puma560@0123456789ab/program          canonical bytes of the program (docs/reference/format.md)
    puma560@0123456789ab/certificate.json

Of a bundle that is read only names and definitions are taken: formulas are derived of these, and a program that comes
with one is compared with what was derived by its digest, and never read.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import IO, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from service.content.integrity import digest_of
from service.content.unzipped import file_pointer, invalid, too_large, unzipped
from service.messages.refusals import unprocessable
from service.schemas.shapes import Digest
from substructures.documents import read_json, read_model, write_json
from substructures.documents.fields import LibraryName
from substructures.errors import InvalidInput
from substructures.export import archive
from substructures.part.definition import Definition

FORMAT, VERSION = "substructures.bundle", 2  # 1 was without numbers of versions
MEDIA_TYPE = "application/zip"
LIST = "bundle.json"
DEFINITION, PROGRAM, CERTIFICATE = "definition.json", "program", "certificate.json"
FILES = (DEFINITION, PROGRAM, CERTIFICATE)
MOST_PARTS = 200
MOST_NUMBER = 1_000_000  # of a version that comes from elsewhere
SHORT = len("sha256:") + 12  # characters of a digest in the name of a folder
NOTHING = "nothing was stored"  # of a bundle that is refused


@dataclass(frozen=True, slots=True)
class BundledPart:
    """A part as it travels: canonical bytes of definition and program, and the certificate as JSON. ``number``: of its
    version where it comes from, None where that is not told."""

    name: str
    number: int | None
    digest: str
    program_digest: str
    definition: bytes
    program: bytes
    certificate: bytes

    @property
    def folder(self) -> str:
        """Its folder in the bundle."""
        return f"{self.name}@{self.digest.removeprefix('sha256:')[: SHORT - len('sha256:')]}"

    def file(self, name: str) -> str:
        """The path of one of its files."""
        return f"{self.folder}/{name}"

    @property
    def contents(self) -> dict[str, bytes]:
        """Its files by name."""
        return dict(zip(FILES, (self.definition, self.program, self.certificate), strict=True))


class _Listed(BaseModel):
    """What ``bundle.json`` says of a part; ``files``: SHA-256 by name."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: LibraryName
    number: Annotated[int, Field(strict=True, ge=1, le=MOST_NUMBER)] | None = None
    digest: Digest
    program: Digest
    folder: str
    files: dict[str, Digest]


class _List(BaseModel):
    """``bundle.json``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: str
    version: int
    parts: tuple[_Listed, ...]


def write_bundle(parts: Iterable[BundledPart], most: int) -> bytes:
    """A bundle of at most so many bytes, also unpacked. Raises Refused 422 for one that is too large, as soon
    as it is: no further ``parts`` are taken then."""
    listed, files, size = list[dict[str, Any]](), dict[str, bytes](), 0
    for part in parts:
        number = {} if part.number is None else {"number": part.number}
        digests = {"digest": part.digest, "program": part.program_digest}
        own = {name: digest_of(data) for name, data in part.contents.items()}
        listed.append({"name": part.name, **number, **digests, "folder": part.folder, "files": own})
        files |= {part.file(name): data for name, data in part.contents.items()}
        size += sum(map(len, part.contents.values()))
        _require_room(size, most)
    packed = archive({LIST: write_json({"format": FORMAT, "version": VERSION, "parts": listed}), **files})
    _require_room(len(packed), most)
    return packed


def _require_room(size: int, most: int) -> None:
    if size > most:
        detail = f"the bundle has {size:,} bytes and more; the limit is {most:,}: ask for fewer parts"
        raise unprocessable("too-large", detail, "/query/refs", size=size, limit=most)


def read_bundle(file: IO[bytes], most: int, most_words: int) -> list[BundledPart]:
    """The parts of a bundle of at most ``most`` bytes, in its order, with the digests that it says; ``most_words``: of
    a definition or certificate.

    Raises Refused 422 and InvalidDocument with pointers to the file.
    """

    def limit(path: str) -> int:
        """Bytes that a file may have; a definition and what is known of it no more than can come in by a job."""
        return most if path.endswith(f"/{PROGRAM}") else most_words

    files = unzipped(file, 1 + len(FILES) * MOST_PARTS, most, limit)
    if LIST not in files:
        raise invalid(LIST, "it is missing")
    listed = _list_of(files.pop(LIST))
    parts = [_part(each, files, f"/{LIST}/parts/{k}") for k, each in enumerate(listed.parts)]
    for name in files:
        raise invalid(name, f"{LIST} does not list it")
    return parts


@contextmanager
def _inside(path: str) -> Iterator[None]:
    """Faults of a document have pointers that begin with the path of its file."""
    try:
        yield
    except InvalidInput as error:
        raise error.below(file_pointer(path)) from None


def _list_of(data: bytes) -> _List:
    with _inside(LIST):
        document = read_json(data)
        _check_format(document)
        listed = read_model(_List, document)
    if not 0 < len(listed.parts) <= MOST_PARTS:
        raise too_large(f"{LIST}/parts", "the number of parts", len(listed.parts), MOST_PARTS)
    return listed


def _check_format(document: Any) -> None:
    """Raise Refused for what is no bundle, and for one of a format that is not known here."""
    if not isinstance(document, Mapping) or document.get("format") != FORMAT:
        raise invalid(f"{LIST}/format", f"'{FORMAT}' is needed")
    version = document.get("version")
    if type(version) is not int or version < 1:
        raise invalid(f"{LIST}/version", "the number of the format is needed")
    if version > VERSION:
        detail = f"the bundle has the format {version}, and this server knows formats up to {VERSION}; {NOTHING}"
        raise unprocessable("newer-format", detail, f"/{LIST}/version", known=VERSION)


def _part(listed: _Listed, files: dict[str, bytes], place: str) -> BundledPart:
    """The part that is listed, whose files are taken out of those there are."""
    contents = []
    for name in FILES:
        path = f"{listed.folder}/{name}"
        if name not in listed.files:
            raise unprocessable("invalid-bundle", f"'{name}' is not listed; {NOTHING}", f"{place}/files")
        if path not in files:
            raise invalid(path, "it is listed, and missing")
        contents.append(files.pop(path))
        _check_digest(path, contents[-1], listed.files[name], "the list")
    part = BundledPart(listed.name, listed.number, listed.digest, listed.program, *contents)
    if listed.folder != part.folder or len(listed.files) != len(FILES):
        detail = f"the folder of this part is '{part.folder}', with {', '.join(FILES)}; {NOTHING}"
        raise unprocessable("invalid-bundle", detail, f"{place}/folder")
    _check_digest(part.file(DEFINITION), part.definition, part.digest, "the part")
    _check_digest(part.file(PROGRAM), part.program, part.program_digest, "the part")
    return part


def _check_digest(path: str, data: bytes, digest: str, whose: str) -> None:
    found = digest_of(data)
    if found != digest:
        detail = f"{path}: its bytes have the digest {found}, and by {whose} they have {digest}; {NOTHING}"
        raise unprocessable("wrong-digest", detail, file_pointer(path))


def definition_of(part: BundledPart) -> Definition:
    """The definition, of which there is one text. Raises InvalidDocument, Refused 422."""
    path = part.file(DEFINITION)
    with _inside(path):
        definition = Definition.read(read_json(part.definition))
    if definition.canonical() != part.definition or definition.name != part.name:
        detail = f"{path}: not the canonical text of a definition with the name '{part.name}'; {NOTHING}"
        raise unprocessable("wrong-digest", detail, file_pointer(path))
    return definition
