"""``.../picture`` and ``.../scene`` of parts and trees: as SVG, and as data of what there is to draw."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import conditional
from service.jobs.worker import Worker
from service.messages.answers import JSON, Answer, etag
from service.messages.references import is_pinned
from service.operations import catalogue, modules, pictures, trees
from service.operations.modules import Subject
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.routes.bodies import APIRouter
from service.schemas.scenes import SceneView
from substructures.export import interface_of_part

#: what is drawn, and who draws it, when it is not in memory
Found = Callable[[], tuple[Subject, Worker]]
ADVICE = "draw its parts"

MEDIA_TYPE = "image/svg+xml"
#: nothing inside of a picture may run or be fetched, even when it is opened as a document of its own
HEADERS = {
    "Content-Type": MEDIA_TYPE,
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
}
POSE = "pose: the numbers of a state in order, separated by commas; rad or m, or with a unit: 30 deg"
Q = Annotated[str | None, Query(max_length=50_000, description=POSE)]
DRAWN: dict[int | str, dict[str, Any]] = {
    200: {"description": "The picture", "content": {MEDIA_TYPE: {"schema": {"type": "string"}}}}
}

router = APIRouter(prefix="/v1", tags=["pictures"], dependencies=[needs("read")])


@router.get("/substructures/{ref}/picture", response_class=Response, responses=DRAWN)
async def get_substructure_picture(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, q: Q = None
) -> Response:
    """A part alone, in the pose given or at home."""

    def answer(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            version = catalogue.find(connection, viewer, ref)
            part = None if q is None else store.required_part(connection, version.digest)
        pose = None if part is None else pictures.read_pose(q, interface_of_part(part).vectors["q"].units)
        find = partial(modules.of_version, store, version)
        return _picture(request, version.digest, pose, _lasts(ref, version), lambda: (find(), worker))

    return await in_time(request, answer, ADVICE)


@router.get("/trees/{ref}/picture", response_class=Response, responses=DRAWN)
async def get_tree_picture(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, q: Q = None) -> Response:
    """A tree, in the pose given or at home."""

    def answer(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            tree = trees.find(connection, viewer, ref)
        pose = None if q is None else pictures.read_pose(q, pictures.units_of(tree))
        find = partial(modules.of_revision, store, tree, has_parts=True)
        return _picture(request, tree.digest, pose, _lasts(ref, tree), lambda: (find(), worker))

    return await in_time(request, answer, ADVICE)


@router.get("/substructures/{ref}/scene", response_model=SceneView)
async def get_substructure_scene(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What there is to draw of a part alone: frames, joints, bodies with their inertia, loads, poses."""

    def answer(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            version = catalogue.find(connection, viewer, ref)
        find = partial(modules.of_version, store, version)
        return _scene(request, version.digest, _lasts(ref, version), lambda: (find(), worker))

    return await in_time(request, answer, ADVICE)


@router.get("/trees/{ref}/scene", response_model=SceneView)
async def get_tree_scene(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What there is to draw of a tree: frames, joints, bodies with their inertia, loads, closures, poses."""

    def answer(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            tree = trees.find(connection, viewer, ref)
        find = partial(modules.of_revision, store, tree, has_parts=True)
        return _scene(request, tree.digest, _lasts(ref, tree), lambda: (find(), worker))

    return await in_time(request, answer, ADVICE)


def _lasts(ref: str, found: Version | Tree) -> bool:
    """Whether what is told under this reference never changes."""
    return is_pinned(ref) and found.is_public


def _scene(request: Request, digest: str, lasts: bool, find: Found) -> Response:
    headers = {"Content-Type": JSON}
    return conditional(request, etag(digest, "scene"), lasts, lambda: Answer(200, pictures.scene(*find()), headers))


def _picture(request: Request, digest: str, pose: pictures.PoseValues | None, lasts: bool, find: Found) -> Response:
    tag = etag(digest, "picture", repr(pose))
    return conditional(request, tag, lasts, lambda: Answer(200, pictures.picture(*find(), pose), HEADERS))
