"""Build trees out of stored parts: create, couple, remove; every change is a new immutable revision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from service.answers import etag
from service.database.connections import Connection
from service.database.packed import pack
from service.integrity import digest_of
from service.operations import catalogue, owners
from service.queries import audit, content, trees, uses
from service.queries import catalogue as versions
from service.queries.common import now
from service.queries.owners import private_parts
from service.queries.uses import Withdrawn
from service.references import Reference, is_pinned, parse_reference
from service.refusals import Refused, StaleError, not_found
from service.schemas.entries import PLAIN, Entry
from service.store import Store
from service.summaries import PartContent, part_content, tree_summary
from service.viewer import Viewer
from substructures.documents import read_json
from substructures.documents.tables import with_points
from substructures.errors import InvalidDocument, InvalidInput, among
from substructures.part.parameters import counted
from substructures.part.part import Part, derive
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.model import Model, couple
from substructures.tree.plausibility import Plausibility


@dataclass(frozen=True, slots=True)
class Revision:
    """A coupled tree ready to be stored; ``base`` is what it changes, ``is_exact``: named by number."""

    spec: TreeSpec
    model: Model
    parts: Mapping[str, Part]
    base: trees.Tree | None = None
    is_exact: bool = False
    entry: Entry = PLAIN


@dataclass(frozen=True, slots=True)
class TreeContent:
    """What is stored of a coupled tree: canonical document, packed program with its digest and length, degrees of
    freedom, joints, mass in kg if it is known, the summary as JSON.

    ``parts``: the digest of the part that every instance is; ``inline``: those that the tree brings along;
    ``software``: that coupled it, empty for that of this process.
    """

    name: str
    spec: bytes
    program: bytes
    program_digest: str
    nodes: int
    dof: int
    joints: str
    mass: float | None
    summary: bytes
    parts: Mapping[str, str]
    inline: Sequence[PartContent] = ()
    software: str = ""


@dataclass(frozen=True, slots=True)
class TreeChange:
    """What a tree shall become; ``is_exact``: ``base`` was named by number; ``step``: where the request's body is."""

    document: dict[str, Any]
    base: trees.Tree
    is_exact: bool
    step: str


def prepare(store: Store, viewer: Viewer, data: Any, entry: Entry, named: bool = False) -> Revision:
    """Resolve, pin and couple a tree; ``named``: parts that it brings along are called by name, too, for they are
    stored before it. Raises InvalidDocument, TooLarge, LongWork, Refused 403 or 409.
    """
    return _coupled(store, viewer, TreeSpec.read(data), entry, named=named)


