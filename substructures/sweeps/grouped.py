"""Columns that are computed together, and where their faults are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from substructures.documents import escape, write_json
from substructures.errors import InvalidArgument, InvalidInput, among


def alike(given: Mapping[str, Mapping[str, Any]]) -> Iterator[list[str]]:
    """Names with equal documents, together."""
    groups: dict[bytes, list[str]] = {}
    for name, each in given.items():
        groups.setdefault(write_json(dict(each)), []).append(name)
    yield from groups.values()


def check_fields(at: Mapping[str, Any], known: Sequence[str]) -> None:
    """Raises InvalidArgument (``/name``, ``unknown-field``) for what nothing is done with."""
    for field in at:
        if field not in known:
            message = f"unknown field '{field[:80]}'{among(field, known)}"
            raise InvalidArgument.at(f"/{escape(field)}", "unknown-field", message)


@contextmanager
def inside(place: str) -> Iterator[None]:
    """Faults that are found here have pointers relative to this place."""
    try:
        yield
    except InvalidInput as error:
        raise error.below(place) from None
