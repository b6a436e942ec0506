"""``/``, ``/substructures/{ref}``, ``/trees/{ref}``, ``/jobs``: for people, read with the same keys as the API."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.routing import router_of
from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.refusals import Refused
from service.messages.viewer import ANYBODY
from service.operations import differences, searches
from service.operations.jobs import jobs, tables
from service.operations.jobs.progress import progress as progress_of
from service.pages.account import PageRoute
from service.pages.catalogue import page
from service.pages.found import Found
from service.pages.html import Html
from service.pages.interface import Stored, interface_page
from service.pages.jobs import job_page, jobs_page
from service.pages.layout import answer
from service.pages.model.assets import scripted, with_scripts
from service.pages.results import PREVIEWED, results_section
from service.pages.sweeps import sweep_section
from service.pages.trees import trees_page
from service.pages.versions import (
    difference_page,
)
from service.queries import folders
from service.queries.jobs import jobs as job_rows
from service.queries.jobs import results
from service.queries.searching import part_search
from service.queries.searching.part_search import CatalogueSearch
from service.queries.searching.search import RELEVANCE
from service.queries.searching.tree_search import TreeSearch
from service.queries.searching.words import words_of
from service.queries.trees import Tree
from service.views.jobs import job_path
from substructures.documents.patterns import PATTERNS

Filter = Annotated[str, Query(max_length=500)]
To = Annotated[str, Query(min_length=1, max_length=160)]
DOF = "^[0-9]{0,6}$"
PATTERNS[DOF] = lambda _: "a whole number of degrees of freedom is needed, as in 6"
ADVICE = "compare smaller ones"
CARDS, TREES, JOBS, BAD = 60, 100, 100, 50
NONE: searches.Page[Tree] = searches.Page([], None)

router = router_of(PageRoute, include_in_schema=False, dependencies=[needs("read")])


@router.get("/")
def first_page(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    q: Annotated[str, Query(max_length=200)] = "",
    dof: Annotated[str, Query(pattern=DOF)] = "",
    joints: Annotated[str, Query(pattern="^[RPrp]*$", max_length=1000)] = "",
    tag: Annotated[str, Query(max_length=64)] = "",
    owner: Annotated[str, Query(max_length=64)] = "",
    sort: Annotated[str, Query(max_length=20)] = "",
    after: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """The catalogue."""
    query = {"q": q, "dof": dof, "joints": joints.upper(), "tag": tag, "owner": owner, "sort": sort}
    number = int(dof) if dof else None
    both: dict[str, Any] = {"words": words_of(q), "dof_min": number, "dof_max": number, "sort": sort or RELEVANCE}
    both |= {"joints": joints.upper() or None, "owner": owner or None}
    wanted = searches.checked(CatalogueSearch(**both, tags=(tag,) if tag else ()))
    with store.database.read() as connection:
        found = searches.parts(connection, viewer, wanted, CARDS, after, store.caches.facets)
        total = part_search.count(connection, viewer)
        # parts alone have tags; of trees there is one page
        some = (
            searches.trees(connection, viewer, TreeSearch(**both), TREES, None) if not tag and after is None else NONE
        )
        folder = folders.state(connection, store.settings) or {"refused": ()}
    shown = Found(found, total, some.items, some.next_token is not None, {x: y for x, y in query.items() if y})
    made = page(shown, _address(request), viewer != ANYBODY, viewer.has("write"), len(folder["refused"]))
    return with_scripts(answer(request, scripted(made, "catalogue.js")), compiles=False)


def _address(request: Request) -> str:
    """The address that the browser used."""
    return f"{request.url.scheme}://{request.headers['host']}"


@router.get("/substructures/{ref}/difference")
async def part_difference(ref: str, to: To, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What changed between two versions."""

    def shown(worker: Worker) -> Response:
        """The page, made in a thread."""
        a, b = differences.versions(store, viewer, ref, to)
        names = f"{a.name}@{a.version}", f"{b.name}@{b.version}"
        return answer(request, difference_page("substructures", *names, differences.of_versions(store, worker, a, b)))

    return await in_time(request, shown, ADVICE)


