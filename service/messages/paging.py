"""Keyset pages: opaque tokens that say where the next page begins."""

from __future__ import annotations

import base64
import binascii
import hashlib
from typing import Any

import orjson

from service.messages.refusals import Refused, unprocessable


def write_token(search: object, *position: str | int) -> str:
    """The token of the page that begins after ``position`` in the results of ``search``."""
    return base64.urlsafe_b64encode(orjson.dumps([_mark(search), *position])).decode().rstrip("=")


def read_token(search: object, token: str | None, *kinds: type) -> tuple[Any, ...] | None:
    """The position, None without a token. Raises Refused 422 unless the token came from the same search.

    A token only ever selects rows by comparison with bound values, so it needs no signature.
    """
    if token is None:
        return None
    try:
        mark, *position = _read(token)
    except (ValueError, TypeError, binascii.Error):
        mark, position = "", []
    is_place = [type(value) for value in position] == list(kinds) and all(map(_is_storable, position))
    if mark != _mark(search) or not is_place:
        raise of_no_page()
    return tuple(position)


def _is_storable(value: str | int) -> bool:
    """Whether every database compares it with what it has."""
    return "\0" not in value if isinstance(value, str) else 0 <= value < 2**63


def of_no_page() -> Refused:
    """What is said of a token that is of no page."""
    return unprocessable("page-token", "this page_token belongs to no page of this search", "/query/page_token")


def is_of(search: object, token: str) -> bool:
    """Whether a token came from a search."""
    try:
        return bool(_read(token)[0] == _mark(search))
    except (ValueError, TypeError, binascii.Error, IndexError):
        return False


def _read(token: str) -> Any:
    return orjson.loads(base64.urlsafe_b64decode(token + "=" * (-len(token) % 4)))


def _mark(search: object) -> str:
    return hashlib.sha256(repr(search).encode()).hexdigest()[:16]


def limited(page_size: int, most: int) -> int:
    """The page size if it is allowed. Raises Refused 422."""
    if page_size > most:
        raise unprocessable("page-size", f"page_size is at most {most}", "/query/page_size", limit=most)
    return page_size
