"""``/v1/imports``: robot files as definitions, with a report; stored on request."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.content import bundles
from service.database.connections import Connection
from service.http.acting import ActOf, timed
from service.http.requests import RawBody, StoreOf, check_preconditions, declared_type, needs, received
from service.jobs.files import Wanted, read
from service.jobs.kinds.assemble import NAMED
from service.messages.addresses import tree_path, version_path
from service.messages.answers import Answer, json_answer
from service.messages.refusals import Refused
from service.operations import catalogue, imports
from service.operations.sharing.provenance import IMPORTED
from service.routes.bodies import APIRouter, binary
from service.routes.deferred import ACCEPTED, deferred
from service.schemas.entries import VISIBILITY, PartEntry, Visibility
from service.schemas.imports import ImportView
from substructures.interchange.files.wanted import KINDS, Base, Fixed, Options, Parameters, Rotations
from substructures.part.definition import Definition

router = APIRouter(prefix="/v1/imports", tags=["imports"])
#: media types that no HTML form of another site can send
MEDIA_TYPES = (
    *("application/xml", "text/xml", "application/json", "text/csv", "application/octet-stream"),
    bundles.MEDIA_TYPE,
)
MADE: dict[int | str, dict[str, Any]] = {201: {"description": "It was stored", "model": ImportView}, **ACCEPTED}
BODY: dict[str, Any] = {"requestBody": {"required": True, "content": {m: binary() for m in MEDIA_TYPES}}}


@router.post("", response_model=ImportView, dependencies=[needs("read")], openapi_extra=BODY, responses=MADE)
@timed("derive")
def import_file(
    request: Request,
    body: RawBody,
    store: StoreOf,
    act: ActOf,
    kind: Annotated[str | None, Query(description=f"what the file has to be: {', '.join(KINDS)}")] = None,
    name: Annotated[str | None, Query(max_length=64, description="name of the part")] = None,
    file: Annotated[
        str, Query(max_length=200, description="name of the file, kept as its source; in a zip the robot file")
    ] = "",
    license: Annotated[str, Query(max_length=200, description="licence of the file")] = "",  # noqa: A002 -- its name
    parameters: Parameters = "inertia",
    fixed: Fixed = "ports",
    base: Base = "fixed",
    rotations: Annotated[
        Rotations, Query(description="of ball and free joints: yaw, pitch, roll, or without singular angles")
    ] = "angles",
    cut: Annotated[
        str, Query(max_length=20_000, description="links, separated by commas: each begins a part of its own")
    ] = "",
    preview: Annotated[bool, Query(description="derive it, too, and draw it: nothing is stored")] = False,
    stored: Annotated[bool, Query(alias="store", description="derive, verify and store what was read")] = False,
    visibility: Annotated[Visibility | None, Query(description=f"of what is stored: {VISIBILITY}")] = None,
) -> Response:
    """Read a robot file as a definition; in a zip with the files that it includes and takes meshes from. 200 with the
    report; with `store=true` 201 and what was stored."""
    if declared_type(request) not in MEDIA_TYPES:
        accepted = ", ".join(MEDIA_TYPES)
        detail = f"send one of {accepted}; {received(request)} was received"
        raise Refused(415, "unsupported-media-type", detail, headers={"Accept": accepted})
    links = tuple(text.strip() for text in cut.split(",") if text.strip())
    wanted = Wanted(Options(parameters, fixed, base, rotations), kind, name, file, license, links)
    if not stored:
        return act.compute(lambda: json_answer(imports.answer_of(_read(store, act, body, wanted, preview))))
    act.require("write")
    check_preconditions(request)
    found = act.first(lambda: read(act.worker, body, wanted, store.settings.limits.binary_bytes))
    entry = PartEntry(visibility=visibility)
    return _tree(store, act, found, entry) if "tree" in found else _part(store, act, found, entry)


def _read(store: StoreOf, act: ActOf, body: bytes, wanted: Wanted, preview: bool) -> Mapping[str, Any]:
    found = read(act.worker, body, wanted, store.settings.limits.binary_bytes)
    return imports.with_preview(store, act.worker, found) if preview else found


def _part(store: StoreOf, act: ActOf, found: Mapping[str, Any], entry: PartEntry) -> Response:
    """Derived and stored as a substructure, at once or by a job."""
    definition = Definition.read(found["definition"])

    def prepare() -> Any:
        """Derive, unless that is stored already."""
        make = partial(catalogue.derived, act.worker, definition, store.work_limits)
        submission = catalogue.prepare(store, act.viewer, definition, entry, IMPORTED, make)

        def commit(connection: Connection) -> Answer:
            """Store the version and tell of it."""
            version, is_new = catalogue.submit(connection, act.viewer, submission)
            told = {"name": version.name, "version": version.version, "digest": version.digest}
            told |= {"href": version_path(version)}
            body = imports.answer_of(found, told)
            return json_answer(body, 201 if is_new else 200, {"Location": version_path(version)})

        return commit

    document = {**found["definition"], **_said(entry)}
    return act.run(prepare, deferred(act, "derive", document, members=IMPORTED.members()))


def _tree(store: StoreOf, act: ActOf, found: Mapping[str, Any], entry: PartEntry) -> Response:
    """Its parts stored as substructures, coupled and stored as a tree, at once or by a job."""

    def prepare() -> Any:
        """Derive the parts and couple them."""
        ready = imports.prepare(store, act.viewer, act.worker, found["tree"], entry)

        def commit(connection: Connection) -> Answer:
            """Store the parts and the revision, and tell of it."""
            tree, is_new = imports.commit(connection, act.viewer, ready)
            told = {"name": tree.name, "version": tree.revision, "digest": tree.digest, "href": tree_path(tree)}
            return json_answer(imports.answer_of(found, told), 201 if is_new else 200, {"Location": tree_path(tree)})

        return commit

    return act.run(prepare, deferred(act, "assemble", {**found["tree"], **_said(entry)}, members={NAMED: True}))


def _said(entry: PartEntry) -> dict[str, Any]:
    """The members of a document that say the same."""
    return entry.model_dump(exclude_none=True)
