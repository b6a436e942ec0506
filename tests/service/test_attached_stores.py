"""Stores that come from elsewhere, with forged formulas: named by verify, never served, derived anew."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from time import sleep
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.content.derivation import software
from service.content.summaries import PartContent, part_content
from service.database.backup import backup, restore
from service.database.packed import pack, unpack
from service.messages.refusals import Refused
from service.operations.catalogue import PartSubmission, submit
from service.operations.renewal import OPERATOR
from service.operations.renewing import Renewal
from service.operations.verification import verify_all
from service.settings import Limits, Settings
from service.store.store import Store
from substructures.documents import write_json
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.derive import derive, recheck

from .conftest import HAND, PENDULUM, SLIDER, make_client
from .damaged_bundles import bump, swapped, wrong_elsewhere
from .fake_engine import FakeEngine, finished, running, submitted
from .seals import seal_again

Forgery = Callable[[Any], None]
AT_HALF = {"q": [0.5], "quantities": ["metric"]}


def forged(path: Path, forgery: Forgery) -> None:
    """Other formulas of the pendulum, under a digest of their own, in its part and in the tree that is made of it."""
    with closing(sqlite3.connect(path)) as connection:
        old = connection.execute("SELECT program FROM parts JOIN versions USING (digest) WHERE name = 'pendulum'")
        for table, (program,) in (
            ("parts", old.fetchone()),
            ("trees", connection.execute("SELECT program FROM trees").fetchone()),
        ):
            (content,) = connection.execute("SELECT content FROM programs WHERE digest = ?", (program,)).fetchone()
            document = json.loads(unpack(content))
            if table == "trees" and forgery is not bump:
                continue
            forgery(document)
            wrong = Program.from_bytes(write_json(document))
            connection.execute("INSERT INTO programs VALUES (?, ?, ?, '')", (wrong.digest, pack(wrong), len(wrong)))
            connection.execute(f"UPDATE {table} SET program = ? WHERE program = ?", (wrong.digest, program))  # noqa: S608
        connection.commit()


def boasting(path: Path) -> None:
    """Another certificate."""
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("""UPDATE parts SET certificate = replace(certificate, '"states":1', '"states":9')""")
        connection.commit()


DONE: dict[str, Callable[[Path], None]] = {
    "a bump": lambda path: forged(path, bump),
    "right at a known state": lambda path: forged(path, wrong_elsewhere),
    "swapped rows": lambda path: forged(path, swapped),
    "another certificate": boasting,
    "nothing": lambda _: None,
}


@pytest.mark.parametrize("forgery", [bump, wrong_elsewhere])
def test_what_sampling_takes_for_right(forgery: Forgery) -> None:
    """Why formulas of others are not compared at states: whoever forges them knows the states, or differs between."""
    part = derive(Definition.read(PENDULUM))
    document = json.loads(part.program.to_bytes())
    forgery(document)
    wrong = type(part)(part.definition, Program.from_bytes(write_json(document)), {})
    try:
        assert recheck(wrong)["direct_form"]
    except VerificationFailed:
        pytest.fail("this forgery is found by sampling; plant a better one")
    assert wrong.program.digest != part.program.digest


def served(client: TestClient) -> None:
    """Right numbers of a tree that there is, and of one that is coupled now."""
    answer = client.post("/v1/trees/cell/evaluations", json=AT_HALF)
    assert (answer.status_code, answer.json()["metric"]) == (200, [[2.2]]), answer.text  # m l^2 + m l^2 / 10
    found = client.get("/v1/substructures/pendulum").json()
    assert (found["certificate"]["states"], found["derived_here"]) == (1, True)
    assert client.post("/v1/trees/cell/couplings", json=HAND).status_code == 201


@pytest.mark.parametrize("case", DONE)
@pytest.mark.parametrize("is_in_background", [False, True])
def test_a_store_from_elsewhere(case: str, is_in_background: bool, template: Path, tmp_path: Path) -> None:
    """Its file without the key beside it: what is asked for is derived first, or all of it in the background."""
    path = tmp_path / "store.db"
    shutil.copy(template, path)
    DONE[case](path)
    assert main(["verify", "--database", f"sqlite:///{path}"]) == 1
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        if is_in_background:
            assert Renewal(store).all() == 0
            assert [each for each in verify_all(store.database) if each.fault] == []
        served(make_client(store))
        with store.database.read() as connection:
            kept = set(
                connection.exec_driver_sql("SELECT program FROM parts UNION SELECT program FROM trees").scalars()
            )
            assert set(connection.exec_driver_sql("SELECT digest FROM programs").scalars()) == kept


@pytest.mark.parametrize("case", [case for case in DONE if case != "nothing"])
def test_verify_names_what_has_the_seal_of_this_server(
    case: str, template: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also where whoever forged it has the key: nothing is believed that is not derived."""
    path = tmp_path / "store.db"
    shutil.copy(template, path)
    DONE[case](path)
    seal_again(path)
    assert main(["verify", "--database", f"sqlite:///{path}"]) == 1
    what = "certificate" if case == "another certificate" else "program"
    assert f"substructure pendulum@1: what is stored is not what this version derives of its document: {what}" in (
        capsys.readouterr().out
    )
    assert main(["verify", "--repair", "--database", f"sqlite:///{path}"]) == 0
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        served(make_client(store))


