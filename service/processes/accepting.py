"""Which of several processes accepts the next connection: one of those that have the fewest open.

Left to themselves, whoever is awake takes what comes, and of a handful of clients that keep their connections one
process may have all while the others have nothing to do.
"""

from __future__ import annotations

import os
import socket
import tempfile
from mmap import mmap
from time import monotonic
from typing import Any

PROCESSES = 256  # that share the numbers of their connections
ABSENT = 2**32 - 1
PATIENCE = 0.005  # seconds for which a connection is left to others
LATER = 0.02  # seconds after which it must be another one that waits


def new() -> int:
    """The descriptor of a file without a name, for numbers that processes share."""
    with tempfile.TemporaryFile() as file:
        file.write(b"\xff" * 4 * PROCESSES)  # nobody is there
        file.flush()
        return os.dup(file.fileno())


class Turns:
    """How many connections each process has open."""

    def __init__(self, descriptor: int) -> None:
        self._counts = memoryview(mmap(descriptor, 4 * PROCESSES)).cast("I")

    def note(self, number: int, count: int = ABSENT) -> None:
        """So many has a process now; by default it is gone."""
        self._counts[number] = count

    def take(self, number: int) -> None:
        """A process has one more, until it notes how many there are."""
        self._counts[number] = min(self._counts[number], ABSENT - 1) + 1

    def is_next(self, number: int) -> bool:
        """Whether nobody has fewer than this process."""
        return self._counts[number] <= min(self._counts)


class Listener(socket.socket):
    """A listening socket that leaves connections to processes which have fewer, but none of them for long."""

    def __init__(self, descriptor: int, turns: Turns, number: int) -> None:
        super().__init__(fileno=descriptor)
        self._turns, self._number = turns, number
        self._since = self._last = 0.0

    def accept(self) -> tuple[socket.socket, Any]:
        """As ever. Raises BlockingIOError, as where there is none, while it is another one's turn."""
        if not self._turns.is_next(self._number):
            now = monotonic()
            if now - self._last > LATER:
                self._since = now
            self._last = now
            if now - self._since < PATIENCE:
                raise BlockingIOError
        accepted = super().accept()
        self._last = 0.0
        self._turns.take(self._number)
        return accepted
