"""``/v1/substructures``: submit, find, search and withdraw versions."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any

from fastapi import Header, Query, Request, Response

from service.content.integrity import missing
from service.database.connections import Connection
from service.http.acting import ActOf, Commit, timed
from service.http.requests import JsonBody, OptionalJsonBody, StoreOf, ViewerOf, needs
from service.http.responses import conditional, link_header, next_link, response_of
from service.messages.addresses import version_path
from service.messages.answers import Answer, etag, json_answer
from service.messages.paging import limited
from service.messages.references import is_pinned
from service.operations import catalogue, searches
from service.operations.preconditions import Expected, require_part, tag_of, version_tag
from service.queries import aliases, content, uses
from service.queries.searching.part_search import CatalogueSearch
from service.queries.searching.words import words_of
from service.routes.bodies import APIRouter, body_of, content_of
from service.routes.deferred import deferred, made
from service.routes.filters import NarrowOf, PortName
from service.schemas.entries import PartEntry
from service.schemas.resources import VersionPage, VersionView, WithdrawalRequest
from service.views.resources import dump, page_view, version_view
from service.views.whole_version import names_of, whole_view
from substructures.documents import read_model
from substructures.part.definition import Definition

router = APIRouter(prefix="/v1/substructures", tags=["catalogue"])
READ, WRITE = [needs("read")], [needs("write")]
DEFINITION: dict[str, Any] = body_of("SubmittedDefinition")


@router.post(
    "",
    status_code=201,
    response_model=VersionView,
    dependencies=WRITE,
    openapi_extra=DEFINITION,
    responses=made(VersionView),
)
@timed("derive")
def submit_substructure(
    body: JsonBody,
    store: StoreOf,
    act: ActOf,
    if_match: Annotated[str | None, Header(description="ETag of the version whose next one this is")] = None,
    if_none_match: Annotated[str | None, Header(description="*: only where there is no part of this name")] = None,
) -> Response:
    """Derive, verify and store a definition. 201 with the new version, 200 when nothing changed."""
    entry, document = PartEntry.parted(body)
    definition = Definition.read(document)
    expected = Expected(if_match, if_none_match)

    def prepare() -> Any:
        """Derive, unless that is stored already."""
        make = partial(catalogue.derived, act.worker, definition, store.work_limits)
        submission = catalogue.prepare(store, act.viewer, definition, entry, make=make, expected=expected)

        def commit(connection: Connection) -> Answer:
            """Store the version and answer it."""
            version, is_new = catalogue.submit(connection, act.viewer, submission)
            view = whole_view(connection, act.viewer, version)
            headers = {"Location": version_path(version), "ETag": tag_of(connection, act.viewer, version)}
            return json_answer(dump(view), 201 if is_new else 200, headers)

        return commit

    def later() -> Commit:
        """The job that stores the same."""
        with store.database.read() as connection:
            require_part(connection, act.viewer, definition.name, expected)
        return deferred(act, "derive", body, members=expected.members())()

    return act.run(prepare, later)


@router.get("", response_model=VersionPage, dependencies=READ)
def list_substructures(
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    narrow: NarrowOf,
    q: Annotated[str, Query(max_length=200, description="words in name, title, description and tags")] = "",
    tag: Annotated[list[str], Query(max_length=10)] = [],  # noqa: B006 -- read only
    port: Annotated[list[PortName], Query(max_length=10, description="name of a port")] = [],  # noqa: B006 -- read only
    source: Annotated[str, Query(max_length=200, description="words in the source")] = "",
    facets: Annotated[bool, Query(description="also count tags, joints and degrees of freedom of all found")] = False,
    page_size: Annotated[int, Query(ge=1)] = 50,
    page_token: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """A page of the latest versions. Words that are nowhere are taken for the most similar ones, told in `instead`."""
    chosen = CatalogueSearch(words_of(q), **narrow, tags=tuple(tag), ports=tuple(port), source=words_of(source))
    wanted, size = searches.checked(chosen), limited(page_size, store.settings.limits.page_size)
    with store.database.read() as connection:
        page = searches.parts(connection, viewer, wanted, size, page_token, store.caches.facets if facets else None)
        names = aliases.aliases_of(connection, *((version.name, version.version) for version in page.items))
    link = next_link(request, page.next_token)
    return response_of(json_answer(dump(page_view(page, names, link)), headers=link_header(link)))


@router.get("/{ref}", response_model=VersionView, dependencies=READ)
def get_substructure(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """One version. Aliases and withdrawal may change, so clients revalidate by ETag."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        names = names_of(connection, version)
        gone = uses.withdrawn_in_part(connection, viewer, version.digest)
    tag = version_tag(version, names, gone)
    return conditional(request, tag, False, lambda: json_answer(dump(version_view(version, names, gone))))


@router.get("/{ref}/definition", dependencies=READ, responses=content_of("Definition"))
def get_substructure_definition(ref: str, request: Request, store: StoreOf, viewer: ViewerOf) -> Response:
    """The definition as stored."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
        definition = content.get_definition(connection, version.digest)
    if definition is None:
        raise missing(f"the definition of {version.name}@{version.version}", version.digest)
    tag = etag(version.digest, "definition")
    return conditional(request, tag, is_pinned(ref) and version.is_public, lambda: json_answer(definition))


@router.post(
    "/{ref}/withdraw", response_model=VersionView, dependencies=WRITE, openapi_extra=body_of("WithdrawalRequest", False)
)
def withdraw_substructure(
    ref: str,
    body: OptionalJsonBody,
    act: ActOf,
    if_match: Annotated[str | None, Header(description="ETag of the version that is to be withdrawn")] = None,
) -> Response:
    """Withdraw a version: it stays usable by number and digest but is no longer offered as the latest."""
    wanted = read_model(WithdrawalRequest, body)

    def commit(connection: Connection) -> Answer:
        """Withdraw the version and answer it."""
        version = catalogue.withdraw(connection, act.viewer, ref, wanted.reason, wanted.successor, if_match)
        headers = {"ETag": tag_of(connection, act.viewer, version)}
        return json_answer(dump(whole_view(connection, act.viewer, version)), headers=headers)

    return act.submit(lambda: commit)
