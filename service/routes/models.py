"""``/v1/trees/{ref}/{quantity}`` and ``.../evaluations``: formulas and numbers of a coupled tree."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter, Request, Response

from service.answers import Answer, etag
from service.arrays import MEDIA_TYPE as NPZ
from service.arrow import MEDIA_TYPE as ARROW
from service.negotiation import MEDIA_TYPES
from service.once import OnceSpooled
from service.operations import models, trees
from service.operations.exchange import Evaluation, choose_media_type, read_requests
from service.requests import SpooledBody, StoreOf, conditional, media_type, needs
from service.routes.bodies import binary, body_of, printed
from service.routes.style import StyleOf
from service.routes.trees import is_pinned
from service.schemas import EvaluationResult

router = APIRouter(prefix="/v1/trees/{ref}", tags=["models"])
READ = [needs("read")]
BINARY = {NPZ: binary(), ARROW: binary()}
BODY: dict[str, Any] = body_of("EvaluationRequest", others=BINARY)
RESULT: dict[int | str, dict[str, Any]] = {200: {"content": BINARY}}


@router.post("/evaluations", response_model=EvaluationResult, dependencies=READ, openapi_extra=BODY, responses=RESULT)
def evaluate(ref: str, request: Request, body: SpooledBody, store: StoreOf, once: OnceSpooled) -> Response:
    """Numbers for one state or many: JSON, npz or an Arrow stream by Content-Type, and any of them back by Accept.

    Arrow is evaluated batch by batch, and may have any number of them.
    """
    sent = media_type(request)
    wanted = choose_media_type(request.headers.get("accept", "*/*"), sent)
    with store.database.read() as connection:
        tree = trees.find(connection, ref)
        model = store.model(connection, tree)
    evaluation = Evaluation(model, tree.digest, store.settings.limits, store.kernels)
    return once.compute(lambda: evaluation.answer(read_requests(body, sent, store.settings.limits), wanted))


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
