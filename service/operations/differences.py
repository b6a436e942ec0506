"""How versions of parts, or revisions of trees, differ."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from service.database.connections import Connection
from service.operations import catalogue, trees
from service.operations.sources import tree_parts
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.refusals import Refused, unprocessable
from service.store import Store
from service.viewer import Viewer
from substructures.errors import TooLarge
from substructures.interchange.difference.difference import Difference, of_parts, of_trees

MOST_SINGLE = 5000  # operations of a part, as expected, up to which each change is also looked at by itself


def versions(store: Store, viewer: Viewer, a: str, b: str) -> tuple[Version, Version]:
    """The versions of two references. Raises Refused 404, 422 for the second one."""
    with store.database.read() as connection:
        first = catalogue.find(connection, viewer, a)
        return first, _second(lambda: catalogue.find(connection, viewer, b))


def revisions(store: Store, viewer: Viewer, a: str, b: str) -> tuple[Tree, Tree]:
    """The revisions of two references. Raises as :func:`versions`."""
    with store.database.read() as connection:
        first = trees.find(connection, viewer, a)
        return first, _second(lambda: trees.find(connection, viewer, b))


def _second(find: Callable[[], Any]) -> Any:
    try:
        return find()
    except Refused as error:
        raise (unprocessable(error.code, error.detail, "/query/to") if error.status == 404 else error) from None


def of_versions(store: Store, a: Version, b: Version) -> Difference:
    """The difference of two versions."""
    with store.database.read() as connection:
        parts = [store.required_part(connection, version.digest) for version in (a, b)]

    def admit(operations: int) -> None:
        """Changes of large parts are told together."""
        if operations > MOST_SINGLE:
            raise TooLarge("a part of which every change is looked at alone", operations, MOST_SINGLE)

    return of_parts(parts[0], parts[1], admit)


def of_revisions(store: Store, viewer: Viewer, a: Tree, b: Tree) -> Difference:
    """The difference of two revisions, whose parts are called by their versions where the viewer sees these."""
    (first, ours), (second, theirs) = (tree_parts(store, tree) for tree in (a, b))
    with store.database.read() as connection:
        models = [store.model(connection, tree) for tree in (a, b)]
        references = {x.substructure for spec in (first, second) for x in spec.instances if x.substructure is not None}
        called = {each: _called(connection, viewer, each) for each in references}
    common = [
        (name, part, theirs[name])
        for name, part in ours.items()
        if name in theirs and part.definition.digest != theirs[name].definition.digest
    ]
    return of_trees((first, models[0]), (second, models[1]), common, lambda given: called.get(given, given))


def _called(connection: Connection, viewer: Viewer, reference: str) -> str:
    """The version that a reference with a digest means, or the reference where the viewer does not see it."""
    try:
        version = catalogue.find(connection, viewer, reference)
    except Refused as error:
        if error.status != 404:
            raise
        return reference
    return f"{version.name}@{version.version}"
