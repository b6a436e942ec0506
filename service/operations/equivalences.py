"""Two models out of references, documents or robot files, compared."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from service.operations import trees
from service.operations.owners import absent_either
from service.operations.sources import tree_parts
from service.queries import catalogue
from service.queries import trees as stored_trees
from service.references import parse_reference
from service.store import Store
from service.viewer import Viewer
from substructures.errors import InvalidDocument, InvalidInput
from substructures.interchange.equivalence import Equivalence, equivalence
from substructures.interchange.importing import document_of
from substructures.interchange.sides import Parts, sides
from substructures.part.definition import Definition
from substructures.part.part import Part, derive
from substructures.tree.document import TreeSpec


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
    ours, theirs = sides(*found)
    return equivalence(ours, theirs, coordinates)


def _read(store: Store, viewer: Viewer, given: Any) -> Part | Parts:
    if isinstance(given, str):
        return _stored(store, viewer, given)
    if not isinstance(given, Mapping):
        raise InvalidDocument.at("", "object-expected", "a reference, a definition, a tree or a file is needed")
    given = document_of(given)
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
            raise InvalidDocument.at("", "unknown-reference", absent_either(connection, viewer, reference))
    return tree_parts(store, tree)
