"""``.../program.wasm``, ``.../program.json``, ``.../origins``: what a browser computes a tree or a part with, and what
the entries of its formulas come from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.responses import conditional
from service.jobs.worker import Worker
from service.messages.answers import JSON, Answer, etag
from service.operations import modules
from service.operations.modules import Subject
from service.routes.bodies import APIRouter, binary
from service.schemas.modules import OriginsView, ProgramView

WASM = "application/wasm"
ADVICE = "name fewer quantities"
NAMES = "names, ...; default metric, christoffel, of a tree forces, position, rotation"
Names = Annotated[str, Query(max_length=5_000, description=NAMES)]
MODULE: dict[int | str, dict[str, Any]] = {
    200: {"description": "A module of WebAssembly; program.json says how it is called", "content": {WASM: binary()}}
}

router = APIRouter(prefix="/v1", tags=["models"], dependencies=[needs("read")])


@router.get("/trees/{ref}/program.wasm", response_class=Response, responses=MODULE)
async def get_tree_module(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, quantities: Names = ""
) -> Response:
    """Quantities of a tree as a module of WebAssembly."""
    return await _program(request, lambda: modules.of_tree(store, viewer, ref), quantities, "wasm")


@router.get("/trees/{ref}/program.json", response_model=ProgramView)
async def get_tree_layout(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, quantities: Names = ""
) -> Response:
    """What stands where in the memory of `program.wasm`, and how its functions are called."""
    return await _program(request, lambda: modules.of_tree(store, viewer, ref), quantities, "json")


@router.get("/trees/{ref}/origins", response_model=OriginsView)
async def get_tree_origins(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The bodies and symbols that every entry of metric, Christoffel symbols and forces comes from."""
    return await _origins(request, lambda: modules.of_tree(store, viewer, ref, has_parts=True))


@router.get("/substructures/{ref}/program.wasm", response_class=Response, responses=MODULE)
async def get_substructure_module(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, quantities: Names = ""
) -> Response:
    """Quantities of a part, as it stands alone, as a module of WebAssembly."""
    return await _program(request, lambda: modules.of_part(store, viewer, ref), quantities, "wasm")


@router.get("/substructures/{ref}/program.json", response_model=ProgramView)
async def get_substructure_layout(
    ref: str, request: Request, store: StoreOf, viewer: ViewerOf, quantities: Names = ""
) -> Response:
    """What stands where in the memory of `program.wasm`, and how its functions are called."""
    return await _program(request, lambda: modules.of_part(store, viewer, ref), quantities, "json")


@router.get("/substructures/{ref}/origins", response_model=OriginsView)
async def get_substructure_origins(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The bodies and symbols that every entry of metric, Christoffel symbols and gravity comes from."""
    return await _origins(request, lambda: modules.of_part(store, viewer, ref))


async def _program(request: Request, find: Callable[[], Subject], quantities: str, file: str) -> Response:
    names = [name.strip() for name in quantities.split(",") if name.strip()]

    def answer(worker: Worker) -> Response:
        """In a thread."""
        subject = find()
        tag = etag(subject.digest, subject.program, subject.reference, "module", file, *names)

        def make() -> Answer:
            """Both files are made, and kept, together."""
            body = modules.program(subject, worker, names)[file]
            return Answer(200, body, {"Content-Type": WASM if file == "wasm" else JSON})

        return conditional(request, tag, subject.is_lasting, make)

    return await in_time(request, answer, ADVICE)


async def _origins(request: Request, find: Callable[[], Subject]) -> Response:
    def answer(worker: Worker) -> Response:
        """In a thread."""
        subject = find()
        tag = etag(subject.digest, subject.program, "origins")
        headers = {"Content-Type": JSON}
        return conditional(
            request, tag, subject.is_lasting, lambda: Answer(200, modules.origins(subject, worker), headers)
        )

    return await in_time(request, answer, ADVICE)
