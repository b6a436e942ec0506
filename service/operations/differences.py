"""How versions of parts, or revisions of trees, differ; the levels of a part, and how wrong the shorter ones are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from service.database.connections import Connection
from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.refusals import Refused, unprocessable
from service.messages.viewer import Viewer
from service.operations import catalogue, trees
from service.operations.sharing.sources import pinned_tree
from service.queries import uses
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


@dataclass(frozen=True, slots=True)
class Level:
    """Another level of a part: ``shorter`` was made from ``full``, and one of both is ``version``. ``error``: of
    quantities that are not the same in both the largest change of an entry, relative to its largest number at random
    states, and ``rms`` that of the root mean square over the states; 1 where an entry is there in one alone, None where
    there are no numbers. None where it was not to be computed.
    """

    version: Version
    level: Literal["full", "reduced", "abbreviated"]
    full: Version
    shorter: Version
    error: Mapping[str, float | None] | None
    rms: Mapping[str, float | None] | None


#: levels that are looked for
MOST_LEVELS = 20


def levels(
    store: Store, viewer: Viewer, worker: Worker, ref: str, most: int | None = None
) -> tuple[Version, list[Level]]:
    """The version that a reference means, and its other levels: what it is one of, then what was made from it.

    ``most``: operations of parts whose errors are computed, by default of all. Raises Refused 404.
    """
    with store.database.read() as connection:
        chosen = catalogue.find(connection, viewer, ref)
        fuller = [] if chosen.derived_from is None else [catalogue.find(connection, viewer, chosen.derived_from)]
        used = uses.page(connection, viewer, chosen.name, chosen.version, None, MOST_LEVELS)
        made = [f"{each.name}@{each.number}" for each in used if each.kind == "derived"]
        pairs = [(full, chosen) for full in fuller]
        pairs += [(chosen, catalogue.find(connection, viewer, each)) for each in made]
    found = []
    for full, shorter in pairs:
        level = _level(full, shorter)
        if level is not None:
            error = rms = None
            if most is None or _total(full) <= most:
                quantities = of_versions(store, worker, full, shorter)["quantities"]
                error, rms = (_errors(quantities, level == "abbreviated", name) for name in ("change", "rms"))
            is_shorter = shorter is chosen
            other = full if is_shorter else shorter
            found.append(Level(other, "full" if is_shorter else level, full, shorter, error, rms))
    return chosen, found


def _level(full: Version, shorter: Version) -> Literal["reduced", "abbreviated"] | None:
    """What a version is to the one that it was made from: reduced to fewer coordinates, abbreviated to fewer
    operations in the same ones; None for what is no shorter, such as a correction, and for what is withdrawn.
    """
    if shorter.withdrawn_at is not None:
        return None
    if shorter.dof < full.dof:
        return "reduced"
    return "abbreviated" if shorter.coordinates == full.coordinates and _total(shorter) < _total(full) else None


def _total(version: Version) -> int:
    """The operations of all its formulas."""
    return int(read_json(version.operations.encode())["total"])


def _errors(quantities: Mapping[str, Any], has_all: bool, which: str) -> dict[str, float | None]:
    """By quantity; ``has_all``: both have the same coordinates, and so each of them all entries; ``which``: ``change``
    (the largest) or ``rms``.
    """
    errors: dict[str, float | None] = {}
    for name, each in quantities.items():
        if has_all and each["new"] + each["gone"]:
            errors[name] = max(1.0, float(each[which] or 0))
        elif each["changed"] or each["moved"]:
            errors[name] = None if each[which] is None else float(each[which])
    return errors


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
