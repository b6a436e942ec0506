"""The progress of a job as a bar, on terminals and in notebooks."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any, TextIO

WIDTH = 30


class Bar:
    """A line that is written over; where nobody can watch it, only the last one is written."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._width = stream, 0
        self._is_watched = stream.isatty() or "ipykernel" in sys.modules

    def show(self, job: Mapping[str, Any]) -> None:
        """Show where a job is."""
        self._put(line(job))

    def lost(self, waited: float, reason: str) -> None:
        """Show for how long, in seconds, the server has not answered, and why."""
        self._put(f"the server cannot be reached for {waited:.0f} s: {reason}")

    def _put(self, text: str) -> None:
        if self._is_watched:
            self._stream.write("\r" + text.ljust(self._width))
            self._stream.flush()
            self._width = len(text)

    def end(self, job: Mapping[str, Any]) -> None:
        """Leave the last line."""
        self._put(line(job))
        self._stream.write("\n" if self._is_watched else f"{line(job)}\n")


def line(job: Mapping[str, Any]) -> str:
    """A bar, the state, how many items have ended, and the time that is left."""
    progress = job["progress"]
    done = int(WIDTH * progress["fraction"])
    left = progress.get("eta_seconds")
    told = f"[{'#' * done}{'.' * (WIDTH - done)}]  {job['state']}  {counted(job)}"
    return told if left is None else f"{told}  {left:.0f} s left"


def counted(job: Mapping[str, Any]) -> str:
    """How many items have ended, and what became of those that did not succeed; a server may count no skipped ones."""
    progress = job["progress"]
    cancelled = progress["total"] - progress["done"] if job["state"] == "cancelled" else 0
    counts = (("failed", progress["failed"]), ("cancelled", cancelled), ("skipped", progress.get("skipped", 0)))
    return ", ".join([f"{progress['done']:,} of {progress['total']:,}", *(f"{n:,} {word}" for word, n in counts if n)])
