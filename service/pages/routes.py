"""``/``, ``/substructures/{ref}``, ``/trees/{ref}``, ``/jobs``: for people, read with the same keys as the API."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.jobs.worker import Worker
from service.operations import catalogue, differences, jobs, searches, trees
from service.operations.sources import sources_of
from service.pages.account import PageRoute
from service.pages.catalogue import Shown, page
from service.pages.details import metric_section, part_page, tree_page
from service.pages.jobs import job_page, jobs_page
from service.pages.layout import answer
from service.pages.trees import trees_page
from service.pages.versions import (
    SHOWN,
    difference_page,
    revisions_section,
    uses_section,
    versions_section,
    withdrawn_section,
)
from service.queries import aliases, part_search, uses, versions
from service.queries import jobs as job_rows
from service.queries.part_search import CatalogueSearch
from service.queries.search import RELEVANCE
from service.queries.tree_search import TreeSearch
from service.queries.words import words_of
from service.viewer import ANYBODY
from substructures.part.outputs import with_own_inertia

To = Annotated[str, Query(min_length=1, max_length=160)]
ADVICE = "compare smaller ones"
CARDS, TREES, JOBS, BAD = 60, 100, 100, 50

router = APIRouter(include_in_schema=False, dependencies=[needs("read")], route_class=PageRoute)


@router.get("/")
def first_page(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    q: Annotated[str, Query(max_length=200)] = "",
    after: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """The catalogue."""
    wanted = CatalogueSearch(words_of(q), sort=RELEVANCE)
    with store.database.read() as connection:
        found = searches.parts(connection, viewer, wanted, CARDS, after)
        total = part_search.count(connection, viewer)
        some = searches.trees(connection, viewer, TreeSearch(), TREES, None)
    shown = Shown(found, q, total, some.items, some.next_token is not None)
    with_key = viewer != ANYBODY
    return answer(request, page(shown, _address(request), with_key))


def _address(request: Request) -> str:
    """The address that the browser used."""
    return f"{request.url.scheme}://{request.headers['host']}"


@router.get("/substructures/{ref}")
def substructure(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A part."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        names = aliases.aliases_of(connection, (version.name, version.version))[0]
        part = store.required_part(connection, version.digest)
        gone = uses.withdrawn_in_part(connection, viewer, version.digest)
        all_of_it = versions.page_versions(connection, viewer, version.name, None, SHOWN + 1)
        used = uses.page(connection, viewer, version.name, version.version, None, SHOWN + 1)
    reference = f"{version.name}@{version.version}"
    notes = withdrawn_section(gone), [*versions_section(all_of_it), *uses_section(used, reference)]
    metric = metric_section(
        version, lambda: with_own_inertia(part, part.program.select(["metric"])), store.caches.sections
    )
    return answer(request, part_page(version, names, part, metric, notes))


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
    after: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """Trees by relevance, or by name."""
    wanted = TreeSearch(words_of(q), sort=RELEVANCE)
    with store.database.read() as connection:
        found = searches.trees(connection, viewer, wanted, TREES, after)
    return answer(request, trees_page(found, q))


@router.get("/trees/{ref}")
def tree(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A revision of a tree, the latest for a bare name."""
    with store.database.read() as connection:
        found = trees.find(connection, viewer, ref)
        model = store.model(connection, found)
        gone = trees.withdrawn(connection, viewer, found)
        all_of_it = versions.page_revisions(connection, viewer, found.name, None, SHOWN + 1)
    metric = metric_section(found, lambda: sources_of(store, found, model).formulas("metric"), store.caches.sections)
    return answer(request, tree_page(found, model, metric, (withdrawn_section(gone), revisions_section(all_of_it))))


@router.get("/jobs")
def all_jobs(request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The latest jobs."""
    with store.database.read() as connection:
        found = job_rows.page_jobs(connection, viewer, None, None, None, JOBS + 1)
        progress = [jobs.progress(connection, job) for job in found[:JOBS]]
    return answer(request, jobs_page(found[:JOBS], progress, len(found) > JOBS))


@router.get("/jobs/{job}")
def one_job(job: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A job with its progress."""
    with store.database.read() as connection:
        found = jobs.find(connection, viewer, job)
        bad = job_rows.page_items(connection, job, "failed", -1, BAD + 1)
        progress = jobs.progress(connection, found)
    return answer(request, job_page(found, progress, bad[:BAD], len(bad) > BAD))
