"""How versions of parts, or revisions of trees, differ."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from service.database.connections import Connection
from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.refusals import Refused, unprocessable
from service.messages.viewer import Viewer
from service.operations import catalogue, trees
from service.operations.sharing.sources import pinned_tree
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.store.store import Store
from substructures.documents import read_json, write_json


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


def of_versions(store: Store, worker: Worker, a: Version, b: Version) -> Mapping[str, Any]:
    """The difference of two versions."""
    item = {side: {"definition": each.digest, "program": each.program} for side, each in (("a", a), ("b", b))}
    digests = (a.digest, a.program, b.digest, b.program)
    return _kept(store, digests, lambda: worker("difference", item, store.blobs(digests)).summary)


def of_revisions(store: Store, worker: Worker, viewer: Viewer, a: Tree, b: Tree) -> Mapping[str, Any]:
    """The difference of two revisions, whose parts are called by their versions where the viewer sees these."""
    (first, blobs), (second, others) = (pinned_tree(store, tree) for tree in (a, b))
    digests = (a.digest, a.program, b.digest, b.program)
    instances = [x for item in (first, second) for x in item["spec"].get("instances", ())]
    references = {x["substructure"] for x in instances if "substructure" in x}
    with store.database.read() as connection:
        called = {each: _called(connection, viewer, each) for each in references}
    item = {"a": first, "b": second, "called": called}
    key = (*digests, *sorted(called.items()))
    return _kept(store, key, lambda: worker("difference", item, {**blobs, **others}).summary)


def _kept(store: Store, key: tuple[object, ...], make: Callable[[], Mapping[str, Any]]) -> Mapping[str, Any]:
    """What was made before is kept as bytes."""
    kept = store.caches.printed.once(("difference", *key), lambda: Answer(200, write_json(make()), {}))
    found: Mapping[str, Any] = read_json(kept.body)
    return found


def _called(connection: Connection, viewer: Viewer, reference: str) -> str:
    """The version that a reference with a digest means, or the reference where the viewer does not see it."""
    try:
        version = catalogue.find(connection, viewer, reference)
    except Refused as error:
        if error.status != 404:
            raise
        return reference
    return f"{version.name}@{version.version}"
