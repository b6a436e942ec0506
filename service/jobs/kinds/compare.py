"""compare: an item is ``{"a", "b", "coordinates"}``; whether both are the same model, and what makes them different.

Each is what ``POST /v1/equivalences`` takes: a reference, a definition, a tree, or ``{"file": text, "kind": ...}``.
``b`` may be a list, one against many, each an item of its own, or ``*`` for all versions of the catalogue.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.jobs.engine import Outcome
from service.jobs.kinds.assemble import pinned_tree, tree_parts
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.derive import DERIVE
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, admitted, check_fields, inside
from service.jobs.kinds.library import Library
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.sides import Parts, sides
from substructures.part.definition import Definition
from substructures.part.part import Part, derive

ALL, SIDES = "*", ("a", "b")


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    check_fields(item, ("a", "b"), ("coordinates",))
    coordinates = item.get("coordinates", {})
    if not isinstance(coordinates, dict) or not all(isinstance(name, str) for name in coordinates.values()):
        raise InvalidDocument.at("/coordinates", "object-expected", "names in a to names in b are needed")
    many = list(library.catalogue()) if item["b"] == ALL else item["b"]
    found: list[ItemDocument] = []
    with inside("/a"):
        a = _read(item["a"], library)
    for k, b in enumerate(many if isinstance(many, list) else [many]):
        with inside(f"/b/{k}" if isinstance(item["b"], list) else "/b"):
            found.append({"a": a, "b": _read(b, library), "coordinates": coordinates, "nodes": limits.job_nodes})
    if not found:
        raise InvalidDocument.at("/b", "empty", "a list of at least one model is needed")
    return found


def _read(given: Any, library: Library) -> Any:
    """A reference or a document; a file as what is read of it. Raises InvalidDocument."""
    if isinstance(given, str):
        return given
    if not isinstance(given, Mapping):
        raise InvalidDocument.at("", "object-expected", "a reference, a definition, a tree or a file is needed")
    return library.file(given) if "file" in given else given


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
    return DERIVE.resolve({"definition": given, "nodes": nodes}, library)


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


COMPARE = Kind(_spread, _resolve, _run)
