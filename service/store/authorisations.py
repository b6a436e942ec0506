"""What a process remembers of requests: who was authenticated a moment ago, and wrong keys at sign-in."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from dataclasses import dataclass
from math import ceil
from time import monotonic

from service.messages.refusals import Refused
from service.messages.viewer import ANYBODY, Viewer

REMEMBERED = 1000  # authorisations in memory
TRIES, TRIES_SECONDS = 10, 60.0  # wrong keys of an address at sign-in


@dataclass(frozen=True, slots=True)
class Credentials:
    """What a request shows: the header Authorization, or the cookie of a session of pages."""

    authorization: str = ""
    session: str = ""


class Authorisations:
    """Who was authenticated a moment ago, so that most requests need no transaction for it.

    A key that is revoked, expires or is the first one of a server takes effect at most ``seconds`` later.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._known: dict[tuple[str, str], tuple[float, Viewer]] = {}

    def get(self, given: Credentials) -> Viewer | None:
        """Who asks, or None when that has to be looked up."""
        until, viewer = self._known.get(_kept(given), (0.0, ANYBODY))
        return viewer if monotonic() < until else None

    def put(self, given: Credentials, viewer: Viewer) -> None:
        """Remember who was authenticated."""
        if len(self._known) >= REMEMBERED:
            self._known.clear()
        self._known[_kept(given)] = monotonic() + self.seconds, viewer

    def forget(self, given: Credentials) -> None:
        """Look it up the next time."""
        self._known.pop(_kept(given), None)


class WrongKeys:
    """A brake on guessing: after TRIES wrong keys of an address in a time no more of it are looked at until that is
    over. ``addresses``: as many are remembered.
    """

    def __init__(self, addresses: int = REMEMBERED) -> None:
        self._most = addresses
        self._seen: OrderedDict[str, list[float]] = OrderedDict()

    def require_few(self, address: str) -> None:
        """Raise Refused 429 where there were too many of late."""
        seen = self._of_late(address)
        if len(seen) >= TRIES:
            wait = max(1, ceil(seen[0] + TRIES_SECONDS - monotonic()))
            detail = f"{TRIES} wrong keys came from this address in {TRIES_SECONDS:g} s; wait {wait} s"
            raise Refused(429, "too-many-attempts", detail, headers={"Retry-After": str(wait)})

    def note(self, address: str) -> None:
        """One more."""
        self._seen[address] = [*self._of_late(address), monotonic()]
        self._seen.move_to_end(address)
        if len(self._seen) > self._most:
            self._seen.popitem(last=False)

    def _of_late(self, address: str) -> list[float]:
        since = monotonic() - TRIES_SECONDS
        return [each for each in self._seen.get(address, []) if each > since]


def _kept(given: Credentials) -> tuple[str, str]:
    return hashed(given.authorization), hashed(given.session)


def hashed(secret: str) -> str:
    """SHA-256 in hexadecimal digits: secrets have 256 random bits, so one round of a fast hash is enough."""
    return hashlib.sha256(secret.encode()).hexdigest()
