"""Search in the catalogue: relevance, words with slips, and what is seen, on both databases."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.queries import membership
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import PENDULUM, make_client
from .databases import fresh

PARTS = {
    "gripper": {"title": "Two fingers"},
    "gripper-wide": {"title": "Two long fingers"},
    "parallel-gripper": {"title": "Parallel fingers"},
    "hand": {"title": "A gripper with a thumb"},
    "wrist": {"title": "Three axes", "description": "carries a gripper", "tags": ["spherical"]},
    "r2": {"title": "Drehgelenk für Türen"},
}
#: names with a word that are few enough to be sorted: SQLite takes more of them rank by rank
FEW = pytest.mark.parametrize("few", [0, 5000])


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with (
        fresh(request.param, tmp_path_factory.mktemp("search")) as address,
        open_store(Settings(database=address, catalogue=False)) as found,
    ):
        client = make_client(found)
        for name, more in PARTS.items():
            answer = client.post("/v1/substructures", json=changed(name=name, **more))
            assert answer.status_code == 201, answer.text
        yield found


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return make_client(store)


def changed(**fields: Any) -> dict[str, Any]:
    return {**PENDULUM, "tags": [], "description": "", **fields}


def found(client: TestClient, **query: Any) -> dict[str, Any]:
    answer = client.get("/v1/substructures", params=query)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def names(client: TestClient, **query: Any) -> list[str]:
    return [item["name"] for item in found(client, **query)["items"]]


@FEW
def test_names_come_before_the_rest(client: TestClient, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(membership, "FEW", few)
    order = ["gripper", "gripper-wide", "parallel-gripper", "hand", "wrist"]
    assert names(client, q="Gripper") == names(client, q="gripper", sort="relevance") == order
    assert names(client, q="wide gripper") == ["gripper-wide"]
    assert names(client, q="gripper", sort="name") == sorted(order)
    assert names(client, sort="relevance") == names(client) == sorted(PARTS)


@FEW
@pytest.mark.parametrize("size", [1, 2, 3])
def test_pages_by_relevance(client: TestClient, size: int, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(membership, "FEW", few)
    page = found(client, q="gripper", page_size=size)
    seen = [item["name"] for item in page["items"]]
    while page["next_page_token"]:
        page = dict(client.get(page["links"]["next"]).json())
        seen += [item["name"] for item in page["items"]]
    assert seen == ["gripper", "gripper-wide", "parallel-gripper", "hand", "wrist"]


@pytest.mark.parametrize(
    ("typed", "meant"), [("griper", "gripper"), ("gripperr", "gripper"), ("sphreical", "spherical"), ("wrsit", "wrist")]
)
def test_a_slip_is_forgiven_and_told(client: TestClient, typed: str, meant: str) -> None:
    slipped, right = found(client, q=typed), found(client, q=meant)
    assert (slipped["instead"], slipped["items"]) == ({typed: meant}, right["items"])
    assert "instead" not in right


def test_pages_of_a_slip(client: TestClient) -> None:
    page = found(client, q="griper", page_size=3)
    rest = dict(client.get(page["links"]["next"]).json())
    seen = [item["name"] for item in (*page["items"], *rest["items"])]
    assert seen == names(client, q="gripper")
    assert rest["instead"] == {"griper": "gripper"}


@pytest.mark.parametrize(
    "text", ["xylophone", '"', "'", "%", "_", "\\", "a*", "NEAR", "\0", "griper NOT", "(", "ab", "zz"]
)
def test_what_is_nowhere_finds_nothing_and_does_no_harm(client: TestClient, text: str) -> None:
    assert names(client, q=text) == []


def test_short_words_and_other_letters(client: TestClient) -> None:
    assert names(client, q="r2") == ["r2"]
    assert names(client, q="th") == ["hand", "wrist"]
    assert names(client, q="t f") == ["gripper", "gripper-wide", "r2"]  # two fingers, für Türen
    assert names(client, q="sp") == ["wrist"]  # its tag
    assert names(client, q="w gripper") == ["wrist", "gripper-wide", "hand"]
    assert names(client, q="ip") == []  # in the midst of a word
    assert names(client, q="TÜREN") == ["r2"]
    assert names(client, q="ü d") == ["r2"]


def test_only_what_is_seen_is_suggested(store: Store, client: TestClient) -> None:
    with store.database.write() as connection:
        mine, other = (keys.create(connection, owner, ["read", "write"], None, owner=owner) for owner in ("a", "b"))
    by = {name: {"Authorization": f"Bearer {key}"} for name, key in (("mine", mine), ("other", other))}
    secret = changed(name="zeppelin", title="Zeppelin", visibility="private")
    assert client.post("/v1/substructures", json=secret, headers=by["mine"]).status_code == 201
    for who, expected in (("mine", {"zepelin": "zeppelin"}), ("other", None)):
        answer = client.get("/v1/substructures?q=zepelin", headers=by[who]).json()
        assert answer.get("instead") == expected
        assert [item["name"] for item in answer["items"]] == (["zeppelin"] if expected else [])


def test_search_follows_the_latest_version(store: Store, client: TestClient) -> None:
    with store.database.write() as connection:
        key = keys.create(connection, "all", ["read", "write", "admin"], None)
    headers = {"Authorization": f"Bearer {key}"}

    def ask(word: str) -> list[str]:
        return [each["name"] for each in client.get(f"/v1/substructures?q={word}", headers=headers).json()["items"]]

    newer = changed(name="r2", title="Hinge of doors")
    assert client.post("/v1/substructures", json=newer, headers=headers).status_code == 201
    assert (ask("hinge"), ask("Drehgelenk")) == (["r2"], [])
    assert (ask("do"), ask("dr")) == (["r2"], [])
    assert client.post("/v1/substructures/r2@2/withdraw", headers=headers).status_code == 200
    assert (ask("hinge"), ask("Drehgelenk")) == ([], ["r2"])
    assert (ask("do"), ask("dr")) == ([], ["r2"])
    assert client.post("/v1/substructures/r2@1/withdraw", headers=headers).status_code == 200
    assert (ask("hinge"), ask("Drehgelenk"), ask("dr")) == ([], [], [])
