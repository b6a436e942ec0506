"""API keys, scopes, expiry, and the refusal to be open to others."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from service.database.tables import api_keys
from service.messages.viewer import ANYBODY
from service.queries.common import now
from service.queries.keys import list_keys, revoke_key
from service.server import check_exposure
from service.settings import SettingsError
from service.store import keys
from service.store.authorisations import REMEMBERED, Authorisations, Credentials
from service.store.store import Store

from .conftest import PENDULUM, make_client
from .fake_engine import export


def new_key(store: Store, *scopes: str, days: float | None = None, owner: str = "local") -> dict[str, str]:
    with store.database.write() as connection:
        return {"Authorization": f"Bearer {keys.create(connection, 'test', scopes, days, owner)}"}


def test_open_without_keys_closed_with_them(client: TestClient, store: Store) -> None:
    assert client.get("/v1/trees").status_code == 200
    reader, writer, admin = (new_key(store, scope) for scope in ("read", "write", "admin"))
    denied = client.get("/v1/trees")
    assert (denied.status_code, denied.headers["www-authenticate"]) == (401, "Bearer")
    assert denied.json()["code"] == "key-missing"
    assert client.get("/v1/trees", headers=reader).status_code == 200
    assert client.get("/v1/trees", headers=writer).status_code == 403
    assert client.post("/v1/substructures", json=PENDULUM, headers=reader).status_code == 403
    assert client.post("/v1/substructures", json=PENDULUM, headers=writer).status_code == 201
    assert client.get("/v1/trees", headers=admin).status_code == 200
    for path in ("/livez", "/readyz", "/openapi.json"):
        assert client.get(path).status_code == 200
    for path in ("/metrics", "/v1/limits"):
        assert client.get(path).status_code == 401


@pytest.mark.parametrize(
    "header", ["", "Bearer", "Bearer x", "Basic x", "Bearer sub_x_y", "Bearer sub__", "Bearer sub_'--_x"]
)
def test_wrong_keys(client: TestClient, store: Store, header: str) -> None:
    new_key(store, "read")
    assert client.get("/v1/trees", headers={"Authorization": header}).status_code == 401


def test_wrong_secret(client: TestClient, store: Store) -> None:
    key = new_key(store, "read")["Authorization"]
    assert (
        client.get("/v1/trees", headers={"Authorization": key[:-1] + ("a" if key[-1] != "a" else "b")}).status_code
        == 401
    )


def test_expired_keys_keep_the_server_closed_and_revoked_ones_open_it(client: TestClient, store: Store) -> None:
    key = new_key(store, "read", days=1)
    assert client.get("/v1/trees", headers=key).status_code == 200
    with store.database.write() as connection:
        connection.execute(update(api_keys).values(expires=now(timedelta(seconds=-1))))
    assert client.get("/v1/trees", headers=key).status_code == 401
    with store.database.write() as connection:
        connection.execute(update(api_keys).values(expires=None))
        last = keys.create(connection, "another", ["read"]).split("_")[1]
        assert keys.revoke(connection, list_keys(connection)[0].id)
    denied = client.get("/v1/trees", headers=key)
    assert (denied.status_code, denied.json()["code"]) == (401, "key-revoked")
    assert client.get("/v1/trees").status_code == 401
    with store.database.write() as connection:
        assert not keys.revoke(connection, last)  # the last one that counted
    assert client.get("/v1/trees").status_code == 200
    store.settings = store.settings.model_copy(update={"host": "192.0.2.1"})  # not on loopback
    assert client.get("/v1/trees").status_code == 401


def test_secrets_are_not_stored(store: Store) -> None:
    secret = new_key(store, "read")["Authorization"].split("_", 2)[2]
    with store.database.read() as connection:
        assert secret not in str(list_keys(connection))


def test_idempotency_keys_are_private(client: TestClient, store: Store) -> None:
    one, two = new_key(store, "write"), new_key(store, "write")
    shared = {"Idempotency-Key": "same"}
    assert client.post("/v1/substructures", json=PENDULUM, headers={**one, **shared}).status_code == 201
    assert client.post("/v1/substructures", json=PENDULUM, headers={**two, **shared}).status_code == 200


@pytest.mark.parametrize("scopes", [(), ("root",)])
def test_wrong_scopes(store: Store, scopes: Any) -> None:
    with pytest.raises(ValueError, match="scope"):
        new_key(store, *scopes)


def test_refuses_to_be_open_to_others(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    check_exposure(store)
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"host": "0.0.0.0"}))  # noqa: S104 -- a setting; nothing listens
    with pytest.raises(SettingsError, match="without API keys"):
        check_exposure(store)
    new_key(store, "read")
    check_exposure(store)


def test_an_authorisation_is_remembered_for_its_time_only(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A revoked key works on for at most ``key_seconds``; refusals are never remembered."""
    clock = [100.0]
    monkeypatch.setattr("service.store.authorisations.monotonic", lambda: clock[0])
    monkeypatch.setattr(store.runtime, "authorisations", Authorisations(seconds=1.0))
    client = make_client(store)
    key = new_key(store, "read")
    assert client.get("/v1/trees", headers=key).status_code == 200
    with store.database.write() as connection:
        keys.create(connection, "another", ["read"])
        assert revoke_key(connection, list_keys(connection)[0].id)
    assert client.get("/v1/trees", headers=key).status_code == 200
    assert client.get("/metrics", headers={}).status_code == 401
    assert client.post("/v1/trees", json={}, headers=key).status_code == 403  # its scopes are remembered, too
    clock[0] += 1.0
    assert client.get("/v1/trees", headers=key).status_code == 401


