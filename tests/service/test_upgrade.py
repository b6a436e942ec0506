"""Programs of older versions of the software are usable, and derived anew on request: their documents stay."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from service.app import open_store
from service.content.improvement import AS_IT_WAS, MORE, SHORTER
from service.database.packed import pack, unpack
from service.jobs.kinds.requested import renewed
from service.messages.viewer import Viewer
from service.models.grouping import QUANTITIES as GROUPED
from service.operations.upgrade import Upgraded, upgrade
from service.operations.verification import verify_all
from service.settings import Settings
from service.store import keys
from service.store.store import Store
from substructures.expr.program import Program

from .conftest import HAND, SLIDER, copied, make_client
from .fake_engine import FakeEngine, finished, items, running, submitted
from .seals import seal_again
from .whole_summaries import put_whole_summary, whole_summary


def longer(content: bytes) -> Program:
    """As an older software may have derived it: (x + x) - x in place of the first formula of the metric."""
    document = json.loads(unpack(content))
    entries, n = document["outputs"]["metric"]["entries"], len(document["operations"])
    x = entries[0]
    document["operations"] += [["add", x, x], ["sub", n, x]]
    entries[0] = n + 1
    return Program.from_bytes(json.dumps(document).encode())


def poorer(content: bytes) -> Program:
    """As an older software may have stored it: without an output."""
    document = json.loads(unpack(content))
    del document["outputs"]["nonlinear_effects"]
    return Program.from_bytes(json.dumps(document).encode()).select(list(document["outputs"]))


def put(connection: sqlite3.Connection, table: str, old: str, program: Program) -> None:
    connection.execute(
        "INSERT OR IGNORE INTO programs VALUES (?, ?, ?, '')", (program.digest, pack(program), len(program))
    )
    connection.execute(f"UPDATE {table} SET program = ? WHERE program = ?", (program.digest, old))  # noqa: S608


def age(path: Path, *tables: str) -> None:
    """Make all programs of tables longer than today's software does, with what is stored beside them."""
    with closing(sqlite3.connect(path)) as connection:
        for table in tables:
            for (old,) in connection.execute(f"SELECT DISTINCT program FROM {table}").fetchall():  # noqa: S608
                (content,) = connection.execute("SELECT content FROM programs WHERE digest = ?", (old,)).fetchone()
                put(connection, table, old, longer(content))
        connection.commit()
    seal_again(path, "older")


@pytest.fixture
def path(template: Path, tmp_path: Path) -> Path:
    """A store of an older software, to be opened."""
    copied(template, tmp_path / "store.db")
    age(tmp_path / "store.db", "parts", "trees")
    return tmp_path / "store.db"


@pytest.fixture
def old(path: Path) -> Iterator[Store]:
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as store:
        yield store


def by_name(found: Any) -> dict[str, Upgraded]:
    return {each.what: each for each in found}


def test_shorter_programs_take_the_place_of_longer_ones(old: Store) -> None:
    client = make_client(old)
    before = {ref: client.get(f"/v1/{ref}").json() for ref in ("substructures/pendulum", "trees/cell")}
    found = by_name(upgrade(old.database))
    assert found.keys() == {"substructure pendulum@1", "substructure slider@1", "tree cell@1"}
    for each in found.values():
        assert (each.outcome, each.fault) == (SHORTER, "")
        assert each.before is not None
        assert each.after is not None
        assert each.before - each.after == 2
    for ref, was in before.items():
        now = client.get(f"/v1/{ref}").json()
        assert now["digest"] == was["digest"], "the document is what it was"
        assert now["program"] != was["program"]
        told = {name: value for name, value in now.items() if name not in ("program", "certificate", "operations")}
        assert told.items() <= was.items()
    assert all(finding.is_sound for finding in verify_all(old.database))
    assert {each.outcome for each in upgrade(old.database)} == {AS_IT_WAS}


def test_what_is_printed_has_another_tag_then(old: Store) -> None:
    """Also of a server that has it in memory; numbers stay what they are."""
    client = make_client(old)
    paths = ("substructures/pendulum@1/formulas/metric", "trees/cell@1/metric", "trees/cell@1/regressor")
    state = {"q": [0.3], "qd": [1], "qdd": [2], "quantities": ["metric", "inverse_dynamics"]}
    first = {path: client.get(f"/v1/{path}?form=compact&format=json") for path in paths}
    numbers = client.post("/v1/trees/cell@1/evaluations", json=state).json()
    list(upgrade(old.database))
    for path in paths:
        again = client.get(f"/v1/{path}?form=compact&format=json")
        assert again.headers["etag"] != first[path].headers["etag"], path
        known = {"If-None-Match": first[path].headers["etag"]}
        assert client.get(f"/v1/{path}?form=compact&format=json", headers=known).status_code == 200
    was, shorter = first[paths[1]].json(), client.get(f"/v1/{paths[1]}?form=compact&format=json").json()
    assert len(was["operations"]) - len(shorter["operations"]) == 2
    now = client.post("/v1/trees/cell@1/evaluations", json=state).json()
    assert now == numbers
    assert client.post("/v1/trees/cell/couplings", json=HAND).status_code == 201


