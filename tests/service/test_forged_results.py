"""Who can write to the database has no forged result, answer or number believed; nor has who hands over a store."""

from __future__ import annotations

import io
import shutil
from collections.abc import Iterator
from math import cos
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select, update

from service.app import open_store
from service.content.derivation import software
from service.database.backup import backup, restore
from service.database.job_tables import results
from service.database.seal_keys import BYTES
from service.database.seals import seal
from service.database.tables import idempotency, parts, renewals, versions
from service.messages.viewer import ANYBODY
from service.operations.jobs import jobs
from service.operations.renewing import Renewal
from service.operations.verification import verify_all
from service.queries.jobs.jobs import NewItem, add_job
from service.queries.jobs.results import Result, put_results
from service.settings import Settings
from service.store.store import Store

from .conftest import HAND, PENDULUM, SLIDER, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, export, finished, items, running, submitted

KEY = {"Idempotency-Key": "3f6b"}
#: of the pendulum of 2 kg at 1 m
WEIGHT = 2 * 9.81
RESULTS = """UPDATE results SET summary = o.summary, digest = o.digest{} FROM results o
WHERE o.key = '{}' AND results.key = '{}'"""
FILES = """UPDATE result_files SET content = o.content, digest = o.digest FROM result_files o
WHERE o.key = '{}' AND result_files.key = '{}'"""


