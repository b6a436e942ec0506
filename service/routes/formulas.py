"""``/v1/substructures/{ref}/formulas``: the stored formulas of a version."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated, Any, Literal

from fastapi import Depends, Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import conditional, remembered
from service.jobs.kinds.requested.printed import BODY
from service.jobs.worker import Worker
from service.messages.answers import Answer, etag, json_answer
from service.messages.negotiation import MEDIA_TYPES
from service.messages.references import is_pinned
from service.messages.refusals import not_found
from service.messages.viewer import Viewer
from service.models import printing
from service.operations import catalogue, models
from service.queries.searching import formulas as index
from service.routes.bodies import APIRouter, printed
from service.routes.style import StyleOf
from service.schemas.resources import FormulaIndex
from service.store.store import Store
from service.views.resources import dump, formulas_view
from substructures.errors import among, meant
from substructures.export import first_index
from substructures.part.part import INTERNAL, Part
from substructures.quantities.quantity import outputs_of

router = APIRouter(prefix="/v1/substructures/{ref}/formulas", tags=["formulas"])
READ = [needs("read")]
ADVICE = "; its index lists all"
INERTIA = "own: as the part stands alone; symbols: as stored, with the inertia of what may be mounted left open"
Filter = Annotated[str | None, Query(max_length=200)]


@router.get("", response_model=FormulaIndex, dependencies=READ)
def list_substructure_formulas(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The index of the stored formulas."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        rows = index.list_formulas(connection, version.digest)
    tag = etag(version.digest, version.program, "formulas")
    return conditional(
        request, tag, is_pinned(ref) and version.is_public, lambda: json_answer(dump(formulas_view(version, rows)))
    )


@dataclass(frozen=True, slots=True)
class Chosen:
    """Which formulas of a quantity are wanted: all, or those of one body, coordinate and component."""

    body: str | None
    coordinate: str | None
    component: str | None
    inertia: Literal["own", "symbols"]


async def chosen_of(
    body: Filter = None,
    coordinate: Filter = None,
    component: Annotated[str | None, Query(max_length=200, description="index from 0, e.g. 2 or 0,1")] = None,
    inertia: Annotated[Literal["own", "symbols"], Query(description=INERTIA)] = "own",
) -> Chosen:
    """What a request chooses."""
    return Chosen(body, coordinate, component, inertia)


@router.get("/{quantity}", dependencies=READ, responses=printed(MEDIA_TYPES))
async def get_substructure_formula(
    ref: str,
    quantity: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    style: StyleOf,
    chosen: Annotated[Chosen, Depends(chosen_of)],
) -> Response:
    """The formulas of one quantity, all or those of one body, coordinate and component."""
    advice = "ask for one body, coordinate or component, or for form=compact"
    return await in_time(
        request, lambda worker: _formula(ref, quantity, request, store, viewer, style, chosen, worker), advice
    )


def _absent(part: Part, quantity: str, chosen: Chosen) -> str:
    """What a part does not have, and what was meant or where to look."""
    known = sorted({name.partition(".")[0] for name in part.program.outputs if name not in INTERNAL})
    if not {quantity, *outputs_of(quantity)} & {*known, *part.program.outputs}:
        return f"formula of '{quantity[:80]}'{meant(quantity, known) or ADVICE}"
    places = ("body", chosen.body, (*part.bodies, *part.ports)), ("coordinate", chosen.coordinate, part.coordinates)
    for what, name, names in places:
        if name is not None and name not in names:
            return f"{what} '{name[:80]}'{among(name, names)}"
    return f"such formula of '{quantity[:80]}'{ADVICE}"


def _formula(
    ref: str,
    quantity: str,
    request: Request,
    store: Store,
    viewer: Viewer,
    style: printing.Style,
    chosen: Chosen,
    worker: Worker,
) -> Response:
    """The formulas in a thread."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        rows = index.list_formulas(connection, version.digest, outputs_of(quantity), chosen.body, chosen.coordinate)
        part = store.required_part(connection, version.digest)
    wanted = models.Wanted(quantity, chosen.body, chosen.coordinate, chosen.component)
    found = models.part_formulas(part, rows, wanted, first_index(style.format))
    if found is None:
        raise not_found(f"'{ref}' has no {_absent(part, quantity, chosen)}", "unknown-formula")
    identity = str((chosen.body, chosen.coordinate, chosen.component, chosen.inertia))
    style = style.of(f"{version.name}, version {version.version}", quantity)
    tag = etag(version.digest, version.program, quantity, identity, *style.identity)

    def make() -> Answer:
        """Bind and print."""
        content, digests = found.to_bytes(), (version.digest, version.program)
        item: dict[str, Any] = {"digest": version.digest, "program": version.program, "selected": found.digest}
        item |= {
            "quantity": quantity,
            "style": asdict(style),
            "own": chosen.inertia == "own",
            "not_judged": sorted(found.not_judged),
        }
        text = worker("print-part", item, {**store.blobs(digests), found.digest: content}).files[BODY]
        return Answer(200, text, {"Content-Type": MEDIA_TYPES[style.format]})

    return remembered(store, request, tag, is_pinned(ref) and version.is_public, make)