def coupling(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """One more instance on an existing tree. Raises Refused 403, 404 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    instances = spec.get("instances", [])
    grown = {**spec, "instances": [*instances, data]}
    return TreeChange(grown, base, is_pinned(text), f"/instances/{len(instances)}")


def removal(store: Store, viewer: Viewer, text: str, instance: str, if_match: str | None = None) -> TreeChange:
    """One instance less, which must not carry another. Raises Refused 403, 404, 409 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    instances = spec.get("instances", [])
    known = [each["name"] for each in instances]
    if instance not in known:
        raise not_found(f"the tree '{text}' has no instance '{instance}'{among(instance, known)}", "unknown-instance")
    carried = [each["name"] for each in instances if each.get("at", "").partition(".")[0] == instance]
    if carried:
        raise Refused(409, "instance-in-use", f"'{instance}' carries {', '.join(carried)}; remove these first")
    kept = [each for each in instances if each["name"] != instance]
    return TreeChange({**spec, "instances": kept}, base, is_pinned(text), "")


def load(store: Store, viewer: Viewer, text: str, data: Any, if_match: str | None = None) -> TreeChange:
    """One load more between frames of an existing tree, its ``tables`` beside it. Raises Refused 404 or 412, and
    InvalidDocument for tables.
    """
    base, spec = _existing(store, viewer, text, if_match)
    loads = spec.get("loads", [])
    return TreeChange({**spec, "loads": [*loads, with_points(data)]}, base, is_pinned(text), f"/loads/{len(loads)}")


def unload(store: Store, viewer: Viewer, text: str, name: str, if_match: str | None = None) -> TreeChange:
    """One load of the tree less. Raises Refused 404 or 412."""
    base, spec = _existing(store, viewer, text, if_match)
    loads = spec.get("loads", [])
    kept = [each for each in loads if each["name"] != name]
    if len(kept) == len(loads):
        known = [each["name"] for each in loads]
        raise not_found(f"the tree '{text}' has no load '{name}'{among(name, known)}", "unknown-load")
    changed = {key: value for key, value in spec.items() if key != "loads"} | ({"loads": kept} if kept else {})
    return TreeChange(changed, base, is_pinned(text), "")


def prepare_change(store: Store, viewer: Viewer, change: TreeChange) -> Revision:
    """Couple a changed tree. Raises InvalidDocument, TooLarge, LongWork."""
    try:
        return _coupled(store, viewer, TreeSpec.read(change.document), PLAIN, change.base, change.is_exact)
    except InvalidInput as error:  # as seen from the instance document alone
        raise error.moved(lambda pointer: pointer.removeprefix(change.step)) from None


def tree_tag(tree: trees.Tree, withdrawn: Sequence[Withdrawn] = ()) -> str:
    """The ETag of a tree; ``withdrawn``: those of its instances whose parts are withdrawn."""
    gone = [f"{each.instance}:{each.successor}" for each in withdrawn]
    return etag(tree.digest, tree.program, str(tree.revision), *([] if tree.is_public else [tree.visibility]), *gone)


def withdrawn(connection: Connection, viewer: Viewer, tree: trees.Tree) -> Sequence[Withdrawn]:
    """The instances of a tree whose parts are withdrawn, with reason and successor."""
    return uses.withdrawn(connection, viewer, tree.name, tree.revision)


def _existing(store: Store, viewer: Viewer, text: str, if_match: str | None) -> tuple[trees.Tree, dict[str, Any]]:
    with store.database.read() as connection:
        base = find(connection, viewer, text)
        tag = tree_tag(base, withdrawn(connection, viewer, base)) if if_match else ""
    owners.require(viewer, base.owner, base.name, "changes it; couple what you need to a tree of your own")
    if if_match not in (None, "*", tag):
        detail = f"the tree '{text}' is not what If-Match says; it is {tag} now"
        raise Refused(412, "precondition-failed", detail, headers={"ETag": tag})
    return base, _current(base)


def _current(tree: trees.Tree) -> dict[str, Any]:
    """The document of a stored tree as one of today: units that did not count when it was stored become words, and
    gravity that was given as zero stays given.
    """
    spec: dict[str, Any] = counted(read_json(tree.spec.encode()))
    for instance in spec.get("instances", ()):
        if "definition" in instance:
            instance["definition"] = counted(instance["definition"])
    warnings = read_json(tree.summary.encode())["certificate"].get("warnings")
    if warnings is not None and all(warning["code"] != "gravity-not-given" for warning in warnings):
        spec.setdefault("gravity", [0, 0, 0])
    return spec


def _coupled(
    store: Store,
    viewer: Viewer,
    spec: TreeSpec,
    entry: Entry,
    base: trees.Tree | None = None,
    is_exact: bool = False,
    named: bool = False,
) -> Revision:
    with store.database.read() as connection:
        whose = owners.wanted(connection, viewer, "tree", spec.name, entry)
        parts = parts_of(store, connection, viewer, spec)
        digests = {name: part.definition.digest for name, part in parts.items()}
        faults = list(owners.private_parts(connection, whose, list(map(_shown, spec.instances)), digests))
    if faults:
        raise InvalidDocument(faults)
    pinned = tuple(_pin(instance, parts[instance.name], named) for instance in spec.instances)
    spec = spec.model_copy(update={"instances": pinned})
    model = couple(spec, parts, store.settings.limits.program_nodes, store.admit)
    store.remember_model(spec.digest, model)
    store.kernels.prepare(parts.values())
    return Revision(spec, model, parts, base, is_exact, entry)


def _shown(instance: Instance) -> dict[str, Any]:
    return {"name": instance.name, "substructure": instance.substructure}


def parts_of(store: Store, connection: Connection, viewer: Viewer, spec: TreeSpec) -> dict[str, Part]:
    """The part that every instance is; an inline definition that is not stored is derived. Raises InvalidDocument."""
    found = [_part(store, connection, viewer, index, instance) for index, instance in enumerate(spec.instances)]
    return {instance.name: part for instance, part in zip(spec.instances, found, strict=True)}


def _part(store: Store, connection: Connection, viewer: Viewer, index: int, instance: Instance) -> Part:
    if instance.definition is not None:
        digest = instance.definition.digest
        hidden = [owner for _, owner in private_parts(connection, [digest]).values() if not viewer.may_change(owner)]
        # what is private takes its time as what is not there
        return (None if hidden else store.part(connection, digest, is_newest=True)) or _derived(store, index, instance)
    pointer = f"/instances/{index}/substructure"
    ref = parse_reference(instance.substructure or "")
    version = versions.resolve(connection, viewer, ref) if ref is not None else None
    if version is None:
        why = owners.absent_part(connection, viewer, instance.substructure or "")
        message = f"instance '{instance.name}': {why}"
        raise InvalidDocument.at(pointer, "unknown-substructure", message)
    return store.required_part(connection, version.digest, is_newest=True)


def _derived(store: Store, index: int, instance: Instance) -> Part:
    if instance.definition is None:
        raise ValueError("only an inline definition can be derived")
    step = f"/instances/{index}/definition"
    try:
        part = derive(instance.definition, store.settings.limits.program_nodes, store.admit)
    except InvalidInput as error:
        raise error.below(step) from None
    store.remember_part(part)
    return part


def _pin(instance: Instance, part: Part, named: bool) -> Instance:
    if instance.definition is not None and not named:
        return instance
    reference = f"{part.definition.name}@{part.definition.digest}"
    return instance.model_copy(update={"definition": None, "substructure": reference})


def commit(connection: Connection, viewer: Viewer, revision: Revision) -> tuple[trees.Tree, bool]:
    """Store a revision; as :func:`store`."""
    spec, model = revision.spec, revision.model
    inline = [part_content(revision.parts[each.name]) for each in spec.instances if each.definition is not None]
    digests = {name: part.definition.digest for name, part in revision.parts.items()}
    program, summary = model.program, tree_summary(spec, model)
    mass = Plausibility(spec, {name: part.definition for name, part in revision.parts.items()}).mass
    figures = program.digest, len(program), model.dof, model.joints, mass
    coupled = TreeContent(spec.name, spec.canonical(), pack(program), *figures, summary, digests, inline)
    number = revision.base.revision if revision.base else None
    return store(connection, viewer, coupled, revision.entry, number, revision.is_exact)


def store(
    connection: Connection,
    viewer: Viewer,
    coupled: TreeContent,
    entry: Entry,
    base: int | None = None,
    is_exact: bool = False,
) -> tuple[trees.Tree, bool]:
    """Store a coupled tree; the tree, and whether it is new (creating the same tree again is not).

    Raises StaleError when the latest revision is no longer ``base``, the one that was changed, unless that was pinned;
    Refused 403, 409 where the name is another's, or others would see private parts.
    """
    name, digest = coupled.name, digest_of(coupled.spec)
    whose = owners.claimed(connection, viewer, "tree", name, entry)
    owners.require_public_parts(connection, whose, coupled.parts.values())
    latest = trees.latest_revision(connection, name)
    if base is None and latest:
        current = trees.resolve(connection, viewer, Reference(name))
        if current is not None and current.digest == digest:
            return current, False
    if base is not None and not is_exact and latest != base:
        raise StaleError(f"'{name}' was changed meanwhile")
    for part in coupled.inline:
        catalogue.store_part(connection, part)
    content.put_program(connection, coupled.program_digest, coupled.program, coupled.nodes)
    texts = coupled.spec.decode(), coupled.program_digest, coupled.dof, coupled.summary.decode()
    whom = viewer.key, whose.owner, whose.visibility, entry.note or ""
    figures = coupled.joints, coupled.mass, coupled.software
    tree = trees.Tree(name, latest + 1, digest, *texts, now(), base, digest_of(coupled.summary), *whom, *figures)
    trees.add_revision(connection, tree, coupled.parts)
    audit.note(connection, viewer, "tree.store", f"{name}@{tree.revision}", digest=digest, based_on=base)
    return tree, True


def remove(connection: Connection, viewer: Viewer, name: str) -> None:
    """Remove a tree with all its revisions; its parts stay, and what was published of it.

    Raises Refused 404 where the viewer sees none, 403 where it is another's.
    """
    tree = find(connection, viewer, name)
    if tree.name != name:
        raise Refused(422, "bare-name-expected", f"a tree is removed as a whole: '{tree.name}', not '{name[:160]}'")
    owners.require(viewer, tree.owner, name, "removes it")
    trees.remove(connection, name)
    audit.note(connection, viewer, "tree.remove", name, revisions=tree.revision)


def find(connection: Connection, viewer: Viewer, text: str) -> trees.Tree:
    """The revision that a reference means. Raises Refused 404 for what the viewer does not see."""
    ref = parse_reference(text)
    tree = None if ref is None else trees.resolve(connection, viewer, ref)
    if tree is None:
        raise not_found(owners.absent_tree(connection, viewer, text), "unknown-tree")
    return tree
