"""The README is a promise: its requests, its part and its Python example are run as they stand there."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from service.server import background
from service.settings import Settings
from substructures import Definition, derive

README = (Path(__file__).parent.parent / "README.md").read_text()
ADDRESS = "http://127.0.0.1:8000"


def blocks(language: str) -> list[str]:
    """The fenced blocks of one language, in order."""
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def curl(command: str, address: str) -> str:
    """Run one curl command of the README against another address; anything but 2xx fails."""
    words = [word.replace(ADDRESS, address) for word in shlex.split(command)]
    done = subprocess.run([*words, "--fail-with-body"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.skipif(shutil.which("curl") is None, reason="the README's requests need curl")
def test_requests_in_order(tmp_path: Path) -> None:
    requests = [line for block in blocks("sh") for line in re.split(r"\n(?=curl)", block.strip()) if line[:4] == "curl"]
    assert len(requests) >= 6
    with background(Settings(database=f"sqlite:///{tmp_path / 'readme.db'}")) as address:
        answers = [curl(request, address) for request in requests]
    assert '"cell"' in answers[0]
    assert "metric[1, 1]" in answers[1]
    assert '"revision":2' in answers[-1]


def test_own_part() -> None:
    part = derive(Definition.read(yaml.safe_load(blocks("yaml")[0])))
    assert part.coordinates == ("q1",)
    assert not part.certificate["warnings"]


def test_python_example(tmp_path: Path) -> None:
    script = tmp_path / "example.py"
    script.write_text(blocks("python")[0])
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "cos(arm.q2)" in done.stdout


@pytest.mark.parametrize("word", ["demo", "serve", "derive", "submit", "key create"])
def test_commands_exist(word: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "service.cli", *word.split(), "--help"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
