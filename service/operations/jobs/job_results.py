"""What is written when an item succeeds: a tree, a version of a substructure, or files kept as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from service.content.derivation import release
from service.content.improvement import Improvement
from service.content.integrity import checked
from service.content.summaries import UNKNOWN, PartContent
from service.content.tree_content import TreeContent
from service.content.tree_summaries import TreeSummary
from service.database.connections import Connection
from service.database.packed import unpack
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import NAMED
from service.jobs.kinds.kind import ENTRY
from service.messages.addresses import tree_path, version_path
from service.messages.viewer import Viewer
from service.operations import catalogue, trees
from service.operations.catalogue import PartSubmission
from service.operations.jobs.submission import key_of
from service.operations.preconditions import Expected
from service.operations.renewal import TreeProgram, put_part, put_tree
from service.operations.sharing.provenance import IMPORTED, Origin
from service.queries.attempts import Attempt
from service.queries.jobs import results
from service.queries.jobs.jobs import submitters
from service.schemas.entries import Entry, PartEntry
from substructures.documents import read_json, write_json

#: fields of an item that changes a tree: the number of the revision that it changes, and whether that was pinned
BASE_REVISION, IS_EXACT = "base", "is_exact"


#: counts bytes that a principal is about to keep, and refuses what is too many
Take = Callable[[Connection, str, str, int], None]


def keep(connection: Connection, ended: Iterable[tuple[Attempt, Outcome]], take: Take | None = None) -> None:
    """Store outcomes under the keys of their items, in the transaction that completes the items.

    Raises Refused where there is no room for them.
    """
    ended = list(ended)
    viewers = submitters(connection, {attempt.job for attempt, _ in ended})
    found = [
        replace(_result(connection, viewers[attempt.job], attempt, outcome), principal=viewers[attempt.job].key)
        for attempt, outcome in ended
    ]
    if take is not None:
        for owner in sorted({each.principal for each in found}):
            take(connection, "result", owner, sum(each.size for each in found if each.principal == owner))
    results.put_results(connection, found)


def _result(connection: Connection, viewer: Viewer, attempt: Attempt, outcome: Outcome) -> results.Result:
    stored: dict[str, Any] = {}
    files: Mapping[str, bytes] = {}
    match attempt.kind:
        case "assemble":
            stored = _tree(connection, viewer, read_json(attempt.item.encode()), outcome)
        case "derive":
            stored = _version(connection, viewer, read_json(attempt.item.encode()), outcome)
        case "upgrade":
            stored = _upgraded(connection, viewer, read_json(attempt.item.encode()), outcome)
        case _:
            files = outcome.files
    told = write_json({**outcome.summary, **stored}).decode()
    content = attempt.item.encode()
    is_of_key = attempt.key == key_of(attempt.kind, read_json(content), content, release())
    return results.Result(attempt.key, attempt.kind, told, files, is_good=outcome.problem is None, is_of_key=is_of_key)


def _tree(connection: Connection, viewer: Viewer, item: Mapping[str, Any], outcome: Outcome) -> dict[str, Any]:
    coupled = TreeContent.of_files(outcome.summary, outcome.files)
    entry = PartEntry(**item.get(ENTRY, {}))
    for part in coupled.inline if item.get(NAMED) else ():
        catalogue.submit(connection, viewer, PartSubmission(part.name, part.digest, part, entry=entry, origin=IMPORTED))
    tree, _ = trees.store(connection, viewer, coupled, _entry(item), item.get(BASE_REVISION), bool(item.get(IS_EXACT)))
    return {"revision": tree.revision, "tree": f"{tree.name}@{tree.revision}", "location": tree_path(tree)}


def _version(connection: Connection, viewer: Viewer, item: Mapping[str, Any], outcome: Outcome) -> dict[str, Any]:
    part = PartContent.of_files(outcome.files)
    entry, origin = PartEntry(**item.get(ENTRY, {})), Origin.of_item(item)
    submission = PartSubmission(
        part.name, part.digest, part, entry=entry, origin=origin, expected=Expected.of_item(item)
    )
    version, _ = catalogue.submit(connection, viewer, submission)
    return {"version": version.version, "location": version_path(version)}


def _upgraded(connection: Connection, viewer: Viewer, item: Mapping[str, Any], outcome: Outcome) -> dict[str, Any]:
    """Nothing more is told than what the outcome says."""
    files, told = outcome.files, outcome.summary
    found = Improvement(told["before"], told["after"], told["outcome"])
    if found.is_one and "tree" in item:
        checked("the program of a tree", told["program"], unpack(files["program"]))
        figures = told["program"], told["nodes"], told["dof"]
        made = TreeProgram(files["program"], *figures, TreeSummary.of_files(files), told.get("software", UNKNOWN))
        put_tree(connection, viewer, told["name"], told["digest"], item["program"], made, found)
    elif found.is_one:
        put_part(connection, viewer, item["substructure"], item["program"], PartContent.of_files(files), found)
    return {}


def _entry(item: Mapping[str, Any]) -> Entry:
    return Entry(**item.get(ENTRY, {}))
