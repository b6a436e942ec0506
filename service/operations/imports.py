"""Foreign files as definitions or trees; what of them is stored is stored like any other document."""

from __future__ import annotations

from typing import Any

from substructures.documents import write_json
from substructures.interchange.importing import Imported


def answer_of(found: Imported, stored: dict[str, Any] | None = None) -> bytes:
    """The body of an answer: what was read, the report, and what became of it in the store."""
    return write_json({**found.plain(), **({} if stored is None else {"stored": stored})})
