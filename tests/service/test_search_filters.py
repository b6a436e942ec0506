"""Ports, masses and sources of parts, and trees by the same means: found, refused and seen, on both databases."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient

from service.app import open_store
from service.content.tree_summaries import summary_text
from service.database.connections import Database
from service.database.migrate import upgrade
from service.database.tables import metadata, search_terms
from service.queries import membership
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import make_client
from .databases import fresh

KINDS = ("sqlite", "postgresql")
#: what a migrated store has only when the server that starts has derived it anew
RENEWED = ("software", "seal", "index_digest", "recipe")
#: name: mass, ports, source, parameters
GIVEN: dict[str, tuple[Any, tuple[str, ...], str, dict[str, Any]]] = {
    "anvil": (50, ("top",), "Weighed", {}),
    "ball": ("m", ("top", "side"), "Khalil 1986, p. 12", {"m": {"value": 1.5, "unit": "kg"}}),
    "coin": ({"value": "15/2", "unit": "g"}, (), "KHALIL 1987", {}),
    "disc": ("pi*r^2*sqrt(4)", ("side",), "khalil", {"r": {"value": 1, "unit": "m"}}),
    "egg": ("m", ("top",), "100 % my own", {"m": {"unit": "kg"}}),
    "feather": (0, (), "", {}),
    "gram": ("2*m", ("side",), "r2", {"m": {"value": "1/3", "unit": "g"}}),
}
MASSES = {"anvil": 50, "ball": 1.5, "coin": 0.0075, "disc": 6.283185307179586, "feather": 0, "gram": 2 / 3000}
INSTANCES: dict[str, list[dict[str, Any]]] = {
    "heavy-cell": [{"name": "a", "substructure": "anvil"}, {"name": "b", "substructure": "ball"}],
    "light-cell": [{"name": "a", "substructure": "ball", "parameters": {"m": {"value": 250, "unit": "g"}}}],
    "made": [
        {"name": "a", "substructure": "ball", "parameters": {"m": "w"}},
        {"name": "b", "substructure": "egg", "parameters": {"m": "a.m/2"}},
    ],
    "open": [{"name": "a", "substructure": "egg"}],
    "swing": [{"name": "a", "substructure": "pendulum-of-one"}, {"name": "b", "substructure": "coin"}],
}
OF_TREES = {"heavy-cell": 51.5, "light-cell": 0.25, "made": 4.5, "swing": 2.0075}
HINGE = {"type": "revolute", "coordinate": "q"}


def part(name: str) -> dict[str, Any]:
    mass, ports, source, parameters = GIVEN[name]
    body = {"name": "it", "parent": "base", "joint": {"type": "fixed"}, "mass": mass}
    at = [{"name": port, "body": "it"} for port in ports]
    return {"name": name, "source": source, "parameters": parameters, "bodies": [body], "ports": at}


def tree(name: str) -> dict[str, Any]:
    parameters = {"w": {"value": 3, "unit": "kg"}} if name == "made" else {}
    return {"name": name, "gravity": [0, 0, 0], "parameters": parameters, "instances": INSTANCES[name]}


def fill(client: TestClient) -> None:
    rod = {"name": "rod", "parent": "base", "joint": HINGE, "mass": 2, "inertia": {"zz": 1, "yy": 1}}
    for each in (*map(part, GIVEN), {"name": "pendulum-of-one", "bodies": [rod]}):
        answer = client.post("/v1/substructures", json=each)
        assert answer.status_code == 201, answer.text
    for name in INSTANCES:
        answer = client.post("/v1/trees", json=tree(name))
        assert answer.status_code == 201, answer.text


@pytest.fixture(scope="module", params=KINDS)
def store(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with (
        fresh(request.param, tmp_path_factory.mktemp("filters")) as address,
        open_store(Settings(database=address, catalogue=False)) as found,
    ):
        fill(make_client(found))
        yield found


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return make_client(store)


def ask(client: TestClient, query: str, what: str = "substructures", **headers: str) -> dict[str, Any]:
    answer = client.get(f"/v1/{what}?{query}", headers=headers)
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def names(client: TestClient, query: str, what: str = "substructures", **headers: str) -> str:
    return " ".join(item["name"] for item in ask(client, query, what, **headers)["items"])


def test_masses_are_told(client: TestClient) -> None:
    told = {each["name"]: each["mass"] for each in ask(client, "")["items"]}
    assert told == {**MASSES, "egg": None, "pendulum-of-one": 2}
    assert client.get("/v1/substructures/gram").json()["mass"] == 2 / 3000
    assert {each["name"]: each["mass"] for each in ask(client, "", "trees")["items"]} == {**OF_TREES, "open": None}
    assert client.get("/v1/trees/made").json()["mass"] == 4.5


PARTS = {
    "port=top": "anvil ball egg",
    "port=top&port=side": "ball",
    "port=side&sort=-name": "gram disc ball",
    "port=nothing": "",
    "port=to": "",
    "mass_min=1.5": "anvil ball disc pendulum-of-one",
    "mass_max=0.0075": "coin feather gram",
    "mass_min=1.5&mass_max=1.5": "ball",
    "mass_min=0": "anvil ball coin disc feather gram pendulum-of-one",
    "mass_min=51": "",
    "source=khalil": "ball coin disc",
    "source=KHALIL%20198": "ball coin",
    "source=khalil&port=side": "ball disc",
    "source=r2": "gram",
    "source=%25": "egg",
    "source=ball": "",
    "q=khalil": "",
    "q=ball&source=khalil&port=top&mass_max=2&dof_max=0": "ball",
    "source=khalil&mass_min=1&sort=-created": "disc ball",
}
TREES = {
    "": "heavy-cell light-cell made open swing",
    "q=cell": "heavy-cell light-cell",
    "q=cell%20heavy": "heavy-cell",
    "q=light": "light-cell",
    "q=w": "swing",
    "q=xylophone": "",
    "uses=ball": "heavy-cell light-cell made",
    "uses=ball&q=cell&mass_max=1": "light-cell",
    "uses=nothing": "",
    "mass_min=1&mass_max=10": "made swing",
    "mass_max=1000": "heavy-cell light-cell made swing",
    "dof_min=1": "swing",
    "dof_max=0&sort=-name": "open made light-cell heavy-cell",
    "joints=R": "swing",
    "joints=P": "",
    "owner=local&joints=R": "swing",
    "owner=nobody": "",
    "sort=-created": "swing open made light-cell heavy-cell",
    "sort=-dof": "swing heavy-cell light-cell made open",
}


@pytest.mark.parametrize("few", [5000, 0])
@pytest.mark.parametrize("query", PARTS)
def test_parts_that_are_found(client: TestClient, query: str, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(membership, "FEW", few)
    assert names(client, query) == PARTS[query]
    monkeypatch.setattr(membership, "MANY", few)
    assert names(client, query) == PARTS[query]


@pytest.mark.parametrize("few", [5000, 0])
@pytest.mark.parametrize("query", TREES)
def test_trees_that_are_found(client: TestClient, query: str, few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(membership, "FEW", few)
    assert names(client, query, "trees") == TREES[query]
    monkeypatch.setattr(membership, "MANY", few)
    assert names(client, query, "trees") == TREES[query]


def test_trees_by_relevance_and_with_slips(client: TestClient) -> None:
    for name in ("cell", "cell-two"):
        assert client.post("/v1/trees", json={**tree("open"), "name": name}).status_code == 201
    assert names(client, "q=cell", "trees") == "cell cell-two heavy-cell light-cell"
    page = ask(client, "q=celll&page_size=3", "trees")
    rest = dict(client.get(page["links"]["next"]).json())
    assert [each["name"] for each in (*page["items"], *rest["items"])] == [
        "cell",
        "cell-two",
        "heavy-cell",
        "light-cell",
    ]
    assert page["instead"] == rest["instead"] == {"celll": "cell"}
    assert "instead" not in ask(client, "q=cell", "trees")


@pytest.mark.parametrize("what", ["substructures", "trees"])
@pytest.mark.parametrize("sort", ["name", "-name", "dof", "-dof", "created", "-created"])
def test_pages_of_filters(client: TestClient, what: str, sort: str) -> None:
    query = f"mass_min=0.1&sort={sort}"
    page = ask(client, f"{query}&page_size=2", what)
    seen = page["items"]
    while page["next_page_token"]:
        page = dict(client.get(page["links"]["next"]).json())
        seen += page["items"]
    assert " ".join(each["name"] for each in seen) == names(client, query, what)
    assert len(seen) == 4


def test_a_page_belongs_to_its_filters(client: TestClient) -> None:
    for what, query, other in (
        ("substructures", "mass_min=0", "mass_min=0.5"),
        ("substructures", "port=top", "port=side"),
        ("substructures", "source=khalil", "source=Weighed"),
        ("trees", "mass_min=0", "mass_max=100"),
    ):
        token = ask(client, f"{query}&page_size=1", what)["next_page_token"]
        answer = client.get(f"/v1/{what}?{other}&page_token={token}")
        assert (answer.status_code, answer.json()["code"]) == (422, "page-token")


BAD = {
    "mass_min=abc": "/query/mass_min",
    "mass_max=-1": "/query/mass_max",
    "mass_max=nan": "/query/mass_max",
    "mass_min=1e999": "/query/mass_min",
    "mass_min=2&mass_max=1": "/query/mass_min",
    "dof_min=2&dof_max=1": "/query/dof_min",
    "joints=RX": "/query/joints",
    "sort=mass": "/query/sort",
    "mas_min=1": "/query/mas_min",
}


@pytest.mark.parametrize("what", ["substructures", "trees"])
@pytest.mark.parametrize("query", BAD)
def test_what_is_refused(client: TestClient, what: str, query: str) -> None:
    answer = client.get(f"/v1/{what}?{query}")
    assert answer.status_code == 422, answer.text
    assert [each["pointer"] for each in answer.json()["errors"]] == [BAD[query]]


@pytest.mark.parametrize("what", ["substructures", "trees"])
def test_joints_may_be_written_small(client: TestClient, what: str) -> None:
    found = names(client, "joints=R", what)
    assert found
    assert names(client, "joints=r", what) == found
    told = client.get(f"/v1/{what}?joints=RX").json()["detail"]
    assert 'joints are R (revolute) and P (prismatic) in order, as in RRP, found "RX"' in told


@pytest.mark.parametrize(("query", "pointer"), [("port=tip.x", "port/0"), ("port=top&port=%00", "port/1")])
def test_bad_names_of_ports(client: TestClient, query: str, pointer: str) -> None:
    answer = client.get(f"/v1/substructures?{query}")
    assert answer.status_code == 422
    assert [each["pointer"] for each in answer.json()["errors"]] == [f"/query/{pointer}"]


def test_unknown_parameters_are_refused_with_the_known_ones(client: TestClient) -> None:
    answer = client.get("/v1/trees?colour=red").json()
    assert answer["code"] == "unknown-query"
    assert {"q", "uses", "owner", "mass_min", "joints", "sort", "page_token"} <= set(answer["known"])
    assert "'port'" in client.get("/v1/substructures?prot=tip").json()["detail"]


def test_a_parameter_with_one_value_is_given_once(client: TestClient) -> None:
    """The last one was taken in silence; lists are given as often as there are elements."""
    answer = client.get("/v1/substructures?sort=name&sort=dof")
    (fault,) = answer.json()["errors"]
    assert (answer.status_code, fault["pointer"], fault["code"]) == (422, "/query/sort", "given-twice")
    assert client.get("/v1/substructures?sort=name&port=tip&port=top&tag=planar&tag=textbook").status_code == 200


@pytest.mark.parametrize(
    "text", ["%00", "%22", "'", "%25", "_", "%5C", "a*", "NEAR", "a%20OR%20b", "(", "source%20:%20a"]
)
def test_hostile_words_do_no_harm(client: TestClient, text: str) -> None:
    assert names(client, f"source={text}zz") == names(client, f"q={text}zz", "trees") == ""


def test_search_by_source_follows_the_latest_version(client: TestClient) -> None:
    for source, expected in (("zanzibar", "mover"), ("elsewhere", "")):
        newer = {**part("feather"), "name": "mover", "source": source}
        assert client.post("/v1/substructures", json=newer).status_code == 201
        assert names(client, "source=zanzibar") == expected
    assert client.post("/v1/substructures/mover/withdraw").status_code == 200
    assert names(client, "source=zanzibar") == "mover"
    assert client.post("/v1/substructures/mover/withdraw").status_code == 200
    assert names(client, "source=zanzibar") == names(client, "q=mover") == ""


def test_trees_follow_the_latest_revision(client: TestClient) -> None:
    first = {**tree("light-cell"), "name": "changing"}
    assert client.post("/v1/trees", json=first).status_code == 201
    more = {"name": "b", "substructure": "pendulum-of-one", "at": "a.it"}
    assert client.post("/v1/trees/changing/couplings", json=more).status_code == 201
    assert names(client, "q=changing&mass_min=2.25&mass_max=2.25&joints=R", "trees") == "changing"
    assert names(client, "q=changing&mass_max=0.25", "trees") == ""
    assert client.delete("/v1/trees/changing/couplings/b").status_code == 201
    assert names(client, "q=changing&mass_max=0.25&dof_max=0", "trees") == "changing"
    assert "changing" not in names(client, "uses=pendulum-of-one", "trees")


def test_removed_trees_are_nowhere(client: TestClient) -> None:
    """Neither on pages, which stay full, nor among what may have been meant; the next one counts on."""
    form = {"gravity": [0, 0, 0], "instances": [{"name": "a", "substructure": "ball"}]}
    for name in ("gone-a", "gone-b", "gone-c"):
        assert client.post("/v1/trees", json={"name": name, **form}).status_code == 201
    for name in ("gone-a", "gone-b"):
        assert client.delete(f"/v1/trees/{name}").status_code == 204
    for sort in ("name", "-created", "relevance"):
        found = client.get(f"/v1/trees?q=gone&sort={sort}&page_size=1").json()
        assert [each["name"] for each in found["items"]] == ["gone-c"]
        assert found["next_page_token"] is None
    assert "gone-c" in client.get("/v1/trees/gone-d").json()["detail"]
    assert "'gone-a'" not in client.get("/v1/trees/gone-aa").json()["detail"]
    assert client.delete("/v1/trees/gone-a").status_code == 404
    assert client.post("/v1/trees", json={"name": "gone-a", **form}).json()["revision"] == 2
    assert len(client.get("/v1/trees?q=gone").json()["items"]) == 2


def test_only_what_is_seen_is_found(store: Store, client: TestClient) -> None:
    with store.database.write() as connection:
        mine, other = (keys.create(connection, owner, ["read", "write"], None, owner=owner) for owner in ("a", "b"))
    a, b = ({"Authorization": f"Bearer {key}"} for key in (mine, other))
    secret = {**part("disc"), "name": "zeppelin", "source": "hush", "visibility": "private"}
    secret["ports"] = [{"name": "gondola", "body": "it"}]
    assert client.post("/v1/substructures", json=secret, headers=a).status_code == 201
    fleet = {"name": "zeppelins", "gravity": [0, 0, 0], "visibility": "private"}
    fleet["instances"] = [{"name": "one", "substructure": "zeppelin"}]
    assert client.post("/v1/trees", json=fleet, headers=a).status_code == 201
    for query in ("port=gondola", "source=hush", "mass_min=6&mass_max=7&q=zep", "q=zepelin"):
        assert (names(client, query, **a), names(client, query, **b)) == ("zeppelin", "")
    for query in ("uses=zeppelin", "q=zepelins", "mass_min=6&mass_max=7"):
        assert (names(client, query, "trees", **a), names(client, query, "trees", **b)) == ("zeppelins", "")
    assert "instead" not in ask(client, "q=zepelins", "trees", **b)
    similar = {**part("feather"), "name": "zeppolin"}
    assert client.post("/v1/substructures", json=similar, headers=a).status_code == 201
    assert ask(client, "q=zeppelin", **b)["instead"] == {"zeppelin": "zeppolin"}
    assert "instead" not in ask(client, "q=zeppelin", **a)


#: what columns of older stores are called now
SINCE = {"yanked": "withdrawn_at", "yank_reason": "withdrawal_reason", "summary": "summary_values"}


@pytest.mark.parametrize("kind", KINDS)
def test_an_older_store_is_as_if_it_were_made_today(kind: str, tmp_path: Path) -> None:
    with (
        fresh(kind, tmp_path, is_migrated=False) as address,
        open_store(Settings(database=f"sqlite:///{tmp_path / 'new.db'}", catalogue=False)) as new,
    ):
        fill(make_client(new))
        engine = sa.create_engine(address)
        upgrade(engine, "0011")
        tables = [
            metadata.tables[name]
            for name in ("programs", "parts", "substructures", "versions", "tree_names", "trees", "tree_parts")
        ]
        with new.database.write() as connection:
            put_whole(connection)
        with new.database.read() as connection, engine.begin() as old:
            for table in tables:
                there = sa.Table(table.name, sa.MetaData(), autoload_with=old)
                columns = [table.c[SINCE.get(c.name, c.name)].label(c.name) for c in there.c if c.name != "number"]
                rows = [dict(row) for row in connection.execute(sa.select(*columns)).mappings()]
                if rows:
                    old.execute(sa.insert(there), rows)
            expected, terms = {table: rows_of(connection, table) for table in tables}, terms_of(connection)
        engine.dispose()
        migrated = Database(address)
        with migrated.read() as connection:
            assert {table: rows_of(connection, table) for table in expected} == expected
            assert terms_of(connection) == terms != []
        migrated.close()
        with open_store(Settings(database=address, catalogue=False)) as opened:
            client = make_client(opened)
            assert {query: names(client, query) for query in PARTS} == PARTS
            assert {query: names(client, query, "trees") for query in TREES} == TREES


def put_whole(connection: sa.Connection) -> None:
    """Summaries of trees in one part, as older versions stored them."""
    trees, forms = metadata.tables["trees"], metadata.tables["summary_forms"]
    columns = trees.c.name, trees.c.revision, trees.c.spec, trees.c.summary_values, forms.c.content
    both = trees.outerjoin(forms, trees.c.summary_form == forms.c.digest)
    for name, revision, spec, values, form in connection.execute(sa.select(*columns).select_from(both)).all():
        whole = {"summary_values": summary_text(values, form, spec), "summary_form": None}
        connection.execute(sa.update(trees).where(trees.c.name == name, trees.c.revision == revision).values(whole))


def terms_of(connection: sa.Connection) -> list[Any]:
    return sorted(map(tuple, connection.execute(sa.select(search_terms))))


def rows_of(connection: sa.Connection, table: sa.Table) -> list[Any]:
    columns = [column for column in table.columns if column.name not in ("number", *RENEWED)]
    return sorted(map(tuple, connection.execute(sa.select(*columns))), key=str)
