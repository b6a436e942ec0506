"""Pages are signed in to with a key: the cookie, its end, and what other sites cannot do with it."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select, update

from service.database.tables import api_keys, sessions
from service.http.requests import SESSION
from service.messages.refusals import Refused
from service.queries.common import now
from service.store import keys
from service.store.authorisations import TRIES, WrongKeys
from service.store.store import Store

from .conftest import PENDULUM
from .reading import Page, read
from .test_keys import new_key
from .test_pages import PAGES, PICTURES

SITES = ({"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"})


def token(store: Store, *scopes: str, days: float | None = None) -> str:
    return new_key(store, *scopes, days=days)["Authorization"].removeprefix("Bearer ")


def sign_in(client: TestClient, key: str, target: str = "/", **headers: str) -> Any:
    return client.post("/sign-in", data={"key": key, "next": target}, headers=headers, follow_redirects=False)


def test_signing_in_and_out(filled: TestClient, store: Store) -> None:
    key = token(store, "read")
    for path in PAGES:
        denied = filled.get(path)
        assert (denied.status_code, denied.headers["cache-control"]) == (401, "no-store")
        page = Page(denied.text)
        assert {("action", "/sign-in"), ("value", path), ("type", "password")} <= set(page.attributes)
        assert "pendulum" not in page.text.lower()
    answer = sign_in(filled, key, "/trees/cell")
    assert (answer.status_code, answer.headers["location"]) == (303, "/trees/cell")
    cookie = answer.headers["set-cookie"]
    for said in ("HttpOnly", "SameSite=Strict", "Path=/", "Max-Age=43200"):
        assert said in cookie
    assert key not in cookie
    for path in (*PAGES, *PICTURES, "/trees", "/jobs", "/v1/trees"):
        assert filled.get(path).status_code == 200, path
    account = read(filled, "/account")
    assert "local" in account.text
    assert ("action", "/sign-out") in account.attributes
    value = filled.cookies[SESSION]
    out = filled.post("/sign-out", follow_redirects=False)
    assert (out.status_code, "Max-Age=0" in out.headers["set-cookie"]) == (303, True)
    assert filled.get("/", headers={"Cookie": f"{SESSION}={value}"}).status_code == 401


def test_who_may_not_write_is_shown_the_command(filled: TestClient, store: Store) -> None:
    assert ("id", "file") in read(filled, "/").attributes
    sign_in(filled, token(store, "read"))
    page = read(filled, "/")
    assert ("id", "file") not in page.attributes
    assert 'substructures submit FILE --server http://localhost --key "$SUBSTRUCTURES_KEY"' in page.text
    sign_in(filled, token(store, "read", "write"))
    assert ("id", "file") in read(filled, "/").attributes


OURS = {"Sec-Fetch-Site": "same-origin", "Origin": "http://localhost"}


def test_a_session_acts_with_the_scopes_of_its_key(filled: TestClient, store: Store) -> None:
    """For scripts of our own pages; what is stored of the cookie does not let anybody in."""
    sign_in(filled, token(store, "read", "write"))
    made = filled.post("/v1/substructures", json={**PENDULUM, "name": "another"}, headers=OURS)
    assert made.status_code == 201, made.text
    assert filled.delete("/v1/trees/cell", headers=OURS).status_code == 204
    denied = filled.post("/v1/jobs", json={"kind": "verify", "items": [{"substructure": "*"}]}, headers=OURS)
    assert (denied.status_code, denied.json()["code"]) == (403, "scope-missing")
    with store.database.read() as connection:
        stored = connection.execute(select(sessions.c.id)).scalar_one()
    assert filled.get("/", headers={"Cookie": f"{SESSION}={stored}"}).status_code == 401


@pytest.mark.parametrize(
    "change",
    [
        {"Sec-Fetch-Site": "same-site"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "none"},
        {"Origin": "https://localhost.evil.example"},
        {"Origin": "null"},
        {"Origin": ""},
        {"Content-Type": "text/plain"},
        {"Content-Type": "application/x-www-form-urlencoded; charset=utf-8"},
        {"Content-Type": "multipart/form-data; boundary=x"},
    ],
)
def test_nobody_else_acts_with_a_session(filled: TestClient, store: Store, change: dict[str, str]) -> None:
    key = new_key(store, "read", "write")
    sign_in(filled, key["Authorization"].removeprefix("Bearer "))
    headers = {"Content-Type": "application/json", **OURS, **change}
    for method, path in (("POST", "/v1/trees"), ("POST", "/v1/trees/cell/evaluations"), ("DELETE", "/v1/trees/cell")):
        refused = filled.request(method, path, content=b"{}", headers=headers)
        assert (refused.status_code, refused.json()["code"]) == (403, "cross-site")
    assert filled.get("/v1/trees/cell").status_code == 200


@pytest.mark.parametrize("key", ["", "sub_x_y", "sub__", "x" * 3000, "é"])
def test_wrong_keys(filled: TestClient, store: Store, key: str) -> None:
    token(store, "read")
    answer = sign_in(filled, key, "/jobs")
    assert (answer.status_code, "set-cookie" in answer.headers) == (401, False)
    assert ("value", "/jobs") in Page(answer.text).attributes


@pytest.mark.parametrize("target", ["//evil.example", "/\\evil.example", "https://evil.example", "/a\r\nX: y", "x"])
def test_nobody_is_sent_elsewhere(filled: TestClient, store: Store, target: str) -> None:
    assert sign_in(filled, token(store, "read"), target).headers["location"] == "/"


@pytest.mark.parametrize("site", [*SITES, {"Origin": "https://evil.example"}, {"Origin": "null"}])
def test_forms_of_other_sites_are_refused(filled: TestClient, store: Store, site: dict[str, str]) -> None:
    key = token(store, "read")
    assert sign_in(filled, key, **site).status_code == 403
    assert sign_in(filled, key, Origin="http://localhost").status_code == 303
    assert filled.post("/sign-out", headers=site, follow_redirects=False).status_code == 403
    assert filled.get("/").status_code == 200


@pytest.mark.parametrize("site", SITES)
def test_other_sites_cannot_read(filled: TestClient, store: Store, site: dict[str, str]) -> None:
    key = new_key(store, "read")
    sign_in(filled, key["Authorization"].removeprefix("Bearer "))
    for path in ("/", "/v1/trees", PICTURES[0]):
        assert filled.get(path, headers=site).status_code == 403
        assert filled.get(path, headers={**site, **key}).status_code == 200  # a key is sent on purpose


def test_sessions_end_with_time_and_with_their_key(filled: TestClient, store: Store) -> None:
    key = token(store, "read", days=1)
    token(store, "read")
    sign_in(filled, key)
    assert filled.get("/").status_code == 200
    with store.database.write() as connection:
        connection.execute(update(sessions).values(expires=now(timedelta(seconds=-1))))
    assert "signed out" in Page(filled.get("/").text).text
    sign_in(filled, key)
    with store.database.write() as connection:
        keys.revoke(connection, key.split("_")[1])
    denied = filled.get("/")
    assert (denied.status_code, "revoked" in Page(denied.text).text) == (401, True)
    with store.database.write() as connection:
        keys.delete(connection, key.split("_")[1])
    assert filled.get("/").status_code == 401


def test_sessions_do_not_outlive_their_key(filled: TestClient, store: Store) -> None:
    sign_in(filled, token(store, "read", days=0.01))
    with store.database.read() as connection:
        assert (
            connection.execute(select(sessions.c.expires)).scalar_one()
            == connection.execute(select(api_keys.c.expires)).scalar_one()
        )


def test_without_keys_there_is_nothing_to_sign_in_to(filled: TestClient) -> None:
    assert "no API keys" in read(filled, "/account").text


def test_trees_beyond_the_first_page(filled: TestClient) -> None:
    for k in range(101):
        tree = {"name": f"many-{k:03d}", "gravity": [0, 0, 0], "instances": [{"name": "a", "substructure": "slider"}]}
        assert filled.post("/v1/trees", json=tree).status_code == 201
    assert "/trees" in read(filled, "/").links
    first = read(filled, "/trees")
    following = next(address for address in first.links if address.startswith("/trees?"))
    assert "/trees/many-100@1" not in first.links
    assert "/trees/many-100@1" in read(filled, following).links
    assert {each for each in read(filled, "/trees?q=MANY-05").links if "@" in each and "/v1" not in each} == {
        f"/trees/many-{k:03d}@1" for k in range(50, 60)
    }


def test_wrong_keys_meet_a_brake(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """After ten in a minute no more of the address are looked at, right or wrong, until the minute is over."""
    clock = [1000.0]
    monkeypatch.setattr("service.store.authorisations.monotonic", lambda: clock[0])
    right = token(store, "read")
    for k in range(TRIES):
        clock[0] += 1
        assert sign_in(client, f"sub_{k:012x}_wrong").status_code == 401
    for key in ("sub_000000000000_wrong", right):
        braked = sign_in(client, key)
        assert (braked.status_code, braked.headers["retry-after"]) == (429, "51")
        assert "10 wrong keys came from this address in 60 s" in braked.text
    assert client.get("/v1/trees", headers={"Authorization": f"Bearer {right}"}).status_code == 200
    clock[0] += 51
    assert sign_in(client, right).status_code == 303
    assert sign_in(client, "sub_000000000000_wrong").status_code == 401


def test_the_brake_remembers_some_addresses() -> None:
    wrong = WrongKeys(addresses=2)
    for _ in range(TRIES):
        wrong.note("first")
    with pytest.raises(Refused, match="wrong keys"):
        wrong.require_few("first")
    wrong.require_few("second")
    for address in ("second", "third"):
        wrong.note(address)
    wrong.require_few("first")
