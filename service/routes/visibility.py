"""``/v1/substructures/{name}/visibility`` and ``/v1/trees/{name}/visibility``: whose a name is, and who sees it."""

from __future__ import annotations

from fastapi import Response

from service.http.requests import JsonBody, StoreOf, ViewerOf, needs
from service.http.responses import response_of
from service.messages.answers import json_answer
from service.operations import owners
from service.queries.owners import Kind, Ownership
from service.routes.bodies import APIRouter, body_of
from service.schemas.entries import OwnershipView, VisibilityRequest
from service.views.resources import dump
from substructures.documents import read_model

router = APIRouter(prefix="/v1")
READ, WRITE = [needs("read")], [needs("write")]
BODY = body_of("VisibilityRequest")


def _answer(name: str, found: Ownership) -> Response:
    shown = {"name": name, "owner": found.owner, "visibility": found.visibility}
    return response_of(json_answer(dump(shown), headers={"Cache-Control": "no-cache"}))


def _read(kind: Kind, name: str, store: StoreOf, viewer: ViewerOf) -> Response:
    with store.database.read() as connection:
        return _answer(name, owners.seen(connection, viewer, kind, name))


def _change(kind: Kind, name: str, body: JsonBody, store: StoreOf, viewer: ViewerOf) -> Response:
    wanted = read_model(VisibilityRequest, body)
    with store.database.write() as connection:
        return _answer(name, owners.set_visibility(connection, viewer, kind, name, wanted.visibility))


@router.get("/substructures/{name}/visibility", response_model=OwnershipView, dependencies=READ, tags=["catalogue"])
def get_substructure_visibility(name: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """Whose a name is, and who sees its versions."""
    return _read("substructure", name, store, viewer)


@router.put(
    "/substructures/{name}/visibility",
    response_model=OwnershipView,
    dependencies=WRITE,
    openapi_extra=BODY,
    tags=["catalogue"],
)
def set_substructure_visibility(name: str, body: JsonBody, store: StoreOf, viewer: ViewerOf) -> Response:
    """Let everybody see all versions. What is public stays so (409)."""
    return _change("substructure", name, body, store, viewer)


@router.get("/trees/{name}/visibility", response_model=OwnershipView, dependencies=READ, tags=["trees"])
def get_tree_visibility(name: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """Whose a name is, and who sees its revisions."""
    return _read("tree", name, store, viewer)


@router.put(
    "/trees/{name}/visibility", response_model=OwnershipView, dependencies=WRITE, openapi_extra=BODY, tags=["trees"]
)
def set_tree_visibility(name: str, body: JsonBody, store: StoreOf, viewer: ViewerOf) -> Response:
    """Let everybody see all revisions, whose parts have to be public (409). What is public stays so (409)."""
    return _change("tree", name, body, store, viewer)
