"""``/v1/equivalences``: whether two models are the same."""

from __future__ import annotations

from fastapi import Response

from service.http.acting import ActOf, timed
from service.http.requests import JsonBody, StoreOf, needs
from service.messages.answers import Answer, json_answer
from service.operations import equivalences
from service.routes.bodies import APIRouter, body_of
from service.schemas.equivalences import EquivalenceRequest, EquivalenceView
from substructures.documents import read_model, write_json

router = APIRouter(prefix="/v1/equivalences", tags=["imports"])


@router.post(
    "", response_model=EquivalenceView, dependencies=[needs("read")], openapi_extra=body_of("EquivalenceRequest")
)
@timed("derive")
def compare_models(body: JsonBody, store: StoreOf, act: ActOf) -> Response:
    """Compare two models: by formulas, else by numbers; the culprit is named."""
    wanted = read_model(EquivalenceRequest, body)

    def work() -> Answer:
        """Couple both, and compare."""
        found = equivalences.compared(store, act.viewer, act.worker, wanted.a, wanted.b, wanted.coordinates)
        return json_answer(write_json(dict(found)))

    return act.compute(work)
