"""Content is named by the SHA-256 of its bytes: whoever reads some compares, and what is damaged or gone is refused.

The refusals blame the store, not the request: status 500, code ``damaged-content`` or ``missing-content``, with what it
is and the digest that it should have. Damaged content is never used.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from service.messages.refusals import Refused
from substructures.errors import InvalidDocument, InvalidProgram

#: what is wrong with what was changed, and with what came without the key
NOT_SEALED = "it does not have the seal of this server"
REMEDY = "restore a backup, or derive it anew with 'substructures verify --repair'"


def digest_of(content: bytes) -> str:
    """``sha256:`` and 64 hex digits."""
    return "sha256:" + hashlib.sha256(content).hexdigest()


def damaged(what: str, digest: str, why: str, remedy: str = REMEDY) -> Refused:
    """500: the store has it, but not as it was stored. ``what``: e.g. ``the program of arm@2``."""
    detail = f"{what}, {digest}, is damaged in the store: {why}; {remedy}"
    return Refused(500, "damaged-content", detail, what=what, digest=digest)


def missing(what: str, digest: str) -> Refused:
    """500: the store has to have it, and has not."""
    return Refused(
        500, "missing-content", f"{what}, {digest}, is gone from the store; {REMEDY}", what=what, digest=digest
    )


def checked(what: str, digest: str, content: bytes, remedy: str = REMEDY) -> bytes:
    """The content, whose digest is what it is called by. Raises Refused (``damaged-content``)."""
    found = digest_of(content)
    if found != digest:
        raise damaged(what, digest, f"its bytes have the digest {found}", remedy)
    return content


@contextmanager
def reading(what: str, digest: str) -> Iterator[None]:
    """Faults of a stored document or program are those of the store. Raises Refused (``damaged-content``)."""
    try:
        yield
    except (InvalidDocument, InvalidProgram, KeyError, TypeError, ValueError) as error:
        raise damaged(what, digest, f"it cannot be read ({type(error).__name__}: {error})") from error


class CheckedBlobs(Mapping[str, bytes]):
    """Contents by digest, each compared with its digest when it is read."""

    def __init__(self, blobs: Mapping[str, bytes]) -> None:
        self._blobs = blobs

    def __getitem__(self, digest: str) -> bytes:
        if digest not in self._blobs:
            raise missing("a content", digest)
        return checked("a content", digest, self._blobs[digest])

    def __iter__(self) -> Iterator[str]:
        return iter(self._blobs)

    def __len__(self) -> int:
        return len(self._blobs)
