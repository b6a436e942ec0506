"""Keys of caches: something that is recognised by what it was made from."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Known:
    """Something with a digest, as key of a cache: equal when the digests are."""

    digest: str
    source: Any = field(compare=False)
