"""``/v1/audit``: who did what."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query, Request, Response

from service.http.requests import StoreOf, needs
from service.http.responses import link_header, next_link, response_of
from service.messages.answers import json_answer
from service.messages.paging import limited, read_token, write_token
from service.queries import audit
from service.routes.bodies import APIRouter
from service.schemas.resources import AuditPage
from service.views.resources import audit_view, dump

router = APIRouter(prefix="/v1/audit", tags=["system"], dependencies=[needs("admin")])
Filter = Annotated[str | None, Query(max_length=200)]


@router.get("", response_model=AuditPage)
def list_audit_entries(
    request: Request,
    store: StoreOf,
    owner: Filter = None,
    key: Filter = None,
    action: Filter = None,
    subject: Filter = None,
    page_size: Annotated[int, Query(ge=1)] = 50,
    page_token: Annotated[str | None, Query(max_length=2000)] = None,
) -> Response:
    """A page of acts, the latest first: submissions, aliases, withdrawals, trees, jobs, keys, sessions."""
    given = {"owner": owner, "key": key, "action": action, "subject": subject}
    wanted = {name: value for name, value in given.items() if value is not None}
    size, search = limited(page_size, store.settings.limits.page_size), ("audit", sorted(wanted.items()))
    before = read_token(search, page_token, int)
    with store.database.read() as connection:
        found = audit.page(connection, wanted, before[0] if before else None, size + 1)
    token = write_token(search, found[size - 1].seq) if len(found) > size else None
    link = next_link(request, token)
    view = {"items": list(map(audit_view, found[:size])), "next_page_token": token, "links": {"next": link}}
    return response_of(json_answer(dump(view), headers={"Cache-Control": "no-store", **link_header(link)}))
