"""``/v1/bundles``: parts with their programs and certificates from one instance to another, as a zip."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Query, Request, Response

from service.content.bundles import MEDIA_TYPE, read_bundle, write_bundle
from service.content.integrity import digest_of
from service.database.connections import Connection
from service.http.acting import Commit, SpooledActOf, timed
from service.http.requests import StoreOf, ViewerOf, declared_type, needs, received
from service.http.responses import conditional
from service.messages.addresses import version_path
from service.messages.answers import Answer, etag, json_answer
from service.messages.references import is_pinned
from service.messages.refusals import Refused
from service.operations.sharing import bundles
from service.operations.sharing.bundles import Imported
from service.routes.bodies import APIRouter, binary
from service.schemas.bundles import BundleView
from service.schemas.entries import VISIBILITY, PartEntry, Visibility
from service.views.resources import dump

router = APIRouter(prefix="/v1/bundles", tags=["catalogue"])
ZIP: dict[int | str, dict[str, Any]] = {200: {"description": "The bundle", "content": {MEDIA_TYPE: binary()}}}
BODY: dict[str, Any] = {"requestBody": {"required": True, "content": {MEDIA_TYPE: binary()}}}
STORED: dict[int | str, dict[str, Any]] = {201: {"description": "Something of it was new", "model": BundleView}}


@router.get("", dependencies=[needs("read")], responses=ZIP, response_class=Response)
def get_bundle(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    refs: Annotated[str, Query(max_length=60_000, description="references of parts, separated by commas")],
) -> Response:
    """Definitions, programs and certificates of parts as they are stored; the same bytes for the same versions."""
    with store.database.read() as connection:
        versions = bundles.find(connection, viewer, refs)
    known = [text for each in versions for text in (each.digest, each.program, digest_of(each.certificate.encode()))]
    lasting = all(is_pinned(text.strip()) for text in refs.split(",")) and all(each.is_public for each in versions)

    def make() -> Answer:
        """Read and pack them."""
        with store.database.read() as connection:
            parts = (bundles.bundled(connection, version) for version in versions)
            data = write_bundle(parts, store.settings.limits.binary_bytes)
        name = f"{versions[0].name}.zip" if len(versions) == 1 else "bundle.zip"
        return Answer(200, data, {"Content-Type": MEDIA_TYPE, "Content-Disposition": f'attachment; filename="{name}"'})

    return conditional(request, etag("bundle", *known), lasting, make)


@router.post("", response_model=BundleView, dependencies=[needs("write")], openapi_extra=BODY, responses=STORED)
@timed("derive")
def import_bundle(
    request: Request,
    store: StoreOf,
    act: SpooledActOf,
    visibility: Annotated[Visibility | None, Query(description=VISIBILITY)] = None,
) -> Response:
    """Derive the parts of a bundle and store them, all or nothing. 201 when something was new, else 200."""
    if declared_type(request) != MEDIA_TYPE:
        raise Refused(
            415,
            "unsupported-media-type",
            f"send {MEDIA_TYPE}; {received(request)} was received",
            headers={"Accept": MEDIA_TYPE},
        )
    entry, limit = PartEntry(visibility=visibility), store.settings.limits.program_nodes

    def prepare() -> Commit:
        """Derive every part from its definition."""
        with act.spool.reader() as file:
            limits = store.settings.limits
            parts = read_bundle(file, limits.binary_bytes, limits.job_bytes)
        ready = []
        for part in parts:
            act.require_time()
            ready.append(bundles.prepare(store, act.viewer, part, entry, act.worker, limit))

        def commit(connection: Connection) -> Answer:
            """Store all that is new."""
            found = bundles.commit(connection, act.viewer, parts, ready)
            items = [_view(each) for each in found]
            return json_answer(dump({"items": items}), 201 if any(each.is_new for each in found) else 200)

        return commit

    return act.run(prepare)


def _view(found: Imported) -> dict[str, Any]:
    version = found.version
    told = {"name": version.name, "version": version.version, "digest": version.digest}
    outcome = {"outcome": "stored" if found.is_new else "same", "formulas": "equal" if found.is_equal else "differ"}
    return {**told, **outcome, "links": {"self": version_path(version)}}