@pytest.fixture(params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """With two versions of the pendulum and a tree, all of it derived here, and a key of its own."""
    (tmp_path / "seal.key").write_bytes(bytes(range(BYTES)))
    with fresh(request.param, tmp_path) as address:
        settings = Settings(database=address, catalogue=False, seal_key=str(tmp_path / "seal.key"), key_seconds=0)
        with open_store(settings) as opened, running(opened, FakeEngine()):
            client = make_client(opened)
            for kind, body in (("substructures", PENDULUM), ("substructures", SLIDER), ("trees", TREE)):
                assert client.post(f"/v1/{kind}", json=body).status_code == 201
            longer = {**PENDULUM, "ports": [{"name": "tip", "body": "rod", "position": ["2*l", 0, 0]}]}
            assert client.post("/v1/substructures", json=longer).json()["version"] == 2
            assert Renewal(opened).all() == 0
            yield opened


@pytest.fixture
def client(store: Store) -> TestClient:
    return make_client(store)


def done(store: Store, *statements: str) -> None:
    """Behind the back of the server."""
    with store.database.write() as connection:
        for statement in statements:
            connection.exec_driver_sql(statement)


def faults(store: Store) -> dict[str, str]:
    return {finding.what: finding.fault for finding in verify_all(store.database) if finding.fault}


def at(q: float) -> dict[str, Any]:
    return {"kind": "evaluate", "items": [{"tree": "cell@1", "request": {"q": [q], "quantities": ["forces"]}}]}


def force(client: TestClient, job: str) -> float:
    """What the one item of a job says."""
    answer = client.get(f"/v1/jobs/{job}/items/0/files/result")
    assert answer.status_code == 200, answer.text
    return float(np.load(io.BytesIO(answer.content))["forces"].ravel()[0])


def right(q: float) -> Any:
    return pytest.approx(-WEIGHT * cos(q), rel=1e-14)


def told(answer: Any, words: str) -> None:
    """The store is blamed, with a way out."""
    assert (answer.status_code, answer.json()["code"]) == (500, "damaged-content"), answer.text
    assert "it does not have the seal of this server" in answer.json()["detail"]
    assert words in answer.json()["detail"]


FORGED = {
    "the seal stays": "",
    "the seal of another result": ", seal = o.seal",
    "a seal of who has no key": f", seal = '{64 * '0'}'",
    "no seal, as of an older version": ", seal = ''",
}


@pytest.mark.parametrize("case", FORGED)
def test_a_forged_result_is_computed_anew(case: str, client: TestClient, store: Store) -> None:
    """Summary, file and digests are those of another state, so that each is right by itself."""
    job, other = submitted(client, at(0.3)), submitted(client, at(1.2))
    for each in (job, other):
        finished(client, each)
    assert (force(client, job), force(client, other)) == (right(0.3), right(1.2))
    keys = items(client, other)[0]["key"], items(client, job)[0]["key"]
    done(store, RESULTS.format(FORGED[case], *keys), FILES.format(*keys))
    if "older" in case:  # its owner may read it, and is told
        assert [each["computed_here"] for each in items(client, job)] == [False]
        assert faults(store) == {}
    else:
        told(client.get(f"/v1/jobs/{job}/items"), "submit its job again")
        told(client.get(f"/v1/jobs/{job}/items/0/files/result"), "submit its job again")
        assert list(faults(store)) == [f"result {keys[1]}"]
    again = finished(client, submitted(client, at(0.3)))
    assert (again["state"], again["attempts"]) == ("succeeded", 1)
    assert [force(client, each) for each in (again["id"], job, other)] == [right(0.3), right(0.3), right(1.2)]
    assert [each["computed_here"] for each in items(client, job)] == [True]
    assert finished(client, submitted(client, at(0.3)))["attempts"] == 0, "and is computed once from now on"
    assert faults(store) == {}


OTHERWISE = {
    "a result of an item that failed": "UPDATE results SET is_good = {yes}",
    "a file more": "INSERT INTO result_files (key, name, size, content, digest) "
    "SELECT key, 'more', size, content, digest FROM result_files",
    "a file less": "DELETE FROM result_files",
    "a file of another name": "UPDATE result_files SET name = 'more'",
    "another digest, and no content of it": "UPDATE result_files SET digest = ''",
}


@pytest.mark.parametrize("case", OTHERWISE)
def test_what_belongs_to_a_result_is_sealed(case: str, client: TestClient, store: Store) -> None:
    item = at(0.3)
    key = items(client, finished(client, submitted(client, item))["id"])[0]["key"]
    if "failed" in case:
        done(store, "DELETE FROM result_files", "DELETE FROM results")
        with store.database.write() as connection:
            put_results(connection, [Result(key, "evaluate", "{}", {"result": b"half"}, is_good=False)])
    done(store, OTHERWISE[case].format(yes="true"))
    again = finished(client, submitted(client, item))
    assert (again["attempts"], force(client, again["id"])) == (1, right(0.3))


def test_an_item_under_the_key_of_another_is_of_no_use_to_that(client: TestClient, store: Store) -> None:
    """What this server computes of a forged item has no seal of that key."""
    wanted, other = (jobs.prepare(store, ANYBODY, at(q)).items[0] for q in (0.3, 1.2))
    with store.database.write() as connection:
        job = add_job(connection, "evaluate", ANYBODY, [NewItem(wanted.key, other.item, other.blobs)])
    assert finished(client, job)["state"] == "succeeded"
    assert (force(client, job), items(client, job)[0]["computed_here"]) == (right(1.2), False)
    again = finished(client, submitted(client, at(0.3)))
    assert (again["attempts"], force(client, again["id"])) == (1, right(0.3))


def test_what_is_asked_for_by_get_is_computed_anew(client: TestClient, store: Store) -> None:
    """The job that it has become already is of no use when its result is forged."""
    path, headers = "/v1/trees/cell/export?target=c&quantities=forces", {"Prefer": "respond-async"}
    made = list[Any]()
    for statement in ("SELECT 1", "SELECT 1", "UPDATE results SET summary = '{}', digest = ''"):
        done(store, statement)
        answer = client.get(path, headers=headers)
        assert answer.status_code == 202, answer.text
        made.append(finished(client, answer.json()["id"]))
    assert made[0]["id"] == made[1]["id"] != made[2]["id"]
    assert (made[2]["state"], made[2]["attempts"]) == ("succeeded", 1)


def test_a_damaged_result_is_computed_anew_after_a_repair(client: TestClient, store: Store) -> None:
    """Its seal is right, and its content is not: only who reads all of it sees that."""
    job = finished(client, submitted(client, at(0.3)))["id"]
    done(store, "UPDATE result_files SET content = (SELECT content FROM programs LIMIT 1)")
    answer = client.get(f"/v1/jobs/{job}/items/0/files/result")
    assert (answer.status_code, answer.json()["code"]) == (500, "damaged-content")
    assert "after 'substructures verify --repair', submit its job again" in answer.json()["detail"]
    assert [finding.what.split()[0] for finding in verify_all(store.database, repair=True) if finding.fault] == [
        "result"
    ]
    again = finished(client, submitted(client, at(0.3)))
    assert (again["attempts"], force(client, again["id"]), force(client, job)) == (1, right(0.3), right(0.3))


ANSWERS = {
    "no body": "UPDATE idempotency SET body = NULL",
    "a body": "UPDATE idempotency SET body = '{}'",  # a text on SQLite, bytes on PostgreSQL
    "a status": "UPDATE idempotency SET status = 200",
    "headers": """UPDATE idempotency SET headers = '{"Location": "/v1/trees/cell@1"}'""",
    "no seal": "UPDATE idempotency SET seal = ''",
    "the answer to another request": "UPDATE idempotency SET seal = o.seal, body = o.body, headers = o.headers, "
    "status = o.status FROM idempotency o WHERE o.key = 'other' AND idempotency.key = '3f6b'",
}


@pytest.mark.parametrize("case", ANSWERS)
def test_a_forged_answer_is_not_given_again(case: str, client: TestClient, store: Store) -> None:
    """Nor is what was done done twice; another key does what is to be done."""
    for headers, name in ((KEY, "hand"), ({"Idempotency-Key": "other"}, "second")):
        body = {**HAND, "name": name}
        first, replayed = (client.post("/v1/trees/cell/couplings", json=body, headers=headers) for _ in range(2))
        assert (first.status_code, replayed.content) == (201, first.content)
    assert faults(store) == {}
    before = client.get("/v1/trees/cell").json()
    done(store, ANSWERS[case])
    for _ in range(2):
        told(client.post("/v1/trees/cell/couplings", json=HAND, headers=KEY), "is not served again")
    assert client.get("/v1/trees/cell").json() == before
    named = [what for what in faults(store) if "'3f6b' of 'local'" in what]
    assert len(named) == (case != "no seal")
    other = {"json": {**HAND, "name": "third"}, "headers": {"Idempotency-Key": "third"}}
    assert client.post("/v1/trees/cell/couplings", **other).status_code == 201


def exchanged(store: Store, *columns: str) -> None:
    """Values of two versions of the pendulum; ``columns`` begin with the digest, which is unique at all times."""
    chosen = [versions.c[name] for name in columns]
    with store.database.write() as connection:
        query = select(versions.c.version, *chosen).where(versions.c.name == "pendulum").order_by(versions.c.version)
        (_, *one), (_, *two) = connection.execute(query).all()
        free = select(parts.c.digest).where(parts.c.digest.not_in(select(versions.c.digest)))
        spare = connection.execute(free).scalar_one()
        for number, values in ((1, [spare, *one[1:]]), (2, one), (1, two)):
            row = update(versions).where(versions.c.name == "pendulum", versions.c.version == number)
            connection.execute(row.values(dict(zip(columns, values, strict=True))))


@pytest.mark.parametrize("columns", ["digest", "digest seal", "digest created author"])
def test_exchanged_versions_are_named(columns: str, client: TestClient, store: Store) -> None:
    inline = {"name": "other", "instances": [{"name": "a", "definition": {**PENDULUM, "name": "nobody"}}]}
    assert client.post("/v1/trees", json=inline).status_code == 201
    assert faults(store) == {}
    exchanged(store, *columns.split())
    named = {
        "substructure pendulum@1": "it was pendulum@2, and is pendulum@1 now",
        "substructure pendulum@2": "it was pendulum@1, and is pendulum@2 now",
    }
    assert Renewal(store).all() == 0
    found = faults(store)
    assert all(found[what].startswith(words) for what, words in named.items()), found
    assert client.get("/v1/substructures/pendulum@1").status_code == 200
    job = finished(client, submitted(client, {"kind": "verify", "items": [{"substructure": "*"}]}))
    problems = [each["problem"]["detail"] for each in items(client, job["id"]) if each["problem"]]
    assert [any(words in each for each in problems) for words in named.values()] == [True, True]
    assert len(problems) == 2
    done(store, "UPDATE versions SET seal = ''")
    assert named.keys() <= faults(store).keys(), "a seal that is gone is told, once there was one"


def as_before_seals(store: Store) -> None:
    """What the version before this schema left."""
    with store.database.write() as connection:
        for table in (versions, results, idempotency):
            connection.execute(update(table).values(seal=""))
        connection.execute(update(renewals).values(seal=seal(connection, ["renewal", software()])))


def test_a_store_of_before_is_sealed_once(client: TestClient, store: Store, caplog: pytest.LogCaptureFixture) -> None:
    """Results of before are read, and not taken for those of later items."""
    job = finished(client, submitted(client, at(0.3)))["id"]
    as_before_seals(store)
    assert faults(store) == {}
    assert Renewal(store).all() == 0
    assert "the numbers of 3 versions had no seal of this server" in caplog.text
    assert faults(store) == {}
    assert [each["computed_here"] for each in items(client, job)] == [False]
    assert force(client, job) == right(0.3)
    assert "without the seal of this server: 0" in client.get(f"/jobs/{job}").text
    assert finished(client, submitted(client, at(0.3)))["attempts"] == 1
    caplog.clear()
    assert Renewal(store).all() == 0
    assert caplog.text == ""


def test_a_store_without_its_key(tmp_path: Path) -> None:
    """Results are of somebody else until their jobs are submitted again, or the key is back."""
    address, other = (f"sqlite:///{tmp_path / name}" for name in ("a.db", "b.db"))
    with open_store(Settings(database=address, catalogue=False)) as store, running(store, FakeEngine()):
        client = make_client(store)
        for kind, body in (("substructures", PENDULUM), ("trees", TREE)):
            assert client.post(f"/v1/{kind}", json=body, headers={"Idempotency-Key": kind}).status_code == 201
        made = [finished(client, submitted(client, body))["id"] for body in (at(0.3), export("cell", "metric"))]
    backup(address, tmp_path / "saved")
    restore(tmp_path / "saved", other)
    with open_store(Settings(database=other, catalogue=False)) as store, running(store, FakeEngine()):
        client = make_client(store)
        assert Renewal(store).all() == 0
        assert {what.split()[0] for what in faults(store)} == {"result", "answer"}
        for job in made:
            told(client.get(f"/v1/jobs/{job}/items"), "submit its job again")
        told(client.post("/v1/trees", json=TREE, headers={"Idempotency-Key": "trees"}), "under another key")
        assert finished(client, submitted(client, at(0.3)))["attempts"] == 1
        assert force(client, made[0]) == right(0.3)
    shutil.copy(tmp_path / "saved", tmp_path / "c.db")
    shutil.copy(tmp_path / "a.db.key", tmp_path / "c.db.key")
    with open_store(Settings(database=f"sqlite:///{tmp_path / 'c.db'}", catalogue=False)) as store:
        assert faults(store) == {}
        assert force(make_client(store), made[0]) == right(0.3)
