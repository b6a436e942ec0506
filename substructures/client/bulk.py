"""Large bodies for the client: sent from an iterator, and received where they stay, without a copy in between.

The standard library's connection reads into memory that it is given; the general client hands out small pieces.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection, IncompleteRead
from urllib.parse import urlsplit

import httpx2
import numpy as np
from numpy.typing import NDArray

ROOM = 64 * 2**20  # bytes; memory is only taken as it fills


@contextmanager
def transfer(
    address: str, path: str, content: Iterable[bytes | memoryview], headers: Mapping[str, str], timeout: float
) -> Iterator[HTTPResponse]:
    """The answer to a POST on a connection of its own, to be read inside of the block. Raises httpx2.HTTPError."""
    url = urlsplit(address)
    kind = HTTPSConnection if url.scheme == "https" else HTTPConnection
    with closing(kind(url.hostname or "", url.port, timeout=timeout)) as connection:
        try:
            with suppress(BrokenPipeError, ConnectionResetError):  # the server may answer before it has read all
                connection.request("POST", url.path.rstrip("/") + path, content, dict(headers))
            yield connection.getresponse()
        except TimeoutError as error:
            raise httpx2.ReadTimeout(str(error)) from error
        except (OSError, HTTPException) as error:
            raise httpx2.RemoteProtocolError(f"the answer was cut off: {error!r}") from error


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
