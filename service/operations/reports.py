"""Reports about stored parts and trees: in words, as a document, as a page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from service.answers import Answer
from service.operations.pictures import INSTANCE
from service.operations.sources import tree_parts
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.store import Store
from substructures.analysis.report.latex import latex_report
from substructures.analysis.report.page import page_report
from substructures.analysis.report.report import Heading, Report, report
from substructures.analysis.report.text import text_report
from substructures.documents import write_json
from substructures.part.part import Part
from substructures.pictures.latex import latex_picture
from substructures.pictures.tree import picture
from substructures.tree.document import TreeSpec
from substructures.tree.glossary import glossary
from substructures.tree.model import Model

FORMATS: Mapping[str, str] = {
    "json": "application/json",
    "text": "text/plain; charset=utf-8",
    "latex": "application/x-latex; charset=utf-8",
    "mathml": "application/xhtml+xml; charset=utf-8",
}
#: of a part alone, which does not say gravity
GRAVITY = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": "9.81", "unit": "m/s^2"}}}
ASSUMED = "The part stands alone on the ground, with gravity g against the third axis of its interface: an assumption."


@dataclass(frozen=True, slots=True)
class Subject:
    """What a report is about."""

    heading: Heading
    spec: TreeSpec
    parts: Mapping[str, Part]
    model: Model


def of_part(store: Store, version: Version) -> Subject:
    """A part alone. Raises Refused for damaged content, TooLarge."""
    with store.database.read() as connection:
        part = store.required_part(connection, version.digest)
    instance = {"name": INSTANCE, "substructure": f"{version.name}@{version.digest}"}
    spec = TreeSpec.read({"name": version.name, "instances": [instance], **GRAVITY})
    parts = {INSTANCE: part}
    definition = part.definition
    called = f"{version.name}@{version.version}"
    heading = Heading(called, definition.title, definition.description, version.digest, (ASSUMED,))
    return Subject(heading, spec, parts, store.coupled(spec, parts))


def of_tree(store: Store, tree: Tree) -> Subject:
    """A revision of a tree. Raises Refused for damaged content."""
    spec, parts = tree_parts(store, tree)
    with store.database.read() as connection:
        model = store.model(connection, tree)
    notes = [f"Instances: {', '.join(f'{name} ({part.name})' for name, part in parts.items())}."]
    if model.closures:
        closed = ", ".join(rows.name for rows in model.closures)
        notes.append(f"The formulas are those of the tree without its closures ({closed}).")
    heading = Heading(f"{tree.name}@{tree.revision}", f"Tree {tree.name}", "", tree.digest, tuple(notes))
    return Subject(heading, spec, parts, model)


def written(store: Store, about: Subject, format: str, document: bool) -> Answer:  # noqa: A002 -- the name in the contract
    """The report in one of FORMATS; ``document``: LaTeX with its head and end. Raises TooLarge."""
    found = report(
        about.model,
        {name: part.definition for name, part in about.parts.items()},
        about.heading,
        glossary(about.spec, about.parts, model=about.model.program),
    )
    text = _text(found, about, format, document, store.settings.limits.program_nodes)
    return Answer(200, text, {"Content-Type": FORMATS[format]})


def _text(found: Report, about: Subject, format: str, document: bool, limit: int) -> bytes:  # noqa: A002 -- as above
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
