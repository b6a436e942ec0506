"""Quotas in bytes: of what one API key may keep in the store, and of what all may."""

from __future__ import annotations

import threading
from time import monotonic

from service.database.connections import Connection
from service.messages.refusals import Refused
from service.queries.usage import KEPT, bytes_by_principal
from service.settings import Limits

FRESH = 15.0  # seconds for which sums are taken for granted, but for what is added here


class Usage:
    """The bytes that are kept for each principal, by kind (``upload``, ``result``, ``answer``).

    Several servers on one database see what the others add when they sum anew, and may exceed a quota by that.
    """

    def __init__(self, limits: Limits) -> None:
        given = limits.model_dump()
        self._most = {what: (given[f"{what}_bytes_per_key"], given[f"{what}_bytes"]) for what in KEPT}
        self._lock = threading.Lock()
        self._known: dict[str, tuple[float, dict[str, int]]] = {}

    def take(self, connection: Connection, what: str, principal: str, size: int) -> None:
        """Count bytes that will be kept. Raises Refused 503 (``quota-exceeded``) where they are more than may be."""
        with self._lock:
            kept = self._kept(connection, what)
            own, whole = kept.get(principal, 0), sum(kept.values())
            for whose, there, most in zip(("of your key", "of all"), (own, whole), self._most[what], strict=True):
                if there + size > most or there >= most:
                    detail = f"the {what}s {whose} take {there:,} bytes, of {most:,} that they may; nothing was stored"
                    headers = {"Retry-After": "60"}
                    raise Refused(503, "quota-exceeded", detail, headers=headers, what=what, size=size, limit=most)
            kept[principal] = own + size

    def add(self, what: str, principal: str, size: int) -> None:
        """Count bytes that are kept in any case."""
        with self._lock:
            kept = self._known.get(what, (0.0, {}))[1]
            kept[principal] = kept.get(principal, 0) + size

    def _kept(self, connection: Connection, what: str) -> dict[str, int]:
        summed, kept = self._known.get(what, (0.0, {}))
        if not summed or monotonic() - summed > FRESH:
            kept = bytes_by_principal(connection, what)
            self._known[what] = monotonic(), kept
        return kept
