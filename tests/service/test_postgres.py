"""The main flows on PostgreSQL."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.database import clock
from service.database.connections import Database, DatabaseError
from service.settings import Settings

from .conftest import HAND, PENDULUM, SLIDER, TREE, at_once, make_client
from .databases import fresh


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A fresh database that is dropped afterwards."""
    with fresh("postgresql", tmp_path_factory.mktemp("postgres")) as found:
        yield found


@pytest.fixture
def client(address: str) -> Iterator[TestClient]:
    with open_store(Settings(database=address, catalogue=False)) as store:
        yield make_client(store)


def test_main_flow(client: TestClient) -> None:
    for body in (PENDULUM, SLIDER):
        assert client.post("/v1/substructures", json=body).status_code in (200, 201)
    assert client.post("/v1/trees", json=TREE).status_code == 201
    key = {"Idempotency-Key": "k"}
    first = client.post("/v1/trees/cell/couplings", json=HAND, headers=key)
    assert first.status_code == 201, first.text
    assert client.post("/v1/trees/cell/couplings", json=HAND, headers=key).content == first.content
    assert client.get("/v1/trees/cell/metric?format=text").status_code == 200
    result = client.post("/v1/trees/cell/evaluations", json={"quantities": ["metric"], "q": [0, 0]})
    assert len(result.json()["metric"]) == 2
    page = client.get(
        "/v1/substructures?q=pend&tag=planar&dof_max=1&joints=R&page_size=1&sort=-created&facets=true"
    ).json()
    assert [item["name"] for item in page["items"]] == ["pendulum"]
    assert page["facets"]["joints"] == {"R": 1}
    assert client.get("/v1/substructures/pendulum/formulas/metric?format=latex").status_code == 200
    assert client.put("/v1/substructures/pendulum/aliases/a", json={"version": 1}).status_code == 201
    assert client.get("/v1/substructures/pendulum@a").json()["aliases"] == ["a"]
    assert client.post("/v1/substructures/pendulum@a/withdraw").json()["is_withdrawn"] is True
    assert client.post("/v1/trees", json={"name": "x", "instances": [{"name": "1"}]}).status_code == 422


@pytest.mark.parametrize("encoding", ["SQL_ASCII", "LATIN1"])
def test_a_database_that_cannot_keep_all_characters_is_refused(encoding: str) -> None:
    told = f"encoding {encoding}, .* ENCODING 'UTF8' TEMPLATE template0"
    with fresh("postgresql", Path(), encoding=encoding) as found, pytest.raises(DatabaseError, match=told):
        Database(found)


def test_nul_is_harmless(client: TestClient) -> None:
    definition = {**PENDULUM, "name": "nul", "title": "a\0b", "description": "\0"}
    refused = client.post("/v1/substructures", json=definition)
    assert [each["code"] for each in refused.json()["errors"]] == ["control-character"] * 2
    assert client.post("/v1/substructures", json={**PENDULUM, "name": "nul"}).status_code == 201
    assert client.get("/v1/substructures?q=%00").json()["items"] == []
    for path in ("?tag=%00", "/nul/formulas/%00", "/nul/formulas/metric?coordinate=%00"):
        answer = client.get(f"/v1/substructures{path}")
        assert answer.status_code in (404, 422), answer.text
        assert answer.headers["content-type"] == "application/problem+json"
    assert client.get("/v1/trees/%00").status_code == 404
    for path, pointer in (("?label=%00", "/query/label"), ("/a%00b", "/path/job"), ("?label=a%00b", "/query/label")):
        refused = client.get(f"/v1/jobs{path}")
        assert (refused.status_code, [each["pointer"] for each in refused.json()["errors"]]) == (422, [pointer])


def test_concurrency(client: TestClient) -> None:
    definition = {**PENDULUM, "name": "contended"}
    codes = at_once(lambda _: client.post("/v1/substructures", json=definition).status_code, range(6))
    assert sorted(codes) == [200] * 5 + [201]


def test_concurrent_couplings(client: TestClient) -> None:
    client.post("/v1/substructures", json=SLIDER)
    client.post("/v1/trees", json={"name": "rail", "instances": [{"name": "base0", "substructure": "slider"}]})

    def couple(k: int) -> int:
        body = {"name": f"s{k}", "substructure": "slider", "at": "base0.top"}
        return client.post("/v1/trees/rail/couplings", json=body).status_code

    assert at_once(couple, range(4)) == [201] * 4
    assert client.get("/v1/trees/rail").json()["dof"] == 5


def test_several_servers_share_a_database(address: str) -> None:
    settings = Settings(database=address, catalogue=False)
    with open_store(settings) as one, open_store(settings) as two:
        assert make_client(one).post("/v1/substructures", json={**PENDULUM, "name": "shared"}).status_code == 201
        assert make_client(two).get("/v1/substructures/shared").status_code == 200


class _Late(datetime):
    """The clock of a host that is ten minutes late."""

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> datetime:
        """The time that it shows."""
        return datetime.now(tz) - timedelta(minutes=10)


def test_hosts_agree_on_the_time_of_the_database(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leases and claims of one host would be over for another as soon as they are taken."""
    monkeypatch.setattr(clock, "_ahead", timedelta())
    for place in ("service.database.clock.datetime", "service.database.connections.datetime"):
        monkeypatch.setattr(place, _Late)
    assert clock.time_now() < datetime.now(UTC) - timedelta(minutes=9)
    with open_store(Settings(database=address, catalogue=False)):
        assert abs(clock.time_now() - datetime.now(UTC)) < timedelta(seconds=2)
