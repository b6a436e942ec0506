"""``/v1/trees/{ref}/{quantity}`` and ``.../evaluations``: formulas and numbers of a coupled tree."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import Act, Commit, SpooledAct, SpooledActOf, in_time
from service.http.one_state import OneStateRoute
from service.http.requests import StoreOf, ViewerOf, media_type, needs
from service.http.responses import remembered
from service.http.routing import router_of
from service.jobs.worker import Worker
from service.messages.answers import JSON, Answer, Stream, etag
from service.messages.negotiation import MEDIA_TYPES
from service.messages.references import is_pinned
from service.messages.viewer import Viewer
from service.models import printing
from service.models.exporting import ExportRequest
from service.models.formulas import QUANTITIES, check_options
from service.models.formulas.entry import Options
from service.models.grouping import check_group
from service.operations import analyses, at_hand, trees
from service.operations.exchange import TreeEvaluation, choose_media_type, read_requests
from service.operations.jobs import uploads
from service.operations.sharing.sources import engine_of, part_programs, sources_of
from service.queries.trees import Tree
from service.routes.bodies import APIRouter, binary, body_of, printed
from service.routes.deferred import ACCEPTED, committed, deferred
from service.routes.options import OptionsOf
from service.routes.programs.exports import ADVICE, EXPORTED, ExportOf, export_job
from service.routes.style import StyleOf
from service.schemas.numbers import EvaluationResult
from service.store.store import Store
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrow import MEDIA_TYPE as ARROW

router = APIRouter(prefix="/v1/trees/{ref}", tags=["models"])
evaluations = router_of(OneStateRoute, prefix="/v1/trees/{ref}", tags=["models"])
GROUP = "in base parameters: symbols for what masses and lengths occur in together, with their definitions"
Group = Annotated[bool, Query(description=GROUP)]
READ = [needs("read")]
BINARY = {NPZ: binary(), ARROW: binary()}
BODY: dict[str, Any] = body_of("EvaluationRequest", others=BINARY)
RESULT: dict[int | str, dict[str, Any]] = {200: {"content": BINARY}, **ACCEPTED}


@evaluations.post(
    "/evaluations", response_model=EvaluationResult, dependencies=READ, openapi_extra=BODY, responses=RESULT
)
async def evaluate_tree(ref: str, request: Request, act: SpooledActOf) -> Response:
    """Numbers for one state or many: JSON, npz or an Arrow stream by Content-Type, and any of them back by Accept.

    npz: arrays by the names of the JSON request, nested ones joined by dots (`inputs.tau.arm.q1`, `parameters.arm.m`).

    Arrow: a row for each state; columns `q`, `qd`, `qdd` (lists of n doubles) or `q.<coordinate>`, `t`,
    `inputs.<name>`, `parameters.<name>`; in the metadata of the schema, as JSON, `quantities` and what is the same for
    all states. The stream may have any number of record batches (`stream_states`, `stream_bytes` in `/v1/limits`), each
    at most `binary_bytes`, not compressed. The answer has fixed-size lists, row-major, with the `shape` in the metadata
    of the field, null where a state has no result and the reason, as JSON, in the column `failures`; coordinates and
    digest are metadata of the schema. It begins when the first states are computed, which `sync_seconds` limits; a
    fault in a later batch cuts it off before the end-of-stream marker and without the last chunk of the body.

    An npz answer of more than 4 MiB begins when the first states are computed, too.

    With `Prefer: respond-async`, or when it takes too long, it becomes a job, acknowledged when all states are checked
    and on the disk. States are evaluated in items of at most `job_states`, whose results, npz or Arrow by Accept (npz
    for JSON), can be fetched while the job runs; what was uploaded goes with the job.
    """
    sent = media_type(request)
    wanted = choose_media_type(request.headers.get("accept", "*/*"), sent)
    return await act.within_time("evaluate", lambda: _evaluate(ref, sent, wanted, act))


def _evaluate(ref: str, sent: str, wanted: str, act: SpooledAct) -> Response:
    """The evaluation in a thread."""
    store, body, limits = act.store, act.spool, act.store.settings.limits
    with store.database.read() as connection:
        tree = trees.find(connection, act.viewer, ref)
        model = store.model(connection, tree)
    sources = sources_of(store, tree, model, act.worker)
    evaluation = TreeEvaluation(sources, tree.digest, limits, engine_of(store, tree, model))

    def work() -> Answer | Stream:
        """Read the states and evaluate."""
        requests = read_requests(body, sent, limits)
        answer = evaluation.answer(requests, wanted)
        if sent == JSON and is_pinned(ref):
            (given,) = requests
            at_hand.remember(store, tree, ref, given, evaluation)
        return answer

    def later() -> Commit:
        """The job for the same states."""
        act.require("jobs")
        requests, form = read_requests(body, sent, limits), "arrow" if wanted == ARROW else "npz"
        if sent == JSON:
            (given,) = requests
            return deferred(act, "evaluate", {"tree": ref, "request": given.given(), "format": form}, "/request")()
        submission = uploads.prepare(store, act.viewer, tree, evaluation.sources, requests, form)
        return committed(store, act.viewer, submission)

    return act.compute(work, later)


@router.get("/export", dependencies=READ, responses=EXPORTED)
async def export_tree(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, wanted: ExportOf) -> Response:
    """Functions of the tree for a target: C, MATLAB, Fortran, computer algebra, ..., on one calling convention.

    What takes longer than a request may becomes a job of kind `export`, as with `Prefer: respond-async`.
    """

    def job(act: Act) -> Commit:
        """The job that does the same. Raises Refused 404."""
        with store.database.read() as connection:
            tree = trees.find(connection, viewer, ref)
        return export_job(act, {"tree": f"{tree.name}@{tree.revision}"}, wanted)

    return await in_time(request, lambda worker: _export(ref, request, store, viewer, wanted, worker), ADVICE, job)


def _export(
    ref: str, request: Request, store: Store, viewer: Viewer, wanted: ExportRequest, worker: Worker
) -> Response:
    """The files in a thread."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    tag = etag(
        tree.digest, *_programs(store, tree, wanted.quantities), f"{tree.name}@{tree.revision}", *wanted.identity
    )
    lasting = is_pinned(ref) and tree.is_public
    return remembered(store, request, tag, lasting, lambda: analyses.tree_files(store, worker, tree, wanted))


