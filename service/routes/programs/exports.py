"""How exports are asked for, and ``/v1/substructures/{ref}/export``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any, Literal

from fastapi import Depends, Query, Request, Response

from service.http.acting import Act, Commit, in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import remembered
from service.jobs.worker import Worker
from service.messages.answers import etag
from service.messages.references import is_pinned
from service.messages.viewer import Viewer
from service.models.exporting import ALL_TARGETS, ZIP, ExportRequest
from service.operations import analyses, catalogue
from service.operations.jobs import jobs
from service.routes.bodies import APIRouter, binary
from service.routes.deferred import ACCEPTED, committed
from service.store.store import Store
from substructures.errors import InvalidInput

router = APIRouter(prefix="/v1/substructures/{ref}", tags=["formulas"])
READ = [needs("read")]
RANGES = "of precision=single: name:lowest:highest,... of elements of arguments, or q, qd, u, ..., in SI units"
ADVICE = "name fewer quantities, or ask with a key that may submit jobs"
EXPORTED: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The file, or a zip of several",
        "content": {
            ZIP: binary(),
            **{media: {"schema": {"type": "string"}} for media in ("text/plain", "application/xml")},
        },
    },
    **ACCEPTED,
}


async def export_of(
    target: Annotated[str, Query(max_length=40, json_schema_extra={"enum": list(ALL_TARGETS)})],
    quantities: Annotated[
        str, Query(max_length=5_000, description="names, ...; default metric, christoffel, forces")
    ] = "",
    name: Annotated[str, Query(max_length=80, description="prefix of functions; default the name of the tree")] = "",
    bind: Annotated[str, Query(max_length=50_000, description="name:value,... or defaults")] = "",
    together: Annotated[bool, Query(description="also a function with all quantities, NAME_all")] = False,
    packed: Annotated[bool, Query(description="of metric and christoffel the independent elements alone")] = False,
    fmi: Annotated[Literal["3.0", "2.0"], Query(description="of target=fmu: version of the interface")] = "3.0",
    precision: Annotated[Literal["double", "single"], Query(description="of target=c")] = "double",
    ranges: Annotated[str, Query(max_length=50_000, description=RANGES)] = "",
    stages: Annotated[bool, Query(description="of target=c: NAME_prepare(p, w), once per set of parameters")] = False,
    standard: Annotated[Literal["c99", "c89"], Query(description="of target=c")] = "c99",
    independent: Annotated[
        str, Query(max_length=5_000, description="coordinates in whose velocities constrained motions are, ...")
    ] = "",
) -> ExportRequest:
    """The export that a request asks for."""
    names = tuple(text.strip() for text in quantities.split(",") if text.strip())
    chosen = tuple(text.strip() for text in independent.split(",") if text.strip())
    return ExportRequest(target, names, name, bind, together, packed, fmi, precision, ranges, stages, standard, chosen)


ExportOf = Annotated[ExportRequest, Depends(export_of)]


@router.get("/export", dependencies=READ, responses=EXPORTED)
async def export_substructure(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, wanted: ExportOf
) -> Response:
    """Functions of the part as it stands alone for a target, on one calling convention.

    What takes longer than a request may becomes a job of kind `export`, as with `Prefer: respond-async`.
    """

    def job(act: Act) -> Commit:
        """The job that does the same. Raises Refused 404."""
        with store.database.read() as connection:
            version = catalogue.find(connection, viewer, ref)
        return export_job(act, {"substructure": f"{version.name}@{version.version}"}, wanted)

    return await in_time(request, lambda worker: _export(ref, request, store, viewer, wanted, worker), ADVICE, job)


def export_job(act: Act, of: Mapping[str, str], wanted: ExportRequest) -> Commit:
    """Prepare the job that exports the same. Raises InvalidInput with pointers into the query."""
    item = {**of, **asdict(wanted), "quantities": list(wanted.quantities), "independent": list(wanted.independent)}
    act.require("jobs")
    try:
        submission = jobs.prepare_one(act.store, act.viewer, "export", item)
    except InvalidInput as error:
        raise error.below("/query") from None
    return committed(act.store, act.viewer, submission, is_asked=True)


def _export(
    ref: str, request: Request, store: Store, viewer: Viewer, wanted: ExportRequest, worker: Worker
) -> Response:
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
    lasting, reference = is_pinned(ref) and version.is_public, f"{version.name}@{version.version}"
    tag = etag(version.digest, version.program, reference, *wanted.identity)
    return remembered(store, request, tag, lasting, lambda: analyses.part_files(store, worker, version, wanted))
