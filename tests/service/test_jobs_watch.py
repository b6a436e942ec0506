"""Watching a job whose server stops, hangs, comes back, or does not."""

from __future__ import annotations

import io
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from service.cli import progress
from service.cli.main import main
from service.cli.progress import Bar
from service.settings import Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE
from .door import Door
from .farm import free_port
from .test_jobs_cli import Terminal

SAMPLE = {"tree": "cell", "request": {"quantities": ["metric"]}, "sample": {"count": 5}}


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Door]:
    """A server on which no job ends: nothing computes."""
    server = Door(Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False, engine="none"))
    server.start()
    yield server
    server.kill()


def queued(server: Door) -> str:
    with Client(server.address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        return str(client.submit_job({"kind": "evaluate", "items": [SAMPLE]})["id"])


def test_a_server_that_is_gone_is_told_of_and_given_up(capsys: pytest.CaptureFixture[str]) -> None:
    address, begun = f"http://127.0.0.1:{free_port()}", time.monotonic()
    assert main(["jobs", "watch", "0123abc", "--server", address, "--patience", "2"]) == 1
    assert 2 <= time.monotonic() - begun < 10
    lines = capsys.readouterr().err.splitlines()
    assert "the server cannot be reached" in lines[0]
    assert "trying for 2 s" in lines[0]
    assert f"{address} has not answered for 2 s" in lines[-1]
    assert "0123abc" in lines[-1]


def test_watching_goes_on_when_the_server_returns(
    server: Door, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "LINES", 0.0)
    job, shown = queued(server), ""
    command = ["jobs", "watch", job, "--server", server.address, "--patience", "60"]
    status: list[int] = []
    watching = threading.Thread(target=lambda: status.append(main(command)))
    watching.start()

    def until(words: str) -> None:
        nonlocal shown
        end = time.monotonic() + 60
        while words not in shown:
            assert time.monotonic() < end, shown
            time.sleep(0.05)
            shown += capsys.readouterr().err

    until("queued  0 of 1")
    server.kill()
    until("cannot be reached")
    server.start()
    until("the server answers again after")
    shown = ""
    until("queued  0 of 1")
    server.hang()  # it is there, and silent
    until("cannot be reached")
    server.go_on()
    until("the server answers again after")
    with Client(server.address) as client:
        assert client.cancel_job(job)["state"] == "cancelled"
    watching.join(30)
    assert status == [5]  # the exit code of a job that was cancelled


@pytest.mark.parametrize("stream", [io.StringIO(), Terminal()])
def test_bar_of_a_lost_server(stream: Any) -> None:
    progress = {"done": 1, "total": 2, "failed": 0, "fraction": 0.5, "rate": None, "eta_seconds": None}
    bar = Bar(stream)
    bar.show({"state": "running", "progress": progress})
    for waited in (0.0, 1.0, 7.0):
        bar.lost(waited, 60, "Connection refused")
    bar.show({"state": "running", "progress": progress})
    lines = stream.getvalue().replace("\r", "\n").split("\n")
    told = [line.split("  ")[2] if line.startswith("[") else line.strip() for line in lines if line]
    lost = "the server cannot be reached (Connection refused): {} s, trying for 60 s"
    waits = (0, 1, 7) if stream.isatty() else (0,)
    assert told == ["running", *map(lost.format, waits), "the server answers again after 7 s", "running"]
