"""compare: an item is ``{"a", "b", "coordinates"}``; whether both are the same model, and what makes them different.

Each is what ``POST /v1/equivalences`` takes: a reference, a definition, a tree, or ``{"file": text, "kind": ...}``.
``b`` may be a list, one against many, each an item of its own, or ``*`` for all versions of the catalogue.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.derive import resolve_definition
from service.jobs.kinds.items import Compared
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, admitted, inside
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json, read_model
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.sides import Parts, sides
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.part import Part

ALL, SIDES = "*", ("a", "b")


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    read = read_model(Compared, item)
    common = {"coordinates": read.coordinates, "nodes": limits.job_nodes}
    with inside("/a"):
        a = _document(read.a, library)
    found: list[ItemDocument] = []
    for k, b in enumerate(library.catalogue() if read.b == ALL else read.b if isinstance(read.b, list) else [read.b]):
        with inside(f"/b/{k}" if isinstance(read.b, list) else "/b"):
            found.append({"a": a, "b": _document(b, library), **common})
    if not found:
        raise InvalidDocument.at("/b", "empty", "the catalogue has no versions")
    return found


def _document(given: str | Mapping[str, Any], library: Library) -> Any:
    """A reference or a document; a file as what is read of it. Raises InvalidDocument."""
    return library.file(given) if not isinstance(given, str) and "file" in given else given


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    found, blobs = dict(item), dict[str, None]()
    for name in SIDES:
        with inside(f"/{name}"):
            found[name], needed = pinned_side(item[name], item["nodes"], library)
        blobs |= dict.fromkeys(needed)
    return found, tuple(blobs)


def pinned_side(given: Any, nodes: int, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """A part by its digests, a tree with those of its parts, or a definition."""
    if isinstance(given, str):
        version = library.version(given)
        if version is not None:
            pinned = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
            return pinned, (version.digest, version.program)
        tree = library.tree(given)
        if tree is None:
            raise InvalidDocument.at("", "unknown-reference", library.absent("substructure or tree", given))
        return pinned_tree({"tree": read_json(tree.spec.encode()), "nodes": nodes}, library, is_stored=True)
    if "instances" in given:
        return pinned_tree({"tree": given, "nodes": nodes}, library)
    return resolve_definition({"definition": given, "nodes": nodes}, library)


def _run(item: ItemDocument, blobs: Blobs, progress: ItemProgress) -> Outcome:
    """The summary is the answer of ``POST /v1/equivalences``. Raises InvalidInput, TooLarge."""
    read = []
    for name in SIDES:
        with inside(f"/{name}"):
            read.append(_decoded(item[name], blobs))
        progress(0.2 * len(read))
    a, b = sides(*read)
    told = equivalence(a, b, item["coordinates"]).plain()
    return Outcome({"a": _name(item["a"]), "b": _name(item["b"]), **told})


def _decoded(pinned: ItemDocument, blobs: Blobs) -> Part | Parts:
    if "substructure" in pinned:
        return part_of(pinned["substructure"].partition("@")[2], pinned["program"], blobs)
    if "tree" in pinned:
        return tree_parts(pinned, blobs)
    return derive(Definition.read(pinned["definition"]), pinned["nodes"], admitted(pinned))


def _name(pinned: ItemDocument) -> str:
    """What is compared, by its name."""
    if "substructure" in pinned:
        return str(pinned["substructure"]).partition("@")[0]
    return str(pinned["tree" if "tree" in pinned else "definition"]["name"])


KINDS = {"compare": Kind(_spread, _resolve, _run)}
