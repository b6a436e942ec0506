"""Bundles: parts as others get them, and parts of others that are stored here.

Of what others send only definitions are believed: what is stored is derived of them here. Formulas that come with them
are compared by digest with those that are stored, so that it is told where they differ, be they forged or of another
version of the software.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

from service.content import bundles
from service.content.bundles import BundledPart
from service.content.integrity import missing
from service.content.summaries import PartContent
from service.content.unzipped import file_pointer, too_large
from service.database.connections import Connection
from service.jobs.worker import Worker
from service.messages.refusals import Refused, unprocessable
from service.messages.viewer import Viewer
from service.operations import catalogue
from service.operations.catalogue import PartSubmission
from service.operations.sharing.provenance import IMPORTED
from service.queries import content
from service.queries.catalogue import Version
from service.schemas.entries import PartEntry
from service.store.store import Store
from substructures.errors import Fault, InvalidInput, TooLarge


def find(connection: Connection, viewer: Viewer, refs: str) -> list[Version]:
    """The versions that references, separated by commas, mean: in their order, each once. Raises Refused 404, 422."""
    texts = [text.strip() for text in refs.split(",") if text.strip()]
    if not 0 < len(texts) <= bundles.MOST_PARTS:
        detail = f"refs is one to {bundles.MOST_PARTS} references, separated by commas; {len(texts)} were given"
        raise unprocessable("refs", detail, "/query/refs", limit=bundles.MOST_PARTS)
    found = [catalogue.find(connection, viewer, text) for text in texts]
    return list({version.digest: version for version in found}.values())


def bundled(connection: Connection, version: Version) -> BundledPart:
    """A version as it travels. Raises Refused for content that is damaged or gone."""
    part = content.get_part(connection, version.digest)
    if part is None:
        raise missing(f"the definition of {version.name}@{version.version}", version.digest)
    number, digests = version.version, (version.digest, version.program)
    return BundledPart(version.name, number, *digests, part.definition, part.program, part.certificate)


def prepare(
    store: Store, viewer: Viewer, part: BundledPart, entry: PartEntry, worker: Worker, max_nodes: int
) -> PartSubmission:
    """Derive a part of a bundle from its definition, unless its content is known. It keeps the number of its version.

    Raises Refused 403 for a name of others, 409, 422 and InvalidDocument, with pointers to the file, TimeoutError.
    """
    definition = bundles.definition_of(part)
    path = part.file(bundles.DEFINITION)

    def make() -> PartContent:
        """What is stored of it."""
        return catalogue.derived(worker, definition, {"nodes": max_nodes})

    try:
        with _inside(part):
            return replace(catalogue.prepare(store, viewer, definition, entry, IMPORTED, make), number=part.number)
    except InvalidInput as error:
        raise error.below(file_pointer(path)) from None
    except TooLarge as error:
        raise too_large(path, error.what, error.size, error.limit) from None


@dataclass(frozen=True, slots=True)
class Imported:
    """What a part of a bundle has become. ``is_new``: it was not there before; ``is_equal``: the formulas in the bundle
    are, by their digest, those that are stored.
    """

    version: Version
    is_new: bool
    is_equal: bool


def commit(
    connection: Connection, viewer: Viewer, parts: Sequence[BundledPart], ready: Sequence[PartSubmission]
) -> list[Imported]:
    """Store what was prepared, all or nothing. Raises Refused 403, 409."""
    found: dict[str, Imported] = {}
    # names are locked in one order, whatever that of a bundle is
    for part, submission in sorted(zip(parts, ready, strict=True), key=lambda pair: pair[0].name):
        with _inside(part):
            version, is_new = catalogue.submit(connection, viewer, submission)
        found[part.digest] = Imported(version, is_new, version.program == part.program_digest)
    return [found[part.digest] for part in parts]


@contextmanager
def _inside(part: BundledPart) -> Iterator[None]:
    """What is refused of a part has a pointer to its folder."""
    try:
        yield
    except Refused as error:
        if error.faults or error.status >= 500:
            raise
        fault = Fault(file_pointer(part.folder), error.code, error.detail)
        raise Refused(error.status, error.code, error.detail, [fault], error.headers, **error.members) from None
