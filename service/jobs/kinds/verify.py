"""verify: an item is ``{"substructure": reference}`` or ``{"tree": reference}``, ``*`` for all there are.

Its certificate is made anew from what is stored.
"""

from __future__ import annotations

from service.integrity import reading
from service.jobs.engine import Outcome
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, check_fields, known_part, known_tree
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json, write_json
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Part, recheck
from substructures.tree.document import TreeSpec
from substructures.tree.recheck import SUMMARY, recheck_tree

ALL = "*"


def _spread(item: ItemDocument, _limits: Limits, library: Library) -> list[ItemDocument]:
    kind = "tree" if "tree" in item else "substructure"
    check_fields(item, (kind,))
    if item[kind] != ALL:
        return [item]
    references = library.trees() if kind == "tree" else library.catalogue()
    return [{kind: reference} for reference in references]


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    return _pinned_tree(item, library) if "tree" in item else _pinned_part(item, library)


def _pinned_part(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    version = known_part(item, library)
    pinned = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
    return pinned, (version.digest, version.program)


def _pinned_tree(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """The document with the digests of its parts, and what the stored summary says beside the certificate."""
    tree = known_tree(item, library)
    with reading(f"the document of tree {tree.name}", tree.digest):
        spec, summary = read_json(tree.spec.encode()), read_json(tree.summary.encode())
        digests = {pin.partition("@")[2] for i in spec.get("instances", ()) if (pin := i.get("substructure"))}
    said = {name: summary[name] for name in SUMMARY if name in summary}
    pinned = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "spec": spec, "summary": said}
    return pinned, (tree.program, *sorted(digests))


def _run(item: ItemDocument, blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """File ``certificate``. Raises VerificationFailed, Refused for damaged content."""
    return _tree(item, blobs) if "tree" in item else _part(item, blobs)


def _part(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["substructure"].partition("@")
    with reading(f"the part {name}", digest):
        # never one that was decoded before
        part = Part.load(Definition.stored(read_json(blobs[digest])), blobs[item["program"]], {})
    certificate = recheck(part)
    return _outcome(name, digest, certificate, {"warnings": certificate["warnings"]})


def _tree(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["tree"].partition("@")
    with reading(f"the tree {name}", digest):
        spec = TreeSpec.stored(item["spec"])
        program = Program.from_bytes(blobs[item["program"]])
    definitions: dict[str, Definition] = {}
    for instance in spec.instances:
        pin = (instance.substructure or "").partition("@")[2]
        with reading(f"the definition of '{instance.name}'", pin):
            definitions[instance.name] = instance.definition or Definition.stored(read_json(blobs[pin]))
    return _outcome(name, digest, recheck_tree(spec, definitions, item["summary"], program), {})


def _outcome(name: str, digest: str, certificate: dict[str, object], more: dict[str, object]) -> Outcome:
    agreement = certificate["direct_form"]
    errors = agreement["max_relative_error"] if isinstance(agreement, dict) else {}
    summary = {"name": name, "digest": digest, **more, "max_relative_error": errors}
    return Outcome(summary, {"certificate": write_json(certificate)})


VERIFY = Kind(_spread, _resolve, _run)
