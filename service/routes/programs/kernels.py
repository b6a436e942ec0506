"""``/v1/trees/{ref}/kernels``: compile on request what would otherwise be compiled in the background."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter

from fastapi import Response

from service.http.acting import ActOf, timed
from service.http.requests import JsonBody, StoreOf, needs
from service.messages.answers import Answer, json_answer
from service.operations import trees
from service.operations.sharing.sources import sources_of
from service.routes.bodies import APIRouter, body_of
from service.schemas.numbers import EvaluationRequest, KernelsView
from service.views.resources import dump
from substructures.quantities.sources import read_quantities, steps

router = APIRouter(prefix="/v1/trees/{ref}/kernels", tags=["models"])


@router.post(
    "",
    status_code=201,
    response_model=KernelsView,
    dependencies=[needs("read")],
    openapi_extra=body_of("KernelsRequest"),
)
@timed("evaluate")
def compile_tree_kernels(ref: str, body: JsonBody, store: StoreOf, act: ActOf) -> Response:
    """Compile a tree for evaluations of these quantities together. 201 when something was compiled, else 200.

    Without this a tree is compiled in the background after its first evaluation, and at once for many states.
    """
    with store.database.read() as connection:
        tree = trees.find(connection, act.viewer, ref)
        model = store.model(connection, tree)

    def work() -> Answer:
        """Compile what the quantities come from."""
        quantities = read_quantities(EvaluationRequest.read(body).quantities)  # also the body of an evaluation
        rows = []
        sources = replace(sources_of(store, tree, model, act.worker), numbers=None)
        for source, program, names in steps(sources, quantities):
            if program is not None:
                start = perf_counter()
                kernel, is_new = store.kernels.compiled(program, names)
                described = {"program": source, "outputs": names, "operations": program.count(names)["total"]}
                times = {"new": is_new, "machine_code": kernel.compiled, "seconds": perf_counter() - start}
                rows.append(described | times)
        status = 201 if any(row["new"] for row in rows) else 200
        return json_answer(dump({"digest": tree.digest, "kernels": rows}), status)

    return act.compute(work)
