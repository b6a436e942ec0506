"""``/v1/substructures/{ref}/difference`` and ``/v1/trees/{ref}/difference``: what changed between two of them;
``/v1/substructures/{ref}/levels``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import conditional, response_of
from service.jobs.worker import Worker
from service.messages.addresses import version_path
from service.messages.answers import REVALIDATE, Answer, etag, json_answer
from service.messages.references import is_pinned
from service.operations import differences
from service.routes.bodies import APIRouter
from service.schemas.versions import DifferenceView, LevelList
from service.views.resources import dump
from service.views.versions import level_view
from substructures.documents import write_json
from substructures.interchange.difference.formulas import RANGE, STATES

router = APIRouter(prefix="/v1")
READ = [needs("read")]
To = Annotated[str, Query(min_length=1, max_length=160, description="reference to what it is compared with")]
ADVICE = "compare smaller parts, or their definitions"


@router.get("/substructures/{ref}/difference", response_model=DifferenceView, dependencies=READ, tags=["catalogue"])
async def get_substructure_difference(ref: str, to: To, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """How a version differs from another one, also of another part: fields, formulas entry by entry, and in words."""

    def answered(worker: Worker) -> Response:
        """The answer in a thread."""
        a, b = differences.versions(store, viewer, ref, to)
        is_fixed = is_pinned(ref) and is_pinned(to) and a.is_public and b.is_public
        names = f"{a.name}@{a.version}", f"{b.name}@{b.version}"
        tag = etag(a.digest, a.program, b.digest, b.program, "difference", *names)
        return conditional(request, tag, is_fixed, lambda: _answer(names, differences.of_versions(store, worker, a, b)))

    return await in_time(request, answered, ADVICE)


@router.get("/substructures/{ref}/levels", response_model=LevelList, dependencies=READ, tags=["catalogue"])
async def list_substructure_levels(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The other levels of a version, by what was made from what: full, reduced, abbreviated; with their errors."""

    def answered(worker: Worker) -> Response:
        """The answer in a thread."""
        version, found = differences.levels(store, viewer, worker, ref)
        view = {
            "items": [level_view(each) for each in found],
            "states": STATES,
            "range": RANGE,
            "links": {"self": f"{version_path(version)}/levels"},
        }
        return response_of(json_answer(dump(view), headers={"Cache-Control": REVALIDATE}))

    return await in_time(request, answered, ADVICE)


@router.get("/trees/{ref}/difference", response_model=DifferenceView, dependencies=READ, tags=["trees"])
async def get_tree_difference(ref: str, to: To, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """How a revision of a tree differs from another one, or from another tree."""

    def answered(worker: Worker) -> Response:
        """The answer in a thread."""
        a, b = differences.revisions(store, viewer, ref, to)
        is_fixed = is_pinned(ref) and is_pinned(to) and a.is_public and b.is_public
        names = f"{a.name}@{a.revision}", f"{b.name}@{b.revision}"
        tag = etag(a.digest, a.program, b.digest, b.program, "difference", *names)
        return conditional(
            request, tag, is_fixed, lambda: _answer(names, differences.of_revisions(store, worker, viewer, a, b))
        )

    return await in_time(request, answered, ADVICE)


def _answer(names: tuple[str, str], found: Mapping[str, Any]) -> Answer:
    return json_answer(write_json({"a": names[0], "b": names[1], **found}))