def test_remembered_authorisations_are_few() -> None:
    remembered = Authorisations(seconds=60.0)
    for number in range(3 * REMEMBERED):
        remembered.put(Credentials(f"Bearer {number}"), ANYBODY)
    assert len(remembered._known) <= REMEMBERED


def test_jobs_are_their_submitters_own(filled: TestClient, store: Store) -> None:
    """Others see those that are marked shared, an admin all; nobody else's is cancelled."""
    mine, admin = new_key(store, "read", "jobs"), new_key(store, "admin")
    others = new_key(store, "read", "jobs", owner="others")
    ids = [
        filled.post("/v1/jobs", json={**export("cell", "metric"), "shared": shared}, headers=mine).json()["id"]
        for shared in (False, True)
    ]

    def seen(key: dict[str, str]) -> set[str]:
        return {each["id"] for each in filled.get("/v1/jobs", headers=key).json()["items"]}

    assert (seen(mine), seen(others), seen(admin)) == (set(ids), {ids[1]}, set(ids))
    paths = ("", "/items", "/result", "/archive", "/items/0/files/x", "/items/-1/files/x")
    for key, hidden in ((mine, False), (others, True), (admin, False)):
        for path in paths:
            answer = filled.get(f"/v1/jobs/{ids[0]}{path}", headers=key)
            assert (answer.status_code == 404 and answer.json()["code"] == "unknown-job") == hidden, path
        assert (filled.get(f"/jobs/{ids[0]}", headers=key).status_code == 404) == hidden
        assert (ids[0][:16] in filled.get("/jobs", headers=key).text) != hidden
        assert filled.get(f"/v1/jobs/{ids[1]}", headers=key).json()["shared"] is True
    assert filled.get(f"/v1/jobs/{ids[0]}/events", headers=others).status_code == 404
    assert filled.post(f"/v1/jobs/{ids[0]}/cancel", headers=others).status_code == 404
    assert filled.post(f"/v1/jobs/{ids[1]}/cancel", headers=others).status_code == 403
    assert filled.post(f"/v1/jobs/{ids[0]}/cancel", headers=mine).status_code == 200
    wrong = filled.post("/v1/jobs", json={**export("cell", "metric"), "shared": 1}, headers=mine)
    assert wrong.json()["errors"][0]["pointer"] == "/shared"
