"""Exports over HTTP, on the command line and as jobs: files of targets, the same bytes for the same request."""

from __future__ import annotations

import io
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.cli.main import main
from substructures.export import TARGETS

TREE = {
    "name": "to-go",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [{"name": "arm", "substructure": "pendulum"}],
}


@pytest.fixture
def made(filled: TestClient) -> TestClient:
    assert filled.post("/v1/trees", json=TREE).status_code in (200, 201)
    return filled


def exported(client: TestClient, path: str = "trees/to-go@1", status: int = 200, **query: Any) -> Any:
    answer = client.get(f"/v1/{path}/export", params=query)
    assert answer.status_code == status, answer.text
    return answer


def members(data: bytes) -> dict[str, str]:
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        assert {info.date_time for info in packed.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        return {name: packed.read(name).decode("latin-1") for name in packed.namelist()}


@pytest.mark.parametrize("target", TARGETS)
def test_every_target(made: TestClient, target: str) -> None:
    first, second = (exported(made, target=target, together=target == "c") for _ in range(2))
    assert first.content == second.content
    assert first.headers["etag"] == second.headers["etag"]
    text = "\n".join(members(first.content).values()) if "zip" in first.headers["content-type"] else first.text
    assert "to_go" in text
    assert "sha256:" in text
    assert "to-go version 1" in text or '"reference": "to-go@1"' in text
    assert 'filename="to_go' in first.headers["content-disposition"]


def test_c_of_a_tree_compiles_and_is_right(made: TestClient, tmp_path: Path) -> None:
    files = members(exported(made, target="c", quantities="metric,forces,bias", name="swing").content)
    assert sorted(files) == ["swing.c", "swing.h", "swing_selftest.c"]
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


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    Path("swing.yaml").write_text("{name: swing, instances: [{name: arm, substructure: acrobot}]}")
    assert main(["export", "swing.yaml", "--target", "python", "--quantities", "metric,forces"]) == 0
    assert "swing_python.zip" in capsys.readouterr().out
    files = members(Path("swing_python.zip").read_bytes())
    assert "def swing_forces(t, q, qd, u, p=P):" in files["swing.py"]
    assert main(["export", "swing.yaml", "--target", "maxima", "--out", "model.mac"]) == 0
    assert "swing_metric(q, p) :=" in Path("model.mac").read_text()
