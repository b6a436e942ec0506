"""The command line starts quickly: it imports what the named command needs, and nothing for its help."""

from __future__ import annotations

import subprocess
import sys

import pytest

from service.cli.main import COMMANDS, main, parser_for

HEAVY = {"fastapi", "sqlalchemy", "numpy", "scipy", "sympy", "pydantic", "llvmlite", "httpx2", "heyoka"}


def test_help_imports_nothing_heavy(capfd: pytest.CaptureFixture[str]) -> None:
    script = (
        "import sys\nfrom service.cli.main import main\ntry:\n    main(['--help'])\nexcept SystemExit:\n    pass\n"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}), file=sys.stderr)"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
    out, err = capfd.readouterr()
    assert "COMMAND" in out
    assert "argparse" in err.split()
    assert not HEAVY & set(err.split())


@pytest.mark.parametrize("name", [command.name for command in COMMANDS])
def test_every_command_has_its_arguments(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        parser_for([name]).parse_args([name, "--help"])
    assert ended.value.code == 0
    assert f"usage: substructures {name}" in capsys.readouterr().out


def test_unknown_command_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["simulat"])
    assert ended.value.code == 2
    assert "invalid choice: 'simulat'" in capsys.readouterr().err
