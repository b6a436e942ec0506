"""The commands simulate and analyse, without a server and with one; and the same by the client."""

from __future__ import annotations

import json
import os
from errno import ENOSPC
from pathlib import Path

import numpy as np
import pytest

from service.cli.main import main
from service.server import background
from service.settings import Limits, Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A tree document with its part beside it, and a request."""
    (tmp_path / "cell.yaml").write_text(json.dumps(TREE))
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    (tmp_path / "swing.yaml").write_text("q: [0.5]\nspan: [0, 2]\ncount: 21\n")
    return tmp_path


def test_simulate_a_document(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["simulate", str(folder / "cell.yaml"), str(folder / "swing.yaml")]
    assert main(command) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("finished\nenergy: constant, holds")
    for name in ("out.npz", "out.csv", "out.svg", "out.json", "out.arrow"):
        assert main([*command, "--out", str(folder / name)]) == 0
    with np.load(folder / "out.npz", allow_pickle=False) as arrays:
        assert np.array_equal(arrays["q"], json.loads((folder / "out.json").read_text())["q"])
    assert main([*command, "--out", str(folder / "out.xlsx")]) == 1
    assert ".npz, .csv" in capsys.readouterr().err


def test_simulate_by_options(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Alone, and in place of members of a request."""
    command = ["simulate", str(folder / "cell.yaml"), "--json"]
    request = {"qd": [0.1], "span": [0, 1], "parameters": {"arm.l": 0.5}, "inputs": {"tau.arm.q": 2}}
    options = ["--qd", "0.1", "--until", "1", "--set", "arm.l=500 mm", "--input", "tau.arm.q=2 N*m"]
    for q, given in (([np.pi / 6], ["--q", "30 deg"]), ([0.5], [str(folder / "swing.yaml")])):
        (folder / "all.json").write_text(json.dumps({**request, "q": q, "count": 21}))
        assert main([*command, str(folder / "all.json")]) == 0
        wanted = json.loads(capsys.readouterr().out)
        assert main([*command, *given, *options]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["t"][-1] == 1
        assert told["q"][-1] == pytest.approx(wanted["q"][-1], rel=1e-12)
    for missing in ([], ["--q", "1"], ["--until", "1"]):
        assert main([*command, *missing]) == 2
        assert "--q and --until" in capsys.readouterr().err


def test_members_are_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    columns = "columns: {top: {expression: arm.q, take: largest}}\n"
    (folder / "many.yaml").write_text(f"q: [[0.1], [0.2]]\nspan: [0, 1]\n{columns}")
    command = ["analyse", str(folder / "cell.yaml"), "ensembles", str(folder / "many.yaml")]
    for more in ([], ["--out", str(folder / "many.json")]):
        assert main([*command, *more]) == 0
        shown = capsys.readouterr().out
        assert "2 members: 2 right, 0 failed\nenergy: constant, violated by 0, at most " in shown
        assert "\ntop: count 2, mean 0.15, deviation 0.0707107, least 0.1, largest 0.2" in shown
    assert main([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["columns"] == {"top": [0.1, 0.2]}
    (folder / "one.yaml").write_text(f"q: [[0.1]]\nspan: [0, 1]\n{columns}")
    assert main(["analyse", str(folder / "cell.yaml"), "ensembles", str(folder / "one.yaml")]) == 0
    assert "\ntop: count 1, mean 0.1, least 0.1, largest 0.1" in capsys.readouterr().out


def test_a_place_that_cannot_be_written_is_told_before_anything_is_computed(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A motion of minutes is not lost by a folder that is not there."""
    monkeypatch.delattr("service.cli.numbers.local_source")
    command = ["simulate", str(folder / "cell.yaml"), str(folder / "swing.yaml"), "--out"]
    (folder / "taken.npz").mkdir()
    assert main([*command, str(folder / "nowhere" / "x.npz")]) == 1
    assert f"there is no folder {folder / 'nowhere'}" in capsys.readouterr().err
    assert main([*command, str(folder / "taken.npz")]) == 1
    assert "is a folder; the name of a file is needed" in capsys.readouterr().err


def test_a_full_disk_leaves_the_file_that_was_there_and_is_told_with_its_name(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file may be the only one of a motion of minutes."""
    out = folder / "kept.json"
    command = ["simulate", str(folder / "cell.yaml"), str(folder / "swing.yaml"), "--out", str(out)]
    assert main(command) == 0
    out.chmod(0o600)
    before, names = out.read_bytes(), sorted(folder.iterdir())
    write = Path.write_bytes

    def half(path: Path, data: bytes) -> int:
        write(path, data[:100])
        raise OSError(ENOSPC, os.strerror(ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", half)
    capsys.readouterr()
    assert main(command) == 1
    assert f"{out}: {os.strerror(ENOSPC)}" in capsys.readouterr().err
    assert (out.read_bytes(), sorted(folder.iterdir())) == (before, names)
    monkeypatch.undo()
    assert main(command) == 0
    assert out.stat().st_mode & 0o777 == 0o600


def test_a_wrong_motion_is_a_failure(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "rough.yaml").write_text("q: [0.5]\nspan: [0, 2]\nfixed_step: {step: 0.2, method: semi-implicit-euler}\n")
    assert main(["simulate", str(folder / "cell.yaml"), str(folder / "rough.yaml")]) == 1
    shown = capsys.readouterr().out
    assert shown.startswith("finished WRONG")
    assert "VIOLATED from t = " in shown


def test_a_motion_beyond_its_limits_is_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    joint = {"type": "prismatic", "coordinate": "x", "limits": [-1, 1]}
    part = {"name": "a", "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}]}
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "a", "definition": part}]}
    (tmp_path / "t.json").write_text(json.dumps(tree))
    (tmp_path / "drop.json").write_text('{"q": [0], "span": [0, 1]}')
    assert main(["simulate", str(tmp_path / "t.json"), str(tmp_path / "drop.json")]) == 0
    assert "'a.x' leaves its limits [-1, 1] m: it goes down to -4.905 m" in capsys.readouterr().err


def test_states_of_ball_joints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A top at rest, turned by the quaternion (0.6, 0.8, 0, 0), and in motion."""
    body = {"name": "b", "parent": "base", "mass": 2, "com": [0, 0, 0.5], "joint": {"type": "ball"}}
    part = {"name": "a", "bodies": [body | {"inertia": {"xx": 1, "yy": 1, "zz": 1}}]}
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "a", "definition": part}]}
    (tmp_path / "t.json").write_text(json.dumps(tree))
    (tmp_path / "turn.json").write_text('{"q": [1, 0, 0, 0], "qd": [0, 0, 3], "span": [0, 1]}')
    assert main(["evaluate", str(tmp_path / "t.json"), "gravity"]) == 0
    assert capsys.readouterr().out.split()[1:] == ["a.w_b_x", "0", "a.w_b_y", "0", "a.w_b_z", "0"]
    assert main(["evaluate", str(tmp_path / "t.json"), "gravity", "--q", "0.6,0.8,0,0"]) == 0
    assert capsys.readouterr().out.split()[1:3] == ["a.w_b_x", "9.4176"]  # m g sin(phi)/2, sin(phi) = 2 0.6 0.8
    assert main(["simulate", str(tmp_path / "t.json"), str(tmp_path / "turn.json")]) == 0
    assert "a.q_b_w = 0.0707372" in capsys.readouterr().out.splitlines()[-1]  # cos 1.5


def test_analyse_a_document(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree = str(folder / "cell.yaml")
    assert main(["analyse", tree, "first_integrals", "--bind", "defaults"]) == 0
    assert "energy in J, constant: all forces have a potential" in capsys.readouterr().out
    assert main(["analyse", tree, "state_space", "--outputs", "sin(arm.q),arm.q'", "--format", "python"]) == 0
    assert "def " in capsys.readouterr().out
    assert main(["analyse", tree, "metric", "--out", str(folder / "metric.txt")]) == 0
    assert "metric[1, 1]" in (folder / "metric.txt").read_text()
    assert main(["analyse", tree, "equilibria"]) == 0
    found = json.loads(capsys.readouterr().out)["found"]
    assert {e["at"]["stability"]["verdict"] for e in found} == {"stable", "unstable"}


@pytest.mark.parametrize("level", [0, 9])
def test_a_section(folder: Path, capsys: pytest.CaptureFixture[str], level: int) -> None:
    """Met or not."""
    request = folder / "section.yaml"
    request.write_text(f"q: [0.5]\nquantity: arm.q\nlevel: {level}\nduration: 9\ncount: 2\n")
    assert main(["analyse", str(folder / "cell.yaml"), "poincare-sections", str(request)]) == 0
    shown = capsys.readouterr().out
    assert ("the section is met 0 times in 9 s" in shown, "arm.q = " in shown) == (level == 9, level == 0)


def test_errors_name_the_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree, swing = str(folder / "cell.yaml"), str(folder / "swing.yaml")
    for arguments, expected in (
        (["analyse", tree, "nothing"], "there is no quantity 'nothing'"),
        (["analyse", tree, "metric", swing], "no request"),
        (["analyse", tree, "adjoint", "--running", "nobody"], "/query/running"),
        (["analyse", tree, "simulations"], "/span: "),
        (["simulate", str(folder / "nothing.yaml"), swing], "nothing.yaml: No such file"),
    ):
        assert main(arguments) == 1
        captured = capsys.readouterr()
        assert expected in captured.err
        assert "Traceback" not in captured.err
    (folder / "cell.yaml").write_text(json.dumps(TREE).replace('"pendulum"', '"nobody"'))
    assert main(["simulate", tree, swing]) == 1
    assert "/instances/0/substructure" in capsys.readouterr().err


def test_on_a_server(folder: Path, settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        found = client.simulate("cell", q=np.array([0.5]), span=[0, 2], count=21)
        assert found["is_right"]
        assert found["q"].shape == (21, 1)
        assert found["series"]["energy"].shape == (21,)
        assert client.analyse("cell", "linearisations", q=[0])["coordinates"] == ["arm.q"]
        assert "sin" in client.formula("cell", "state_space", outputs="sin(arm.q)")
        server = ["--server", address]
        assert main(["simulate", "cell", str(folder / "swing.yaml"), "--out", str(folder / "x.csv"), *server]) == 0
        assert (folder / "x.csv").read_text().startswith("t,arm.q,arm.q'")
        (folder / "long.yaml").write_text("q: [0.5]\nspan: [0, 2]\nmax_steps: 2\n")
        assert main(["simulate", "cell", str(folder / "long.yaml"), "--out", str(folder / "y.csv"), *server]) == 1
        assert "NOT KNOWN to be right" in capsys.readouterr().out
        assert main(["simulate", "cell", str(folder / "swing.yaml"), *server]) == 0
        assert "energy: constant, holds" in capsys.readouterr().out
        assert main(["analyse", "cell", "first_integrals", "--bind", "defaults", *server]) == 0
        assert "energy in J, constant" in capsys.readouterr().out
        assert main(["analyse", "cell", "simulations", *server]) == 1
        assert "/span: " in capsys.readouterr().err


def test_what_takes_long_is_waited_for(folder: Path, settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    """The request becomes a job, which a process of its own computes."""
    slow = settings.model_copy(update={"workers": 1, "limits": Limits(sync_seconds=0.02)})
    with background(slow) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        found = client.simulate("cell", q=[0.5], span=[0, 200], count=21, relative_tolerance=1e-12)
        assert found["is_right"]
        assert found["q"].shape == (21, 1)
        (job,) = [each for each in client.jobs() if each["kind"] == "analyse"]
        assert job["state"] == "succeeded"
        text = "q: [0.5]\nspan: [0, 400]\nfixed_step: {step: 0.005, method: rk4}\ndrift_limit: 1.0e-14\n"
        (folder / "rough.yaml").write_text(text)
        command = ["simulate", "cell", str(folder / "rough.yaml"), "--out", str(folder / "x.csv"), "--server", address]
        assert main(command) == 1
        assert "finished WRONG" in capsys.readouterr().out
