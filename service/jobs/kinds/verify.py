"""verify: an item is ``{"substructure": reference}``, ``*`` for the whole catalogue; its certificate is made anew."""

from __future__ import annotations

from service.jobs.engine import Outcome
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, check_fields
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json, write_json
from substructures.errors import InvalidDocument, InvalidProgram
from substructures.part.definition import Definition
from substructures.part.part import Part, recheck

ALL = "*"


def _spread(item: ItemDocument, _limits: Limits, library: Library) -> list[ItemDocument]:
    check_fields(item, ("substructure",))
    if item["substructure"] != ALL:
        return [item]
    return [{"substructure": reference} for reference in library.catalogue()]


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    reference = item["substructure"]
    version = library.version(reference) if isinstance(reference, str) else None
    if version is None:
        message = f"there is no substructure '{str(reference)[:160]}'"
        raise InvalidDocument.at("/substructure", "unknown-substructure", message)
    pinned = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
    return pinned, (version.digest, version.program)


def _run(item: ItemDocument, blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """File ``certificate``. Raises VerificationFailed, InvalidProgram."""
    definition = Definition.stored(read_json(blobs[item["substructure"].partition("@")[2]]))
    part = Part.load(definition, blobs[item["program"]], {})  # never one that was decoded before
    if part.program.digest != item["program"]:
        raise InvalidProgram(f"the stored program has the digest {part.program.digest}, not {item['program']}")
    certificate = recheck(part)
    summary = {"name": part.name, "digest": part.definition.digest, "warnings": certificate["warnings"]}
    errors = certificate.get("direct_form", {}).get("max_relative_error", {})
    return Outcome({**summary, "max_relative_error": errors}, {"certificate": write_json(certificate)})


VERIFY = Kind(_spread, _resolve, _run)
