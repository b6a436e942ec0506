"""Canonical JSON: one byte string for equal data."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import Any

from substructures.documents.numbers import RefusedNumberError, plain_text
from substructures.documents.text import MAX_DEPTH, SURROGATE, TOO_DEEP, pointer_step
from substructures.errors import InvalidDocument

_text = json.JSONEncoder(ensure_ascii=False).encode


def write_json(data: Any) -> bytes:
    """Canonical JSON of plain data, and of NumPy's scalars and arrays in it: sorted keys, no spaces, UTF-8.

    Equal numbers have equal bytes: a ``Decimal`` is written without exponent and without trailing zeros, ``-0`` as
    ``0``; a ``float`` is written as its shortest decimal text. Raises :class:`InvalidDocument` for a value that is not
    plain data or not finite, for a lone surrogate, and for nesting deeper than ``MAX_DEPTH``.
    """
    out: list[str] = []
    _write(data, [], out)
    try:
        return "".join(out).encode("utf-8")
    except UnicodeEncodeError:
        raise InvalidDocument.at("", "encoding", SURROGATE) from None


def _write(value: Any, path: list[str | int], out: list[str]) -> None:
    """Append the text of a value; ``path``: where it is."""
    if value is None or isinstance(value, str | bool):
        out.append(_text(value))
    elif isinstance(value, int | Decimal | float):
        out.append(_number(value, path))
    elif len(path) >= MAX_DEPTH:
        raise InvalidDocument.at(_pointer(path), "nesting", TOO_DEEP)
    elif isinstance(value, list | tuple):
        _write_list(value, path, out)
    elif isinstance(value, dict):
        _write_mapping(value, path, out)
    elif type(value).__module__ == "numpy" and not isinstance(plain := value.tolist(), type(value)):
        _write(plain, path, out)
    else:
        message = f"{type(value).__name__} is not plain data: numbers, texts, lists, objects, NumPy's arrays of them"
        raise InvalidDocument.at(_pointer(path), "type", message)


def _write_list(value: Sequence[Any], path: list[str | int], out: list[str]) -> None:
    path.append(0)
    for index, item in enumerate(value):
        out.append("," if index else "[")
        path[-1] = index
        _write(item, path, out)
    path.pop()
    out.append("]" if value else "[]")


def _write_mapping(value: dict[Any, Any], path: list[str | int], out: list[str]) -> None:
    for key in value:
        if not isinstance(key, str):
            raise InvalidDocument.at(_pointer(path), "key", f"keys are strings, not {type(key).__name__}")
    path.append("")
    for index, key in enumerate(sorted(value)):
        out.append(("," if index else "{") + _text(key) + ":")
        path[-1] = key
        _write(value[key], path, out)
    path.pop()
    out.append("}" if value else "{}")


def _pointer(path: Iterable[str | int]) -> str:
    return "".join(map(pointer_step, path))


def _number(value: int | Decimal | float, path: Iterable[str | int]) -> str:
    try:
        return plain_text(value)
    except RefusedNumberError as error:
        raise InvalidDocument.at(_pointer(path), "number", str(error)) from None
