"""``/v1/trees``: couple stored substructures; every change is a new revision."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request, Response

from service.addresses import tree_path
from service.answers import Answer, json_answer
from service.database.connections import Connection
from service.http.acting import Act, ActOf, Commit, timed
from service.http.requests import JsonBody, StoreOf, needs
from service.http.responses import conditional, link_header, next_link, response_of
from service.operations import trees
from service.operations.job_results import BASE_REVISION, IS_EXACT
from service.paging import limited, read_token, write_token
from service.queries.trees import page
from service.references import is_pinned
from service.routes.bodies import body_of
from service.routes.deferred import deferred, made
from service.schemas.resources import TreePage, TreeView
from service.views.resources import dump, tree_item, tree_view

router = APIRouter(prefix="/v1/trees", tags=["trees"])
READ, WRITE = [needs("read")], [needs("write")]
IfMatch = Annotated[str | None, Header(description="ETag of the tree that is to be changed")]


def revision(prepare: Callable[[], trees.Revision]) -> Callable[[], Commit]:
    """What ``Act`` runs: prepare a revision, then store it and answer it."""

    def prepared() -> Commit:
        """Couple."""
        ready = prepare()

        def commit(connection: Connection) -> Answer:
            """Store the revision and answer it."""
            tree, is_new = trees.commit(connection, ready)
            return json_answer(tree_view(tree), 201 if is_new else 200, {"Location": tree_path(tree)})

        return commit

    return prepared


def changed(act: Act, change: Callable[[], trees.TreeChange]) -> Response:
    """Store a changed tree, at once or by a job."""

    def later() -> Commit:
        """The job that stores the same change."""
        found = change()
        members = {BASE_REVISION: found.base.revision, IS_EXACT: found.is_exact}
        return deferred(act, "assemble", found.document, found.step, members)()

    return act.run(revision(lambda: trees.prepare_change(act.store, change())), later)


@router.post(
    "",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("TreeSpec"),
    responses=made(TreeView),
)
@timed("derive")
def create(body: JsonBody, store: StoreOf, act: ActOf) -> Response:
    """Couple instances to a tree. 201 with the new revision, 200 when the latest one is the same."""
    return act.run(revision(lambda: trees.prepare(store, body)), deferred(act, "assemble", body))


@router.get("", response_model=TreePage, dependencies=READ)
def list_trees(
    request: Request,
    store: StoreOf,
    page_size: Annotated[int, Query(ge=1)] = 50,
    page_token: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """A page of trees, the latest revision of each."""
    size = limited(page_size, store.settings.limits)
    after = read_token("trees", page_token, str)
    with store.database.read() as connection:
        found = page(connection, after[0] if after else None, size + 1)
    token = write_token("trees", found[size - 1].name) if len(found) > size else None
    link = next_link(request, token)
    view = {"items": [tree_item(t) for t in found[:size]], "next_page_token": token, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers=link_header(link)))


@router.get("/{ref}", response_model=TreeView, dependencies=READ)
def get_tree(ref: str, request: Request, store: StoreOf) -> Response:
    """A revision of a tree, the latest for a bare name."""
    with store.database.read() as connection:
        tree = trees.find(connection, ref)
    return conditional(request, trees.tree_tag(tree), is_pinned(ref), lambda: json_answer(tree_view(tree)))


@router.post(
    "/{ref}/couplings",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("Instance"),
    responses=made(TreeView),
)
@timed("derive")
def add_coupling(ref: str, body: JsonBody, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Couple one more instance onto the tree: a new revision."""
    return changed(act, lambda: trees.coupling(store, ref, body, if_match))


@router.delete(
    "/{ref}/couplings/{instance}",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    responses=made(TreeView),
)
@timed("derive")
def remove_coupling(ref: str, instance: str, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Remove an instance that carries no other: a new revision."""
    return changed(act, lambda: trees.removal(store, ref, instance, if_match))
