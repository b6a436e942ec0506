"""What commands say where something is missing, empty or of the wrong size, and that their JSON is JSON."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from service.cli.main import main
from service.database.connections import Database

from .conftest import PENDULUM, TREE


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An own directory with the documents of a part and of trees of one and of two of it."""
    monkeypatch.chdir(tmp_path)
    arm = TREE["instances"][0]
    pair: dict[str, Any] = {**TREE, "name": "pair", "instances": [arm, {**arm, "name": "fore", "at": "arm.tip"}]}
    for document in (PENDULUM, TREE, pair):
        Path(f"{document['name']}.json").write_text(json.dumps(document))
    return tmp_path


class Run:
    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *words: str, code: int = 0) -> str:
        """All that is printed."""
        found = main(words)
        shown = self._capsys.readouterr()
        assert found == code, shown.err
        return re.sub(r"[\s│]+", " ", shown.out + shown.err) if code else shown.out + shown.err


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    return Run(capsys)


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    ("tree", "option", "numbers", "expected"),
    [
        ("pair", "--q", "1", "--q: 1 number found, but there are 2 coordinates: arm.q, fore.q"),
        ("pair", "--qd", "1,2,3,4", "--qd: 4 numbers found, but there are 2 coordinates: arm.q, fore.q"),
        (
            "pair",
            "--qd",
            "1,x",
            "--qd: numbers between commas are needed, in SI units or with their units, as in '30 d",
        ),
        ("cell", "--q", "1,2", "--q: 2 numbers found, but there is 1 coordinate: arm.q"),
    ],
)
def test_a_state_of_another_length(run: Run, tree: str, option: str, numbers: str, expected: str) -> None:
    assert expected in run("evaluate", f"{tree}.json", "metric", option, numbers, code=2)


@pytest.mark.usefixtures("folder")
def test_a_state_with_units(run: Run) -> None:
    here = [run("evaluate", "pair.json", "metric", "--q", numbers) for numbers in ("0,90 deg", f"0,{math.pi / 2}")]
    assert here[0] == here[1]


@pytest.mark.usefixtures("folder")
def test_a_state_of_another_length_in_a_request(run: Run) -> None:
    Path("request.json").write_text('{"q": [1, 2, 3], "span": [0, 1]}')
    expected = "/q: 3 numbers found, but there are 2 coordinates: arm.q, fore.q"
    assert expected in run("simulate", "pair.json", "request.json", code=1)
    assert "3 states, as there is 1 coordinate: arm.q; one is needed here, several are a job" in run(
        "simulate", "cell.json", "request.json", code=1
    )


@pytest.mark.usefixtures("folder")
def test_a_formula_as_json_is_json(run: Run) -> None:
    found = json.loads(run("derive", "pendulum.json", "--show", "metric", "--json"))
    assert list(found["outputs"]) == ["metric"]


@pytest.mark.usefixtures("folder")
def test_a_certificate_is_told_in_words(run: Run) -> None:
    told = run("derive", "pendulum.json")
    assert not re.search(r"[{}']|\bTrue\b|\[\]", told)
    assert re.search(r"direct_form: max_relative_error \S+ \(\S+\) of \d+ quantities", told)
    assert "positive_definite: yes" in told


@pytest.mark.usefixtures("folder")
def test_indices_are_named_and_nothing_is_said_to_be_nothing(run: Run) -> None:
    frames = run("derive", "pendulum.json", "--show", "frame")
    assert frames.startswith("# frames: 1 base, 2 rod, 3 tip\n")
    assert run("derive", "pendulum.json", "--show", "port.U").startswith("# ports: 1 tip\n# coordinates: 1 q\n")
    assert run("derive", "pendulum.json", "--show", "r").startswith("# joints carry: 1 rod\n")
    christoffel = run("derive", "pendulum.json", "--show", "christoffel")
    assert "; all elements are 0\n" in christoffel
    assert "other" not in christoffel
    assert "all other elements are 0\n" in frames


