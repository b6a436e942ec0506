"""References: ``name``, ``name@3``, ``name@alias``, ``name@sha256:<64 hex>``."""

from __future__ import annotations

import re
from dataclasses import dataclass

NAME = r"[a-z0-9][a-z0-9-]{0,63}"
ALIAS = r"[A-Za-z][A-Za-z0-9_-]{0,63}"
_REFERENCE = re.compile(rf"({NAME})(?:@(?:([1-9][0-9]{{0,8}})|(sha256:[0-9a-f]{{64}})|({ALIAS})))?")


@dataclass(frozen=True, slots=True)
class Reference:
    """A name and at most one of number, digest and alias; none of them means the latest."""

    name: str
    number: int | None = None
    digest: str | None = None
    alias: str | None = None

    @property
    def is_pinned(self) -> bool:
        """Whether the reference means the same content for ever."""
        return self.number is not None or self.digest is not None


def parse_reference(text: str) -> Reference | None:
    """The reference, or None when the text is none."""
    match = _REFERENCE.fullmatch(text)
    if match is None:
        return None
    name, number, digest, alias = match.groups()
    return Reference(name, int(number) if number else None, digest, alias)


def is_pinned(text: str) -> bool:
    """Whether a text is a reference that means the same content for ever."""
    reference = parse_reference(text)
    return reference is not None and reference.is_pinned
