"""Robot files read as documents of parts, with a report: a work of requests."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO

from service.content.unzipped import unzipped
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.kind import Blobs
from service.schemas.jobs import ItemDocument
from substructures.errors import InvalidArgument
from substructures.interchange.files.archive import Beside, main_of
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file

ZIP = b"PK\x03\x04"
MOST_FILES = 2000


def _read_file(item: ItemDocument, blobs: Blobs) -> Outcome:
    """The document of a robot file, with the report. Raises InvalidDocument with line and element, or with pointers
    into the query."""
    options = Options(item["parameters"], item["fixed"], item["base"], item["rotations"])
    data, called, beside = _opened(blobs[item["file"]], item["called"], item["unpacked"])
    about = {"name": item["name"], "file": called, "license_of_file": item["license"], "included": beside}
    try:
        found = import_file(data, options, kind=item["kind"], cut=item["cut"], **about)
    except InvalidArgument as error:
        raise error.below("/query") from None
    return Outcome(found.plain())


def _opened(data: bytes, called: str, most: int) -> tuple[bytes, str, Mapping[str, bytes]]:
    """A robot file, its name, and what lies about it in a zip of at most so many bytes. Raises InvalidDocument, Refused
    422."""
    if not data.startswith(ZIP):
        return data, called, {}
    files = unzipped(BytesIO(data), MOST_FILES, most, lambda _: most)
    main = main_of(files, files.__getitem__, called)
    return files[main], main, Beside(main, files, files.__getitem__)


REQUESTED = {"import": _read_file}
