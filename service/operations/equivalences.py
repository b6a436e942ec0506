"""Two models out of references, documents or robot files, compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.operations import trees
from service.operations.sources import tree_parts
from service.queries import catalogue
from service.queries import trees as stored_trees
from service.references import parse_reference
from service.store import Store
from service.viewer import Viewer
from substructures.errors import InvalidDocument, InvalidInput
from substructures.interchange.equivalence import Equivalence, equivalence
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side
from substructures.part.definition import Definition
from substructures.part.part import Part, derive
from substructures.tree.document import TreeSpec

#: a tree and the parts of its instances
Parts = tuple[TreeSpec, Mapping[str, Part]]


def compared(store: Store, viewer: Viewer, a: Any, b: Any, coordinates: Mapping[str, str]) -> Equivalence:
    """Whether two models are the same; each a reference, a definition, a tree, or ``{"file": text}``.

    A part that is compared with a tree gets its gravity; references are to what the viewer sees.
    Raises InvalidDocument, TooLarge, LongWork.
    """
    found: list[Part | Parts] = []
    for name, given in (("a", a), ("b", b)):
        try:
            found.append(_read(store, viewer, given))
        except InvalidInput as error:
            raise error.below(f"/{name}") from None
    like = next((x[0] for x in found if not isinstance(x, Part)), None)
    sides = [Side.of_part(x, like) if isinstance(x, Part) else Side.of_tree(*x) for x in found]
    return equivalence(sides[0], sides[1], coordinates)


def _read(store: Store, viewer: Viewer, given: Any) -> Part | Parts:
    if isinstance(given, str):
        return _stored(store, viewer, given)
    if not isinstance(given, Mapping):
        raise InvalidDocument.at("", "object-expected", "a reference, a definition, a tree or a file is needed")
    if "file" in given:
        if set(given) - {"file", "kind"} or not isinstance(given["file"], str):
            raise InvalidDocument.at("/file", "file-expected", "a file is its text, and perhaps its kind")
        read = import_file(given["file"].encode("utf-8", "replace"), kind=given.get("kind"))
        given = read.definition if read.tree is None else read.tree
    if "instances" in given:
        spec = TreeSpec.read(given)
        with store.database.read() as connection:
            return spec, trees.parts_of(store, connection, viewer, spec)
    # derived also where it is stored: what is private to others takes its time as what is not there
    return derive(Definition.read(given), store.settings.limits.program_nodes, store.admit)


def _stored(store: Store, viewer: Viewer, reference: str) -> Part | Parts:
    """The part of this name, or else the tree."""
    ref = parse_reference(reference)
    with store.database.read() as connection:
        version = None if ref is None else catalogue.resolve(connection, viewer, ref)
        if version is not None:
            return store.required_part(connection, version.digest)
        tree = None if ref is None else stored_trees.resolve(connection, viewer, ref)
    if tree is None:
        message = f"there is no substructure or tree '{reference[:80]}'"
        raise InvalidDocument.at("", "unknown-reference", message)
    return tree_parts(store, tree)
