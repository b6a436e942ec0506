"""``/v1/substructures/{name}/aliases``: names for versions, with history."""

from __future__ import annotations

from typing import Annotated

from fastapi import Header, Response

from service.http.requests import JsonBody, StoreOf, ViewerOf, needs
from service.http.responses import response_of
from service.messages.answers import REVALIDATE, json_answer
from service.messages.refusals import not_found
from service.operations import catalogue
from service.operations.preconditions import Expected
from service.queries import aliases
from service.routes.bodies import APIRouter, body_of
from service.schemas.resources import AliasList, AliasRequest, AliasView
from service.views.resources import alias_view, dump
from substructures.documents import read_model

router = APIRouter(prefix="/v1/substructures/{name}/aliases", tags=["catalogue"])
READ, WRITE = [needs("read")], [needs("write")]


@router.get("", response_model=AliasList, dependencies=READ)
def list_aliases(name: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """All aliases of a substructure."""
    with store.database.read() as connection:
        catalogue.check_name(connection, viewer, name)
        rows = aliases.list_aliases(connection, name)
        items = [alias_view(name, row, aliases.history(connection, name, row.alias)) for row in rows]
    return response_of(json_answer(dump({"items": items})))


@router.get("/{alias}", response_model=AliasView, dependencies=READ)
def get_alias(name: str, alias: str, store: StoreOf, viewer: ViewerOf) -> Response:
    """An alias, with the ETag that moving it needs."""
    with store.database.read() as connection:
        catalogue.check_name(connection, viewer, name)
        row = aliases.get_alias(connection, name, alias)
        if row is None:
            raise not_found(f"there is no alias '{name}@{alias}'", "unknown-alias")
        view = alias_view(name, row, aliases.history(connection, name, alias))
    return response_of(json_answer(dump(view), headers={"ETag": catalogue.alias_tag(row), "Cache-Control": REVALIDATE}))


@router.put(
    "/{alias}",
    response_model=AliasView,
    dependencies=WRITE,
    openapi_extra=body_of("AliasRequest"),
    responses={201: {"description": "The alias is new", "model": AliasView}},
)
def set_alias(
    name: str,
    alias: str,
    body: JsonBody,
    store: StoreOf,
    viewer: ViewerOf,
    if_match: Annotated[str | None, Header(description="ETag of the alias that is to be moved")] = None,
    if_none_match: Annotated[str | None, Header(description="*: only where there is no such alias")] = None,
) -> Response:
    """Create an alias (201) or move it (200; needs If-Match: 428 without, 412 when it was moved meanwhile)."""
    wanted = read_model(AliasRequest, body)
    with store.database.write() as connection:
        row = catalogue.set_alias(connection, viewer, name, alias, wanted.version, Expected(if_match, if_none_match))
        view = alias_view(name, row, aliases.history(connection, name, alias))
    status = 201 if row.revision == 1 and if_match is None else 200
    return response_of(json_answer(dump(view), status, {"ETag": catalogue.alias_tag(row)}))
