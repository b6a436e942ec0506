"""The id of the request being served, for answers and log lines."""

from __future__ import annotations

import re
from contextvars import ContextVar
from random import getrandbits

_ACCEPTED = re.compile(r"[A-Za-z0-9._:-]{1,128}")
_current: ContextVar[str] = ContextVar("request_id", default="-")


def current_request_id() -> str:
    """The id of the request being served, ``-`` outside of one."""
    return _current.get()


def begin_request(given: str | None) -> str:
    """Take the client's id when it is harmless, otherwise a new one."""
    identifier = given if given is not None and _ACCEPTED.fullmatch(given) else f"{getrandbits(64):016x}"
    _current.set(identifier)
    return identifier
