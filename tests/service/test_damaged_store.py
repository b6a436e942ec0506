"""What was changed in the store behind its back is refused by name, by everybody who reads, and never used."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.database.packed import pack, unpack
from service.operations.verification import verify_all
from service.settings import Settings
from substructures.expr.program import Program

from .conftest import HAND, PENDULUM, copied, make_client
from .fake_engine import FakeEngine, finished, running, submitted
from .seals import seal_again
from .whole_summaries import put_whole_summary, whole_summary

Damage = Callable[[sqlite3.Connection], None]


@contextmanager
def opened(template: Path, folder: Path, damage: Damage, is_sealed: bool = False) -> Iterator[TestClient]:
    """A server on a copy of a store that was damaged before anybody asked it; ``is_sealed``: by who has its key."""
    copied(template, folder / "store.db")
    settings = Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False)
    with open_store(settings) as store, running(store, FakeEngine()):
        with closing(sqlite3.connect(folder / "store.db")) as connection:
            damage(connection)
            connection.commit()
        if is_sealed:
            seal_again(folder / "store.db")
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


GETS_PART = ("/v1/substructures/pendulum/formulas/metric", "/substructures/pendulum")
GETS_TREE = ("/v1/trees/cell/metric", "/trees/cell")
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
        for path in GETS_PART if damage is not gone_part else ():
            refused(client.get(path), code)
        refused(client.post("/v1/trees/cell/couplings", json=HAND), code)
        refused(client.post("/v1/trees/cell/evaluations", json=REGRESSOR), code)
        assert client.get("/v1/trees/cell").json()["revision"] == 1


@pytest.mark.parametrize(
    ("damage", "code"),
    [
        (wrong_tree, "damaged-content"),
        (other_tree, "damaged-content"),
        (lambda c: other_summary(c), "damaged-content"),
        (lambda c: other_values(c), "damaged-content"),
        (lambda c: one_value_less(c), "damaged-content"),
        (lambda c: other_form(c), "damaged-content"),
        (gone_tree_program, "missing-content"),
    ],
)
def test_a_damaged_tree_is_refused_by_name(template: Path, tmp_path: Path, damage: Damage, code: str) -> None:
    with opened(template, tmp_path, damage) as client:
        for path in GETS_TREE:
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


def wrong_formula(connection: sqlite3.Connection, table: str) -> None:
    """A wrong program under the digest that it has: as an older version may have derived it."""
    (old,) = connection.execute(f"SELECT program FROM {table} ORDER BY digest LIMIT 1").fetchone()  # noqa: S608
    doubled(connection, old)
    (content, nodes) = connection.execute("SELECT content, nodes FROM programs WHERE digest = ?", (old,)).fetchone()
    new = Program.from_bytes(unpack(content)).digest
    connection.execute("INSERT INTO programs VALUES (?, ?, ?, '')", (new, content, nodes))
    connection.execute(f"UPDATE {table} SET program = ? WHERE program = ?", (new, old))  # noqa: S608


def other_summary(connection: sqlite3.Connection) -> None:
    connection.execute("""UPDATE summary_forms SET content = replace(content, '"joints":"R"', '"joints":"P"')""")


def other_values(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE trees SET summary_values = replace(summary_values, '9.81', '9.82')")


def one_value_less(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE trees SET summary_values = substr(summary_values, instr(summary_values, char(10)) + 1)")


def other_form(connection: sqlite3.Connection) -> None:
    connection.execute("PRAGMA foreign_keys=OFF")
    connection.execute("UPDATE trees SET summary_form = 'sha256:0'")


def with_its_digest(connection: sqlite3.Connection, before: str, after: str) -> None:
    """Another summary, as an older version may have written it."""
    summary = whole_summary(connection)
    wrong = summary.replace(before, after)
    assert wrong != summary
    put_whole_summary(connection, wrong)


def other_axes(connection: sqlite3.Connection) -> None:
    with_its_digest(connection, '"joints":"R"', '"joints":"P"')


def other_defaults(connection: sqlite3.Connection) -> None:
    with_its_digest(connection, '"value":9.81', '"value":9.82')


def other_index(connection: sqlite3.Connection) -> None:
    connection.execute("""UPDATE parts SET formulas = replace(formulas, '"rod"', '"nose"')""")


def other_columns(connection: sqlite3.Connection) -> None:
    connection.execute("""UPDATE parts SET coordinates = '["nose"]' WHERE coordinates = '["q"]'""")


def test_a_wrong_part_is_named_when_it_is_coupled(template: Path, tmp_path: Path) -> None:
    """Digest and seal are right, so that the certificate of the tree has to find it."""
    with opened(template, tmp_path, lambda c: wrong_formula(c, "parts"), is_sealed=True) as client:
        for name in ("pendulum", "slider"):
            answer = client.post("/v1/trees", json={"name": "t", "instances": [{"name": "x", "substructure": name}]})
            if answer.status_code != 201:
                break
        problem = answer.json()
        assert (problem["status"], problem["code"]) == (500, "verification-failed")
        assert f"'{name}'" in problem["detail"]
        assert "sha256:" in problem["detail"]
        assert client.get("/v1/trees/t").status_code == (404 if name == "pendulum" else 200)


def other_certificate(connection: sqlite3.Connection) -> None:
    """One digit."""
    connection.execute("""UPDATE parts SET certificate = replace(certificate, '"states":1', '"states":2')""")


def other_seconds(connection: sqlite3.Connection) -> None:
    connection.execute("""UPDATE parts SET certificate = replace(certificate, '"derive":0.', '"derive":7.')""")


def other_counts(connection: sqlite3.Connection) -> None:
    connection.execute("""UPDATE parts SET operations = replace(operations, '"total":', '"total":1')""")


def heavier(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE parts SET mass = mass + 1")


def heavier_tree(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE trees SET mass = mass + 1")


def found_as_heavier(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE substructures SET mass = mass + 1, dof = dof + 1")


def tree_found_as_heavier(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE tree_names SET mass = mass + 1")


def found_by_other_words(connection: sqlite3.Connection) -> None:
    connection.execute("UPDATE search_terms SET term = 'spatial' WHERE term = 'planar'")


def found_by_other_parts(connection: sqlite3.Connection) -> None:
    other = "SELECT digest FROM parts WHERE digest NOT IN (SELECT part FROM tree_parts)"
    connection.execute(f"UPDATE tree_parts SET part = ({other})")  # noqa: S608


def program_of_another(connection: sqlite3.Connection) -> None:
    """The row of a part points to the program of another one."""
    digest, _ = pendulum(connection)
    other = "SELECT program FROM parts WHERE digest != ?"
    connection.execute(f"UPDATE parts SET program = ({other}) WHERE digest = ?", (digest, digest))  # noqa: S608


def program_of_no_tree(connection: sqlite3.Connection) -> None:
    """The row of a tree points to the program of a part, which has the same symbols."""
    connection.execute("UPDATE trees SET program = ?", (pendulum(connection)[1],))


def called_otherwise(connection: sqlite3.Connection) -> None:
    """A part becomes a version of another name, which searches do not find."""
    connection.execute("UPDATE versions SET name = 'slider', version = 2 WHERE name = 'pendulum'")


WRONG: list[tuple[Damage, tuple[str, ...], bool]] = [
    (lambda c: wrong_formula(c, "parts"), ("substructure",), True),
    (lambda c: wrong_formula(c, "trees"), ("tree cell@1",), True),
    (wrong_part, ("substructure pendulum@1",), True),
    (wrong_tree, ("tree cell@1",), True),
    (torn_program, ("substructure pendulum@1",), True),
    (gone_program, ("substructure pendulum@1",), True),
    (gone_tree_program, ("tree cell@1",), True),
    (other_summary, ("tree cell@1", "summary"), True),
    (other_axes, ("tree cell@1", "joints"), True),
    (other_defaults, ("tree cell@1", "parameters"), True),
    (other_index, ("substructure", "index"), True),
    (other_columns, ("substructure pendulum@1", "coordinates"), True),
    (other_certificate, ("substructure pendulum@1", "certificate"), True),
    (other_seconds, ("substructure pendulum@1", "changed in the store"), True),
    (other_counts, ("substructure pendulum@1", "operations"), True),
    (heavier, ("substructure pendulum@1", "mass"), True),
    (heavier_tree, ("tree cell@1", "mass"), True),
    (found_as_heavier, ("substructure pendulum@1", "dof, mass"), True),
    (tree_found_as_heavier, ("tree cell@1", "mass"), True),
    (found_by_other_words, ("substructure pendulum@1", "words"), True),
    (found_by_other_parts, ("tree cell@1", "parts"), True),
    (program_of_another, ("substructure pendulum@1", "program"), True),
    (program_of_no_tree, ("tree cell@1", "program"), True),
    (called_otherwise, ("substructure slider@2", "'pendulum'"), False),
    (other_definition, ("substructure pendulum@1",), False),
    (broken_definition, ("substructure pendulum@1", "tree cell@1"), False),
    (gone_part, ("substructure pendulum@1", "submit it again"), False),
    (other_tree, ("tree cell@1",), False),
]


@pytest.mark.parametrize(("damage", "told", "can_mend"), WRONG)
def test_verify_finds_and_mends(
    template: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    damage: Damage,
    told: tuple[str, ...],
    can_mend: bool,
) -> None:
    """``substructures verify`` tells of it by name, also while a server runs; --repair mends what has its document."""
    address = f"sqlite:///{tmp_path / 'store.db'}"
    with opened(template, tmp_path, lambda _: None):
        assert main(["verify", "--database", address]) == 0
        assert "3 verified, 0 wrong" in capsys.readouterr().out
    with opened(template, tmp_path, damage) as client:
        assert main(["verify", "--database", address]) == 1
        found = capsys.readouterr().out
        assert all(words in found for words in told), found
        assert main(["verify", "--database", address, "--repair"]) == int(not can_mend)
        assert ("derived anew" in capsys.readouterr().out) or not can_mend
        assert main(["verify", "--database", address]) == int(not can_mend)
        if can_mend:
            assert client.get("/v1/trees/cell/metric").status_code == 200
            assert client.post("/v1/trees/cell/couplings", json=HAND).status_code == 201


HEALS = (
    other_certificate,
    other_counts,
    heavier,
    program_of_another,
    other_columns,
    lambda c: wrong_formula(c, "parts"),
)
HEALS_TREE = (heavier_tree, program_of_no_tree, lambda c: wrong_formula(c, "trees"))
REQUESTS = ("/v1/substructures/pendulum", "/v1/substructures/pendulum/formulas", "/v1/trees/cell")


@pytest.mark.parametrize("damage", [*HEALS, *HEALS_TREE])
def test_what_is_served_is_derived_anew(template: Path, tmp_path: Path, damage: Damage) -> None:
    """A change that leaves each digest right breaks the seal: no wrong digit is served, nor a wrong number computed."""
    with opened(template, tmp_path, lambda _: None) as client:
        right = [client.get(path).json() for path in REQUESTS]
        numbers = client.post("/v1/trees/cell/evaluations", json=EVALUATION).json()
    with opened(template, tmp_path, damage) as client:
        listed = [each["derived_here"] for kind in ("substructures", "trees") for each in _items(client, kind)]
        assert listed.count(False) >= 1
        assert client.post("/v1/trees/cell/evaluations", json=EVALUATION).json() == numbers
        for path, was in zip(REQUESTS, right, strict=True):
            found = client.get(path).json()
            told = [{name: x for name, x in each.items() if name != "certificate"} for each in (found, was)]
            assert told[0] == told[1], path
        assert client.get("/v1/substructures/slider").status_code == 200
        assert all(each["derived_here"] for kind in ("substructures", "trees") for each in _items(client, kind))
        assert main(["verify", "--database", f"sqlite:///{tmp_path / 'store.db'}"]) == 0


@pytest.mark.parametrize("what", ["summary", "file"])
def test_a_damaged_result_is_refused_and_named(what: str, template: Path, tmp_path: Path) -> None:
    with opened(template, tmp_path, lambda _: None) as client:
        job = submitted(client, {"kind": "verify", "items": [{"tree": "cell"}]})
        assert finished(client, job)["state"] == "succeeded"
        (item,) = client.get(f"/v1/jobs/{job}/items").json()["items"]
        file = item["files"][0]["href"]
        assert client.get(file).status_code == 200
        store = client.app.state.store  # type: ignore[attr-defined]
        with store.database.write() as connection:
            if what == "summary":
                connection.exec_driver_sql("UPDATE results SET summary = replace(summary, 'cell', 'call')")
            else:
                connection.exec_driver_sql("UPDATE result_files SET content = x'7b7d'")
        answer = client.get(f"/v1/jobs/{job}/items" if what == "summary" else file)
        assert (answer.status_code, answer.json()["code"]) == (500, "damaged-content")
        (fault,) = [finding for finding in verify_all(store.database) if finding.fault]
        assert fault.what.startswith("result ")


@pytest.mark.parametrize("is_asked", [True, False])
def test_a_tree_whose_row_points_to_the_program_of_another(filled: TestClient, is_asked: bool) -> None:
    """Both are valid, of trees of like structure (1 stays in one): numbers are those of the tree, verify names it."""
    store = filled.app.state.store  # type: ignore[attr-defined]
    for name, mass in (("dmg14", 3), ("dmg15", 1)):
        arm = {"name": "arm", "substructure": "pendulum", "parameters": {"m": mass}}
        assert filled.post("/v1/trees", json={"name": name, "instances": [arm]}).status_code == 201
    with store.database.write() as connection:
        connection.exec_driver_sql(
            "UPDATE trees SET program = (SELECT program FROM trees WHERE name = 'dmg15') WHERE name = 'dmg14'"
        )
    if is_asked:
        answer = filled.post("/v1/trees/dmg14/evaluations", json=EVALUATION)
        assert (answer.status_code, answer.json()["metric"]) == (200, [[pytest.approx(3.3, rel=1e-15)]])
    faults = {finding.what: finding.fault for finding in verify_all(store.database) if finding.fault}
    assert list(faults) == ([] if is_asked else ["tree dmg14@1"])


def _items(client: TestClient, kind: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = client.get(f"/v1/{kind}").json()["items"]
    return found


@pytest.mark.parametrize(
    ("damage", "item", "code"),
    [
        (lambda c: wrong_formula(c, "parts"), {"substructure": "*"}, "verification-failed"),
        (lambda c: wrong_formula(c, "trees"), {"tree": "*"}, "verification-failed"),
        (called_otherwise, {"substructure": "slider@2"}, "verification-failed"),
        (wrong_tree, {"tree": "cell"}, "damaged-content"),
        (other_axes, {"tree": "cell@1"}, "verification-failed"),
        (gone_tree_program, {"tree": "cell"}, "missing-content"),
    ],
)
def test_the_verify_job_finds(template: Path, tmp_path: Path, damage: Damage, item: dict[str, str], code: str) -> None:
    with opened(template, tmp_path, damage, is_sealed=True) as client:
        job = submitted(client, {"kind": "verify", "items": [item]})
        finished(client, job)
        items = client.get(f"/v1/jobs/{job}/items").json()["items"]
        assert code in {(each["problem"] or {}).get("code") for each in items}
    with opened(template, tmp_path, lambda _: None) as client:
        job = submitted(client, {"kind": "verify", "items": [{"tree": "*"}, {"substructure": "*"}]})
        assert finished(client, job)["state"] == "succeeded"
