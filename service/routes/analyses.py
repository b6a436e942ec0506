"""``POST /v1/trees/{ref}/simulations``, ``.../linearisations``, ...: numbers that follow from a tree."""

from __future__ import annotations

from collections.abc import Awaitable, Callable

from fastapi import Request, Response

from service.http.acting import ActOf, timed
from service.http.requests import JsonBody, StoreOf, needs
from service.messages.negotiation import MEDIA_TYPES as PRINTED
from service.messages.negotiation import choose_media_type
from service.models.numbers import OFFERED, Offered
from service.models.results import JSON
from service.operations.analyses import FORMATS, analyse, velocity_equations
from service.routes.bodies import APIRouter, binary, body_of, printed
from service.routes.deferred import ACCEPTED, deferred
from service.routes.style import StyleOf
from service.schemas.numbers import AnalysisResult

router = APIRouter(prefix="/v1/trees/{ref}", tags=["analyses"])
READ = [needs("read")]


def _endpoint(name: str, analysis: Offered) -> Callable[..., Awaitable[Response]]:
    @timed("analyse")
    def _run(ref: str, request: Request, body: JsonBody, store: StoreOf, act: ActOf) -> Response:
        media = choose_media_type(request.headers.get("accept", "*/*"), analysis.media)
        item = {"tree": ref, "analysis": name, "request": body, "format": FORMATS[media]}
        later = deferred(act, "analyse", item, "/request")
        return act.compute(lambda: analyse(store, act.viewer, act.worker, ref, name, body, media), later)

    return _run


def _add(name: str, analysis: Offered) -> None:
    others = {media: binary() for media in analysis.media if media != JSON}
    router.add_api_route(
        f"/{name}",
        _endpoint(name, analysis),
        methods=["POST"],
        name=f"compute_{name.replace('-', '_')}",
        summary=analysis.text,
        response_model=AnalysisResult,
        dependencies=READ,
        openapi_extra=body_of(analysis.schema),
        responses={200: {"content": others}, **ACCEPTED},
    )


for _name, _analysis in OFFERED.items():
    _add(_name, _analysis)


@router.post(
    "/velocity-equations",
    dependencies=READ,
    openapi_extra=body_of("VelocityConstraints"),
    responses={**printed(PRINTED), **ACCEPTED},
)
@timed("analyse")
def compute_velocity_equations(ref: str, body: JsonBody, store: StoreOf, act: ActOf, style: StyleOf) -> Response:
    """Voronets' and Boltzmann-Hamel equations with velocity constraints (rolling, knife edges, closures) as formulas.

    Formats as those of the quantities of a tree; the JSON answer names velocities, constraints and gaps.
    """
    how = {"format": style.format, "form": style.form, "bind": style.bind, "name": style.name}
    item = {"tree": ref, "quantity": "velocity-equations", "request": body, **how}
    later = deferred(act, "export", item, "/request")
    return act.compute(lambda: velocity_equations(store, act.viewer, act.worker, ref, body, style), later)
