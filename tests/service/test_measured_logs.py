"""Measured motions as files: what a data logger wrote is identified as the same numbers in a request are."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service.cli.main import main
from substructures.client import log_of

from .analysis_trees import ask, client, store
from .conftest import PENDULUM, TREE

__all__ = ["client", "store"]  # fixtures
Columns = dict[str, np.ndarray[Any, Any]]
FORMS = ("csv", "npz", "arrow")


def measured(client: TestClient, samples: int = 20) -> dict[str, Any]:
    rng = np.random.default_rng(4)
    motion = {name: rng.uniform(-1, 1, (samples, 1)).tolist() for name in ("q", "qd", "qdd")}
    forces = ask(client, "clock/evaluations", quantities=["inverse_dynamics"], **motion)["inverse_dynamics"]
    return {**motion, "tau": forces}


def in_units(motion: Mapping[str, Any]) -> Columns:
    """As a logger writes it: degrees, primes for rates, newton millimetres, a time."""
    q, qd, qdd, tau = (np.array(motion[name])[:, 0] for name in ("q", "qd", "qdd", "tau"))
    return {
        "time [s]": np.arange(len(q)) * 0.01,
        "p.q1 [deg]": np.rad2deg(q),
        "p.q1'": qd,
        "qdd.p.q1": qdd,
        "tau.p.q1 [N mm]": 1000 * tau,
    }


def written(columns: Columns, form: str, separator: str = ",") -> bytes:
    if form == "csv":
        rows = [
            separator.join(columns),
            *(separator.join(map(repr, r)) for r in zip(*(x.tolist() for x in columns.values()), strict=True)),
        ]
        return ("\ufeff" + "\r\n".join(rows) + "\r\n").encode()
    file = io.BytesIO()
    if form == "npz":
        np.savez(file, **columns)  # type: ignore[arg-type]
    else:
        table = pa.table(columns)
        with pa.ipc.new_stream(file, table.schema) as stream:
            stream.write_table(table, max_chunksize=7)
    return file.getvalue()


@pytest.mark.parametrize("form", FORMS)
def test_a_log_is_what_its_numbers_are(client: TestClient, form: str, tmp_path: Path) -> None:
    motion = measured(client)
    file = tmp_path / f"log.{form}"
    file.write_bytes(written(in_units(motion), form))
    expected = ask(client, "clock/identifications", **motion, held_out=0.2)
    found = ask(client, "clock/identifications", log=log_of(file), held_out=0.2)
    assert found["names"] == expected["names"]
    assert found["values"] == pytest.approx(expected["values"], rel=1e-10)
    assert max(found["residual"]) < 1e-12
    assert ask(client, "clock/excitations", log=log_of(file))["is_good"]


def test_columns_of_other_names(client: TestClient, tmp_path: Path) -> None:
    """Only what is named is read, whatever else the logger wrote."""
    motion = measured(client)
    given = in_units(motion)
    renamed = dict(zip(("clock", "j1_pos", "j1_vel", "j1_acc", "j1_torque"), given.values(), strict=True))
    file = tmp_path / "log.csv"
    file.write_bytes(written({**renamed, "temperature": np.full(20, 293.0)}, "csv", ";"))
    meaning = {"j1_pos": "p.q1 [deg]", "j1_vel": "qd.p.q1", "j1_acc": "p.q1''", "j1_torque": "tau.p.q1 [N mm]"}
    found = ask(client, "clock/identifications", log=log_of(file, meaning))
    assert max(found["residual"]) < 1e-12


def test_arrays_of_all_coordinates(client: TestClient) -> None:
    motion = {name: np.array(x) for name, x in measured(client).items()}
    text = base64.b64encode(written(motion, "npz")).decode()
    assert max(ask(client, "clock/identifications", log={"npz": text})["residual"]) < 1e-12


HEAD = "p.q1,p.q1',p.q1'',tau.p.q1"


@pytest.mark.parametrize(
    ("request_", "pointer", "code", "said"),
    [
        ({"log": {}}, "/log", "one-source", "one of"),
        ({"log": {"csv": HEAD, "npz": ""}}, "/log", "one-source", "one of"),
        ({"log": {"csv": HEAD}, "q": [[1]]}, "/q", "given-twice", "a log"),
        ({"log": {"csv": f"{HEAD}\n1,2,3\n"}}, "/log", "csv", "row 1 has 3 values"),
        ({"log": {"csv": f"{HEAD}\n1,2,3,x\n"}}, "/log", "csv", "'x' is no number"),
        ({"log": {"csv": "p.q1,p.q1\n1,2\n"}}, "/log", "csv", "each once"),
        ({"log": {"csv": f"{HEAD},qd.p.q1\n1,2,3,4,5\n"}}, "/log/qd.p.q1", "given-twice", "twice"),
        ({"log": {"csv": f"{HEAD.replace('q1,', 'q1 [kg],', 1)}\n1,2,3,4\n"}}, "/q/p.q1", "unit-mismatch", "kg"),
        ({"log": {"csv": f"{HEAD},p.q7\n1,2,3,4,5\n"}}, "/q/p.q7", "unknown-coordinate", "p.q7"),
        ({"log": {"csv": "p.q1,tau.p.q1\n1,2\n"}}, "/qdd", "missing", "'qdd'"),
        ({"log": {"csv": HEAD, "columns": {"a": "p.q1"}}}, "/log/columns/a", "unknown-column", "no column 'a'"),
        ({"log": {"csv": ""}}, "/log", "csv", "not a table"),
        ({"log": {"csv": "x" * 200_000}}, "/log", "csv", "not a table"),
        ({"log": {"csv": f"{HEAD}\n1,2,\x00,4\n"}}, "/log", "csv", "is no number"),
        ({"log": {"npz": "!"}}, "/log", "base64", "base64"),
        ({"log": {"npz": "AAAA"}}, "/log", "npz", "not an npz"),
        ({"log": {"arrow": "AAAA"}}, "/log", "arrow", "not an Arrow"),
        ({}, "/q", "missing", "'q' is needed"),
    ],
)
def test_what_is_wrong_with_a_log_is_told(
    client: TestClient, request_: Any, pointer: str, code: str, said: str
) -> None:
    answer = client.post("/v1/trees/clock/identifications", json=request_)
    assert answer.status_code == 422, answer.json()
    fault = answer.json()["errors"][0]
    assert (fault["pointer"], fault["code"]) == (pointer, code)
    assert said in fault["message"]


def test_values_that_are_no_numbers_are_refused(client: TestClient) -> None:
    answer = client.post("/v1/trees/clock/identifications", json={"log": {"csv": f"{HEAD}\nnan,2,3,4\n"}})
    assert answer.status_code == 422, answer.json()


def test_the_command_takes_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cell.json").write_text(json.dumps(TREE))
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    (tmp_path / "log.csv").write_text("arm.q,arm.q'',tau.arm.q\n0,1,0.5\n1,2,0.7\n0.5,-1,0.2\n2,0.3,0.1\n")
    main(["analyse", str(tmp_path / "cell.json"), "excitations", "--log", str(tmp_path / "log.csv"), "--json"])
    assert "is_good" in json.loads(capsys.readouterr().out)
    assert main(["analyse", str(tmp_path / "cell.json"), "excitations", "--log", "log.xlsx"]) == 1
    assert ".csv, .npz, .arrow" in capsys.readouterr().err
