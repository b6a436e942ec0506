"""The command line: output, exit codes, and errors without stack traces."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from service.cli.commands import demo
from service.cli.main import main
from service.database.connections import Database
from service.server import background
from service.settings import Settings

from .conftest import PENDULUM


@pytest.fixture
def definition(tmp_path: Path) -> Path:
    path = tmp_path / "pendulum.json"
    path.write_text(json.dumps(PENDULUM))
    return path


def test_demo_does_the_main_job(capsys: pytest.CaptureFixture[str]) -> None:
    """Over real HTTP with the whole catalogue."""
    assert demo.run() == 0
    shown = capsys.readouterr().out
    assert "cell@2" in shown
    assert "metric[1, 1]" in shown
    assert shown.count("agrees") == 2
    assert "All numbers agree" in shown


def test_demo_for_programs(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "--json"]) == 0
    shown = capsys.readouterr()
    told = json.loads(shown.out)
    assert told["agrees"] is True
    assert [check["agrees"] for check in told["checks"]] == [True, True]
    assert max(check["difference"] for check in told["checks"]) <= demo.ROUNDING
    assert "All numbers agree" in shown.err


def test_demo_notices_wrong_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    assert demo.compare("first", [[1.00004, 2]], [[1, 2]])["agrees"]
    assert not demo.compare("second", [[1.0001, 2]], [[1, 2]])["agrees"]
    assert "DISAGREES" in capsys.readouterr().out


def test_derive(definition: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["derive", str(definition)]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("pendulum: 1 coordinate (R), bodies rod")
    assert main(["derive", str(definition), "--show", "metric", "--format", "latex"]) == 0
    assert capsys.readouterr().out
    assert main(["derive", str(definition), "--show", "nothing"]) == 1


def test_derive_yaml(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "rail.yaml"
    path.write_text(
        "name: rail\nbodies:\n  - {name: a, parent: base, joint: {type: prismatic, coordinate: x}, mass: 1.50}\n"
    )
    assert main(["derive", str(path)]) == 0
    assert "rail: 1 coordinate (P)" in capsys.readouterr().out


def test_submit(definition: Path, settings: Settings, capsys: pytest.CaptureFixture[str]) -> None:
    with background(settings) as address:
        assert main(["submit", str(definition), "--server", address]) == 0
        assert "pendulum@1 stored" in capsys.readouterr().out
        assert main(["submit", str(definition), "--server", address]) == 0
        assert "stored already" in capsys.readouterr().out
        definition.write_text(json.dumps({**PENDULUM, "name": "Bad Name"}))
        assert main(["submit", str(definition), "--server", address]) == 1
        assert "/name:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"name": "x", "bodies": [{"name": "a", "parent": "b", "joint": {"type": "fixed"}}]}', "/bodies/0/parent"),
        ('{"name": ', "line 1, column"),
        ("[]", "object"),
    ],
)
def test_errors_name_the_place(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, expected: str) -> None:
    path = tmp_path / "wrong.json"
    path.write_text(text)
    assert main(["derive", str(path)]) == 1
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("substructures: ")
    assert expected in captured.err
    assert "Traceback" not in captured.err


def test_errors_of_the_surroundings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["derive", str(tmp_path / "nothing.json")]) == 1
    assert "nothing.json: No such file" in capsys.readouterr().err
    (tmp_path / "a.json").write_text("{}")
    assert main(["submit", str(tmp_path / "a.json"), "--server", "http://127.0.0.1:9"]) == 1
    assert "nothing answers at http://127.0.0.1:9; start it with 'substructures serve'" in capsys.readouterr().err
    assert main(["serve", "--database", "mysql://x"]) == 1
    assert "mysql" in capsys.readouterr().err
    address = f"sqlite:///{tmp_path / 'x.db'}"
    monkeypatch.setenv("SUBSTRUCTURES_CATALOGUE", "no")
    assert main(["serve", "--host", "0.0.0.0", "--database", address]) == 1  # noqa: S104 -- refused
    assert "without API keys" in capsys.readouterr().err
    monkeypatch.setenv("SUBSTRUCTURES_PROT", "1")
    assert main(["serve", "--database", address]) == 1
    assert "SUBSTRUCTURES_PROT" in capsys.readouterr().err
    assert main(["fly"]) == 2


def test_the_key_of_a_client_is_no_setting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_KEY", "sub_x")
    address = f"sqlite:///{tmp_path / 'x.db'}"
    Database(address).close()
    assert main(["key", "list", "--json", "--database", address]) == 0
    assert main(["backup", str(tmp_path / "y.db"), "--database", address]) == 0
    assert not capsys.readouterr().err


def test_keys(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    database = ["--database", f"sqlite:///{tmp_path / 'x.db'}"]
    assert (
        main(["key", "create", "--scope", "read", "--scope", "write", "--label", "robot", "--days", "3", *database])
        == 0
    )
    key = capsys.readouterr().out.strip()
    assert key.startswith("sub_")
    assert main(["key", "list", *database]) == 0
    listed = capsys.readouterr().out
    assert "read write" in listed
    assert re.search(r"  expires \d{4}-\d\d-\d\d  robot\n", listed)
    assert key.split("_", 2)[2] not in listed
    assert main(["key", "revoke", key.split("_")[1], *database]) == 0
    assert main(["key", "delete", key, "--json", *database]) == 0  # a whole one, whose secret is not told
    assert json.loads(capsys.readouterr().out) == {"deleted": key.split("_")[1]}
    for action in ("revoke", "rotate", "delete"):
        assert main(["key", action, key, *database]) == 1
        shown = capsys.readouterr()
        assert f"there is no key '{key.split('_')[1]}'" in shown.err
        assert key.split("_", 2)[2] not in shown.err + shown.out
    assert main(["key", "revoke", "nothing", *database]) == 1
    assert "there is no key" in capsys.readouterr().err


@pytest.mark.parametrize("days", ["-3", "0", "nan", "inf", "1e9"])
def test_no_key_is_made_that_never_worked(tmp_path: Path, capsys: pytest.CaptureFixture[str], days: str) -> None:
    database = ["--database", f"sqlite:///{tmp_path / 'x.db'}"]
    assert main(["key", "create", "--days", days, *database]) == 1
    assert "more than 0 and at most 36500 days" in capsys.readouterr().err
    assert main(["key", "list", *database]) == 0
    assert capsys.readouterr().out == ""


def test_keys_for_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rest = ["--json", "--database", f"sqlite:///{tmp_path / 'x.db'}"]

    def told(*words: str) -> Any:
        """What a command prints, as JSON."""
        assert main(["key", *words, *rest]) == 0
        return json.loads(capsys.readouterr().out)

    first = told("create")
    assert first["key"].startswith(f"sub_{first['id']}_")
    second = told("rotate", first["id"])
    assert second["id"] != first["id"]
    assert told("delete", first["id"]) == {"deleted": first["id"]}
    assert told("revoke", second["id"]) == {"revoked": second["id"], "keys_left": False}
    assert [each["id"] for each in told("list")] == [second["id"]]


def test_a_command_that_is_not_there_is_guessed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serch", "arm"]) == 2
    assert "did you mean 'search'?" in capsys.readouterr().err


def test_openapi(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["openapi"]) == 0
    assert json.loads(capsys.readouterr().out)["info"]["title"] == "substructures"
