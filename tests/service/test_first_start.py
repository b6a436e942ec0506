"""The first start of a store: it says what it does where that takes long, and is left out where none may be."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from service import app
from service.cli import output
from service.cli.main import main
from service.operations import seed
from service.server import serve
from service.settings import Settings, SettingsError

NAMES = ("acrobot", "camera", "cart-pendulum")


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        """It is one."""
        return True


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever is done takes long enough to be told, of a small catalogue."""
    monkeypatch.setattr(output, "QUICK", 0.0)
    monkeypatch.setattr(seed.catalogue, "names", lambda: NAMES)


@pytest.mark.usefixtures("slow")
def test_a_line_where_there_is_no_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["list", "--database", f"sqlite:///{tmp_path / 'new.db'}"]
    assert main(command) == 0
    shown = capsys.readouterr()
    assert shown.err == "first start, the shipped catalogue is derived and stored: 1 of 3 ...\n"
    assert all(f"{name}@1" in shown.out for name in NAMES)
    assert main(command) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("slow")
def test_a_line_that_is_written_over_on_a_terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert main(["list", "--database", f"sqlite:///{tmp_path / 'new.db'}"]) == 0
    assert "first start" in terminal.getvalue()
    assert "of 3 ..." in terminal.getvalue()
    assert output._shown == []


def test_who_waits_already_sees_it_in_the_same_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output, "QUICK", 0.0)
    monkeypatch.setattr(sys, "stderr", Terminal())
    with output.waiting("evaluating"), output.counting("first start") as told:
        (line,) = output._shown
        told(1, 3)
        assert output._shown == [line]
        assert line.status == "first start: 1 of 3 ..."


def test_what_is_quick_is_not_told(capsys: pytest.CaptureFixture[str]) -> None:
    with output.counting("first start") as told:
        told(1, 3)
    assert capsys.readouterr().err == ""


def test_a_server_that_may_not_be_derives_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    derived: list[object] = []
    monkeypatch.setattr(app, "import_catalogue", lambda *given: derived.append(given))
    open_to_all = Settings(database=f"sqlite:///{tmp_path / 'new.db'}", host="0.0.0.0", port=0)  # noqa: S104 -- that is what is refused
    with pytest.raises(SettingsError, match="without API keys"):
        serve(open_to_all)
    assert derived == []
