"""``/v1/trees/{ref}/{quantity}`` and ``.../evaluations``: formulas and numbers of a coupled tree."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response

from service.answers import Answer, etag, json_answer
from service.arrays import as_npz
from service.negotiation import MEDIA_TYPES
from service.once import OnceOf
from service.operations import evaluations, models, trees
from service.problems import Refused
from service.requests import NPZ, RawBody, StoreOf, conditional, media_type, needs, require_json
from service.routes.bodies import binary, body_of, printed
from service.routes.deferred import ACCEPTED, deferred
from service.routes.style import StyleOf
from service.routes.trees import is_pinned
from service.schemas import EvaluationResult
from substructures.documents import read_json

router = APIRouter(prefix="/v1/trees/{ref}", tags=["models"])
READ = [needs("read")]
BODY: dict[str, Any] = body_of("EvaluationRequest", others={NPZ: binary()})
RESULT: dict[int | str, dict[str, Any]] = {200: {"content": {NPZ: binary()}}, **ACCEPTED}


@router.post("/evaluations", response_model=EvaluationResult, dependencies=READ, openapi_extra=BODY, responses=RESULT)
def evaluate(ref: str, request: Request, raw: RawBody, store: StoreOf, once: OnceOf) -> Response:
    """Numbers for one state or many. JSON or npz by Content-Type; JSON or npz by Accept."""
    limits = store.settings.limits
    with store.database.read() as connection:
        tree = trees.find(connection, ref)
        model = store.model(connection, tree)

    def work() -> Answer:
        wanted = _request(request, raw, store)
        result = {**evaluations.compute(model, wanted, limits, store.kernels), "digest": tree.digest}
        if _wants_npz(request):
            return Answer(200, as_npz(result), {"Content-Type": NPZ})
        return json_answer(evaluations.as_json(result, wanted))

    if media_type(request) == NPZ:  # arrays stay out of the queue
        return once.compute(work)
    return once.compute(
        work, lambda: deferred(once, "evaluate", {"tree": ref, "request": read_json(raw)}, "/request")()
    )


def _request(request: Request, raw: bytes, store: StoreOf) -> Any:
    if media_type(request) == NPZ:
        return evaluations.read_npz_request(raw, store.settings.limits)
    require_json(request)
    return read_json(raw)


def _wants_npz(request: Request) -> bool:
    accept = request.headers.get("accept", "*/*")
    if NPZ in accept:
        return True
    if "*" in accept or "json" in accept:
        return "json" not in accept and media_type(request) == NPZ
    raise Refused(406, "not-acceptable", f"answers are application/json or {NPZ}")


@router.get("/{quantity}", dependencies=READ, responses=printed(MEDIA_TYPES))
def get_quantity(ref: str, quantity: str, request: Request, store: StoreOf, style: StyleOf) -> Response:
    """The formulas of a quantity: metric, christoffel, forces, gravity, coriolis, kinematics, ..."""
    with store.database.read() as connection:
        tree = trees.find(connection, ref)
        model = store.model(connection, tree)
    models.check_quantity(model, quantity)
    tag = etag(tree.digest, quantity, *style.identity)

    def make() -> Answer:
        program = models.bound(models.model_quantity(model, quantity), model.parameters, style.bind)
        return models.printed(program, style, model.coordinates)

    return conditional(request, tag, is_pinned(ref), make)
