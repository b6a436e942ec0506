"""The command line starts quickly: it imports what the named command needs, and nothing for its help."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import get_args

import pytest

from service.cli import choices
from service.cli.main import COMMANDS, main
from service.jobs import kinds
from service.jobs.kinds.requested import REQUESTED
from service.models import exporting, numbers
from service.models.formulas import _QUANTITIES, OF_PARTS
from substructures import catalogue, export, printers
from substructures.documents import write_json
from substructures.sweeps.columns import ANALYSES as OF_SWEEPS
from substructures.sweeps.document import AnalysisColumn

HEAVY = {"fastapi", "sqlalchemy", "numpy", "scipy", "sympy", "pydantic", "llvmlite", "httpx2"}


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


def test_an_interrupt_while_it_starts_is_no_traceback(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("raise KeyboardInterrupt\n")
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    module, name = project["scripts"]["substructures"].split(":")
    path = os.pathsep.join([str(tmp_path), *sys.path])
    command = [sys.executable, "-c", f"import sys\nfrom {module} import {name}\nsys.exit({name}())", "list"]
    done = subprocess.run(command, env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_a_server_starts_without_what_few_requests_need() -> None:
    late = {"alembic", "distributed", "pandas", "pint", "pyarrow", "scipy.linalg", "scipy.optimize", "sympy"}
    late |= MOTIONS | {
        "substructures.analysis.stability",
        "substructures.analysis.control",
        "substructures.abbreviation",
    }
    late |= {"substructures.analysis.closed", "substructures.ensembles.ensemble", "service.models.numbers.analysis"}
    late |= {f"service.jobs.kinds.{kind}" for kind in ("analyse", "evaluate", "export", "verify")}
    late |= {"substructures.interchange.importing", "substructures.interchange.kinds"}
    late |= {"httpx2", "llvmlite", "markdown_it", "sqlalchemy.dialects.postgresql"}
    program = (
        "import sys, service.cli.commands.server, service.app\nprint(*sys.modules)\n"
        "print(*(each.path for each in service.app.bare_app().described if 'read' in vars(each)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not late & set(done.stdout.split())
    assert not done.stderr.split()  # no parameters of an operation were read


def test_the_parent_of_a_server_imports_nothing_heavy() -> None:
    program = "import sys, service.cli.main, service.processes.parent; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not HEAVY & set(done.stdout.split())


TREE = {"name": "t", "instances": [{"name": "a", "substructure": "simple-pendulum"}]}


#: of a server, of those who talk to one, of robot files, of few motions, of terminals
SERVED = {"fastapi", "sqlalchemy", "uvicorn", "service.database", "service.store.store"}
TALKING = {"httpx2", "substructures.client.client"}
ROBOTS = {"substructures.interchange.kinds", "substructures.interchange.importing"}
SCIPY = {"scipy.integrate", "scipy.linalg", "scipy.optimize", "scipy.special"}
NEVER = {"asyncio", "pint", "sympy", "rich.console", *SERVED}
#: the names of formats and targets are not those who write them
WRITERS = {"substructures.export", "substructures.printers"}
ANALYSES = {
    "service.models.abbreviations",
    "substructures.analysis.control",
    "substructures.analysis.identification",
    "substructures.analysis.stability",
    "substructures.abbreviation",
}
MOTIONS = {"substructures.analysis.simulate", "service.schemas.analyses.motions"}
HERE = NEVER | TALKING | ROBOTS
STARTS = {
    "derive d.json": HERE | SCIPY | WRITERS | ANALYSES | MOTIONS | {"substructures.quantities.numbers.evaluation"},
    "derive d.json --show metric": HERE | SCIPY | ANALYSES | MOTIONS,
    "evaluate t.json metric": HERE | SCIPY | WRITERS | ANALYSES | MOTIONS | {"llvmlite"},
    "export t.json --target c --out t.zip": HERE | SCIPY | ANALYSES | MOTIONS | {"llvmlite"},
    "analyse t.json metric": HERE | SCIPY | MOTIONS | {"llvmlite", "substructures.analysis.stability"},
    "analyse t.json first_integrals": HERE | SCIPY | MOTIONS | {"substructures.analysis.stability"},
    "simulate t.json m.json": HERE | SCIPY | ANALYSES | {"service.models.printing"},
    "same d.json d.json": (HERE - ROBOTS) | SCIPY | ANALYSES | MOTIONS,
}
DOCUMENTS = {
    "d.json": catalogue.load("simple-pendulum"),
    "t.json": {"name": "t", "instances": [{"name": "a", "substructure": "simple-pendulum"}]},
    "m.json": {"q": [0.5], "span": [0, 0.1], "inputs": {"tau.a.q1": {"times": [0, 1], "values": [0, 1]}}},
}


def imported(words: list[str], folder: Path, code: int = 0) -> set[str]:
    """The modules that are there after a command with this exit code, in a process of its own."""
    program = f"import sys\nfrom service.cli.main import main\ncode = main({words!r})\n"
    program += "print('modules', *sys.modules)\nsys.exit(code)"
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == code, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("command", STARTS)
def test_a_command_on_files_imports_what_it_needs(command: str, tmp_path: Path) -> None:
    for name, document in DOCUMENTS.items():
        (tmp_path / name).write_bytes(write_json(document))
    found = imported(command.split(), tmp_path)
    assert not STARTS[command] & found
    assert "numpy" in found


@pytest.mark.parametrize("command", ["list", "search x", "versions x", "show x"])
def test_a_command_on_a_server_computes_nothing_itself(command: str, tmp_path: Path) -> None:
    """Nothing answers there."""
    found = imported([*command.split(), "--server", "http://127.0.0.1:9"], tmp_path, 1)
    computing = {"flint", "llvmlite", "scipy", "substructures.part.part", "substructures.tree.couple"}
    assert not (NEVER | ROBOTS | WRITERS | ANALYSES | MOTIONS | computing) & found
    assert "httpx2" in found


def test_names_of_formats_are_those_of_who_writes_them() -> None:
    assert tuple(sorted(export.FORMATS)) == choices.FORMATS
    assert choices.FORMS == printers.FORMS
    assert choices.NAME == exporting.NAME


def test_tables_name_the_modules_of_their_entries() -> None:
    assert [name for name, entry in _QUANTITIES.items() if entry.needs_parts] == list(OF_PARTS)
    assert all(analysis.schema.__doc__ for analysis in numbers.ANALYSES.values())
    schemas = {name: analysis.schema.__name__ for name, analysis in numbers.ANALYSES.items()}
    assert schemas == {name: offered.schema for name, offered in numbers.OFFERED.items()}
    assert all(table[name] for table in (kinds._KINDS, REQUESTED) for name in table)
    assert set(OF_SWEEPS) == {
        get_args(kind.model_fields["analysis"].annotation)[0] for kind in get_args(AnalysisColumn)
    }
    with pytest.raises(KeyError):
        numbers.ANALYSES["simulation"]


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