def _programs(store: Store, tree: Tree, quantities: Iterable[str]) -> list[str]:
    """The digests of the programs that quantities are printed from."""
    return [tree.program, *(part_programs(store, tree) if any(map(printing.has_parts, quantities)) else ())]


@router.get("/{quantity}", dependencies=READ, responses=printed(MEDIA_TYPES))
async def get_tree_quantity(
    ref: str, quantity: str, request: Request, store: StoreOf, style: StyleOf, options: OptionsOf, group: Group = False
) -> Response:
    """The formulas of a quantity: metric, christoffel, forces, gravity, coriolis, kinematics, regressor, ...

    What follows from them (first_integrals, perturbation, curvature, ...) is described by further members of the JSON
    answer. What takes longer than a request may is an item of a job of kind `export`.
    """
    item = f'{{"tree": "{ref[:80]}", "quantity": "{quantity[:80]}", "format": "{style.format}", ...}}'
    advice = f"submit a job of kind 'export' with the item {item}"
    return await in_time(
        request, lambda worker: _quantity(ref, quantity, request, store, style, options, group, worker), advice
    )


def _quantity(
    ref: str,
    quantity: str,
    request: Request,
    store: Store,
    style: printing.Style,
    options: Options,
    group: bool,
    worker: Worker,
) -> Response:
    """The formulas in a thread."""
    with store.database.read() as connection:
        tree = trees.find(connection, request.state.viewer, ref)
        model = store.model(connection, tree)
    style = style.of(f"{tree.name}, revision {tree.revision}", quantity)
    if quantity not in QUANTITIES:
        printing.check_quantity(model, quantity)
    programs = _programs(store, tree, [quantity])
    chosen = [str(sorted(options.items()))]
    if group:
        check_options(quantity, options)
        check_group(quantity, style)
        programs, chosen = [tree.program, *part_programs(store, tree)], ["grouped"]
    elif quantity not in QUANTITIES:
        check_options(quantity, options, printing.options_of_quantity(quantity))
        chosen = [f"{name}={x}" for name, x in options.items()]
    tag = etag(tree.digest, *programs, quantity, *chosen, *style.identity)
    lasting = is_pinned(ref) and tree.is_public
    return remembered(
        store, request, tag, lasting, lambda: analyses.printed(store, worker, tree, quantity, style, options, group)
    )
