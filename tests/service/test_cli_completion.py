"""What the shell offers: commands, options and words, and names that a server knows."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.cli import completion
from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures.client import Client

from .conftest import PENDULUM, SLIDER, TREE


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path = tmp_path_factory.mktemp("completion") / "x.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False)) as found:
        with Client(found) as client:
            client.submit(PENDULUM)
            client.submit({**SLIDER, "name": "pen", "title": "A pendulum's friend"})
            client.submit({**SLIDER, "title": "Something like a pendulum"})
            client.create_tree(TREE)
        yield found


class Shell:
    """Bash behind a line that is not ended."""

    def __init__(self, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
        self._capsys, self._monkeypatch = capsys, monkeypatch

    def __call__(self, *words: str) -> list[str]:
        """What it offers for the last word."""
        self._monkeypatch.setenv("_SUBSTRUCTURES_COMPLETE", "complete_bash")
        self._monkeypatch.setenv("COMP_WORDS", " ".join(["substructures", *words]))
        self._monkeypatch.setenv("COMP_CWORD", str(len(words)))
        assert main([]) == 0
        shown = self._capsys.readouterr()
        assert not shown.err
        return shown.out.split()


@pytest.fixture
def offered(address: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Shell:
    monkeypatch.setenv("SUBSTRUCTURES_SERVER", address)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(completion, "SECONDS", 60.0)  # machines may be slow; whoever types does not wait for them
    return Shell(capsys, monkeypatch)


def test_commands_options_and_words(offered: Shell) -> None:
    assert offered("ev") == ["evaluate"]
    assert offered("catalogue", "") == ["export", "import"]
    assert offered("catalogue", "import", "--pr") == ["--private"]
    assert "latex" in offered("show", "pendulum", "metric", "--format", "")
    assert offered("evaluate", "cell", "metric", "forw") == ["forward_dynamics", "forward_dynamics_derivative"]
    assert "linearisations" in offered("analyse", "cell", "lin")


def test_names_that_the_server_knows(offered: Shell) -> None:
    assert offered("show", "pen") == ["pen", "pendulum"]
    assert offered("show", "") == ["pen", "pendulum", "slider", "cell"]
    assert offered("diff", "pendulum", "sl") == ["slider"]
    assert offered("couple", "ce") == ["cell"]
    assert offered("couple", "cell", "pendu") == ["pendulum"]
    assert (offered("versions", "ce"), offered("versions", "--tree", "ce")) == ([], ["cell"])
    assert offered("rm", "cell", "c") == ["cell"]


def test_quantities_ports_and_jobs(offered: Shell, address: str) -> None:
    assert offered("show", "pendulum", "met") == ["metric"]
    assert offered("show", "cell", "chr") == ["christoffel"]
    assert offered("show", "--tree", "cell", "chr") == ["christoffel"]
    assert offered("export", "cell", "--quantities", "metric,chr") == ["metric,christoffel"]
    assert offered("derive", "x.yaml", "--show", "port.U") == ["port.U"]
    assert offered("jobs", "evaluate", "cell", "x.npz", "--quantities", "metric,forw")[0] == "metric,forward_dynamics"
    assert offered("couple", "cell", "pendulum", "--at", "arm.t") == ["arm.tip"]
    assert offered("publish", "cell", "--port", "end=arm.t") == ["end=arm.tip"]
    assert offered("search", "--port", "ti") == ["tip"]
    with Client(address) as client:
        item = {"tree": "cell", "quantity": "metric", "format": "text"}
        job = client.submit_job({"kind": "export", "items": [item]}).id
    for action in ("show", "watch", "cancel", "retry", "rm", "result"):
        assert offered("jobs", action, job[:8]) == [job]
    assert offered("jobs", "show", "x") == []


def test_without_a_server_nothing_is_offered(offered: Shell, address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert offered("show", "--server", address, "sl") == ["slider"]
    assert offered("show", "--server", "nowhere", "sl") == []
    assert offered("show", "--database", "sqlite:///nowhere.db", "sl") == []
    with socket.socket() as taken:  # nobody listens there
        taken.bind(("127.0.0.1", 0))
        monkeypatch.setenv("SUBSTRUCTURES_SERVER", f"http://127.0.0.1:{taken.getsockname()[1]}")
        assert offered("show", "sl") == []
