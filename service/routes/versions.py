"""``/v1/substructures/{name}/versions``, ``/v1/trees/{name}/revisions``, ``/v1/substructures/{ref}/uses``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import link_header, next_link, response_of
from service.messages.answers import REVALIDATE, json_answer
from service.messages.paging import limited, read_token, write_token
from service.operations import catalogue, owners
from service.queries import uses, versions
from service.routes.bodies import APIRouter
from service.schemas.versions import RevisionList, UsePage, VersionList
from service.views.resources import dump
from service.views.versions import revision_item, use_view, version_item

router = APIRouter(prefix="/v1")
READ = [needs("read")]
PageSize = Annotated[int, Query(ge=1)]
Token = Annotated[str | None, Query(max_length=2000)]


def _page(request: Request, items: Sequence[Any], token: str | None) -> Response:
    link = next_link(request, token)
    view = {"items": items, "next_page_token": token, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers={"Cache-Control": REVALIDATE, **link_header(link)}))


@router.get("/substructures/{name}/versions", response_model=VersionList, dependencies=READ, tags=["catalogue"])
def list_substructure_versions(
    name: str, request: Request, store: StoreOf, viewer: ViewerOf, page_size: PageSize = 50, page_token: Token = None
) -> Response:
    """All versions of a part, the newest first: who made them, when, of what and why; those that are withdrawn, too."""
    size, search = limited(page_size, store.settings.limits.page_size), ("versions", name)
    before = read_token(search, page_token, int)
    with store.database.read() as connection:
        owners.seen(connection, viewer, "substructure", name)
        found = versions.page_versions(connection, viewer, name, before[0] if before else None, size + 1)
    token = write_token(search, found[size - 1].version) if len(found) > size else None
    return _page(request, [version_item(each) for each in found[:size]], token)


@router.get("/trees/{name}/revisions", response_model=RevisionList, dependencies=READ, tags=["trees"])
def list_tree_revisions(
    name: str, request: Request, store: StoreOf, viewer: ViewerOf, page_size: PageSize = 50, page_token: Token = None
) -> Response:
    """All revisions of a tree, the newest first: who made them, when, of which one and why."""
    size, search = limited(page_size, store.settings.limits.page_size), ("revisions", name)
    before = read_token(search, page_token, int)
    with store.database.read() as connection:
        owners.seen(connection, viewer, "tree", name)
        found = versions.page_revisions(connection, viewer, name, before[0] if before else None, size + 1)
    token = write_token(search, found[size - 1].revision) if len(found) > size else None
    return _page(request, [revision_item(each) for each in found[:size]], token)


@router.get("/substructures/{ref}/uses", response_model=UsePage, dependencies=READ, tags=["catalogue"])
def list_substructure_uses(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, page_size: PageSize = 50, page_token: Token = None
) -> Response:
    """Trees with the part, parts that such trees became, parts made from it; of all versions for a bare name."""
    size, search = limited(page_size, store.settings.limits.page_size), ("uses", ref)
    position = read_token(search, page_token, str, str, int)
    after: uses.Position | None = None if position is None else (position[0], position[1], position[2])
    with store.database.read() as connection:
        name, version = catalogue.used(connection, viewer, ref)
        found = uses.page(connection, viewer, name, version, after, size + 1)
    last = found[size - 1] if len(found) > size else None
    token = None if last is None else write_token(search, last.kind, last.name, last.number)
    return _page(request, [use_view(each) for each in found[:size]], token)
