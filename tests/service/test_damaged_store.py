"""What was changed in the store behind its back is refused by name, by everybody who reads, and never used."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.database.packed import pack, unpack
from service.settings import Settings
from substructures.expr.program import Program

from .conftest import HAND, PENDULUM, make_client
from .fake_engine import FakeEngine, finished, running, submitted

Damage = Callable[[sqlite3.Connection], None]


@contextmanager
def opened(template: Path, folder: Path, damage: Damage) -> Iterator[TestClient]:
    """A server on a copy of a store that was damaged before anybody asked it."""
    shutil.copy(template, folder / "store.db")
    settings = Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False)
    with open_store(settings) as store, running(store, FakeEngine()):
        with closing(sqlite3.connect(folder / "store.db")) as connection:
            damage(connection)
            connection.commit()
        yield make_client(store)


def doubled(connection: sqlite3.Connection, digest: str) -> None:
    """A program that can be read, and of which one number is another."""
    (content,) = connection.execute("SELECT content FROM programs WHERE digest = ?", (digest,)).fetchone()
    document = json.loads(unpack(content))
    name = next(n for n in ("metric", "inertia.m") if document["outputs"][n]["entries"])
    entries, n = document["outputs"][name]["entries"], len(document["operations"])
    document["operations"].append(["add", entries[0], entries[0]])
    entries[0] = n
    wrong = pack(Program.from_bytes(json.dumps(document).encode()))
    connection.execute("UPDATE programs SET content = ? WHERE digest = ?", (wrong, digest))


def pendulum(connection: sqlite3.Connection) -> tuple[str, str]:
    """Digests of definition and program."""
    joined = "SELECT p.digest, p.program FROM parts p JOIN versions v ON v.digest = p.digest WHERE v.name = 'pendulum'"
    digest, program = connection.execute(joined).fetchone()
    return str(digest), str(program)


def wrong_part(connection: sqlite3.Connection) -> None:
    doubled(connection, pendulum(connection)[1])


def wrong_tree(connection: sqlite3.Connection) -> None:
    doubled(connection, connection.execute("SELECT program FROM trees").fetchone()[0])


def torn_program(connection: sqlite3.Connection) -> None:
    connection.execute(
        "UPDATE programs SET content = substr(content, 1, 40) WHERE digest = ?", (pendulum(connection)[1],)
    )


def other_definition(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE parts SET definition = replace(definition, '/10', '/11')")


def broken_definition(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE parts SET definition = substr(definition, 1, 90)")


def other_tree(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE trees SET spec = replace(spec, '9.81', '9.82')")


def gone_program(connection: sqlite3.Connection) -> None:
    connection.execute("DELETE FROM programs WHERE digest = ?", (pendulum(connection)[1],))


def gone_tree_program(connection: sqlite3.Connection) -> None:
    connection.execute("DELETE FROM programs WHERE digest IN (SELECT program FROM trees)")


def gone_part(connection: sqlite3.Connection) -> None:
    connection.execute("DELETE FROM parts")


GETS_PART = (
    "/v1/substructures/pendulum/formulas/metric",
    "/substructures/pendulum",
    "/v1/substructures/pendulum/picture",
)
GETS_TREE = ("/v1/trees/cell/metric", "/trees/cell", "/v1/trees/cell/picture")
EVALUATION = {"q": [0.3], "quantities": ["metric"]}
REGRESSOR = {"q": [0.3], "qd": [0], "qdd": [0], "quantities": ["regressor"]}


def refused(answer: Any, code: str) -> None:
    """The store is blamed, by name."""
    assert answer.status_code == 500, answer.text
    problem = answer.json()
    assert problem["code"] == code, problem
    assert problem["digest"].startswith("sha256:")
    assert problem["digest"] in problem["detail"]
    assert not problem["errors"]


@pytest.mark.parametrize(
    ("damage", "code"),
    [
        (wrong_part, "damaged-content"),
        (torn_program, "damaged-content"),
        (other_definition, "damaged-content"),
        (broken_definition, "damaged-content"),
        (gone_program, "missing-content"),
        (gone_part, "missing-content"),
    ],
)
def test_a_damaged_part_is_refused_by_name(template: Path, tmp_path: Path, damage: Damage, code: str) -> None:
    with opened(template, tmp_path, damage) as client:
        for path in GETS_PART[:2] if damage is not gone_part else ():
            refused(client.get(path), code)
        refused(client.post("/v1/trees/cell/couplings", json=HAND), code)
        refused(client.post("/v1/trees/cell/evaluations", json=REGRESSOR), code)
        assert client.get("/v1/trees/cell").json()["revision"] == 1


@pytest.mark.parametrize(
    ("damage", "code"),
    [(wrong_tree, "damaged-content"), (other_tree, "damaged-content"), (gone_tree_program, "missing-content")],
)
def test_a_damaged_tree_is_refused_by_name(template: Path, tmp_path: Path, damage: Damage, code: str) -> None:
    with opened(template, tmp_path, damage) as client:
        for path in GETS_TREE[:2]:
            refused(client.get(path), code)
        refused(client.post("/v1/trees/cell/evaluations", json=EVALUATION), code)


@pytest.mark.parametrize("damage", [wrong_part, torn_program, other_definition, gone_program])
def test_workers_use_no_damaged_content(template: Path, tmp_path: Path, damage: Damage) -> None:
    with opened(template, tmp_path, damage) as client:
        job = submitted(client, {"kind": "verify", "items": [{"substructure": "pendulum"}]})
        assert finished(client, job)["state"] == "failed"
        (item,) = client.get(f"/v1/jobs/{job}/items").json()["items"]
        assert item["problem"]["code"] in ("damaged-content", "missing-content")
        assert "sha256:" in item["problem"]["detail"]


@pytest.mark.parametrize("damage", [wrong_part, torn_program, other_definition, gone_program])
def test_submitting_the_definition_again_mends_it(template: Path, tmp_path: Path, damage: Damage) -> None:
    with opened(template, tmp_path, damage) as client:
        assert client.get("/v1/substructures/pendulum/formulas/metric").status_code == 500
        answer = client.post("/v1/substructures", json=PENDULUM)
        assert (answer.status_code, answer.json()["version"]) == (200, 1)
        assert client.get("/v1/substructures/pendulum/formulas/metric").status_code == 200
        assert client.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
