"""``/v1/trees``: couple stored substructures; every change is a new revision."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from fastapi import Header, Query, Request, Response

from service.database.connections import Connection
from service.http.acting import ActOf, Commit, timed
from service.http.requests import JsonBody, StoreOf, ViewerOf, needs
from service.http.responses import conditional, link_header, next_link, response_of
from service.messages.answers import Answer, json_answer
from service.messages.paging import limited
from service.messages.refusals import unprocessable
from service.operations import searches, trees
from service.operations.jobs.job_results import BASE_REVISION
from service.operations.preconditions import Expected, latest_as, tree_tag, withdrawn
from service.queries.searching.tree_search import TreeSearch
from service.queries.searching.words import words_of
from service.routes.bodies import APIRouter, body_of
from service.routes.deferred import deferred, made
from service.routes.filters import NarrowOf
from service.routes.revisions import changed, revision, shown_soon
from service.schemas.entries import ChangedTree, Entry
from service.schemas.resources import TreePage, TreeView
from service.views.resources import dump, tree_page_view, tree_view
from substructures.documents import read_model
from substructures.tree.document import TreeSpec

router = APIRouter(prefix="/v1/trees", tags=["trees"])
READ, WRITE = [needs("read")], [needs("write")]
IfMatch = Annotated[str | None, Header(description="ETag of the tree that is to be changed")]


@router.post(
    "",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("SubmittedTree"),
    responses=made(TreeView),
)
@timed("derive")
def create_tree(
    body: JsonBody,
    store: StoreOf,
    act: ActOf,
    if_match: Annotated[str | None, Header(description="ETag of the tree whose next revision this is")] = None,
    if_none_match: Annotated[str | None, Header(description="*: only where there is no tree of this name")] = None,
) -> Response:
    """Couple instances to a tree. 201 with the new revision, 200 when the latest one is the same."""
    entry, document = Entry.parted(body)
    expected = Expected(if_match, if_none_match)

    def later() -> Commit:
        """The job that stores the same."""
        base = latest_as(store, act.viewer, TreeSpec.read(document).name, expected)
        return deferred(act, "assemble", body, members={} if base is None else {BASE_REVISION: base})()

    make = partial(trees.prepare, store, act.viewer, act.worker, document, entry, expected=expected)
    return shown_soon(act, act.run(revision(act, make), later))


@router.get("", response_model=TreePage, dependencies=READ)
def list_trees(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    narrow: NarrowOf,
    q: Annotated[str, Query(max_length=200, description="words in the name")] = "",
    uses: Annotated[str | None, Query(max_length=200, description="name of a part that is an instance")] = None,
    page_size: Annotated[int, Query(ge=1)] = 50,
    page_token: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """A page of trees, the latest revision of each. Words that are nowhere are taken for the most similar ones."""
    if uses is not None and "@" in uses:
        where = f"GET /v1/substructures/{uses}/uses, or 'substructures uses {uses}', tells what uses one version"
        detail = f"'uses' is the name of a part alone; {where}"
        raise unprocessable("bare-name-expected", detail, "/query/uses")
    wanted = searches.checked(TreeSearch(words_of(q), **narrow, uses=uses))
    size = limited(page_size, store.settings.limits.page_size)
    with store.database.read() as connection:
        page = searches.trees(connection, viewer, wanted, size, page_token)
    link = next_link(request, page.next_token)
    return response_of(json_answer(dump(tree_page_view(page, link)), headers=link_header(link)))


@router.get("/{ref}", response_model=TreeView, dependencies=READ)
def get_tree(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A revision of a tree, the latest for a bare name. Its parts may be withdrawn, so clients revalidate by ETag."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
        gone = withdrawn(connection, viewer, tree)
    return conditional(request, tree_tag(tree, gone), False, lambda: json_answer(tree_view(tree, gone)))


@router.delete("/{ref}", status_code=204, dependencies=WRITE)
def remove_tree(ref: str, act: ActOf, if_match: IfMatch = None) -> Response:
    """Remove a tree with all its revisions. Its parts stay, and later revisions of the name count on."""

    def commit(connection: Connection) -> Answer:
        """Remove it."""
        trees.remove(connection, act.viewer, ref, if_match)
        return Answer(204, b"")

    return act.submit(lambda: commit)


@router.patch(
    "/{ref}",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("ChangedTree"),
    responses=made(TreeView),
)
@timed("derive")
def change_tree(ref: str, body: JsonBody, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Give a tree other gravity, parameters, inputs, given motions or momenta, velocity constraints or contacts: a new
    revision."""
    read_model(ChangedTree, body)  # whatever becomes of it
    return changed(act, lambda: trees.amendment(store, act.viewer, ref, body, if_match))


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
    return changed(act, lambda: trees.coupling(store, act.viewer, ref, body, if_match))


@router.patch(
    "/{ref}/couplings/{instance}",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("ChangedInstance"),
    responses=made(TreeView),
)
@timed("derive")
def change_coupling(
    ref: str, instance: str, body: JsonBody, store: StoreOf, act: ActOf, if_match: IfMatch = None
) -> Response:
    """Give an instance another part, place or other parameters; what it carries stays on it: a new revision."""
    return changed(act, lambda: trees.replacement(store, act.viewer, ref, instance, body, if_match))


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
    return changed(act, lambda: trees.removal(store, act.viewer, ref, instance, if_match))


@router.post(
    "/{ref}/loads",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("AnyTreeLoad"),
    responses=made(TreeView),
)
@timed("derive")
def add_load(ref: str, body: JsonBody, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Let one more load act between frames of the tree: a new revision."""
    return changed(act, lambda: trees.load(store, act.viewer, ref, body, if_match))


@router.delete(
    "/{ref}/loads/{load}",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    responses=made(TreeView),
)
@timed("derive")
def remove_load(ref: str, load: str, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Remove a load of the tree: a new revision."""
    return changed(act, lambda: trees.unload(store, act.viewer, ref, load, if_match))


@router.post(
    "/{ref}/closures",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    openapi_extra=body_of("Closure"),
    responses=made(TreeView),
)
@timed("derive")
def add_closure(ref: str, body: JsonBody, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Close one more loop of the tree: a new revision."""
    return changed(act, lambda: trees.closure(store, act.viewer, ref, body, if_match))


@router.delete(
    "/{ref}/closures/{closure}",
    status_code=201,
    response_model=TreeView,
    dependencies=WRITE,
    responses=made(TreeView),
)
@timed("derive")
def remove_closure(ref: str, closure: str, store: StoreOf, act: ActOf, if_match: IfMatch = None) -> Response:
    """Cut a loop of the tree open: a new revision."""
    return changed(act, lambda: trees.opening(store, act.viewer, ref, closure, if_match))
