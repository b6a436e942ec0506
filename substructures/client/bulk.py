"""Large bodies for the client: sent from an iterator, and received where they stay, without a copy in between.

The standard library's connection reads into memory that it is given; the general client hands out small pieces.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection, IncompleteRead, RemoteDisconnected
from selectors import EVENT_READ, DefaultSelector
from time import monotonic
from urllib.parse import urlsplit

import httpx2
import numpy as np
from numpy.typing import NDArray

ROOM = 64 * 2**20  # bytes; memory is only taken as it fills
KEPT = 2.0  # seconds; servers close connections on which nothing is asked for longer


class Bulk:
    """Connections to one server for large bodies; those that are free for a moment are used again."""

    def __init__(self, address: str, timeout: float) -> None:
        self._url, self._timeout = urlsplit(address), timeout
        self._free: list[tuple[HTTPConnection, float]] = []  # and since when

    @contextmanager
    def transfer(
        self,
        path: str,
        content: Iterable[bytes | memoryview],
        headers: Mapping[str, str],
        *,
        is_repeatable: bool = False,
    ) -> Iterator[HTTPResponse]:
        """The answer to a POST, to be read inside of the block. Raises httpx2.HTTPError.

        ``is_repeatable``: the content can be sent twice and changes nothing on the server. Only then is a connection
        used again, since its end may be on the way: what is not answered on such a one is asked once more on a new one.
        """
        kept = self._kept() if is_repeatable else None
        connection = kept or self._new()
        is_free = False
        try:
            try:
                answer = self._answer(connection, path, content, headers)
            except (RemoteDisconnected, ConnectionResetError):
                if kept is None:
                    raise
                connection.close()
                connection = self._new()
                answer = self._answer(connection, path, content, headers)
            yield answer
            is_free = answer.isclosed() and not answer.will_close
        except TimeoutError as error:
            raise httpx2.ReadTimeout(str(error)) from error
        except (OSError, HTTPException) as error:
            raise httpx2.RemoteProtocolError(f"the answer was cut off: {error!r}") from error
        finally:
            if is_free:
                self._free.append((connection, monotonic()))
            else:
                connection.close()

    def _answer(
        self, connection: HTTPConnection, path: str, content: Iterable[bytes | memoryview], headers: Mapping[str, str]
    ) -> HTTPResponse:
        with suppress(BrokenPipeError, ConnectionResetError):  # the server may answer before it has read all
            connection.request("POST", self._url.path.rstrip("/") + path, content, dict(headers))
        return connection.getresponse()

    def close(self) -> None:
        """Close all that are free."""
        while self._free:
            self._free.pop()[0].close()

    def _kept(self) -> HTTPConnection | None:
        """One that was used a moment ago and that the server has not closed since."""
        while self._free:
            connection, since = self._free.pop()
            if monotonic() - since < KEPT and not _is_ended(connection):
                return connection
            connection.close()
        return None

    def _new(self) -> HTTPConnection:
        kind = HTTPSConnection if self._url.scheme == "https" else HTTPConnection
        return kind(self._url.hostname or "", self._url.port, timeout=self._timeout)


def _is_ended(connection: HTTPConnection) -> bool:
    """Whether a connection that waits for nothing has something to read: its end."""
    if connection.sock is None:
        return True
    with DefaultSelector() as selector:
        selector.register(connection.sock, EVENT_READ)
        return bool(selector.select(0))


def read_all(answer: HTTPResponse) -> NDArray[np.uint8]:
    """The body."""
    buffer, size = np.empty(min(answer.length or ROOM, ROOM), np.uint8), 0
    while read := answer.readinto(buffer[size:].data):
        size += read
        if size == len(buffer) and answer.length != 0:
            buffer = np.concatenate([buffer, np.empty(3 * size, np.uint8)])
    if answer.length:
        raise IncompleteRead(b"", answer.length)
    return buffer[:size]