@router.get("/trees/{ref}/difference")
async def tree_difference(ref: str, to: To, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """What changed between two revisions of a tree."""

    def shown(worker: Worker) -> Response:
        """The page, made in a thread."""
        a, b = differences.revisions(store, viewer, ref, to)
        names = f"{a.name}@{a.revision}", f"{b.name}@{b.revision}"
        found = differences.of_revisions(store, worker, viewer, a, b)
        return answer(request, difference_page("trees", *names, found))

    return await in_time(request, shown, ADVICE)


@router.get("/trees")
def all_trees(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    q: Annotated[str, Query(max_length=200)] = "",
    part: Annotated[str, Query(max_length=200)] = "",
    after: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """Trees by relevance, or by name; of a ``part`` those that it may be coupled onto."""
    wanted = TreeSearch(words_of(q), sort=RELEVANCE)
    with store.database.read() as connection:
        found = searches.trees(connection, viewer, wanted, TREES, after)
    made = trees_page(found, q, part, viewer.has("write"))
    return with_scripts(answer(request, scripted(made, "trees.js")), compiles=False)


@router.get("/jobs")
def all_jobs(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    state: Filter = "",
    kind: Filter = "",
    label: Filter = "",
) -> Response:
    """The latest jobs (of a state, of a kind, with a label)."""
    query = {"state": state, "kind": kind, "label": label}
    wanted = {name: text or None for name, text in query.items()}
    with store.database.read() as connection:
        found = job_rows.page_jobs(connection, viewer, wanted, None, JOBS + 1)
        progress = [progress_of(connection, job) for job in found[:JOBS]]
    return answer(request, jobs_page(found[:JOBS], progress, len(found) > JOBS, query))


@router.get("/jobs/{job}")
def one_job(
    job: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    where: Filter = "",
    sort: Filter = "",
    x: Filter = "",
    y: Filter = "",
) -> Response:
    """A job with its progress; of a sweep its table, of which the query says what is shown."""
    query = {"where": where, "sort": sort, "x": x, "y": y}
    with store.database.read() as connection:
        found = jobs.find(connection, viewer, job)
        bad = job_rows.page_items(connection, job, "failed", -1, BAD + 1)
        progress = progress_of(connection, found)
        whole = tables.table_of(connection, found) if found.kind == tables.KIND and found.done else None
        good = [] if whole is not None else job_rows.page_items(connection, job, "succeeded", -1, PREVIEWED + 1)
        files = results.list_files(connection, [item.key for item in good])
    made = results_section(found, good, files)
    rows = None if whole is None else _rows(whole, job_path(job), query, viewer.has("write"))
    may_change = viewer.has("jobs") and (viewer.key == found.principal or viewer.may_change(found.owner))
    return answer(request, job_page(found, progress, bad[:BAD], len(bad) > BAD, may_change, made, rows))


@router.get("/docs/interface")
def interface(request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """Every request, filled in with the newest tree, a part and a job that the viewer sees."""
    none = dict.fromkeys(("state", "kind", "label"))
    with store.database.read() as connection:
        newest = searches.trees(connection, viewer, TreeSearch((), sort="-created"), 1, None).items
        some = searches.parts(connection, viewer, CatalogueSearch((), sort="-created", dof_min=1), 1, None).items
        latest = job_rows.page_jobs(connection, viewer, none, None, 1)
    part = f"{some[0].name}@{some[0].version}" if some else ""
    job = latest[0].id if latest else ""
    stored = Stored(newest[0] if newest else None, part, job, _address(request))
    kept = store.caches.printed.once(stored, lambda: Answer(200, interface_page(request.app.openapi(), stored), {}))
    made = scripted(kept.body, "send.js")
    return with_scripts(answer(request, made), compiles=False)


def _rows(whole: tables.Table, path: str, query: dict[str, str], may_write: bool) -> Html:
    """The table of a sweep; what is wrong with the query is said in it."""
    try:
        return sweep_section(whole, tables.chosen(whole, query["where"], query["sort"], ()), path, query, may_write, "")
    except Refused as refused:
        return sweep_section(whole, whole, path, {}, may_write, refused.detail)
