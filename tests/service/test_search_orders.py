"""Every order and every page of a search is that of a plain sort in Python, whichever way the database takes."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import event

from service.app import open_store
from service.queries import membership
from service.settings import Settings
from service.store.store import Store

from .conftest import make_client
from .databases import fresh

WORDS = ("arm", "robot-arm", "ar-robot", "leg", "left", "arms", "le")
FOUND_BY = (
    "q=arm",
    "q=robot arm",
    "q=ar",
    "q=le",
    "q=ar arm",
    "q=l robot",
    "q=arm&tag=a",
    "q=arm&joints=R&port=x",
    "q=arm&sort=name",
    "q=arm&sort=-created",
    "tag=a",
    "tag=a&sort=-name",
    "tag=a&tag=b",
    "port=x&tag=b&sort=-name",
    "joints=R&port=x",
    "joints=P&sort=-name",
    "owner=local&tag=a",
    "owner=nobody",
    "port=x&sort=-created",
    "tag=a&sort=-dof",
    "source=arm",
    "source=arm&tag=b",
    "source=arm&q=leg",
    "joints=R&mass_min=2",
    "sort=relevance&tag=a",
)


def parts() -> list[dict[str, Any]]:
    """Forty with few words in name, title and source, by age."""
    choose, made = random.Random(3), []  # noqa: S311 -- test data
    for k in range(40):
        joint = {"type": choose.choice(("revolute", "prismatic", "fixed")), "coordinate": "q"}
        if joint["type"] == "fixed":
            del joint["coordinate"]
        made.append(
            {
                "name": f"{choose.choice(WORDS)}-{choose.randrange(100)}-{k}",
                "title": choose.choice((*WORDS, "")),
                "source": choose.choice((*WORDS, "")),
                "tags": [tag for tag in "ab" if choose.random() < 0.6],
                "bodies": [{"name": "it", "parent": "base", "joint": joint, "mass": choose.randrange(1, 5)}],
                "ports": [{"name": port, "body": "it"} for port in "xy" if choose.random() < 0.6],
            }
        )
    return made


def joints(part: dict[str, Any]) -> str:
    return {"revolute": "R", "prismatic": "P", "fixed": ""}[part["bodies"][0]["joint"]["type"]]


def expected(query: str) -> list[str]:
    """The names, by looking at every part."""
    asked: dict[str, list[str]] = {}
    for key, _, value in (each.partition("=") for each in query.split("&")):
        asked.setdefault(key, []).append(value)
    words = asked.get("q", [""])[0].split()
    [sort] = asked.get("sort", ["relevance" if words else "name"])

    def is_found(part: dict[str, Any]) -> bool:
        text = " ".join((part["name"], part["title"], *part["tags"]))
        starts = text.replace("-", " ").split()
        return (
            all(word in text if len(word) > 2 else any(x.startswith(word) for x in starts) for word in words)
            and all(tag in part["tags"] for tag in asked.get("tag", []))
            and all(any(port["name"] == x for port in part["ports"]) for x in asked.get("port", []))
            and all(joints(part) == x for x in asked.get("joints", []))
            and all(x == "local" for x in asked.get("owner", []))
            and all(x in part["source"] for x in asked.get("source", []))
            and all(part["bodies"][0]["mass"] >= float(x) for x in asked.get("mass_min", []))
        )

    are_long = any(len(word) > 2 for word in words)

    def place(aged: tuple[int, dict[str, Any]]) -> Any:
        age, part = aged
        name = part["name"]
        if sort == "relevance" and words:
            return 0 if name.startswith(words[0]) else 1 if are_long and all(word in name for word in words) else 2, age
        return {"created": -age, "dof": -len(joints(part))}.get(sort.lstrip("-"), 0), name

    found = sorted((each for each in enumerate(parts()) if is_found(each[1])), key=place, reverse=sort == "-name")
    return [part["name"] for _, part in found]


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with (
        fresh(request.param, tmp_path_factory.mktemp("orders")) as address,
        open_store(Settings(database=address, catalogue=False)) as found,
    ):
        client = make_client(found)
        for part in parts():
            answer = client.post("/v1/substructures", json=part)
            assert answer.status_code == 201, answer.text
        yield found


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return make_client(store)


@pytest.mark.parametrize(("few", "many"), [(5000, 50_000), (0, 50_000), (0, 0), (12, 50_000), (12, 16)])
@pytest.mark.parametrize("query", FOUND_BY)
def test_pages_are_those_of_a_plain_sort(
    client: TestClient, query: str, few: int, many: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(membership, "FEW", few)
    monkeypatch.setattr(membership, "MANY", many)
    for size in (4, 100):
        page = client.get(f"/v1/substructures?{query}&page_size={size}").json()
        seen = [each["name"] for each in page["items"]]
        while page["next_page_token"]:
            page = client.get(page["links"]["next"]).json()
            seen += [each["name"] for each in page["items"]]
        assert seen == expected(query)
    assert seen or "nobody" in query


def test_a_tree_with_two_of_a_part_is_found_once(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    name = parts()[0]["name"]
    for tree in ("pair", "other-pair"):
        both = [{"name": each, "substructure": name} for each in ("one", "two")]
        assert client.post("/v1/trees", json={"name": tree, "instances": both}).status_code == 201
    for few in (5000, 0):
        monkeypatch.setattr(membership, "FEW", few)
        for query, order in (("", ["other-pair", "pair"]), ("&q=pair", ["pair", "other-pair"])):
            found = client.get(f"/v1/trees?uses={name}{query}").json()["items"]
            assert [each["name"] for each in found] == order


@pytest.mark.parametrize(("query", "first"), [("tag=a", "search_terms"), ("joints=R", "joints"), ("q=arm", "_words")])
def test_what_many_have_is_taken_as_it_comes(
    client: TestClient, store: Store, query: str, first: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """SQLite's plan of the last search in an order, before the page is read: nothing is sorted."""
    if not store.database.is_sqlite:
        pytest.skip("of SQLite")
    monkeypatch.setattr(membership, "FEW", 0)
    asked: list[tuple[str, Any]] = []

    def note(_: Any, __: Any, statement: str, given: Any, *___: Any) -> None:
        asked.append((statement, given))

    event.listen(store.database.reader, "after_cursor_execute", note)
    try:
        assert client.get(f"/v1/substructures?{query}").status_code == 200
    finally:
        event.remove(store.database.reader, "after_cursor_execute", note)
    statement, given = next(each for each in reversed(asked) if "FROM (SELECT" in each[0] and "ORDER BY" in each[0])
    with store.database.read() as connection:
        plan = [row[3] for row in connection.exec_driver_sql(f"EXPLAIN QUERY PLAN {statement}", given)]
    assert first in plan[0]
    assert not [line for line in plan if "ORDER BY" in line]
