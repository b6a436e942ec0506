"""Formulas of older versions of the software derived anew with today's: the command ``substructures upgrade``.

A version is its definition, a revision its document: these never change, nor do their digests. Their programs are what
follows: what today's software derives takes the place of what another one did, with a certificate of its own. The
server does so by itself when a newer version starts (:mod:`service.operations.renewing`). The old program stays in the
store under its digest, for items of jobs that are queued with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from service.content.improvement import AS_IT_WAS, improvement
from service.database.connections import Database
from service.database.packed import unpack
from service.messages.viewer import Viewer
from service.operations.renewal import OPERATOR, read_tree, renew_part, renew_tree
from service.operations.verification import told
from service.queries import catalogue, content, trees
from substructures.expr.program import Program
from substructures.part.part import MAX_NODES


@dataclass(frozen=True, slots=True)
class Upgraded:
    """What was derived anew, e.g. ``substructure arm@2``, with its operations before and after; ``fault``: why it was
    left as it is, where it could not be.
    """

    what: str
    digest: str
    before: int | None = None
    after: int | None = None
    outcome: str = AS_IT_WAS
    fault: str = ""


def upgrade(
    database: Database, viewer: Viewer = OPERATOR, every: bool = False, max_nodes: int = MAX_NODES
) -> Iterator[Upgraded]:
    """Derive parts anew, then couple trees anew, each in a transaction of its own: what is told of is on the disk.

    The latest versions and revisions of names that the viewer may change (an admin: all); ``every``: of an admin all
    contents of the store, also older versions, withdrawn ones and what trees brought along. A server may go on using
    the store: it takes up new programs with the next request.
    """
    with database.read() as connection:
        parts = catalogue.own_contents(connection, viewer)
        revisions = trees.own_revisions(connection, viewer, every)
        if every and viewer.is_admin:
            parts = catalogue.all_contents(connection)
    for digest, name in parts.items():
        what = f"substructure {name}" if name else "definition of a tree"
        yield _tried(what, digest, lambda: _part(database, viewer, what, digest, max_nodes))  # noqa: B023 -- called here
    for tree, number in revisions:
        what = f"tree {tree}@{number}"
        yield _tried(what, what, lambda: _tree(database, viewer, tree, number, max_nodes))  # noqa: B023 -- called here


def _tried(what: str, digest: str, work: Callable[[], Upgraded]) -> Upgraded:
    try:
        return work()
    except Exception as error:  # whatever it is, the next one is looked at, too
        return Upgraded(what, digest, fault=told(error))


def _part(database: Database, viewer: Viewer, what: str, digest: str, max_nodes: int) -> Upgraded:
    with database.read() as connection:
        stored = content.get_part(connection, digest)
    if stored is None:
        raise ValueError("its definition is gone from the store; submit it again")
    renew_part(database, digest, max_nodes, viewer)
    with database.read() as connection:
        now = content.get_part(connection, digest)
    found = improvement(Program.from_bytes(stored.program), Program.from_bytes((now or stored).program))
    return Upgraded(what, digest, found.before, found.after, found.outcome)


def _tree(database: Database, viewer: Viewer, name: str, number: int, max_nodes: int) -> Upgraded:
    with database.read() as connection:
        tree, _ = read_tree(connection, name, number)
        data = content.get_program(connection, tree.program)
    if data is None:
        raise ValueError(f"its program {tree.program} is gone from the store")
    made = renew_tree(database, name, number, max_nodes, viewer)
    found = improvement(Program.from_bytes(data), Program.from_bytes(unpack(made.packed)))
    return Upgraded(f"tree {name}@{number}", tree.digest, found.before, found.after, found.outcome)
