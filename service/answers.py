"""What an operation answers, before it becomes an HTTP response; kept under idempotency keys as it is."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

from fastapi import Response

from service import __version__

JSON = "application/json"
FOR_EVER = "max-age=31536000, immutable"
REVALIDATE = "no-cache"


@dataclass(frozen=True, slots=True)
class Answer:
    """Status, body and headers (with the content type) of a success."""

    status: int
    body: bytes
    headers: Mapping[str, str] = field(default_factory=dict)

    def response(self) -> Response:
        """The HTTP response."""
        return Response(self.body, self.status, dict(self.headers))


def json_answer(body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Answer:
    """An answer with a JSON body."""
    return Answer(status, body, {"Content-Type": JSON, **(headers or {})})


def etag(*identity: str) -> str:
    """A strong ETag of a representation that is a function of its identity and of the software."""
    text = "\n".join((__version__, *identity))
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'
