"""Build trees out of stored parts: create, couple, remove; every change is a new immutable revision."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.content.integrity import digest_of, missing
from service.content.tree_content import TreeContent
from service.database.connections import Connection
from service.jobs.kinds.assemble import NAMED, pinned_spec
from service.jobs.kinds.shapes import KNOWN, SHARE
from service.jobs.worker import Worker
from service.messages.references import Reference, is_pinned, parse_reference
from service.messages.refusals import Refused, StaleError, moved, not_found, unprocessable
from service.messages.viewer import Viewer
from service.operations import catalogue, owners
from service.operations.library import StoreLibrary
from service.operations.preconditions import ANY, Expected, latest_as, require_match, tree_tag, withdrawn
from service.queries import audit, content, trees
from service.queries.common import now
from service.queries.owners import private_parts
from service.schemas.entries import PLAIN, Entry
from service.store.store import Store
from substructures.documents import read_json
from substructures.documents.tables import with_points
from substructures.errors import InvalidDocument, among
from substructures.part.parameters import counted
from substructures.tree.document import TreeSpec

#: contents that are kept for the next tree of the same parts: so many, of at most so many bytes
LATEST, SHORT = 8, 100_000


@dataclass(frozen=True, slots=True)
class Revision:
    """A coupled tree ready to be stored; ``base``: the number of the revision that it changes, 0 where there must be
    none, ``is_exact``: named by number."""

    coupled: TreeContent
    base: int | None = None
    is_exact: bool = False
    entry: Entry = PLAIN


@dataclass(frozen=True, slots=True)
class TreeChange:
    """What a tree shall become; ``is_exact``: ``base`` was named by number; ``step``: where the request's body is."""

    document: dict[str, Any]
    base: trees.Tree
    is_exact: bool
    step: str


def prepare(
    store: Store,
    viewer: Viewer,
    worker: Worker,
    data: Any,
    entry: Entry,
    named: bool = False,
    expected: Expected = ANY,
) -> Revision:
    """Resolve, pin and couple a tree; ``named``: parts that it brings along are called by name, too, for they are
    stored before it. Raises InvalidDocument, TooLarge, TimeoutError, Refused 403, 409 or 412.
    """
    spec = TreeSpec.read(data)
    base = latest_as(store, viewer, spec.name, expected)
    return Revision(_coupled(store, viewer, worker, spec, entry, {NAMED: True} if named else {}), base, entry=entry)


