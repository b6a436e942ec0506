"""Quantities and numbers that follow from a stored tree, computed by workers."""

from __future__ import annotations

from typing import Any

import orjson

from service.analyses.printing import Style
from service.analyses.results import MEDIA_TYPES
from service.answers import Answer
from service.jobs.worker import Worker
from service.operations import trees
from service.operations.exports import printed
from service.operations.pinned import pinned_tree
from service.refusals import moved
from service.store import Store
from service.viewer import Viewer

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