def test_what_is_not_renewed_yet_is_neither_wrong_nor_verified(
    template: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As other software left it, until this one has looked at all; without this server's seal it is wrong at once."""
    path = tmp_path / "store.db"
    shutil.copy(template, path)
    shutil.copy(f"{template}.key", f"{path}.key")
    forged(path, bump)
    seal_again(path, "another one")
    command = ["verify", "--database", f"sqlite:///{path}"]
    assert main(command) == 0
    told = capsys.readouterr().out
    assert "substructure pendulum@1: not renewed yet, nor verified: another version derived it" in told
    assert told.endswith("0 verified, 0 wrong, 3 not renewed yet\n")
    assert main([*command, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["verified"], told["wrong"], told["not_renewed"]) == (0, 0, 3)
    for damage, fault in (
        ("UPDATE parts SET title = 'other' WHERE title = 'Pendulum'", "document: program, title"),
        ("UPDATE parts SET formulas = formulas || ' '", "damaged"),
        ("UPDATE trees SET dof = dof + 1", "document: program, dof"),
        ("DELETE FROM programs", "gone from the store"),
        ("UPDATE tree_parts SET part = 'sha256:0'", "the parts that it is found by"),
    ):
        copy = tmp_path / "damaged.db"
        shutil.copy(path, copy)
        shutil.copy(f"{path}.key", f"{copy}.key")
        with closing(sqlite3.connect(copy)) as connection, connection:
            connection.execute("PRAGMA foreign_keys = OFF")
            connection.execute(damage)
        assert main(["verify", "--database", f"sqlite:///{copy}"]) == 1, damage
        assert fault in capsys.readouterr().out, damage
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        assert Renewal(store).all() == 0
        assert main(command) == 0
        assert capsys.readouterr().out == "3 verified, 0 wrong\n"
    seal_again(path, "another one")
    assert main(command) == 1, "this software has looked at all"
    assert "it was derived by another version of the software" in capsys.readouterr().out


def test_what_is_not_renewed_yet_is_derived_anew_where_that_is_asked_for(
    template: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the command with ``--repair``, and before the items of a job are queued."""
    repaired, asked = tmp_path / "repaired.db", tmp_path / "asked.db"
    for path in (repaired, asked):
        shutil.copy(template, path)
        shutil.copy(f"{template}.key", f"{path}.key")
        forged(path, bump)
        seal_again(path, "another one")
    assert main(["verify", "--repair", "--database", f"sqlite:///{repaired}"]) == 0
    assert capsys.readouterr().out.endswith("\n3 verified, 0 wrong, 3 derived anew\n")
    settings = Settings(database=f"sqlite:///{asked}", catalogue=False)
    with open_store(settings) as store, running(store, FakeEngine()):
        client = make_client(store)
        job = submitted(client, {"kind": "verify", "items": [{"tree": "*"}, {"substructure": "*"}]})
        finished(client, job)
        items = client.get(f"/v1/jobs/{job}/items").json()["items"]
        assert [each["state"] for each in items] == ["succeeded"] * 3
    for path in (repaired, asked):
        assert main(["verify", "--database", f"sqlite:///{path}"]) == 0
        assert capsys.readouterr().out == "3 verified, 0 wrong\n"


def test_who_submits_the_definition_gets_its_own_formulas(template: Path, tmp_path: Path) -> None:
    """Content that came from elsewhere is none that is known."""
    path = tmp_path / "store.db"
    shutil.copy(template, path)
    forged(path, bump)
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        answer = make_client(store).post("/v1/substructures", json=PENDULUM)
        right = derive(Definition.read(PENDULUM)).program.digest
        assert (answer.status_code, answer.json()["program"]) == (200, right)


def test_a_backup_is_believed_where_it_was_made(tmp_path: Path) -> None:
    """Its seals are those of the store beside whose key it is put back; elsewhere it is derived anew."""
    settings = Settings(database=f"sqlite:///{tmp_path / 'store.db'}", catalogue=False)
    with open_store(settings) as store:
        assert make_client(store).post("/v1/substructures", json=PENDULUM).status_code == 201
    backup(settings.database, tmp_path / "saved")
    restore(tmp_path / "saved", settings.database, overwrite=True)
    elsewhere = Settings(database=f"sqlite:///{tmp_path / 'other.db'}", catalogue=False)
    restore(tmp_path / "saved", elsewhere.database)
    for where, is_believed in ((settings, True), (elsewhere, False)):
        with open_store(where) as store:
            client = make_client(store)
            (item,) = client.get("/v1/substructures").json()["items"]
            assert item["derived_here"] is is_believed
            assert client.get("/v1/substructures/pendulum").json()["derived_here"] is True


def test_a_published_tree_is_proven_by_what_it_was_coupled_of(filled: TestClient) -> None:
    """Its formulas are others than those that its definition alone leads to, and the tree may be gone."""
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    answer = filled.post("/v1/trees/cell/publish", json={"name": "arm", "ports": {"grip": "hand.tip"}})
    assert answer.status_code == 201, answer.text
    assert filled.delete("/v1/trees/cell").status_code == 204
    store = filled.app.state.store  # type: ignore[attr-defined]
    assert [each for each in verify_all(store.database) if each.fault] == []
    with store.database.write() as connection:
        connection.exec_driver_sql("UPDATE parts SET seal = '' WHERE recipe IS NOT NULL")
    again = filled.get("/v1/substructures/arm").json()
    assert (again["program"], again["derived_here"]) == (answer.json()["program"], True)


def test_what_takes_too_long_is_asked_for_again(template: Path, tmp_path: Path) -> None:
    """It is derived all the same, for the next request."""
    path = tmp_path / "store.db"
    shutil.copy(template, path)
    limits = Limits(sync_seconds=1e-6)
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, limits=limits)) as store:
        client = make_client(store)
        answer = client.get("/v1/trees/cell")
        assert (answer.status_code, answer.json()["code"]) == (503, "not-derived")
        assert answer.headers["retry-after"] == "1"
        with store.runtime.renewing:  # it has ended
            pass
        for _ in range(100):
            if client.get("/v1/trees/cell").status_code == 200:
                break
            sleep(0.1)
        assert client.get("/v1/trees/cell").json()["derived_here"] is True


def test_a_worker_of_other_software(client: TestClient, store: Store) -> None:
    """What it derived is known as such: it is served, and derived anew before anything is coupled of it."""
    made = part_content(derive(Definition.read(PENDULUM)))
    files = {**made.files(), "content": made.files()["content"].replace(software().encode(), b"another one")}
    content = PartContent.of_files(files)
    assert content.row["software"] == "another one"
    assert Renewal(store).all() == 0
    with store.database.write() as connection:
        submit(connection, OPERATOR, PartSubmission(content.name, content.digest, content))
    assert client.get("/v1/substructures/pendulum").json()["derived_here"] is True
    faults = [each.fault for each in verify_all(store.database)]
    assert faults == ["it was derived by another version of the software"]
    tree = {"name": "t", "instances": [{"name": "a", "substructure": "pendulum"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    assert [each.fault for each in verify_all(store.database)] == ["", ""]


@pytest.mark.parametrize("damage", ["program", "definition"])
def test_a_worker_that_answers_with_something_else(damage: str) -> None:
    """Contents have to be what they are called."""
    made, other = (part_content(derive(Definition.read(each))) for each in (PENDULUM, SLIDER))
    files = made.files()
    if damage == "program":
        files["program"] = other.files()["program"]
    else:
        files["content"] = files["content"].replace(b"m*l^2/5", b"m*l^2/6")
    with pytest.raises(Refused, match="its bytes have the digest"):
        PartContent.of_files(files)
