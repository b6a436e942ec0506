"""Exports over HTTP, on the command line and as jobs: files of targets, the same bytes for the same request."""

from __future__ import annotations

import importlib.util
import io
import json
import re
import subprocess
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.models.exporting import ALL_TARGETS
from service.server import background
from service.settings import Settings
from service.store.keys import create
from service.store.store import Store
from substructures.client import Client

from .conftest import PENDULUM, make_client
from .fake_engine import FakeEngine, finished, running
from .job_outcomes import known_library, outcomes
from .one_store import copied

TREE = {
    "name": "to-go",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [{"name": "arm", "substructure": "pendulum"}],
}


@pytest.fixture(scope="module")
def made(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server that knows the tree, for tests that leave each other alone."""
    with copied(template, tmp_path_factory.mktemp("made")) as store, make_client(store) as client:
        assert client.post("/v1/trees", json=TREE).status_code == 201
        yield client


@pytest.fixture
def hurried(filled: TestClient, store: Store) -> TestClient:
    """Another one, on which nothing but what is known may take any time."""
    assert filled.post("/v1/trees", json=TREE).status_code == 201
    limits = store.settings.limits.model_copy(update={"sync_seconds": 1e-6})
    store.settings = store.settings.model_copy(update={"limits": limits})
    return filled


def exported(client: TestClient, path: str = "trees/to-go@1", status: int = 200, **query: Any) -> Any:
    answer = client.get(f"/v1/{path}/export", params=query)
    assert answer.status_code == status, answer.text
    return answer


def members(data: bytes) -> dict[str, str]:
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        assert {info.date_time for info in packed.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        return {name: packed.read(name).decode("latin-1") for name in packed.namelist()}


@pytest.mark.parametrize("target", ALL_TARGETS)
def test_every_target(made: TestClient, target: str) -> None:
    first, second = (exported(made, target=target, together=target == "c") for _ in range(2))
    assert first.content == second.content
    assert first.headers["etag"] == second.headers["etag"]
    text = "\n".join(members(first.content).values()) if "zip" in first.headers["content-type"] else first.text
    assert "to_go" in text
    assert "sha256:" in text
    assert "to-go version 1" in text or '"reference": "to-go@1"' in text
    assert 'filename="to_go' in first.headers["content-disposition"]


#: names in no order
PART = {
    **PENDULUM,
    "name": "unsorted",
    "parameters": {"z": {"value": 1, "unit": "kg"}, **PENDULUM["parameters"]},
    "inputs": {"wind": {"unit": "N*m"}, "brake": {"unit": "N*m"}},
    "loads": [{"type": "joint", "coordinate": "q", "force": "wind - brake*z/m"}],
}
UNSORTED = {
    "name": "to-go",
    "parameters": {"weight": {"value": 2, "unit": "kg"}, "g": {"value": 9.81, "unit": "m/s^2"}},
    "gravity": [0, 0, "-g"],
    "instances": [
        {"name": "b", "substructure": "unsorted", "parameters": {"m": "weight"}},
        {"name": "a", "substructure": "unsorted", "at": "b.tip"},
    ],
}


def test_a_server_that_is_started_again_exports_the_same(settings: Settings) -> None:
    """Also where documents have names in no order, which the store does not keep."""
    asked = [
        (path, target)
        for path in ("trees/to-go@1", "substructures/unsorted@1")
        for target in ALL_TARGETS
        if path.startswith("trees") or target not in ("fmu", "simulink")
    ]
    found = []
    for k in range(2):
        with open_store(settings) as store, make_client(store) as client:
            if k == 0:
                for kind, body in (("substructures", PART), ("trees", UNSORTED)):
                    assert client.post(f"/v1/{kind}", json=body).status_code == 201
            found.append([exported(client, path, target=target).content for path, target in asked])
    for (path, target), first, second in zip(asked, *found, strict=True):
        assert first == second, (path, target)
    told = json.loads(found[0][asked.index(("trees/to-go@1", "interface"))])["vectors"]
    assert told["p"]["names"] == sorted(told["p"]["names"])
    assert told["u"]["names"] == ["a.brake", "a.wind", "b.brake", "b.wind", "tau.b.q", "tau.a.q"]


@pytest.mark.parametrize(
    ("target", "file", "root"),
    [("urdf", "clock.urdf", b'<robot name="clock">'), ("mjcf", "clock.xml", b'<mujoco model="clock">')],
)
def test_a_tree_and_a_part_as_robot_files(made: TestClient, target: str, file: str, root: bytes) -> None:
    """What comes back in is the same; numbers that are bound are in it."""
    for path in ("trees/to-go@1", "substructures/pendulum"):
        first, second = (exported(made, path, target=target, name="clock") for _ in range(2))
        assert first.content == second.content
        assert first.headers["content-type"].startswith("application/xml")
        assert f'filename="{file}"' in first.headers["content-disposition"]
        assert root in first.content
        read = made.post("/v1/imports", content=first.content, headers={"Content-Type": "application/xml"}).json()
        name = next(name for name in read["names"] if name.startswith("joint "))
        told = {"a": path.partition("/")[2], "b": read["definition"]}
        told["coordinates"] = {name.rpartition(".")[2].removeprefix("joint "): read["names"][name]}
        assert made.post("/v1/equivalences", json=told).json()["equal"], path
    assert re.search(b'mass( value)?="7"', exported(made, target=target, bind="arm.m:7").content)


@pytest.mark.parametrize("name", ["a\x03b", "a\x00", " ", "a/b", 'a"b', "../up", "\u65e5\u672c", "\u200b"])
@pytest.mark.parametrize("target", ["urdf", "mjcf", "c", "fmu", "text"])
def test_names_that_no_file_can_have(made: TestClient, target: str, name: str) -> None:
    """Nor a header, nor XML."""
    problem = exported(made, target=target, name=name, status=422).json()
    assert [(each["pointer"], each["code"]) for each in problem["errors"]] == [("/query/name", "bad-name")]


@pytest.mark.parametrize("target", ["urdf", "mjcf"])
def test_robot_files_are_no_sets_of_functions(made: TestClient, target: str) -> None:
    for query in ({"quantities": "metric"}, {"together": True}, {"packed": True}):
        problem = exported(made, target=target, status=422, **query).json()
        assert problem["errors"][0]["code"] == "not-of-target"
        assert problem["errors"][0]["pointer"] == f"/query/{next(iter(query))}"
    assert "nowhere" in exported(made, target=target, status=422, bind="nowhere:1").text


def test_c_of_a_tree_compiles_and_is_right(made: TestClient, tmp_path: Path) -> None:
    files = members(exported(made, target="c", quantities="metric,forces,bias", name="swing").content)
    beside = ["CMakeLists.txt", "README.md", "swing_example.c"]
    assert sorted(files) == sorted([*beside, "swing.c", "swing.h", "swing_selftest.c"])
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    command = ["cc", "-std=c99", "-Wall", "-Werror", "-o", "run", "swing.c", "swing_selftest.c", "-lm"]
    subprocess.run(command, check=True, cwd=tmp_path)
    assert subprocess.run([str(tmp_path / "run")], capture_output=True, check=True).stdout == b"ok\n"


def test_bound_parameters_are_left_out(made: TestClient) -> None:
    told = exported(made, target="interface", bind="g:9.8").json()
    whole = exported(made, target="interface").json()
    assert set(whole["vectors"]["p"]["names"]) - set(told["vectors"]["p"]["names"]) == {"g"}
    assert exported(made, target="interface", bind="defaults").json()["vectors"]["p"]["length"] == 0


def test_packed_as_evaluations_have_it(made: TestClient, tmp_path: Path) -> None:
    asked = {"target": "python", "quantities": "metric,christoffel", "name": "lean"}
    hand = {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}
    made.post("/v1/trees", json={**TREE, "name": "two", "instances": [*TREE["instances"], hand]})
    q = [0.3, 0.7]
    path = tmp_path / "lean.py"
    path.write_text(members(exported(made, "trees/two@1", packed=True, **asked).content)["lean.py"])
    spec = importlib.util.spec_from_file_location("lean", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    request = {"quantities": ["metric", "christoffel"], "q": q, "packed": True}
    answer = made.post("/v1/trees/two@1/evaluations", json=request).json()
    for quantity in request["quantities"]:
        found = getattr(module, f"lean_{quantity}")(q)
        assert found.ravel().tolist() == pytest.approx(np.ravel(answer[quantity]).tolist(), rel=1e-12)
    whole, packed = (exported(made, "trees/two@1", packed=flag, **asked) for flag in (False, True))
    assert whole.headers["etag"] != packed.headers["etag"]


def test_parts(made: TestClient) -> None:
    told = exported(made, "substructures/pendulum@1", target="interface").json()
    assert told["name"] == "pendulum"
    assert told["made_from"]["reference"] == "pendulum@1"
    assert [f["quantity"] for f in told["functions"]] == ["metric", "christoffel"]


@pytest.mark.parametrize(
    ("query", "pointer", "code"),
    [
        ({"target": "exe"}, "/query/target", "unknown-target"),
        ({"target": "c", "quantities": "nonsense"}, "/query/quantities", "unknown-quantity"),
        ({"target": "c", "name": "a b"}, "/query/name", "bad-name"),
        ({"target": "c", "name": "while"}, "/query/name", "reserved-name"),
        ({"target": "c", "bind": "nothing:1"}, "/query/bind", "unknown-parameter"),
        ({}, "/query/target", "missing"),
    ],
)
def test_refusals(made: TestClient, query: Any, pointer: str, code: str) -> None:
    (fault,) = exported(made, status=422, **query).json()["errors"]
    assert (fault["pointer"], fault["code"]) == (pointer, code)
    if query.get("target") != "exe" and "target" in query and "quantities" not in query:
        exported(made, "substructures/pendulum@1", 422, **query)


@pytest.mark.parametrize("path", ["trees/valueless", "substructures/slider@1"])
def test_a_parameter_without_value_is_named_where_it_is_given(made: TestClient, path: str) -> None:
    """Exports take values by 'bind': pointer and way out say so, and it is one."""
    tree = {"name": "valueless", "instances": [{"name": "a", "substructure": "slider", "parameters": {"k": "k"}}]}
    made.post("/v1/trees", json={**tree, "parameters": {"k": {"unit": "N/m"}}})
    for target in ("fmu", "urdf") if path.startswith("trees") else ("urdf", "mjcf"):
        refused = exported(made, path, 422, target=target).json()
        (fault,) = refused["errors"]
        assert (refused["code"], fault["pointer"]) == ("missing-value", "/query/bind"), target
        assert "'k' has no value: give one with bind=k:value" in fault["message"]
        exported(made, path, target=target, bind="k:100")


def test_an_item_without_a_value_points_to_its_own_field() -> None:
    (outcome,) = outcomes(known_library(), "export", {"items": [{"substructure": "slider", "target": "urdf"}]})
    assert outcome.problem is not None
    assert [(each["pointer"], each["code"]) for each in outcome.problem["errors"]] == [("/bind", "missing-value")]


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("swing.yaml").write_text("{name: swing, instances: [{name: arm, substructure: acrobot}]}")
    assert main(["export", "swing.yaml", "--target", "python", "--quantities", "metric,forces"]) == 0
    assert "swing_python.zip" in capsys.readouterr().out
    files = members(Path("swing_python.zip").read_bytes())
    assert "def swing_forces(q, qd, u, p=P):" in files["swing.py"]
    assert main(["export", "swing.yaml", "--target", "interface", "--packed"]) == 0
    assert '"packed"' in Path("swing_interface.json").read_text()
    assert main(["export", "swing.yaml", "--target", "maxima", "--out", "model.mac"]) == 0
    assert "swing_metric(q, p) :=" in Path("model.mac").read_text()
    capsys.readouterr()
    assert main(["export", "swing.yaml", "--target", "urdf", "--json"]) == 0
    size = Path("swing.urdf").stat().st_size
    assert json.loads(capsys.readouterr().out) == {"file": "swing.urdf", "bytes": size}
    before = Path("swing_interface.json").read_bytes()
    assert main(["export", "swing.urdf", "--target", "interface"]) == 1
    assert "is another file already" in capsys.readouterr().err
    assert Path("swing_interface.json").read_bytes() == before
    assert main(["export", "swing.urdf", "--target", "interface", "--force"]) == 0
    assert main(["export", "swing.urdf", "--target", "interface"]) == 0  # the same file
    assert "arm_q1" in Path("swing_interface.json").read_text()
    assert main(["export", "swing.yaml", "--target", "c", "--out", "model.mac"]) == 1  # nor one that is named
    assert "is another file already" in capsys.readouterr().err
    assert "swing_metric(q, p) :=" in Path("model.mac").read_text()


def test_an_fmu_of_either_version_and_floats_in_c(made: TestClient) -> None:
    found = {}
    for fmi in ("3.0", "2.0"):
        answer = exported(made, target="fmu", fmi=fmi)
        assert (answer.status_code, answer.headers["content-type"]) == (200, "application/zip")
        with zipfile.ZipFile(io.BytesIO(answer.content)) as packed:
            found[fmi] = packed.read("modelDescription.xml").decode()
        assert f'fmiVersion="{fmi}"' in found[fmi]
    single = members(exported(made, target="c", precision="single").content)
    header = next(text for name, text in single.items() if name.endswith(".h"))
    assert "const float *q" in header
    assert "// rounding of metric: at most" in header
    both = members(exported(made, target="c", stages=True).content)
    header = next(text for name, text in both.items() if name.endswith(".h"))
    assert "_prepare(const double *p, double *w" in header
    old = members(exported(made, target="c", standard="c89").content)
    assert not any("//" in text for text in old.values())


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        ({"target": "python", "precision": "single"}, "/query/precision"),
        ({"target": "rust", "stages": "true"}, "/query/stages"),
        ({"target": "c", "fmi": "2.0"}, "/query/fmi"),
        ({"target": "cpp", "standard": "c89"}, "/query/standard"),
        ({"target": "c", "standard": "c89", "precision": "single"}, "/query/standard"),
        ({"target": "urdf", "precision": "single"}, "/query/precision"),
        ({"target": "latex", "packed": "true"}, "/query/packed"),
    ],
)
def test_options_of_other_targets_are_refused(made: TestClient, query: dict[str, str], pointer: str) -> None:
    problem = exported(made, status=422, **query).json()
    assert (problem["errors"][0]["pointer"], problem["errors"][0]["code"]) == (pointer, "not-of-target")


def test_a_part_is_no_fmu(made: TestClient) -> None:
    part = made.get("/v1/substructures").json()["items"][0]["name"]
    answer = exported(made, f"substructures/{part}", 422, target="fmu")
    assert "make a tree of the part" in answer.json()["detail"]


@pytest.mark.parametrize("path", ["trees/to-go@1", "substructures/pendulum@1"])
def test_a_long_export_becomes_one_job(made: TestClient, hurried: TestClient, store: Store, path: str) -> None:
    """Whoever asks again gets the same job, and its file is what the request gives, but for the reference."""
    query = {"target": "c", "quantities": "metric", "name": "arm"}
    at_once = exported(made, path, **query)
    with running(store, FakeEngine()):
        first, second = (exported(hurried, path, 202, **query, stages="true") for _ in range(2))
        assert first.json()["id"] == second.json()["id"]
        asked = hurried.get(f"/v1/{path}/export", params=query, headers={"Prefer": "respond-async"})
        assert (asked.status_code, asked.headers["preference-applied"]) == (202, "respond-async")
        assert asked.json()["id"] != first.json()["id"]
        job = finished(hurried, asked.json()["id"])
    item = hurried.get(job["result"]).json()["items"][0]
    assert item["state"] == "succeeded"
    ours, theirs = members(at_once.content), members(hurried.get(item["files"][0]["href"]).content)
    assert set(ours) == set(theirs)
    assert ours["arm_selftest.c"] == theirs["arm_selftest.c"]


def test_an_export_is_of_the_tree_as_it_is(filled: TestClient) -> None:
    """The same request becomes another job where the tree has changed, and where its job is cancelled or removed."""

    def job() -> str:
        """Of the request."""
        answer = filled.get("/v1/trees/to-go/export", params={"target": "c"}, headers={"Prefer": "respond-async"})
        return str(answer.json()["id"])

    assert filled.post("/v1/trees", json=TREE).status_code == 201
    first = job()
    assert filled.post("/v1/trees", json={**TREE, "gravity": [0, 0, -2]}).status_code == 201
    second = job()
    assert first != second == job()
    filled.post(f"/v1/jobs/{second}/cancel")
    third = job()
    assert second != third
    filled.post(f"/v1/jobs/{third}/cancel")
    assert filled.delete(f"/v1/jobs/{third}").status_code == 204
    assert filled.get(f"/v1/jobs/{job()}").status_code == 200


def test_a_long_export_of_a_reader_is_refused(hurried: TestClient, store: Store) -> None:
    with store.database.write() as connection:
        key = create(connection, "reader", ["read"])
    answer = hurried.get("/v1/trees/to-go@1/export", params={"target": "c"}, headers={"Authorization": f"Bearer {key}"})
    assert (answer.status_code, answer.json()["code"]) == (503, "took-too-long")
    assert "key that may submit jobs" in answer.json()["detail"]


def test_jobs_of_what_is_not_there(made: TestClient) -> None:
    later = {"Prefer": "respond-async"}
    assert made.get("/v1/trees/nobody/export", params={"target": "c"}, headers=later).status_code == 404
    refused = made.get("/v1/trees/to-go/export", params={"target": "exe"}, headers=later)
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/query/target")


def test_the_command_waits_where_it_becomes_a_job(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    url = f"sqlite:///{tmp_path / 'store.db'}"
    with background(Settings(database=url, catalogue=False)) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        ask = Client.request
        later = {"headers": {"Prefer": "respond-async"}}

        def asked(self: Client, method: str, path: str, body: Any = None, **options: Any) -> Any:
            """As where the server finds that it takes too long."""
            return ask(self, method, path, body, **(later if path.endswith("/export") else {}), **options)

        monkeypatch.setattr(Client, "request", asked)
        assert main(["export", "to-go", "--target", "c", "--server", address]) == 0
        assert main(["export", "to-go", "--target", "urdf", "--bind", "defaults", "--server", address]) == 0
    assert [line.partition(":")[0] for line in capsys.readouterr().out.splitlines()] == ["to_go_c.zip", "to_go.urdf"]
    assert "to_go.c" in members(Path("to_go_c.zip").read_bytes())
