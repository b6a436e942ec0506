"""``/``, ``/substructures/{ref}``, ``/trees/{ref}``, ``/jobs``: for people, read with the same keys as the API."""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from service.http.requests import StoreOf, ViewerOf, needs
from service.operations import catalogue, jobs, trees
from service.operations.models import model_quantity
from service.operations.sources import sources_of
from service.pages.account import PageRoute
from service.pages.catalogue import Shown, page
from service.pages.details import part_page, tree_page
from service.pages.jobs import job_page, jobs_page
from service.pages.layout import answer
from service.pages.trees import trees_page
from service.queries import aliases
from service.queries import jobs as job_rows
from service.queries import trees as revisions
from service.queries.catalogue import CatalogueSearch
from service.queries.trees import TreeSearch
from service.settings import Settings
from service.viewer import ANYBODY
from substructures.part.outputs import with_own_inertia

CARDS, TREES, JOBS, BAD = 500, 100, 100, 50
_HOST = re.compile(r"[A-Za-z0-9.-]+(:[0-9]+)?|\[[0-9A-Fa-f:.]+\](:[0-9]+)?")

router = APIRouter(include_in_schema=False, dependencies=[needs("read")], route_class=PageRoute)


@router.get("/")
def first_page(request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The catalogue."""
    with store.database.read() as connection:
        found = catalogue.search(connection, viewer, CatalogueSearch(), CARDS, None)
        some = revisions.page(connection, viewer, TreeSearch(), None, TREES + 1)
    shown = Shown(found.versions, sum(found.facets["dof"].values()), some[:TREES], len(some) > TREES)
    with_key = viewer != ANYBODY
    return answer(request, page(shown, _address(request, store.settings), with_key))


def _address(request: Request, settings: Settings) -> str:
    """The address that the browser used, if it is one that can stand in a command line."""
    host = request.headers.get("host", "")
    return f"{request.url.scheme}://{host if _HOST.fullmatch(host) else f'{settings.host}:{settings.port}'}"


@router.get("/substructures/{ref}")
def substructure(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A part."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        names = aliases.aliases_of(connection, (version.name, version.version))[0]
        part = store.required_part(connection, version.digest)
    metric = with_own_inertia(part, part.program.select(["metric"])) if part.dof else None
    return answer(request, part_page(version, names, part, metric))


@router.get("/trees")
def all_trees(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    q: Annotated[str, Query(max_length=200)] = "",
    after: Annotated[str | None, Query(max_length=64)] = None,
) -> Response:
    """Trees by name."""
    with store.database.read() as connection:
        found = revisions.page(connection, viewer, TreeSearch(tuple(q.split())), after, TREES + 1)
    following = found[TREES - 1].name if len(found) > TREES else None
    return answer(request, trees_page(found[:TREES], q, following))


@router.get("/trees/{ref}")
def tree(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """A revision of a tree, the latest for a bare name."""
    with store.database.read() as connection:
        found = trees.find(connection, viewer, ref)
        model = store.model(connection, found)
    metric = model_quantity(sources_of(store, found, model), "metric") if found.dof else None
    return answer(request, tree_page(found, model, metric))


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
