"""The command line starts quickly: it imports what the named command needs, and nothing for its help."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from service.cli.main import COMMANDS, main

HEAVY = {"fastapi", "sqlalchemy", "numpy", "scipy", "sympy", "pydantic", "llvmlite", "httpx2", "heyoka"}


def test_help_imports_nothing_heavy(capfd: pytest.CaptureFixture[str]) -> None:
    script = (
        "import sys\nfrom service.cli.main import main\nmain(['--help'])\n"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
    out, err = capfd.readouterr()
    assert "COMMAND" in out
    assert all(command.name in out for command in COMMANDS)
    assert "typer" in err.split()
    assert not HEAVY & set(err.split())


def test_a_server_starts_without_what_few_requests_need() -> None:
    late = {"alembic", "distributed", "heyoka", "pandas", "pint", "pyarrow", "scipy.linalg", "scipy.optimize", "sympy"}
    program = "import sys, service.cli.server; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not late & set(done.stdout.split())


TREE = {"name": "t", "instances": [{"name": "a", "substructure": "simple-pendulum"}]}


@pytest.mark.parametrize("words", [["evaluate", "{}", "metric"], ["export", "{}", "--target", "c", "--out", "{}.zip"]])
def test_a_file_needs_no_database_and_no_analyses(words: list[str], tmp_path: Path) -> None:
    path = tmp_path / "t.json"
    path.write_text(json.dumps(TREE))
    given = [word.format(path) for word in words]
    program = f"import sys\nfrom service.cli.main import main\nassert main({given!r}) == 0\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    late = {"fastapi", "sqlalchemy", "scipy.linalg", "scipy.optimize", "sympy", "service.analyses.numbers"}
    assert not late & set(done.stdout.split())


@pytest.mark.parametrize("name", [command.name for command in COMMANDS])
def test_every_command_has_its_arguments(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([name, "--help"]) == 0
    assert f"Usage: substructures {name}" in capsys.readouterr().out


def test_unknown_command_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["simulat"]) == 2
    assert "No such command 'simulat'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("substructures jo", "jobs"),
        ("substructures jobs re", "retry"),
        ("substructures derive x.yaml --fo", "--format"),
    ],
)
def test_completion(
    line: str, expected: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Words, actions and options, as the shell asks for them."""
    for name, value in asked(line).items():
        monkeypatch.setenv(name, value)
    main([])
    assert expected in capsys.readouterr().out.split()


def test_completion_in_a_process_of_its_own() -> None:
    command = [sys.executable, "-m", "service.cli.main"]
    environment = {**os.environ, **asked("substructures jo")}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert "jobs" in done.stdout.split()


def asked(line: str) -> dict[str, str]:
    """The variables that the shell sets."""
    last = str(len(line.split()) - 1)
    return {"_SUBSTRUCTURES_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": last}
