"""``.../picture`` and ``.../scene`` of parts and trees: as SVG, and as data of what there is to draw."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import conditional
from service.messages.answers import JSON, Answer, etag
from service.messages.references import is_pinned
from service.operations import catalogue, pictures, trees
from service.schemas.scenes import SceneView

MEDIA_TYPE = "image/svg+xml"
#: nothing inside of a picture may run or be fetched, even when it is opened as a document of its own
HEADERS = {
    "Content-Type": MEDIA_TYPE,
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
}
POSE = "pose: a number for every coordinate, in order, separated by commas; rad or m, or with a unit: 30 deg"
Q = Annotated[str | None, Query(max_length=50_000, description=POSE)]
DRAWN: dict[int | str, dict[str, Any]] = {
    200: {"description": "The picture", "content": {MEDIA_TYPE: {"schema": {"type": "string"}}}}
}

router = APIRouter(prefix="/v1", tags=["pictures"], dependencies=[needs("read")])


@router.get("/substructures/{ref}/picture", response_class=Response, responses=DRAWN)
def substructure_picture(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, q: Q = None) -> Response:
    """A part alone, in the pose given or at home."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
    pose = pictures.read_pose(q, version.joints)
    pinned = is_pinned(ref) and version.is_public
    return _answer(request, version.digest, pose, pinned, lambda: pictures.draw_part(store, version, pose))


@router.get("/trees/{ref}/picture", response_class=Response, responses=DRAWN)
def tree_picture(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, q: Q = None) -> Response:
    """A tree, in the pose given or at home."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    pose = pictures.read_pose(q, pictures.joints_of(tree))
    pinned = is_pinned(ref) and tree.is_public
    return _answer(request, tree.digest, pose, pinned, lambda: pictures.draw_tree(store, tree, pose))


@router.get("/substructures/{ref}/scene", response_model=SceneView)
def substructure_scene(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What there is to draw of a part alone: frames, joints, bodies with their inertia, loads, poses."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
    pinned = is_pinned(ref) and version.is_public
    return _scene(request, version.digest, pinned, lambda: pictures.scene_of_part(store, version))


@router.get("/trees/{ref}/scene", response_model=SceneView)
def tree_scene(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What there is to draw of a tree: frames, joints, bodies with their inertia, loads, closures, poses."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    pinned = is_pinned(ref) and tree.is_public
    return _scene(request, tree.digest, pinned, lambda: pictures.scene_of_tree(store, tree))


def _scene(request: Request, digest: str, pinned: bool, draw: Callable[[], str]) -> Response:
    headers = {"Content-Type": JSON}
    return conditional(request, etag(digest, "scene"), pinned, lambda: Answer(200, draw().encode(), headers))


def _answer(
    request: Request, digest: str, pose: pictures.PoseValues | None, pinned: bool, draw: Callable[[], str]
) -> Response:
    tag = etag(digest, "picture", repr(pose))
    return conditional(request, tag, pinned, lambda: Answer(200, draw().encode(), HEADERS))