@pytest.mark.usefixtures("folder")
def test_numbers_have_the_names_of_their_axes(run: Run) -> None:
    words = "kinematics", "momentum", "reactions", "powers", "inertial_parameters", "christoffel", "--q", "0,0.5"
    told = run("evaluate", "pair.json", *words)
    rows = dict(re.findall(r"^  (\S+(?: \S+)*?)  +(-?[\d.]+.*)$", told, re.MULTILINE))
    assert {"arm.tip", "fore.rod", "x", "arm.q", "gravity", "fore.rod.Jxx"} <= rows.keys()
    assert [float(x) for x in rows["arm.tip"].split()] == [1, 0, 0]
    assert "  [fore.tip, arm.q, y]  1.87758256" in told
    assert "  [arm.q, arm.q, fore.q]  " in told
    assert run("evaluate", "cell.json", "christoffel").startswith("christoffel  all 0\n")


def test_folders_and_files_are_told_apart(run: Run, folder: Path) -> None:
    (folder / "out").mkdir()
    export = ["export", "cell.json", "--target", "c", "--out"]
    assert run(*export, "out", code=1) == "substructures: out is a folder; the name of a file is needed "
    one = ["export", "cell.json", "--target", "modelica", "--out", "cell.zip"]
    assert run(*one, code=1) == "substructures: modelica is one file and no archive: --out cell.mo "
    assert "there is no folder nowhere" in run(*export, "nowhere/cell.zip", code=1)
    store = ["--database", f"sqlite:///{folder / 'x.db'}"]
    Database(store[1]).close()
    assert "cell.json is a file; the name of a folder is needed" in run(
        "catalogue", "export", "cell.json", *store, code=1
    )
    assert "out has no definition in it (*.yaml, *.yml, *.json)" in run("catalogue", "import", "out", *store)


def test_faults_of_a_part_beside_a_tree_name_its_file_alone(run: Run, folder: Path) -> None:
    (folder / "pendulum.json").write_text(json.dumps({**PENDULUM, "portz": []}))
    for words in (["evaluate", "pair.json", "metric"], ["export", "pair.json", "--target", "c"]):
        assert run(*words, code=1).startswith("substructures: pendulum.json#/portz: unknown field 'portz'")
    (folder / "pendulum.json").unlink()
    for words in (["evaluate", "pair.json", "metric"], ["export", "pair.json", "--target", "c"]):
        assert run(*words, code=1).startswith(
            "substructures: pair.json#/instances/0/substructure: 'pendulum' is neither"
        )


def test_no_keys_are_told_with_how_one_is_made(run: Run, folder: Path) -> None:
    store = ["--database", f"sqlite:///{folder / 'x.db'}"]
    Database(store[1]).close()
    told = run("key", "list", *store)
    assert "there are no keys" in told
    assert "'substructures key create --owner TEAM --scope admin'" in told
    assert json.loads(run("key", "list", "--json", *store)) == []


@pytest.mark.usefixtures("folder")
def test_files_that_are_written_are_named(run: Run) -> None:
    Path("request.json").write_text('{"q": [1], "span": [0, 1], "count": 3}')
    assert run("simulate", "cell.json", "request.json", "--out", "motion.csv").startswith("motion.csv: ")
    assert "energy.txt: " in run("analyse", "cell.json", "kinetic_energy", "--out", "energy.txt")


def test_what_goes_to_a_file_is_utf_8_whatever_a_terminal_shows(folder: Path) -> None:
    """As on Windows, where files had code page 1252, which no command reads."""
    (folder / "arm.urdf").write_text('<robot name="Σ\u00fc"><link name="a"/></robot>', encoding="utf-8")
    command = [sys.executable, "-m", "service.cli.main", "import", "arm.urdf"]
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.decode("utf-8"))["title"] == "Σ\u00fc"
