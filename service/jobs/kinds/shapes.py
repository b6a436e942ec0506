"""Shapes of trees that this process coupled and certified itself, each for those alone on whose behalf it did so.

Whether a shape is known shows in the time that a tree takes. So what came of one owner's parts, or of one job, is used
for trees of that owner, or job, and tells nobody else that there is such a shape.
"""

from __future__ import annotations

from dataclasses import dataclass

from service.content.cache import Cache
from service.jobs.kinds.decoded import CAPACITY
from substructures.tree.shape import CertifiedProgram, KnownShapes

SHARE = "share"  # field of an item: on whose behalf it is computed
KNOWN = "known"  # likewise: digests of what need not be sent, for it is stored
_known: Cache[CertifiedProgram] = Cache(CAPACITY, lambda shape: len(shape.program))


@dataclass(frozen=True)
class _OfShare:
    """What is known to one share."""

    share: str

    def get(self, key: str, /) -> CertifiedProgram | None:
        """What is known of a shape."""
        return _known.get((self.share, key))

    def put(self, key: str, value: CertifiedProgram, /) -> None:
        """Remember a shape."""
        _known.put((self.share, key), value)


def shapes_of(item: dict[str, object]) -> KnownShapes | None:
    """The shapes that an item may use; None where it does not say on whose behalf."""
    share = item.get(SHARE)
    return None if share is None else _OfShare(str(share))
