"""What follows from stored trees, as formulas, numbers and files: computed by workers, as items of jobs are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import orjson

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import marks_of
from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.negotiation import MEDIA_TYPES as PRINTED
from service.messages.refusals import moved
from service.messages.viewer import Viewer
from service.models.exporting import WITH_PARTS, ExportRequest
from service.models.formulas.entry import Options
from service.models.printing import TO_READ, Style, has_parts
from service.models.results import MEDIA_TYPES
from service.operations import trees
from service.operations.sharing.sources import pinned_tree
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.store.store import Store

FORMATS = {media: name for name, media in MEDIA_TYPES.items()}
LIMITS = ("program_nodes", "binary_bytes", "states")


def velocity_equations(store: Store, viewer: Viewer, worker: Worker, ref: str, document: Any, style: Style) -> Answer:
    """The equations of a stored tree with velocity constraints as formulas. Raises as ``printed``, Refused 404."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    return printed(store, worker, tree, "velocity-equations", style, request=document)


def analyse(store: Store, viewer: Viewer, worker: Worker, ref: str, name: str, request: Any, media: str) -> Answer:
    """The result of an analysis of ANALYSES in one of its media types.

    Raises Refused 404, InvalidDocument, Refused, TooLarge, TimeoutError.
    """
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    item, blobs = pinned_tree(store, tree)
    limits, folder = store.settings.limits, store.work_folder
    item |= {"analysis": name, "request": request, "format": FORMATS[media], "answered": True}
    item |= {"limits": {each: getattr(limits, each) for each in LIMITS}, "kernels": folder and str(folder)}
    with moved(lambda pointer: pointer.removeprefix("/request")):
        found = worker("analyse", item, blobs)
    headers = {"Content-Type": media}
    motion = found.summary.get("motion")
    if motion is not None:  # a CSV file has no place for them
        right = orjson.dumps(motion["is_right"]).decode()
        headers |= {"Trajectory-Status": motion["status"], "Trajectory-Right": right}
    return Answer(200, found.files["result"], headers)


def printed(
    store: Store,
    worker: Worker,
    tree: Tree,
    quantity: str,
    style: Style,
    options: Options | None = None,
    group: bool = False,
    **more: Any,
) -> Answer:
    """A quantity of a tree in the format chosen; ``more``: fields of the item, the ``request`` that a quantity takes.

    Raises InvalidDocument and Refused with pointers into query and body, TooLarge, TimeoutError.
    """
    item, blobs = pinned_tree(store, tree, group or has_parts(quantity) or style.format in TO_READ)
    item |= {"quantity": quantity, **asdict(style), "group": group, **more}
    item |= {"options": {name: list(texts) for name, texts in (options or {}).items()}}
    item |= {"nodes": store.settings.limits.program_nodes}
    with moved(_of_request):
        text = worker("export", item, blobs).files["text"]
    return Answer(200, text, {"Content-Type": PRINTED[style.format]})


def _of_request(pointer: str) -> str:
    """A pointer into an item as one into the request that it stands for."""
    if pointer in ("/bind", "/group"):
        return f"/query{pointer}"
    if pointer.startswith("/options/"):
        return "/query" + pointer.removeprefix("/options")
    return pointer.removeprefix("/request")


def tree_files(store: Store, worker: Worker, tree: Tree, wanted: ExportRequest) -> Answer:
    """A tree for a target. Raises InvalidInput with pointers into the query, TooLarge, Refused, TimeoutError."""
    item, blobs = pinned_tree(store, tree, wanted.target in WITH_PARTS or any(map(has_parts, wanted.quantities)))
    return _files(store, worker, wanted, {**item, "called": tree.name}, f"{tree.name}@{tree.revision}", blobs)


def part_files(store: Store, worker: Worker, version: Version, wanted: ExportRequest) -> Answer:
    """A part for a target, as it stands alone. Raises as :func:`tree_files`."""
    blobs = store.blobs((version.digest, version.program))
    item: dict[str, Any] = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
    item |= {"not_judged": list(marks)} if (marks := marks_of(version.certificate)) else {}
    return _files(store, worker, wanted, item, f"{version.name}@{version.version}", blobs)


def _files(
    store: Store,
    worker: Worker,
    wanted: ExportRequest,
    of: Mapping[str, Any],
    reference: str,
    blobs: Mapping[str, bytes],
) -> Answer:
    asked = {**asdict(wanted), "quantities": list(wanted.quantities)}
    limit = store.settings.limits.program_nodes
    with moved(lambda pointer: f"/query{pointer}" if pointer else pointer):
        found = worker("export", {**of, **asked, "reference": reference, "nodes": limit}, blobs)
    return _file(found)


def _file(found: Outcome) -> Answer:
    """The one file of an export, to be saved under its name."""
    (data,) = found.files.values()
    disposition = f'attachment; filename="{found.summary["name"]}"'
    return Answer(200, data, {"Content-Type": found.summary["media_type"], "Content-Disposition": disposition})
