"""Canonical JSON: one byte string for equal data."""

from __future__ import annotations

import json
from collections.abc import Iterator
from decimal import Decimal
from typing import Any

from substructures.documents.numbers import RefusedNumberError, plain_text
from substructures.documents.text import MAX_DEPTH, SURROGATE, TOO_DEEP, pointer_step
from substructures.errors import InvalidDocument


def write_json(data: Any) -> bytes:
    """Canonical JSON of plain data: sorted keys, no spaces, UTF-8.

    Equal numbers have equal bytes: a ``Decimal`` is written without exponent and without trailing zeros, ``-0`` as
    ``0``; a ``float`` is written as its shortest decimal text. Raises :class:`InvalidDocument` for a value that is not
    plain data or not finite, for a lone surrogate, and for nesting deeper than ``MAX_DEPTH``.
    """
    try:
        return "".join(_written(data, "", 0)).encode("utf-8")
    except UnicodeEncodeError:
        raise InvalidDocument.at("", "encoding", SURROGATE) from None


def _written(value: Any, pointer: str, depth: int) -> Iterator[str]:
    if value is None or isinstance(value, str | bool):
        yield json.dumps(value, ensure_ascii=False)
    elif isinstance(value, int | Decimal | float):
        yield _number(value, pointer)
    elif depth >= MAX_DEPTH:
        raise InvalidDocument.at(pointer, "nesting", TOO_DEEP)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield "," if index else "["
            yield from _written(item, pointer + pointer_step(index), depth + 1)
        yield "]" if value else "[]"
    elif isinstance(value, dict):
        yield from _mapping(value, pointer, depth)
    else:
        raise InvalidDocument.at(pointer, "type", f"{type(value).__name__} is not plain data")


def _mapping(value: dict[Any, Any], pointer: str, depth: int) -> Iterator[str]:
    for key in value:
        if not isinstance(key, str):
            raise InvalidDocument.at(pointer, "key", f"keys are strings, not {type(key).__name__}")
    for index, key in enumerate(sorted(value)):
        yield ("," if index else "{") + json.dumps(key, ensure_ascii=False) + ":"
        yield from _written(value[key], pointer + pointer_step(key), depth + 1)
    yield "}" if value else "{}"


def _number(value: int | Decimal | float, pointer: str) -> str:
    try:
        return plain_text(value)
    except RefusedNumberError as error:
        raise InvalidDocument.at(pointer, "number", str(error)) from None
