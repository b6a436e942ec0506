"""The commands for jobs, against a server that computes in real processes."""

from __future__ import annotations

import fcntl
import io
import json
import os
import struct
import termios
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.cli.main import main
from service.cli.progress import Bar, outcome, summary, text
from service.jobs.kinds import KINDS
from service.server import background
from service.settings import Settings
from substructures.client import Client, ProblemError
from substructures.client.jobs import Job
from substructures.client.progress import line as bar_line
from substructures.formats import arrow

from .conftest import HAND, PENDULUM, TREE

CELLS: dict[str, Any] = {
    "kind": "assemble",
    "template": {"name": "pair", "instances": [{"name": "a", "substructure": "pendulum"}]},
    "choices": {"a.l": [1, 2, 3]},
}


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path = tmp_path_factory.mktemp("jobs") / "x.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False, workers=1)) as found:
        with Client(found) as client:
            client.submit(PENDULUM)
            client.create_tree(TREE)
        yield found


def test_commands(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, server = tmp_path / "cells.json", ["--server", address]
    file.write_text(json.dumps(CELLS))
    assert main(["jobs", "submit", str(file), *server]) == 0
    shown = capsys.readouterr()
    job = shown.out.strip()
    assert "succeeded  3 of 3" in shown.err
    assert main(["jobs", "list", "--kind", "assemble", *server]) == 0
    assert job in capsys.readouterr().out
    assert main(["jobs", "show", job, *server]) == 0
    assert json.loads(capsys.readouterr().out)["state"] == "succeeded"
    assert main(["jobs", "result", job, *server]) == 0
    assert "pair-2@1" in capsys.readouterr().out
    assert main(["jobs", "result", job, "--output", str(tmp_path / "all.zip"), *server]) == 0
    with zipfile.ZipFile(tmp_path / "all.zip") as archive:
        assert "2/item.json" in archive.namelist()
    assert main(["jobs", "watch", job, *server]) == 0
    assert capsys.readouterr().err.count("3 of 3\n") == 1  # where the bar ends
    assert main(["jobs", "cancel", job, *server]) == 0
    assert "succeeded" in capsys.readouterr().out
    assert main(["jobs", "show", "none", *server]) == 1
    assert "there is no job" in capsys.readouterr().err
    file.write_text(json.dumps({**CELLS, "kind": "fly"}))
    assert main(["jobs", "submit", str(file), *server]) == 1
    assert "/kind:" in capsys.readouterr().err


def test_what_was_skipped_is_told(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "some.json"
    file.write_text(json.dumps({**CELLS, "choices": {"a": ["pendulum", "pendulun"]}, "on_invalid": "skip"}))
    assert main(["jobs", "submit", str(file), "--no-wait", "--server", address]) == 0
    told = capsys.readouterr().err
    assert told.startswith("skipped: item 1: ")
    assert "there is no substructure 'pendulun'" in told
    assert main(["jobs", "submit", str(file), "--json", "--server", address]) == 6
    shown = capsys.readouterr()
    job = json.loads(shown.out)
    assert [each["item"] for each in job["skipped"]] == [1]
    assert "succeeded  1 of 1, 1 skipped" in shown.err
    assert "assemble: 1 succeeded of 1; 1 skipped" in shown.err
    assert main(["jobs", "show", job["id"], "--server", address]) == 0
    assert json.loads(capsys.readouterr().out)["progress"]["skipped"] == 1
    assert main(["jobs", "list", "--server", address]) == 0
    assert "1 of 1, 1 skipped" in capsys.readouterr().out
    assert main(["jobs", "watch", job["id"], "--server", address]) == 6
    with Client(address) as client:
        assert str(client.job(job["id"])).endswith("succeeded, 1 of 1, 1 skipped")


def test_a_motion_that_fails_is_an_item_that_failed(
    address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    swing = {"q": [1.0], "span": [0, 5], "count": 3}
    fixed = {**swing, "fixed_step": {"step": 0.1, "method": "semi-implicit-euler"}}
    file, server = tmp_path / "swings.json", ["--server", address]
    requests = [swing, {**swing, "max_steps": 3}, fixed]
    file.write_text(json.dumps({"kind": "simulate", "items": [{"tree": "cell@1", "requests": requests}]}))
    assert main(["jobs", "submit", str(file), *server]) == 3
    shown = capsys.readouterr()
    job = shown.out.strip()
    assert "simulate: 1 succeeded, 2 failed of 3" in shown.err
    assert "item 1 (cell): 'simulations' failed: 3 steps reached only" in shown.err
    assert "item 2 (cell): 'simulations' is WRONG, a necessary condition is violated: energy, steps" in shown.err
    with Client(address) as client:
        found = client.job(job)
        assert str(found).endswith("succeeded, 3 of 3, 2 failed")
        states = [(each["state"], each["result"]["status"]) for each in found.each()]
        assert states == [("succeeded", "finished"), ("failed", "failed"), ("failed", "finished")]
        motions = list(found.results())
        assert [(each["status"], each["is_right"]) for each in motions] == [
            ("finished", True),
            ("failed", None),
            ("finished", False),
        ]
        again = found.retry().wait()
        assert (again["state"], again["progress"]["failed"]) == ("failed", 2)
        assert again["attempts"] == 2


def test_failures_show_in_the_exit_status(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "wrong.yaml"
    file.write_text("kind: export\nitems:\n  - {tree: cell, quantity: metric, format: text, bind: 'arm.l:nose'}\n")
    assert main(["jobs", "submit", str(file), "--server", address]) == 4
    shown = capsys.readouterr()
    assert "export: 0 succeeded, 1 failed of 1" in shown.err
    job = shown.out.strip()
    assert "item 0 (cell): " in shown.err
    assert "'nose'" in shown.err
    assert f"substructures jobs result {job}" in shown.err
    assert main(["jobs", "result", shown.out.strip(), "--server", address]) == 0
    assert "0  failed  cell: " in capsys.readouterr().out


def test_a_label_what_failed_once_more_and_removal(
    address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, server = tmp_path / "half.yaml", ["--server", address]
    good = "{tree: cell, quantity: metric, format: text}"
    file.write_text(f"kind: export\nitems:\n  - {good}\n  - {good[:-1]}, bind: 'arm.l:nose'}}\n")
    assert main(["jobs", "submit", str(file), "--label", "for the paper", *server]) == 3
    shown = capsys.readouterr()
    assert "export 'for the paper': 1 succeeded, 1 failed of 2" in shown.err
    first = shown.out.strip()
    assert f"substructures jobs retry {first}" in shown.err
    assert main(["jobs", "retry", first, *server]) == 4
    second = capsys.readouterr().out.strip()
    with Client(address) as client:
        again = client.job(second)
        assert (again["progress"]["total"], again["label"], again["retry_of"]) == (1, "for the paper", first)
        assert [item["subject"] for item in client.job_items(first)] == [None, "cell"]
    assert main(["jobs", "rm", first, second, *server]) == 0
    assert main(["jobs", "show", first, *server]) == 1
    capsys.readouterr()
    assert main(["jobs", "list", *server]) == 0
    assert "for the paper" not in capsys.readouterr().out


def test_there_is_nothing_to_try_again(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, server = tmp_path / "cells.json", ["--server", address]
    file.write_text(json.dumps(CELLS))
    assert main(["jobs", "submit", str(file), *server]) == 0
    job = capsys.readouterr().out.strip()
    assert main(["jobs", "retry", job, *server]) == 1
    assert "all its items succeeded" in capsys.readouterr().err
    file.write_text(json.dumps({**CELLS, "label": "x" * 201}))
    assert main(["jobs", "submit", str(file), *server]) == 1
    assert "at most 200 characters" in capsys.readouterr().err


def test_client(address: str) -> None:
    with Client(address) as client:
        grid = {
            "tree": "cell",
            "request": {"quantities": ["metric"]},
            "grid": {"arm.q": {"from": 0, "to": 1, "count": 5}},
        }
        job = client.submit_job({"kind": "evaluate", "items": [grid]})
        events = list(client.events(job["id"]))
        assert events[-1][2]["state"] == "succeeded"
        assert list(client.events(job["id"], events[-2][0])) == events[-1:]
        (item,) = client.job_items(job["id"])
        assert client.request("GET", item["files"][0]["href"]).content[:2] == b"PK"
        assert next(client.jobs(state="succeeded"))["id"] == job["id"]
        with pytest.raises(ProblemError, match="no job"):
            list(client.events("none"))
        tree = client.couple("cell", HAND)
        assert tree["revision"] == 2


def test_requests_that_become_jobs(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    request = Client.request

    def patient(self: Client, method: str, path: str, body: Any = None, **options: Any) -> Any:
        headers = {"Prefer": "respond-async"} if method == "POST" else {}
        return request(self, method, path, body, headers=headers, **options)

    monkeypatch.setattr(Client, "request", patient)
    with Client(address) as client:
        version, _ = client.submit({**PENDULUM, "name": "late"})
        assert (version["name"], version["version"]) == ("late", 1)
        assert client.create_tree({**TREE, "name": "late"})["revision"] == 1
        assert client.couple("late", HAND)["revision"] == 2


@pytest.mark.parametrize("suffix", ["npz", "arrow", "json"])
def test_states_in_files(
    address: str, tmp_path: Path, suffix: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    q, masses = np.linspace(0, 1, 30)[:, None], np.linspace(1, 2, 30)
    file, server = tmp_path / f"states.{suffix}", ["--server", address]
    if suffix == "npz":
        np.savez(file, **{"q": q, "parameters.arm.m": masses})
    elif suffix == "arrow":
        parts = [
            arrow.ArrowTable({"q": q[rows], "parameters.arm.m": masses[rows]}) for rows in (slice(7), slice(7, 30))
        ]
        file.write_bytes(b"".join(arrow.write_tables(parts, {})))
    else:
        file.write_text(json.dumps({"q": q.tolist(), "parameters": {"arm.m": masses.tolist()}}))
    command = ["jobs", "evaluate", "cell@1", str(file), "--quantities", "metric,forces", *server]
    assert main([*command, "--format", "npz" if suffix == "arrow" else "arrow"]) == 0
    job = capsys.readouterr().out.strip()
    with Client(address) as client:
        known = client.evaluate("cell@1", quantities=["metric", "forces"], q=q, parameters={"arm.m": masses})
        (part,) = client.results(job)
        assert part["range"] == [0, 30]
        np.testing.assert_allclose(part["forces"], known["forces"], rtol=1e-12)
        monkeypatch.setattr("substructures.client.jobs.AT_ONCE", 100)  # then it travels as an Arrow stream
        many = client.submit_states("cell@1", {"q": q, "parameters.arm.m": masses, "t": 0.0}, quantities=["forces"])
        assert client.wait(many["id"])["state"] == "succeeded"
    file.write_bytes(b"nothing")
    assert main(command) == 1


def test_evaluations_that_become_jobs(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are waited for, and their parts are put together."""
    known, begin = Client._transfer, {"Prefer": "respond-async"}
    q = np.linspace(0, 1, 20_001)[:, None]
    with Client(address) as client:
        expected = client.evaluate("cell@1", quantities=["forces", "kinematics"], q=q, parameters={"g": 0.0})
        monkeypatch.setattr(Client, "_transfer", lambda self, *given, **more: known(self, *given, **more, **begin))
        found = client.evaluate("cell@1", quantities=["forces", "kinematics"], q=q, parameters={"g": 0.0})
        parts = list(client.evaluate_batches("cell@1", [{"q": q}], quantities=["forces"], parameters={"g": 0.0}))
    assert found.keys() == expected.keys()
    assert (found["count"], found["failures"], len(parts)) == (20_001, [], 3)
    np.testing.assert_allclose(found["kinematics"]["position"], expected["kinematics"]["position"], rtol=1e-12)
    np.testing.assert_allclose(np.concatenate([part["forces"] for part in parts]), expected["forces"], rtol=1e-12)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_bar() -> None:
    progress = {"done": 900, "total": 2000, "failed": 3, "fraction": 0.45, "rate": 120.0, "eta_seconds": 3670.0}
    job = {"state": "running", "progress": progress}
    line = text(job)
    assert line.startswith(
        "[#############.................]  45 %  running  900 of 2,000, 3 failed  120/s  1 h 1 min left"
    )
    for stream, count in ((Terminal(), 0), (io.StringIO(), 1)):
        bar = Bar(stream)
        for _ in range(3):
            bar.show(job)
        assert stream.getvalue().count("\n") == count
        bar.end({**job, "state": "failed"})
        assert stream.getvalue().endswith("\n")
        assert "failed" in stream.getvalue()


@pytest.mark.parametrize(
    ("state", "counts", "code", "line", "words"),
    [
        ("succeeded", (4, 0, 0), 0, "4 of 4", "4 succeeded of 4"),
        ("succeeded", (4, 0, 2), 6, "4 of 4, 2 skipped", "4 succeeded of 4; 2 skipped"),
        ("succeeded", (4, 1, 2), 3, "4 of 4, 1 failed, 2 skipped", "3 succeeded, 1 failed of 4; 2 skipped"),
        ("failed", (4, 4, 0), 4, "4 of 4, 4 failed", "0 succeeded, 4 failed of 4"),
        ("cancelled", (3, 1, 1), 5, "3 of 4, 1 failed, 1 cancelled, 1 skipped",
         "2 succeeded, 1 failed, 1 cancelled of 4; 1 skipped"),
    ],
)  # fmt: skip
def test_what_became_of_items(state: str, counts: tuple[int, int, int], code: int, line: str, words: str) -> None:
    """In the exit code, the last line of both bars, the summary, and the words of a job of the client."""
    progress = {**dict(zip(("done", "failed", "skipped"), counts, strict=True)), "total": 4, "fraction": 1.0}
    progress |= {"rate": None, "eta_seconds": None}
    job = {"id": "1", "kind": "export", "label": "", "state": state, "progress": progress}
    assert (outcome(job), summary(job)) == (code, f"export: {words}")
    assert text(job).endswith(f"{state}  {line}")
    assert bar_line(job).endswith(f"{state}  {line}")
    assert str(Job(job, Client("http://127.0.0.1:9"))) == f"Job 1: export, {state}, {line}"
    del progress["skipped"]  # as servers tell that count none
    assert "skipped" not in text(job) + summary(job)


def test_who_stops_to_wait_is_told_how_to_go_on(
    address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(Client, "wait", interrupted)
    (tmp_path / "job.json").write_text(json.dumps(CELLS))
    assert main(["jobs", "submit", str(tmp_path / "job.json"), "--server", address]) == 130
    shown = capsys.readouterr()
    assert f"'substructures jobs watch {shown.out.strip()}' waits again" in shown.err


def test_bar_of_a_narrow_terminal() -> None:
    """What is longer than a line of it could not be written over."""
    progress = {"done": 9, "total": 20000, "failed": 3, "fraction": 0.1, "rate": 120.0, "eta_seconds": 3670.0}
    keeper, terminal = os.openpty()
    try:
        fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 60, 0, 0))
        with os.fdopen(terminal, "w") as stream:
            bar = Bar(stream)
            bar.show({"state": "running", "progress": progress})
            bar.lost(3, 60, "Connection refused")
        shown = b""
        with suppress(OSError):  # as Linux tells the end
            while some := os.read(keeper, 10_000):
                shown += some
    finally:
        os.close(keeper)
    assert shown.count(b"\r") == 2
    assert max(len(line) for line in shown.split(b"\r")) == 59


@pytest.mark.parametrize("identifier", ["", ".", "..", "../trees/cell", "none?x=1"])
def test_ids_are_steps_of_a_path(address: str, identifier: str, capsys: pytest.CaptureFixture[str]) -> None:
    for action in ("show", "cancel", "watch", "result"):
        assert main(["jobs", action, identifier, "--server", address]) == 1
        shown = capsys.readouterr()
        assert not shown.out
        assert "an id is needed" in shown.err or "404" in shown.err
    with Client(address) as client, pytest.raises((ProblemError, ValueError)):
        client.formula(identifier, "metric")


@pytest.mark.parametrize(
    ("command", "name"),
    [
        (["watch", "x", "--patience", "nan"], "--patience"),
        (["watch", "x", "--patience", "-1"], "--patience"),
        (["submit", "x", "--patience", "soon"], "--patience"),
        (["list", "--count", "-1"], "--count"),
        (["list", "--count", "0"], "--count"),
    ],
)
def test_options_are_checked(command: list[str], name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["jobs", *command]) == 2
    assert f"Invalid value for '{name}'" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize(
    ("command", "name", "content", "expected"),
    [
        (["evaluate", "cell"], "two.json", "[1,2]", "an object with 'quantities'"),
        (["evaluate", "cell"], "bad.npz", "nothing", "not an npz file"),
        (["submit"], "bad.json", '{"kind": ', "line 1"),
        (["submit"], "bad.yaml", "kind: [", "line 1"),
    ],
)
def test_files_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str], name: str, content: str, expected: str
) -> None:
    (tmp_path / name).write_text(content)
    assert main(["jobs", *command, str(tmp_path / name), "--server", "http://127.0.0.1:9"]) == 1
    shown = capsys.readouterr().err
    assert str(tmp_path / name) in shown
    assert expected in shown


def test_faults_are_told_once(address: str) -> None:
    with Client(address) as client:
        with pytest.raises(ProblemError) as caught:
            client.submit_job({"kind": "fly", "items": [{}]})
        assert str(caught.value).count("unknown kind 'fly'") == 1
        assert "/kind: " in str(caught.value)
        with pytest.raises(ProblemError) as caught:
            client.submit_job({"kind": "verify", "items": [{"a": 1, "b": 2}]})
        assert str(caught.value).splitlines()[0] == "422: 2 faults"
        assert str(caught.value).count("unknown field 'b'") == 1
    assert str(ProblemError(404, {"detail": "gone", "errors": []})) == "404: gone"


def test_help_says_what_items_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["jobs", "submit", "--help"]) == 0
    shown = capsys.readouterr().out
    assert all(kind in shown for kind in KINDS)
    assert "/openapi.json" in shown
