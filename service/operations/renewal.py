"""Parts and trees of a store derived anew from their documents, and written over what is stored of them.

It is done for what this server has not derived itself (a store that came from elsewhere, or from before seals), for
what is damaged, and for what another version of the software derived: on request for what is asked for, and in the
background for the rest (:mod:`service.operations.renewing`). Documents never change, nor do their digests.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from service.content.derivation import software
from service.content.improvement import Improvement
from service.content.integrity import checked, digest_of
from service.content.summaries import PartContent
from service.content.tree_summaries import TreeSummary
from service.database.connections import Connection, Database
from service.database.packed import unpack
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.requested import REQUESTED
from service.messages.refusals import Refused
from service.messages.viewer import CONSOLE, OPEN, SCOPES, Viewer
from service.operations.catalogue import mend_part
from service.queries import audit, catalogue, content, seals, trees
from service.queries.trees import Tree
from service.schemas.jobs import ItemDocument
from substructures.documents import read_json
from substructures.part.definition import Definition
from substructures.part.part import MAX_NODES
from substructures.tree.document import TreeSpec

#: who works on a store directly
OPERATOR = Viewer(CONSOLE, OPEN, SCOPES)


@dataclass(frozen=True, slots=True)
class CoupledAnew:
    """A revision as it has to be stored, its packed program of so many operations, digests of its parts by instance."""

    tree: Tree
    packed: bytes
    nodes: int
    parts: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class TreeProgram:
    """What a tree was coupled to anew: packed program with its digest and length, degrees of freedom, summary, and by
    which software.
    """

    program: bytes
    digest: str
    nodes: int
    dof: int
    summary: TreeSummary
    software: str


class Compute(Protocol):
    """Computes a work of :data:`service.jobs.kinds.requested.REQUESTED`, here or elsewhere."""

    def __call__(self, kind: str, item: ItemDocument, blobs: Mapping[str, bytes], /) -> Outcome:
        """What it has made. Raises what the work raises."""


def here(kind: str, item: ItemDocument, blobs: Mapping[str, bytes]) -> Outcome:
    """Compute in this process, for who works on a store directly."""
    return REQUESTED[kind](item, blobs)


def part_anew(connection: Connection, digest: str, max_nodes: int = MAX_NODES, compute: Compute = here) -> PartContent:
    """What has to be stored of a part, derived of its stored definition. Raises ValueError, Refused for a definition
    that is gone or damaged, and as :func:`substructures.part.derive.derive`.
    """
    definition = content.get_definition(connection, digest)
    if definition is None:
        raise ValueError("its definition is gone from the store; submit it again")
    item = {"definition": digest, "recipe": content.get_recipe(connection, digest), "nodes": max_nodes}
    return PartContent.of_files(compute("renew-part", item, {digest: definition}).files)


def tree_anew(
    connection: Connection, name: str, revision: int, max_nodes: int = MAX_NODES, compute: Compute = here
) -> CoupledAnew:
    """A revision coupled of its stored document, and of its parts as they are stored; one that is not as this software
    derives it is derived. Raises as :func:`part_anew`.
    """
    tree, spec = read_tree(connection, name, revision)
    digests = {each: definition.digest for each, definition in stored_definitions(connection, spec).items()}
    blobs, programs = dict[str, bytes](), dict[str, str]()
    for digest in dict.fromkeys(digests.values()):
        definition, program = _newest(connection, digest, max_nodes, compute)
        programs[digest] = digest_of(program)
        blobs |= {digest: definition, programs[digest]: program}
    parts = {each: [digest, programs[digest]] for each, digest in digests.items()}
    item = {"tree": read_json(tree.spec.encode()), "parts": parts, "nodes": max_nodes}
    outcome = compute("renew-tree", item, blobs)
    told, summary = outcome.summary, TreeSummary.of_files(outcome.files)
    made = {each: told[each] for each in ("program", "dof", "joints", "mass")} | summary.columns()
    return CoupledAnew(replace(tree, **made), outcome.files["program"], told["nodes"], digests)


def _newest(connection: Connection, digest: str, max_nodes: int, compute: Compute) -> tuple[bytes, bytes]:
    """Definition and program of a part, as they are stored or derived of what is stored."""
    try:
        stored = content.get_part(connection, digest)
    except Refused:  # damaged
        stored = None
    if stored is not None and stored.is_derived and stored.software == software():
        return stored.definition, stored.program
    found = part_anew(connection, digest, max_nodes, compute)
    return found.row["definition"].encode(), unpack(found.program)


def read_tree(connection: Connection, name: str, revision: int) -> tuple[Tree, TreeSpec]:
    """A revision whose document is sound, whatever else is stored of it. Raises ValueError, Refused."""
    tree = trees.get_damaged(connection, name, revision)
    if tree is None:
        raise ValueError("it is gone from the store")
    checked("its document", tree.digest, tree.spec.encode())
    return tree, TreeSpec.stored(read_json(tree.spec.encode()))


def stored_definitions(connection: Connection, spec: TreeSpec) -> Mapping[str, Definition]:
    """What every instance is. Raises ValueError for what is gone."""
    found = {}
    for instance in spec.instances:
        digest = (instance.substructure or "").partition("@")[2]
        text = None if instance.definition is not None else content.get_definition(connection, digest)
        if text is None and instance.definition is None:
            raise ValueError(f"the definition {digest} of '{instance.name}' is gone from the store")
        found[instance.name] = instance.definition or Definition.stored(read_json(text or b""))
    return found


def renew_part(
    database: Database,
    digest: str,
    max_nodes: int = MAX_NODES,
    viewer: Viewer = OPERATOR,
    compute: Compute = here,
) -> PartContent:
    """Derive a part anew, and write it over what is stored under its digest. Raises as :func:`part_anew`.

    The old program stays under its digest, for items of jobs that are queued with it, if this server derived it.
    """
    with database.read() as connection:
        row = content.get_row(connection, digest)
        before, is_ours = row["program"], row["seal"] == seals.seal_of_part(connection, row)
        made = part_anew(connection, digest, max_nodes, compute)
    with database.write() as connection:
        mend_part(connection, made)
        catalogue.show_again(connection, digest)
        if made.row["program"] != before:
            if not is_ours:
                content.forget_program(connection, before)
            audit.note(connection, viewer, "substructure.renew", digest, program=made.row["program"], was=before)
    return made


def renew_tree(
    database: Database,
    name: str,
    revision: int,
    max_nodes: int = MAX_NODES,
    viewer: Viewer = OPERATOR,
    compute: Compute = here,
) -> CoupledAnew:
    """Couple a revision anew, of parts that are derived anew where they need it, and write it over what is stored.

    Raises as :func:`tree_anew`.
    """
    for digest in _stale_parts_of(database, name, revision):
        renew_part(database, digest, max_nodes, viewer, compute)
    with database.read() as connection:
        was = read_tree(connection, name, revision)[0]
        before = was.program
        found = tree_anew(connection, name, revision, max_nodes, compute)
    with database.write() as connection:
        content.replace_program(connection, found.tree.program, found.packed, found.nodes)
        trees.replace_model(connection, found.tree)
        trees.put_parts(connection, name, revision, found.parts)
        if found.tree.program != before:
            if not was.is_derived:
                content.forget_program(connection, before)
            told = {"program": found.tree.program, "was": before}
            audit.note(connection, viewer, "tree.renew", f"{name}@{revision}", **told)
    return found


def _stale_parts_of(database: Database, name: str, revision: int) -> list[str]:
    """The digests of the stored parts of a revision that are not as this software derives them."""
    with database.read() as connection:
        definitions = stored_definitions(connection, read_tree(connection, name, revision)[1])
        digests = dict.fromkeys(definition.digest for definition in definitions.values())
        return [digest for digest in digests if not is_part_newest(connection, digest)]


def is_part_newest(connection: Connection, digest: str) -> bool:
    """Whether a part is as this software derives it, or not there at all."""
    try:
        stored = content.get_part(connection, digest)
    except Refused:
        return False
    return stored is None or (stored.is_derived and stored.software == software())


def is_tree_newest(connection: Connection, name: str, revision: int, is_older_good: bool = False) -> bool:
    """Whether a revision is as this server has coupled it, with this software or, if that is ``good``, another one."""
    tree = trees.get_damaged(connection, name, revision)
    if tree is None:
        return True
    is_sound = tree.is_derived and digest_of(tree.summary.encode()) == tree.summary_digest
    return is_sound and (is_older_good or tree.software == software())


def put_part(
    connection: Connection, viewer: Viewer, name: str, before: str, made: PartContent, found: Improvement
) -> None:
    """Write what a job derived over a part with the program ``before``; what has another one meanwhile stays."""
    if content.get_row(connection, made.digest)["program"] != before:
        return
    mend_part(connection, made)
    figures = {"before": found.before, "after": found.after, "program": made.row["program"], "was": before}
    audit.note(connection, viewer, "substructure.upgrade", name, **figures)


def put_tree(
    connection: Connection,
    viewer: Viewer,
    name: str,
    digest: str,
    before: str,
    made: TreeProgram,
    found: Improvement,
) -> None:
    """Write what a job coupled over the program ``before``, in all revisions of this document that have it."""
    content.put_program(connection, made.digest, made.program, made.nodes)
    for tree in trees.with_program(connection, name, digest, before):
        coupled = replace(tree, program=made.digest, dof=made.dof, **made.summary.columns())
        trees.replace_model(connection, coupled, made.software)
        figures = {"before": found.before, "after": found.after, "program": made.digest, "was": before}
        audit.note(connection, viewer, "tree.upgrade", f"{name}@{tree.revision}", **figures)
