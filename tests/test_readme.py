"""The README is a promise: its requests, its part and its Python example are run as they stand there."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures import Definition, derive

README = (Path(__file__).parent.parent / "README.md").read_text()
ADDRESS = "http://127.0.0.1:8000"


def blocks(language: str) -> list[str]:
    """The fenced blocks of one language, in order."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def curl(command: str, address: str, folder: Path) -> str:
    """Run one curl command of the README against another address, files go to the folder; anything but 2xx fails."""
    words = [word.replace(ADDRESS, address) for word in shlex.split(command)]
    words = [str(folder / word) if before == "-o" else word for before, word in zip(["", *words], words, strict=False)]
    done = subprocess.run([*words, "--fail-with-body"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def run(text: str, folder: Path) -> str:
    """What an example prints."""
    script = folder / "example.py"
    script.write_text(text)
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


# takes seconds: a server with the whole catalogue, as a reader starts it
@pytest.mark.skipif(shutil.which("curl") is None, reason="the README's requests need curl")
def test_requests_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    requests = [line for block in blocks("sh") for line in re.split(r"\n(?=curl)", block.strip()) if line[:4] == "curl"]
    assert len(requests) >= 6
    with background(Settings(database=f"sqlite:///{tmp_path / 'readme.db'}")) as address:
        answers = [curl(request, address, tmp_path) for request in requests]
        shared = next(block for block in blocks("sh") if "substructures publish" in block).splitlines()
        monkeypatch.chdir(tmp_path)
        codes = [main([*shlex.split(line)[1:], "--server", address]) for line in shared]
        shape = run(blocks("python")[0].replace(ADDRESS, address), tmp_path)
    assert codes == [0] * len(shared)
    assert (tmp_path / "cell.zip").read_bytes()[:2] == b"PK"
    assert '"cell"' in answers[0]
    assert "metric[1, 1]" in answers[1]
    assert '"revision":2' in next(answer for answer in answers if '"arm","eye"' in answer or '"eye"' in answer)
    assert shape == "(1000, 8, 8)\n"
    same = next(answer for answer in answers if '"culprits"' in answer)
    assert '"equal":true' in same


def test_commands_on_robot_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the folder of the clone, but for what is written."""
    commands = [line for block in blocks("sh") for line in block.splitlines() if "interchange/examples" in line]
    commands = [line for line in commands if line.startswith("substructures ")]
    assert len(commands) == 4
    monkeypatch.chdir(Path(__file__).parent.parent)
    for line in commands:
        words = [
            str(tmp_path / word) if word in ("hand.json", "puma560.urdf") else word for word in shlex.split(line)[1:]
        ]
        assert main(words) == 0, line
    assert Definition.read(json.loads((tmp_path / "hand.json").read_text())).name == "franka-hand"


def test_dialogue_at_a_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every line is what the command prints; ``| grep PATTERN`` is done here."""
    (dialogue,) = blocks("console")
    (tmp_path / "pendulum.yaml").write_text(blocks("yaml")[0])
    monkeypatch.chdir(tmp_path)
    with background(Settings(database=f"sqlite:///{tmp_path / 'dialogue.db'}")) as address:
        monkeypatch.setenv("SUBSTRUCTURES_SERVER", address)
        for command, *expected in (part.splitlines() for part in dialogue.split("$ substructures ")[1:]):
            words, _, pattern = command.partition(" | grep ")
            assert main(shlex.split(words)) == 0, command
            shown = capsys.readouterr().out.splitlines()
            if pattern:
                shown = [line for line in shown if re.search(shlex.split(pattern)[0], line)]
            assert shown == expected, command


def test_own_part() -> None:
    part = derive(Definition.read(yaml.safe_load(blocks("yaml")[0])))
    assert part.coordinates == ("q1",)
    assert not part.certificate["warnings"]


def test_python_example(tmp_path: Path) -> None:
    assert "cos(q2)" in run(blocks("python")[1], tmp_path)


@pytest.mark.parametrize(
    "word",
    [
        *("demo", "serve", "worker", "derive", "submit", "simulate", "analyse", "backup", "restore", "key create"),
        *("import", "same", "catalogue export", "catalogue import", "list", "search", "show", "tree", "couple", "rm"),
        *("evaluate", "doctor", "pull", "push", "bundle save", "bundle load", "mirror", "upgrade"),
        *("jobs submit", "jobs list", "jobs watch", "jobs result"),
    ],
)
def test_commands_exist(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*word.split(), "--help"]) == 0
    assert f"Usage: substructures {word}" in capsys.readouterr().out


def test_help_of_a_command_that_is_kept_is_shown_at_once() -> None:
    command = [sys.executable, "-m", "service.cli.main", "serve", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "Usage: substructures serve" in done.stdout