def test_each_is_a_transaction_of_its_own(old: Store) -> None:
    """What was told of is on the disk when the work ends at any moment, and the rest is done by the next one."""
    first = next(upgrade(old.database))
    again = by_name(upgrade(old.database))
    assert again[first.what].outcome == AS_IT_WAS
    assert [each.outcome for each in again.values()].count(SHORTER) == 2


def test_what_fails_is_told_and_left(old: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    right = renewed.derived_part

    def derived(definition: bytes, *given: Any) -> Any:
        """Fails for one of them."""
        if b'"name":"pendulum"' in definition:
            raise ValueError("no")
        return right(definition, *given)

    monkeypatch.setattr(renewed, "derived_part", derived)
    found = by_name(upgrade(old.database))
    assert (found["substructure pendulum@1"].fault, found["substructure pendulum@1"].outcome) == ("no", AS_IT_WAS)
    assert found["substructure slider@1"].outcome == SHORTER
    assert found["tree cell@1"].fault == "no", "its part is derived anew first"


@pytest.fixture
def poor(template: Path, tmp_path: Path) -> Path:
    """A database with a tree that has no output nonlinear_effects."""
    copied(template, tmp_path / "store.db")
    with closing(sqlite3.connect(tmp_path / "store.db")) as connection:
        (program,) = connection.execute("SELECT program FROM trees").fetchone()
        (content,) = connection.execute("SELECT content FROM programs WHERE digest = ?", (program,)).fetchone()
        put(connection, "trees", program, poorer(content))
        told = json.loads(whole_summary(connection))
        del told["operations"]["nonlinear_effects"]
        put_whole_summary(connection, json.dumps(told))
        connection.commit()
    seal_again(tmp_path / "store.db")
    return tmp_path / "store.db"


def test_outputs_that_older_software_did_not_store_are_added(poor: Path) -> None:
    with open_store(Settings(database=f"sqlite:///{poor}", catalogue=False)) as store:
        found = by_name(upgrade(store.database))
        assert found["tree cell@1"].outcome == MORE
        assert make_client(store).get("/v1/trees/cell/nonlinear_effects").status_code == 200


def test_what_older_software_stored_is_grouped_before_it_is_upgraded(poor: Path) -> None:
    with open_store(Settings(database=f"sqlite:///{poor}", catalogue=False)) as store:
        client = make_client(store)
        for quantity in GROUPED:
            plain, grouped = (client.get(f"/v1/trees/cell/{quantity}", params={"group": x}) for x in ("false", "true"))
            assert grouped.status_code == plain.status_code == (404 if quantity == "nonlinear_effects" else 200)


def test_older_versions_on_request(old: Store) -> None:
    client = make_client(old)
    assert client.post("/v1/substructures", json={**SLIDER, "title": "another"}).status_code == 201
    found = by_name(upgrade(old.database))
    assert found["substructure slider@2"].outcome == AS_IT_WAS
    assert "substructure slider@1" not in found
    every = by_name(upgrade(old.database, every=True))
    assert every["substructure slider@1"].outcome == SHORTER


def test_others_names_are_left_alone(old: Store) -> None:
    guest = Viewer("k", "guest", ("read", "write"))
    assert list(upgrade(old.database, guest)) == []
    assert list(upgrade(old.database, guest, every=True)) == []


def test_a_job_does_the_same(path: Path) -> None:
    age_of = Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)
    with open_store(age_of) as store, running(store, FakeEngine()):
        client = make_client(store)
        was = client.get("/v1/substructures/pendulum").json()["program"]
        job = submitted(client, {"kind": "upgrade", "items": [{"substructure": "*"}]})
        assert finished(client, job)["state"] == "succeeded"
        told = {each["result"]["name"]: each["result"] for each in items(client, job)}
        assert told.keys() == {"pendulum", "slider"}
        assert all((each["outcome"], each["before"] - each["after"]) == (SHORTER, 2) for each in told.values())
        assert client.get("/v1/substructures/pendulum").json()["program"] == told["pendulum"]["program"] != was
        tree = submitted(client, {"kind": "upgrade", "items": [{"tree": "cell"}]})
        assert finished(client, tree)["state"] == "succeeded"
        assert items(client, tree)[0]["result"]["outcome"] == SHORTER
        again = submitted(client, {"kind": "upgrade", "items": [{"tree": "*"}]})
        assert finished(client, again)["state"] == "succeeded"
        assert items(client, again)[0]["result"]["outcome"] == AS_IT_WAS
        actions = {each["action"] for each in client.get("/v1/audit").json()["items"]}
        assert {"substructure.upgrade", "tree.upgrade"} <= actions
        assert all(finding.is_sound for finding in verify_all(store.database))


def test_only_owners_may(path: Path) -> None:
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as store:
        client, headers = make_client(store), {}
        with store.database.write() as connection:
            for name, scopes in (("write", ["read", "write", "jobs"]), ("read", ["read", "jobs"])):
                token = keys.create(connection, "", scopes, None, "guest")
                headers[name] = {"Authorization": f"Bearer {token}"}
        body = {"kind": "upgrade", "items": [{"substructure": "pendulum"}]}
        answer = client.post("/v1/jobs", json=body, headers=headers["write"])
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["code"] == "not-owner"
        assert client.post("/v1/jobs", json=body, headers=headers["read"]).status_code == 403
