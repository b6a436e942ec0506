"""Reports about parts and trees, as documents for people, and what changed between two of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.content.cache import Cache
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.decoded import model_of, part_of
from service.jobs.kinds.kind import Blobs
from service.schemas.jobs import ItemDocument
from substructures.analysis.report.latex import latex_report
from substructures.analysis.report.page import page_report
from substructures.analysis.report.report import Heading, Report, report
from substructures.analysis.report.rest import MOST_COORDINATES, MOST_OPERATIONS
from substructures.analysis.report.text import text_report
from substructures.documents import write_json
from substructures.errors import TooLarge
from substructures.interchange.difference.difference import Difference, of_parts, of_trees
from substructures.part.part import Part
from substructures.pictures.latex import latex_picture
from substructures.pictures.tree import picture
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec
from substructures.tree.glossary import glossary
from substructures.tree.model import Model

#: of a part alone, which does not say gravity
GRAVITY = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": "9.81", "unit": "m/s^2"}}}
ASSUMED = "The part stands alone on the ground, with gravity g against the third axis of its interface: an assumption."
INSTANCE = "part"
MOST_SINGLE = 5000  # operations of a part, as expected, up to which each change is also looked at by itself
CAPACITY = 300_000  # operations of parts alone that are kept coupled
_alone: Cache[Model] = Cache(CAPACITY, lambda model: len(model.program))


@dataclass(frozen=True, slots=True)
class _Subject:
    """What a report is about."""

    heading: Heading
    spec: TreeSpec
    parts: Mapping[str, Part]
    model: Model


def report_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """The report about ``called``, a part or a tree, in a format. Raises TooLarge."""
    about = _part(item, blobs) if "definition" in item else _tree(item, blobs)
    definitions = {name: part.definition for name, part in about.parts.items()}
    words = glossary(about.spec, about.parts, model=about.model.program)
    found = report(about.model, definitions, about.heading, words, _regressor(about, item["nodes"]))
    return Outcome(files={"report": _text(found, about, item["format"], item["document"], item["nodes"])})


def _regressor(about: _Subject, nodes: int) -> RegressorModel | None:
    """That of a tree of moderate size; reduced systems are not linear in inertial parameters."""
    if about.model.ignored or about.model.dof > MOST_COORDINATES or len(about.model.program) > MOST_OPERATIONS:
        return None
    try:
        return regressor(about.spec, about.parts, nodes)
    except TooLarge:
        return None


def _part(item: ItemDocument, blobs: Blobs) -> _Subject:
    """A part alone."""
    digest, program = item["definition"], item["program"]
    part = part_of(digest, program, blobs)
    instance = {"name": INSTANCE, "substructure": f"{part.name}@{digest}", "level": "full"}
    spec, parts = TreeSpec.read({"name": part.name, "instances": [instance], **GRAVITY}), {INSTANCE: part}
    model = _alone.once((digest, program, item["nodes"]), lambda: couple(spec, parts, item["nodes"]))
    definition = part.definition
    heading = Heading(item["called"], definition.title, definition.description, digest, (ASSUMED,))
    return _Subject(heading, spec, parts, model)


def _tree(item: ItemDocument, blobs: Blobs) -> _Subject:
    """A revision of a tree."""
    model, (spec, parts) = model_of(item, blobs), tree_parts(item["parts"], blobs)
    notes = [f"Instances: {', '.join(f'{name} ({part.name})' for name, part in parts.items())}."]
    if model.closures:
        closed = ", ".join(rows.name for rows in model.closures)
        notes.append(f"The formulas are those of the tree without its closures ({closed}).")
    name, _, digest = item["tree"].partition("@")
    heading = Heading(item["called"], f"Tree {name}", "", digest, tuple(notes), f"/v1/trees/{item['called']}")
    return _Subject(heading, spec, parts, model)


def _text(found: Report, about: _Subject, format: str, document: bool, limit: int) -> bytes:  # noqa: A002 -- in the contract
    drawn = about.spec, about.parts, about.model
    match format:
        case "json":
            return write_json(found.plain(limit))
        case "latex":
            return latex_report(found, latex_picture(*drawn), document, limit).encode()
        case "mathml":
            return page_report(found, picture(*drawn), limit).encode()
        case _:
            return text_report(found, limit).encode()


def difference_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """What changed from ``a`` to ``b``, versions of parts or revisions of trees."""
    a, b = item["a"], item["b"]
    found = _between_trees(a, b, item["called"], blobs) if "tree" in a else _between_parts(a, b, blobs)
    return Outcome(found.plain())


def _between_parts(a: ItemDocument, b: ItemDocument, blobs: Blobs) -> Difference:
    def admit(operations: int) -> None:
        """Changes of large parts are told together."""
        if operations > MOST_SINGLE:
            raise TooLarge("a part of which every change is looked at alone", operations, MOST_SINGLE)

    ours, theirs = (part_of(each["definition"], each["program"], blobs) for each in (a, b))
    return of_parts(ours, theirs, admit)


def _between_trees(a: ItemDocument, b: ItemDocument, called: Mapping[str, Any], blobs: Blobs) -> Difference:
    """``called``: the versions of parts by reference, where they are seen."""
    (first, ours), (second, theirs) = (tree_parts(each["parts"], blobs) for each in (a, b))
    models = [model_of(each, blobs) for each in (a, b)]
    common = [
        (name, part, theirs[name])
        for name, part in ours.items()
        if name in theirs and part.definition.digest != theirs[name].definition.digest
    ]
    return of_trees((first, models[0]), (second, models[1]), common, lambda given: called.get(given, given))


REQUESTED = {"report": report_of, "difference": difference_of}
