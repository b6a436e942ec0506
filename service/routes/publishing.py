"""``POST /v1/trees/{ref}/publish``: a tree becomes a part."""

from __future__ import annotations

from fastapi import Response

from service.database.connections import Connection
from service.http.acting import ActOf, Commit, timed
from service.http.requests import OptionalJsonBody, StoreOf, needs
from service.messages.addresses import version_path
from service.messages.answers import Answer, json_answer
from service.operations import catalogue, publishing
from service.routes.bodies import APIRouter, body_of
from service.routes.deferred import deferred, made
from service.schemas.publishing import PublishedView, PublishRequest
from service.views.resources import dump
from service.views.whole_version import whole_view
from substructures.documents import read_model

router = APIRouter(prefix="/v1/trees", tags=["trees"])


@router.post(
    "/{ref}/publish",
    status_code=201,
    response_model=PublishedView,
    dependencies=[needs("write")],
    openapi_extra=body_of("PublishRequest", False),
    responses=made(PublishedView),
)
@timed("derive")
def publish_tree(ref: str, body: OptionalJsonBody, store: StoreOf, act: ActOf) -> Response:
    """Make a part of a tree, with its ports and free parameters and a certificate of its own."""
    read_model(PublishRequest, body)  # whatever becomes of it

    def prepare() -> Commit:
        """Verify, unless that is stored already."""
        found = publishing.module(store, act.viewer, ref, body)
        submission = publishing.prepare(store, act.viewer, act.worker, found)

        def commit(connection: Connection) -> Answer:
            """Store the version and answer it."""
            version, is_new = catalogue.submit(connection, act.viewer, submission)
            view = whole_view(connection, act.viewer, version) | {"names": dict(found.found.names)}
            return json_answer(dump(view), 201 if is_new else 200, {"Location": version_path(version)})

        return commit

    def later() -> Commit:
        """The job that stores the same."""
        found = publishing.module(store, act.viewer, ref, body)
        return deferred(act, "derive", found.document(), members=found.origin.members())()

    return act.run(prepare, later)
