"""upgrade: an item is ``{"substructure": reference}`` or ``{"tree": reference}``, ``*`` for the latest ones of all
names that may be changed.

Its formulas are derived anew with today's software, and take the place of those that are stored.
"""

from __future__ import annotations

from typing import Any

from service.content.derivation import derived_part, software
from service.content.improvement import improvement
from service.content.integrity import reading
from service.content.summaries import part_content
from service.content.tree_summaries import tree_summary
from service.database.packed import pack
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.items import Stored, members
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, known_part, known_tree, recipe_member
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json, read_model
from substructures.errors import InvalidDocument
from substructures.expr.program import Program
from substructures.tree.couple import couple_shape
from substructures.tree.document import TreeSpec

ALL = "*"


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    ((kind, reference),) = members(read_model(Stored, item)).items()
    references = library.own(kind) if reference == ALL else [reference]
    return [{kind: reference, "nodes": limits.job_nodes} for reference in references]


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """``software``: what the result of an item depends on beside it."""
    kind = "tree" if "tree" in item else "substructure"
    found = known_tree(item, library) if kind == "tree" else known_part(item, library)
    if not library.may_change(kind, found.name):
        message = f"'{found.name}' belongs to somebody else: only its owner or an admin derives it anew"
        raise InvalidDocument.at(f"/{kind}", "not-owner", message)
    pinned = {kind: f"{found.name}@{found.digest}", "program": found.program, "software": software()}
    if kind == "substructure":
        return {**item, **pinned, **recipe_member(known_part(item, library), library)}, (found.digest, found.program)
    tree = known_tree(item, library)
    document = read_json(tree.spec.encode())
    parts, blobs = pinned_tree({"tree": document, "nodes": item["nodes"]}, library, is_stored=True)
    return {**item, **pinned, "document": document, "parts": parts}, (tree.program, *blobs)


def _run(item: ItemDocument, blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """Files ``program``, and ``content`` of a part or ``summary``, ``form`` of a tree, where they are others than what
    is stored.

    Raises VerificationFailed, TooLarge, Refused for damaged content.
    """
    return _tree(item, blobs) if "tree" in item else _part(item, blobs)


def _part(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["substructure"].partition("@")
    with reading(f"the part {name}", digest):
        definition, old = blobs[digest], Program.from_bytes(blobs[item["program"]])
    new = derived_part(definition, item.get("recipe"), item["nodes"])
    found = improvement(old, new.program)
    told = {"name": name, "digest": digest, "program": new.program.digest}
    figures: dict[str, Any] = {"before": found.before, "after": found.after, "outcome": found.outcome}
    return Outcome({**told, **figures}, part_content(new, item.get("recipe")).files() if found.is_one else {})


def _tree(item: ItemDocument, blobs: Blobs) -> Outcome:
    name, _, digest = item["tree"].partition("@")
    with reading(f"the tree {name}", digest):
        spec, parts = tree_parts(item["parts"], blobs)
        old = Program.from_bytes(blobs[item["program"]])
    model = couple_shape(spec, parts, item["nodes"])
    found = improvement(old, model.program)
    told = {"name": name, "digest": digest, "program": model.program.digest, "nodes": len(model.program)}
    told["software"] = software()
    figures = {"dof": model.dof, "before": found.before, "after": found.after, "outcome": found.outcome}
    if not found.is_one:
        return Outcome({**told, **figures})
    summary = tree_summary(TreeSpec.stored(item["document"]), model)
    return Outcome({**told, **figures}, {"program": pack(model.program), **summary.files()})


KINDS = {"upgrade": Kind(_spread, _resolve, _run)}
