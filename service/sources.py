"""Other instances that may be mirrored: ``https://host``, or with an API key for them ``https://key@host``.

Only what the operator lists is ever asked; keys are told to nobody else.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from urllib.parse import unquote, urlsplit

SCHEMES = ("http", "https")
#: where the operator lists them
SETTING = "SUBSTRUCTURES_MIRROR_SOURCES"


@dataclass(frozen=True, slots=True)
class Source:
    """``address``: scheme, host and port; ``key``: what is sent there, if anything."""

    address: str
    key: str | None = field(default=None, repr=False)


def read_source(text: str) -> Source:
    """The source that a text names. Raises ValueError, which tells nothing of the text: there may be a key in it."""
    parts = urlsplit(text.strip())
    host, port = parts.hostname, parts.port  # of a bad port ValueError
    if parts.scheme not in SCHEMES or not host or parts.path not in ("", "/") or parts.query or parts.fragment:
        raise ValueError("an address is needed: https://host, https://host:8000 or https://key@host, without a path")
    if parts.password is not None:
        raise ValueError("a key stands before the '@' alone, without a password")
    shown = f"[{host}]" if ":" in host else host
    address = f"{parts.scheme}://{shown}" + ("" if port is None else f":{port}")
    return Source(address, unquote(parts.username) if parts.username else None)


def source_of(address: str, listed: Iterable[str]) -> Source | None:
    """The source with this address among those that are listed."""
    return next((source for source in map(read_source, listed) if source.address == address), None)
