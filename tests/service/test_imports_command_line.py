"""Robot files on the command line: what is printed, cut, derived and compared."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures.client import Client

from .test_imports import ARM, LONG


def test_import_prints_the_definition_and_tells_of_the_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ARM)
    assert main(["import", str(path), "--parameters", "none"]) == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["bodies"][1]["mass"] == 2
    assert "urdf: checks of schema passed, topology passed, physics passed; 2 of 4 names changed" in shown.err
    assert main(["import", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["kind"], told["definition"]["bodies"][1]["name"], told["stored"]) == ("urdf", "upper_arm", None)
    assert told["checks"]["physics"]["passed"] is True
    out = tmp_path / "arm.json"
    assert main(["import", str(path), "--out", str(out)]) == 0
    assert main(["derive", str(out)]) == 0
    path.write_text(LONG)
    assert main(["import", str(path), "--cut", "hand", "--out", str(out)]) == 0
    assert [i["name"] for i in json.loads(out.read_text())["instances"]] == ["robot", "hand"]
    assert main(["import", str(path), "--cut", "hnad"]) == 1
    assert "there is no link 'hnad' to be cut at; did you mean 'hand'" in capsys.readouterr().err


def test_parts_of_a_robot_that_is_cut_are_stored_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "long.urdf"
    path.write_text(LONG)
    with background(Settings(database=f"sqlite:///{tmp_path / 's.db'}", catalogue=False)) as address:
        for name in ("long", "long", "other"):
            flags = ["--cut", "hand", "--name", name, "--submit", "--server", address]
            assert main(["import", str(path), *flags]) == 0
        with Client(address) as client:
            trees = {tree["name"]: tree for tree in client.trees()}
            assert {name: tree["revision"] for name, tree in trees.items()} == {"long": 1, "other": 1}
            parts = {(each["name"], each["version"]) for each in client.substructures()}
            assert parts == {(f"{tree}-{part}", 1) for tree in trees for part in ("robot", "hand")}
            called = [each["substructure"].partition("@")[0] for each in client.tree("long")["instances"]]
    assert called == ["long-robot", "long-hand"]
    assert capsys.readouterr().out.splitlines()[0].startswith("long sha256:")


def test_like_remarks_are_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "box.urdf"
    links = '<link name="a">\n<visual/></link>\n<link name="b">\n<visual/>\n<collision/></link>'
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    path.write_text(f'<robot name="box">\n{links}\n{joint}</robot>')
    assert main(["import", str(path)]) == 0
    ignored = [line for line in capsys.readouterr().err.splitlines() if line.startswith("ignored")]
    assert ignored == [
        "ignored: line 3: <visual> and 1 more: how it looks: no influence on the equations of motion",
        "ignored: line 6: <collision>: contacts: no influence on the equations of motion",
    ]


def test_derive_takes_robot_files_by_their_content(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.txt"
    path.write_text(ARM)
    assert main(["derive", str(path), "--show", "metric"]) == 0
    assert "Iyy_upper_arm" in capsys.readouterr().out
    path.write_text(ARM.replace("0 1 0", "0 0 0"))
    assert main(["derive", str(path)]) == 1
    assert f"{path}: line 3: <axis>: the axis has no direction" in capsys.readouterr().err


def test_files_beside_an_mjcf_file_are_included_and_none_elsewhere(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "robot").mkdir()
    inner = '<mujoco><worldbody><body name="b"><joint name="j"/><geom size="1"/></body></worldbody></mujoco>'
    (tmp_path / "robot" / "inner.xml").write_text(inner)
    (tmp_path / "secret.xml").write_text(inner)
    path = tmp_path / "robot" / "robot.xml"
    path.write_text('<mujoco><include file="inner.xml"/></mujoco>')
    assert main(["derive", str(path)]) == 0
    path.write_text('<mujoco><include file="../secret.xml"/></mujoco>')
    assert main(["derive", str(path)]) == 1
    assert "'../secret.xml' is not followed" in capsys.readouterr().err


def test_same_compares_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ours, theirs = tmp_path / "a.urdf", tmp_path / "b.urdf"
    ours.write_text(ARM)
    theirs.write_text(ARM.replace('iyy="1"', 'iyy="2"'))
    assert main(["same", str(ours), str(ours)]) == 0
    assert "the same as formulas" in capsys.readouterr().out
    assert main(["same", str(ours), str(theirs)]) == 1
    assert "upper_arm: inertia.yy 1.0 here, 2.0 there" in capsys.readouterr().out
    tree = {"name": "t", "instances": [{"name": "arm", "substructure": "a"}]}
    (tmp_path / "tree.json").write_text(json.dumps(tree))
    assert main(["import", str(ours), "--out", str(tmp_path / "a.json")]) == 0
    assert main(["same", str(tmp_path / "tree.json"), str(ours)]) == 0
    assert main(["same", str(ours), str(ours), str(theirs), str(tmp_path / "tree.json")]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(": ")[2][:8] for line in lines if "here" not in line][-3:] == [
        "the same",
        "not the ",
        "the same",
    ]
    theirs.write_text(ARM.replace('"shoulder"', '"other"'))
    assert main(["same", str(ours), str(theirs), "--coordinates", "shoulder=other"]) == 0
