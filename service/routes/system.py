"""Health, metrics and limits."""

from __future__ import annotations

from fastapi import Response

from service.http.requests import StoreOf, needs
from service.http.responses import response_of
from service.messages.answers import Answer, json_answer
from service.messages.refusals import Refused, not_found
from service.metrics import CONTENT_TYPE
from service.queries import folders
from service.queries.jobs.jobs import counts
from service.routes.bodies import APIRouter
from service.schemas.folder import FolderView
from service.schemas.resources import Health, LimitsView
from service.views.resources import dump
from substructures.documents import MAX_DEPTH, MAX_DIGITS
from substructures.expr.construction.exact import MAX_EXPONENT

router = APIRouter(tags=["system"])
READ = [needs("read")]
FORMAT_LIMITS = {"number_digits": MAX_DIGITS, "exponent": MAX_EXPONENT, "nesting": MAX_DEPTH}
OK = json_answer(b'{"status":"ok"}', headers={"Cache-Control": "no-store"})


@router.get("/livez", response_model=Health)
async def get_livez() -> Response:
    """The process answers; the database is not touched."""
    return response_of(OK)


@router.get("/readyz", response_model=Health)
def get_readyz(store: StoreOf) -> Response:
    """The database answers and takes changes; the catalogue was imported before the server began to listen."""
    store.database.ping()
    obstacle = store.database.obstacle()
    if obstacle:
        raise Refused(503, "database-unavailable", obstacle, headers={"Retry-After": "30"})
    return response_of(OK)


@router.get("/metrics", dependencies=READ, response_class=Response)
def get_metrics(store: StoreOf) -> Response:
    """Metrics for Prometheus."""
    with store.database.read() as connection:
        store.metrics.queue(counts(connection))
    return response_of(Answer(200, store.metrics.text(), {"Content-Type": CONTENT_TYPE}))


@router.get("/v1/limits", response_model=LimitsView, dependencies=READ)
def get_limits(store: StoreOf) -> Response:
    """Every limit with its value."""
    shown = store.settings.limits.model_dump() | FORMAT_LIMITS
    return response_of(json_answer(dump(shown)))


@router.get("/v1/folder", response_model=FolderView, dependencies=READ)
def get_folder(store: StoreOf) -> Response:
    """What was read of the folder that this server follows, and what is refused."""
    with store.database.read() as connection:
        found = folders.state(connection, store.settings)
    if found is None:
        raise not_found("this server follows no folder; 'substructures serve --folder DIR' does", "no-folder")
    return response_of(json_answer(dump(found), headers={"Cache-Control": "no-store"}))