def coupling(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """One more instance on an existing tree. Raises Refused 403, 404 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    instances = spec.get("instances", [])
    grown = {**spec, "instances": [*instances, data]}
    return TreeChange(grown, base, is_pinned(text), f"/instances/{len(instances)}")


def removal(store: Store, viewer: Viewer, text: str, instance: str, if_match: str | None = None) -> TreeChange:
    """One instance less, which must not carry another. Raises Refused 403, 404, 409 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    instances, _ = _found(spec, text, ("instance", "instances", instance))
    carried = [each["name"] for each in instances if each.get("at", "").partition(".")[0] == instance]
    if carried:
        raise Refused(409, "instance-in-use", f"'{instance}' carries {', '.join(carried)}; remove these first")
    kept = [each for each in instances if each["name"] != instance]
    return TreeChange({**spec, "instances": kept}, base, is_pinned(text), "")


def replacement(
    store: Store, viewer: Viewer, text: str, instance: str, data: Any, if_match: str | None = None
) -> TreeChange:
    """One instance with other members: those of ``data`` take the place of its own, null leaves one out, and a part
    that is named takes that of a definition, or the other way round. Raises Refused 403, 404, 412 or 422.
    """
    base, spec = _existing(store, viewer, text, if_match)
    instances, k = _found(spec, text, ("instance", "instances", instance))
    if not isinstance(data, Mapping):
        raise unprocessable("invalid-document", "send an object with the members that change", "")
    if data.get("name", instance) != instance:
        raise unprocessable("name-stays", f"what hangs on '{instance}' knows it by this name, which stays", "/name")
    left = {"substructure", "definition"} if {"substructure", "definition"} & data.keys() else set()
    merged = {**{name: value for name, value in instances[k].items() if name not in left}, **data}
    made = {name: value for name, value in merged.items() if value is not None}
    document = {**spec, "instances": [*instances[:k], made, *instances[k + 1 :]]}
    return TreeChange(document, base, is_pinned(text), f"/instances/{k}")


def _found(spec: Mapping[str, Any], text: str, which: tuple[str, str, str]) -> tuple[list[dict[str, Any]], int]:
    """All of a kind in a tree, and the number of one among them. Raises Refused 404."""
    kind, members, name = which
    listed = spec.get(members, [])
    known = [each["name"] for each in listed]
    if name not in known:
        raise not_found(f"the tree '{text}' has no {kind} '{name}'{among(name, known)}", f"unknown-{kind}")
    return listed, known.index(name)


def amendment(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """Other members of the tree itself; null leaves one out. Raises Refused 403, 404 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    document = {name: value for name, value in {**spec, **data}.items() if value is not None}
    return TreeChange(document, base, is_pinned(text), "")


def load(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """One load more between frames of an existing tree, its ``tables`` beside it. Raises Refused 404 or 412, and
    InvalidDocument for tables.
    """
    base, spec = _existing(store, viewer, text, if_match)
    loads = spec.get("loads", [])
    return TreeChange({**spec, "loads": [*loads, with_points(data)]}, base, is_pinned(text), f"/loads/{len(loads)}")


def unload(store: Store, viewer: Viewer, text: str, name: str, if_match: str | None = None) -> TreeChange:
    """One load of the tree less. Raises Refused 404 or 412."""
    return _one_less(store, viewer, text, ("load", "loads", name), if_match)


def closure(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """One loop more in an existing tree. Raises Refused 404 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    closures = spec.get("closures", [])
    return TreeChange({**spec, "closures": [*closures, data]}, base, is_pinned(text), f"/closures/{len(closures)}")


def opening(store: Store, viewer: Viewer, text: str, name: str, if_match: str | None = None) -> TreeChange:
    """One closure of the tree less. Raises Refused 404 or 412."""
    return _one_less(store, viewer, text, ("closure", "closures", name), if_match)


def _one_less(store: Store, viewer: Viewer, text: str, which: tuple[str, str, str], if_match: str | None) -> TreeChange:
    """Without what has the name in a list of the tree."""
    base, spec = _existing(store, viewer, text, if_match)
    listed, k = _found(spec, text, which)
    kept, members = [*listed[:k], *listed[k + 1 :]], which[1]
    changed = {key: value for key, value in spec.items() if key != members} | ({members: kept} if kept else {})
    return TreeChange(changed, base, is_pinned(text), "")


def prepare_change(store: Store, viewer: Viewer, worker: Worker, change: TreeChange) -> Revision:
    """Couple a changed tree. Raises InvalidDocument, TooLarge, TimeoutError."""
    with moved(lambda pointer: pointer.removeprefix(change.step)):  # as seen from the instance document alone
        coupled = _coupled(store, viewer, worker, TreeSpec.read(change.document), PLAIN, {})
    return Revision(coupled, change.base.revision, change.is_exact)


def _existing(store: Store, viewer: Viewer, text: str, if_match: str | None) -> tuple[trees.Tree, dict[str, Any]]:
    with store.database.read() as connection:
        base = find(connection, viewer, text)
        tag = tree_tag(base, withdrawn(connection, viewer, base)) if if_match else ""
    owners.require(viewer, base.owner, base.name, "changes it; couple what you need to a tree of your own")
    if if_match is not None:
        require_match(f"the tree '{text}'", tag, if_match)
    return base, _current(base)


def _current(tree: trees.Tree) -> dict[str, Any]:
    """The document of a stored tree as one of today: units that did not count when it was stored become words, gravity
    that was given as zero stays given, and an instance with all coordinates of its loops keeps them.
    """
    spec: dict[str, Any] = counted(read_json(tree.spec.encode()))
    for instance in spec.get("instances", ()):
        if "definition" in instance:
            instance["definition"] = counted(instance["definition"])
    summary = read_json(tree.summary.encode())
    closed = {each["name"].rpartition(".")[0] for each in summary.get("closures", ())}
    for instance in spec.get("instances", ()):
        if instance["name"] in closed:
            instance.setdefault("level", "full")
    warnings = summary["certificate"].get("warnings")
    if warnings is not None and all(warning["code"] != "gravity-not-given" for warning in warnings):
        spec.setdefault("gravity", [0, 0, 0])
    return spec


def _coupled(
    store: Store, viewer: Viewer, worker: Worker, spec: TreeSpec, entry: Entry, members: Mapping[str, Any]
) -> TreeContent:
    """What is stored of a tree; ``members``: of the item of the work."""
    with store.database.read() as connection:
        whose = owners.wanted(connection, viewer, "tree", spec.name, entry)
        library = StoreLibrary(connection, viewer, blobs=store.caches.blobs)
        is_checked = all(each.definition is None for each in spec.instances)
        item, blobs = pinned_spec(spec, store.work_limits, library, is_checked=is_checked)
        pinned = zip(spec.instances, item["tree"].get("instances", ()), strict=True)
        digests = {
            each.name: each.definition.digest if each.definition else given["substructure"].partition("@")[2]
            for each, given in pinned
        }
        hidden = private_parts(connection, digests.values())
        faults = list(owners.private_parts(whose, item["tree"].get("instances", ()), digests, hidden))
    if faults:
        raise InvalidDocument(faults)
    shared = store.caches.shared.once((viewer.owner, *item["programs"].values()), dict)
    known = dict(shared)
    given = {**item, **store.work_limits, **members, SHARE: f"owner {viewer.owner}", KNOWN: list(known)}
    outcome = worker("assemble", given, store.blobs(blobs))
    coupled = TreeContent.of_files(outcome.summary, outcome.files, known)
    for digest, data in coupled.shared.items():
        if len(data) <= SHORT:
            shared[digest] = data
    for digest in list(shared)[:-LATEST]:
        shared.pop(digest, None)
    return coupled


def commit(connection: Connection, viewer: Viewer, revision: Revision) -> tuple[trees.Tree, bool]:
    """Store a revision; as :func:`store`."""
    return store(connection, viewer, revision.coupled, revision.entry, revision.base, revision.is_exact)


def store(
    connection: Connection,
    viewer: Viewer,
    coupled: TreeContent,
    entry: Entry,
    base: int | None = None,
    is_exact: bool = False,
) -> tuple[trees.Tree, bool]:
    """Store a coupled tree; the tree, and whether it is new (neither the latest created again nor ``base`` unchanged).

    Raises StaleError when the latest revision is no longer ``base``, the one that was changed (0: there is one), unless
    that was pinned;
    Refused 403, 409 where the name is another's, or others would see private parts.
    """
    name, digest = coupled.name, digest_of(coupled.spec)
    whose = owners.claimed(connection, viewer, "tree", name, entry)
    owners.require_public_parts(connection, whose, coupled.parts.values())
    latest = trees.latest_revision(connection, name)
    like = base or latest
    there = trees.digest_of(connection, name, like)
    is_other = base is not None and ((not is_exact and latest != base) or there is None)
    if there is not None if base == 0 else is_other:
        raise StaleError(f"'{name}' was changed or removed meanwhile")
    current = trees.resolve(connection, viewer, Reference(name, like)) if there == digest else None
    if current is not None:
        return current, False
    for part in coupled.inline:
        catalogue.store_part(connection, part)
    if coupled.program is not None:
        content.put_program(connection, coupled.program_digest, coupled.program, coupled.nodes)
    elif not content.has_program(connection, coupled.program_digest):
        raise missing("a program", coupled.program_digest)
    spec = coupled.spec.decode()
    figures = {name: getattr(coupled, name) for name in ("dof", "joints", "mass", "software")}
    whom = {"author": viewer.key, "owner": whose.owner, "visibility": whose.visibility, "note": entry.note or ""}
    more: dict[str, Any] = {"created": now(), "based_on": base or None, **figures, **whom, **coupled.summary.columns()}
    tree = trees.Tree(name, latest + 1, digest, spec, coupled.program_digest, **more)
    trees.add_revision(connection, tree, coupled.parts)
    audit.note(connection, viewer, "tree.store", f"{name}@{tree.revision}", digest=digest, based_on=base or None)
    return tree, True


def remove(connection: Connection, viewer: Viewer, name: str, if_match: str | None = None) -> None:
    """Remove a tree with all its revisions; its parts stay, and what was published of it.

    Raises Refused 404 where the viewer sees none, 403 where it is another's, 412 where it is not of ``if_match``.
    """
    tree = find(connection, viewer, name)
    if tree.name != name:
        raise Refused(422, "bare-name-expected", f"a tree is removed as a whole: '{tree.name}', not '{name[:160]}'")
    owners.require(viewer, tree.owner, name, "removes it")
    if if_match is not None:
        require_match(f"the tree '{name}'", tree_tag(tree, withdrawn(connection, viewer, tree)), if_match)
    trees.remove(connection, name)
    audit.note(connection, viewer, "tree.remove", name, revisions=tree.revision)


def find(connection: Connection, viewer: Viewer, text: str) -> trees.Tree:
    """The revision that a reference means. Raises Refused 404 for what the viewer does not see."""
    ref = parse_reference(text)
    tree = None if ref is None else trees.resolve(connection, viewer, ref)
    if tree is None:
        raise not_found(owners.absent_tree(connection, viewer, text), "unknown-tree")
    return tree
