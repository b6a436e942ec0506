"""Bundles: parts as others get them, and parts of others that are stored here, each verified before it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from service import bundles
from service.bundles import BundledPart
from service.database.connections import Connection
from service.integrity import missing
from service.operations import catalogue
from service.operations.catalogue import PartSubmission
from service.operations.provenance import Origin
from service.queries import content
from service.queries.catalogue import Version
from service.refusals import Refused, unprocessable
from service.schemas.entries import PartEntry
from service.store import Store
from service.unzipped import file_pointer, too_large
from service.viewer import Viewer
from substructures.errors import Fault, InvalidInput, InvalidProgram, TooLarge, VerificationFailed
from substructures.part.definition import Definition
from substructures.part.part import Part, received

IMPORTED = Origin("import")


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
    return BundledPart(version.name, version.digest, version.program, part.definition, part.program, part.certificate)


def prepare(store: Store, viewer: Viewer, part: BundledPart, entry: PartEntry, max_nodes: int) -> PartSubmission:
    """Verify a part of a bundle, whose content is stored unless it is known.

    Raises Refused 403 for a name of others, 409, 422 and InvalidDocument, with pointers to the file.
    """
    definition = bundles.definition_of(part)
    made: list[Part] = []

    def verified() -> Part:
        """The part with a certificate of its own."""
        made.append(_received(part, definition, max_nodes))
        return made[0]

    with _inside(part):
        submission = catalogue.prepare(store, viewer, definition, entry, IMPORTED, verified)
    if not made and not _is_stored(store, part):  # another program of what is known is not stored, but refused if wrong
        verified()
    return submission


def _is_stored(store: Store, part: BundledPart) -> bool:
    """Whether what is stored under the digest of the part has the same program."""
    with store.database.read() as connection:
        found = content.get_part(connection, part.digest)
    return found is not None and found.program == part.program


def _received(part: BundledPart, definition: Definition, max_nodes: int) -> Part:
    """The part, its program compared with its definition. Raises Refused 422, InvalidDocument."""
    path, certificate = part.file(bundles.PROGRAM), bundles.certificate_of(part)
    pointer = file_pointer(path)
    try:
        found = received(definition, part.program, certificate, max_nodes)
        if found.program.to_bytes() != part.program:
            raise InvalidProgram("its text is not the canonical one")
    except InvalidInput as error:
        raise error.below(file_pointer(part.file(bundles.DEFINITION))) from None
    except InvalidProgram as error:
        raise unprocessable("invalid-bundle", f"{path}: {error}; nothing was stored", pointer) from None
    except VerificationFailed as error:
        detail = f"{path}: these are not the formulas of the definition: {error}; nothing was stored"
        raise unprocessable("not-verified", detail, pointer) from None
    except TooLarge as error:
        raise too_large(path, error.what, error.size, error.limit) from None
    return found


def commit(
    connection: Connection, viewer: Viewer, parts: Sequence[BundledPart], ready: Sequence[PartSubmission]
) -> list[tuple[Version, bool]]:
    """Store what was prepared, all or nothing: every version, and whether it is new. Raises Refused 403, 409."""
    found: dict[str, tuple[Version, bool]] = {}
    # names are locked in one order, whatever that of a bundle is
    for part, submission in sorted(zip(parts, ready, strict=True), key=lambda pair: pair[0].name):
        with _inside(part):
            found[part.digest] = catalogue.submit(connection, viewer, submission)
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
