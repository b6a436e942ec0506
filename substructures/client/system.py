"""One server itself: its state, its limits, and who did what."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from substructures.client.answers import Answer
from substructures.client.connection import Caller


class SystemCaller(Caller):
    """What there is to know about a server."""

    def limits(self) -> Answer:
        """Every limit with its value."""
        return self.told("GET", "/v1/limits")

    def folder(self) -> Answer:
        """What was read of the folder that the server follows. Raises ProblemError 404 where it follows none."""
        return self.told("GET", "/v1/folder")

    def audit(self, **filters: Any) -> Iterator[Answer]:
        """Who did what, the latest first: of an ``owner``, a ``key``, an ``action``, a ``subject``; needs ``admin``."""
        return self._pages("/v1/audit", filters, Answer)

    def alive(self) -> Answer:
        """Whether the process answers."""
        return self.told("GET", "/livez")

    def ready(self) -> Answer:
        """Whether the database answers. Raises ProblemError 503."""
        return self.told("GET", "/readyz")

    def metrics(self) -> str:
        """Prometheus metrics of one process."""
        return self.request("GET", "/metrics").text
