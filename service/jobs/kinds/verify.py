"""verify: an item is ``{"substructure": reference}`` or ``{"tree": reference}``, ``*`` for all there are.

It is proven by deriving: what is stored has to be what today's software makes of the document, by its digest. What
another version of the software derived is derived anew before the job is queued.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from service.content.derivation import derived_part, software
from service.content.integrity import reading
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.items import Stored, members
from service.jobs.kinds.kind import (
    Blobs,
    ItemProgress,
    Kind,
    known_part,
    known_tree,
    recipe_member,
)
from service.jobs.kinds.library import Library
from service.messages.refusals import NotDerived
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json, read_model, write_json
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.tree.couple import couple_shape

ALL = "*"
#: what is stored of a tree beside its program, but for the certificate
SUMMARY = (
    *("coordinates", "joints", "frames", "closures", "reduction", "limited", "driven", "ignored"),
    *("velocity_constraints", "contacts", "balls", "reduced", "parameters", "inputs", "operations", "numbers"),
)


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    ((kind, reference),) = members(read_model(Stored, item)).items()
    references: Sequence[str] = [reference]
    if reference == ALL:
        references = library.trees() if kind == "tree" else library.catalogue()
    return [{kind: reference, "nodes": limits.job_nodes} for reference in references]


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    return _pinned_tree(item, library) if "tree" in item else _pinned_part(item, library)


def _pinned_part(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    version = known_part(item, library)
    if version.software != software():
        raise NotDerived("part", version.digest)
    pinned = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
    if fault := library.wrong_number(version):
        pinned["fault"] = fault
    return {**item, **pinned, **recipe_member(version, library)}, (version.digest, version.program)


def _pinned_tree(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """The document with its parts, and what the stored summary says beside the certificate."""
    tree = known_tree(item, library)
    if tree.software != software():
        raise NotDerived("tree", f"{tree.name}@{tree.revision}", is_newest=True)
    with reading(f"the document of tree {tree.name}", tree.digest):
        spec, summary = read_json(tree.spec.encode()), read_json(tree.summary.encode())
    parts, blobs = pinned_tree({"tree": spec, "nodes": item["nodes"]}, library, is_stored=True)
    said = {name: summary[name] for name in SUMMARY if name in summary}
    pinned = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "parts": parts, "summary": said}
    return {**item, **pinned}, (tree.program, *blobs)


def _run(item: ItemDocument, blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """File ``certificate``. Raises VerificationFailed, Refused for damaged content."""
    return _tree(item, blobs) if "tree" in item else _part(item, blobs)


def _part(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["substructure"].partition("@")
    with reading(f"the part {name}", digest):
        Program.from_bytes(blobs[item["program"]])
    part = derived_part(blobs[digest], item.get("recipe"), item["nodes"])
    if part.definition.name != name:
        raise VerificationFailed(f"it is called '{name}' in the store, and '{part.definition.name}' in its document")
    _require_same(item["program"], part.program)
    if "fault" in item:
        raise VerificationFailed(item["fault"])
    return _outcome(name, digest, part.certificate, {"warnings": part.certificate["warnings"]})


def _tree(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["tree"].partition("@")
    with reading(f"the tree {name}", digest):
        spec, parts = tree_parts(item["parts"], blobs)
        Program.from_bytes(blobs[item["program"]])
    model = couple_shape(spec, parts, item["nodes"])
    _require_same(item["program"], model.program)
    made = read_json(write_json(model.summary()))
    wrong = [each for each, said in item["summary"].items() if made.get(each) != said]
    if wrong:
        raise VerificationFailed(f"the {', '.join(wrong)} of the stored model are not those of its documents")
    return _outcome(name, digest, model.certificate, {})


def _require_same(stored: str, made: Program) -> None:
    if made.digest != stored:
        raise VerificationFailed(
            f"the stored formulas, {stored}, are not what is derived of the document, {made.digest}"
        )


def _outcome(name: str, digest: str, certificate: Mapping[str, Any], more: Mapping[str, object]) -> Outcome:
    agreement = certificate["direct_form"]
    errors = agreement["max_relative_error"] if isinstance(agreement, dict) else {}
    summary = {"name": name, "digest": digest, **more, "max_relative_error": errors}
    return Outcome(summary, {"certificate": write_json(dict(certificate))})


KINDS = {"verify": Kind(_spread, _resolve, _run)}
