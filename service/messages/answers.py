"""What an operation answers, before it becomes an HTTP response; kept under idempotency keys as it is."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

from service import __version__

JSON = "application/json"
FOR_EVER = "max-age=31536000, immutable"
REVALIDATE = "no-cache"
WHOLE = 2**20  # bytes; a smaller body is sent as a whole


@dataclass(frozen=True, slots=True)
class Answer:
    """Status, body and headers (with the content type) of a success."""

    status: int
    body: bytes
    headers: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Stream:
    """Status, headers and body, piece by piece, of a success that may be larger than memory."""

    pieces: Iterator[bytes | memoryview]
    headers: Mapping[str, str]
    status: int = 200


class Sink(io.RawIOBase):
    """Where a file is written to that is sent while it grows."""

    def __init__(self) -> None:
        self._chunks: list[bytes] = []
        self._size = 0

    def writable(self) -> bool:
        """It only can be written to, so that nothing is sought in it."""
        return True

    def write(self, data: Any) -> int:
        """Keep until it is taken."""
        self._chunks.append(bytes(data))
        self._size += len(data)
        return len(data)

    def tell(self) -> int:
        """How much was written in all."""
        return self._size

    def taken(self) -> bytes:
        """What was written since the last time."""
        chunks, self._chunks = self._chunks, []
        return b"".join(chunks)


def some_of(pieces: Iterator[bytes | memoryview]) -> list[bytes | memoryview]:
    """Some pieces that are worth a change of threads, none at the end."""
    some, size = [], 0
    for piece in pieces:
        some.append(piece)
        size += len(piece)
        if size > WHOLE:
            break
    return some


def streamed(pieces: Iterator[bytes | memoryview], content_type: str) -> Answer | Stream:
    """An answer as a whole if it is small, so that its length is told, otherwise as a stream."""
    begun, headers = some_of(pieces), {"Content-Type": content_type}
    if sum(map(len, begun)) > WHOLE:
        return Stream(chain(begun, pieces), headers)
    return Answer(200, b"".join(begun), headers)


def json_answer(body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Answer:
    """An answer with a JSON body."""
    return Answer(status, body, {"Content-Type": JSON, **(headers or {})})


def etag(*identity: str) -> str:
    """A strong ETag of a representation that is a function of its identity and of the software."""
    text = "\n".join((__version__, *identity))
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'


def names(given: str, tag: str) -> bool:
    """Whether a header names a tag, or all; weak ones are the same, as which proxies send what they compress."""
    known = [each.strip().removeprefix("W/") for each in given.split(",")]
    return tag in known or "*" in known
