"""Names and ids as steps of paths."""

from __future__ import annotations

from typing import Protocol
from urllib.parse import quote


class Referable(Protocol):
    """What has a reference or an id, and can stand in its place."""

    @property
    def ref(self) -> str:
        """The reference, as in paths."""


def step(given: str | Referable) -> str:
    """A name, an id or what has one as one step of a path. Raises ValueError for what can be none."""
    text = given if isinstance(given, str) else given.ref
    if not text.strip("."):
        raise ValueError(f"a name or an id is needed, found '{text}'")
    return quote(text, safe="@:")
