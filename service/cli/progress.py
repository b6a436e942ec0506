"""The progress of a job on a terminal, or in lines, also while its server cannot be reached."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from itertools import islice
from time import monotonic
from typing import Any, TextIO

from service.cli.output import WIDE, print_json
from substructures.client import Client, ServerLost
from substructures.client.jobs import PATIENCE
from substructures.client.progress import counted

WIDTH = 30
SHOWN = 3  # items that failed
#: exit codes of commands that wait for a job
SOME_FAILED, ALL_FAILED, CANCELLED, SOME_SKIPPED = 3, 4, 5, 6
LINES = 10.0  # seconds between lines where there is no terminal


def follow(client: Client, job: str, patience: float = PATIENCE) -> int:
    """Show the progress of a job until it has ended, and what came of it; the exit code says so, too
    (:func:`outcome`). Raises ServerLost.
    """
    bar = Bar(sys.stderr)
    try:
        end = client.wait(job, bar.show, lambda waited, reason: bar.lost(waited, patience, reason), patience)
    except ServerLost:
        bar.leave()
        raise
    except KeyboardInterrupt:
        bar.leave()
        sys.stderr.write(f"the job stays: 'substructures jobs watch {job}' waits again, 'jobs cancel {job}' ends it\n")
        raise
    bar.end(end)
    sys.stderr.write(summary(end) + "\n")
    if end["progress"]["failed"]:
        _explain(client, job)
    return outcome(end)


def became_job(client: Client, job: Mapping[str, Any], wait: bool, as_json: bool = False) -> int:
    """Say that a request takes so long that it is a job now, which is waited for or not; as JSON the job at the end."""
    if not as_json:
        print(f"became the job {job['id']}", flush=True)
    code = follow(client, str(job["id"])) if wait else 0
    if as_json:
        print_json(client.job(str(job["id"])))
    return code


def outcome(job: Mapping[str, Any]) -> int:
    """The exit code of a job that has ended: 0 all succeeded, 3 some items failed, 4 all did, 5 it was cancelled, 6 all
    that were taken succeeded and others were left out.
    """
    progress = job["progress"]
    if job["state"] == "cancelled":
        return CANCELLED
    if progress["failed"]:
        return ALL_FAILED if progress["failed"] == progress["total"] else SOME_FAILED
    return SOME_SKIPPED if progress.get("skipped") else 0


def summary(job: Mapping[str, Any]) -> str:
    """A line about a job that has ended."""
    progress = job["progress"]
    done = progress["done"] - progress["failed"]
    left = progress["total"] - progress["done"]
    counts = [f"{done:,} succeeded"]
    counts += [f"{progress['failed']:,} failed"] if progress["failed"] else []
    counts += [f"{left:,} cancelled"] if left else []
    skipped = f"; {progress['skipped']:,} skipped" if progress.get("skipped") else ""
    name = f"{job['kind']} '{job['label']}'" if job.get("label") else job["kind"]
    return f"{name}: {', '.join(counts)} of {progress['total']:,}{skipped}"


def _explain(client: Client, job: str) -> None:
    """Say why the first items failed that did, and where the others are told."""
    for item in islice(client.job_items(job, state="failed"), SHOWN):
        subject = f" ({item['subject']})" if item.get("subject") else ""
        sys.stderr.write(f"item {item['position']}{subject}: {item['problem']['detail']}\n")
    sys.stderr.write(f"all items: substructures jobs result {job}\n")
    sys.stderr.write(f"once more what failed: substructures jobs retry {job}\n")


class Bar:
    """A line that is written over on a terminal; elsewhere a new line now and then."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._next, self._width = stream, 0.0, 0
        self._waited: float | None = None
        self._last = ""

    def show(self, job: dict[str, Any]) -> None:
        """Show where a job is."""
        if self._waited is not None:
            self._put(f"the server answers again after {self._waited:.0f} s", at_once=True)
            self.leave()
            self._waited = None
        self._put(text(job))

    def lost(self, waited: float, patience: float, reason: str) -> None:
        """Show for how long, in seconds, the server has not answered, and how long it is tried."""
        line = f"the server cannot be reached ({reason}): {waited:.0f} s, trying for {patience:g} s"
        self._put(line, at_once=self._waited is None)
        self._waited = waited

    def _put(self, line: str, at_once: bool = False) -> None:
        if self._stream.isatty():
            line = line[: _columns(self._stream) - 1]  # a line that is broken cannot be written over
            self._stream.write("\r" + line.ljust(self._width))
            self._width = len(line)
        elif at_once or monotonic() >= self._next:
            self._stream.write(line + "\n")
            self._next, self._last = monotonic() + LINES, line
        self._stream.flush()

    def end(self, job: dict[str, Any]) -> None:
        """Leave the last line, which is not written twice."""
        if self._last != text(job):
            self._next = 0.0
            self.show(job)
        self.leave()

    def leave(self) -> None:
        """Begin a new line."""
        self._next, self._width = 0.0, 0
        if self._stream.isatty():
            self._stream.write("\n")


def _columns(terminal: TextIO) -> int:
    """Of a terminal, which may have another width by now; many where it does not tell."""
    try:
        return os.get_terminal_size(terminal.fileno()).columns or WIDE
    except OSError:
        return WIDE


def text(job: dict[str, Any]) -> str:
    """A line about a job: a bar, the state, counts, rate and time left."""
    progress = job["progress"]
    done = int(WIDTH * progress["fraction"])
    words = [
        f"[{'#' * done}{'.' * (WIDTH - done)}]",
        f"{100 * progress['fraction']:.0f} %",
        job["state"],
        counted(job),
    ]
    if progress["rate"]:
        words.append(f"{progress['rate']:.3g}/s")
    if progress["eta_seconds"] is not None:
        words.append(f"{_time(progress['eta_seconds'])} left")
    return "  ".join(words)


def _time(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
