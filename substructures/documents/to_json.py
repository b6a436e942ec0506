"""Canonical JSON: one byte string for equal data."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from decimal import Decimal
from functools import cached_property
from typing import Any, Self

from substructures.documents.numbers import RefusedNumberError, plain_text
from substructures.documents.text import MAX_DEPTH, SURROGATE, TOO_DEEP, pointer_step
from substructures.errors import InvalidDocument

_text: Callable[[str], str] = json.encoder.encode_basestring
_WORDS = {None: "null", True: "true", False: "false"}


def write_json(data: Any, keys: Callable[[dict[Any, Any]], Iterable[Any]] = sorted) -> bytes:
    """Canonical JSON of plain data, and of NumPy's scalars and arrays in it: sorted keys, no spaces, UTF-8; with
    ``keys=list`` they are in the order that they are given in.

    Equal numbers have equal bytes: a ``Decimal`` is written without exponent and without trailing zeros, ``-0`` as
    ``0``; a ``float`` is written as its shortest decimal text. Raises :class:`InvalidDocument` for a value that is not
    plain data or not finite, for a lone surrogate, and for nesting deeper than ``MAX_DEPTH``.
    """
    out: list[str] = []
    _Writing(keys, out).value(data, [])
    try:
        return "".join(out).encode("utf-8")
    except UnicodeEncodeError:
        raise InvalidDocument.at("", "encoding", SURROGATE) from None


class Written(dict[str, Any]):
    """Plain data that stands in many documents and is not changed: its text is written once."""

    @classmethod
    def of(cls, data: dict[str, Any], text: bytes) -> Self:
        """The data of a canonical text."""
        found = cls(data)
        found.text = text.decode()
        return found

    @cached_property
    def text(self) -> str:
        """Canonical JSON."""
        return write_json(dict(self)).decode()


class _Writing:
    """Appends texts of values to ``out``; ``path``: where a value is."""

    def __init__(self, keys: Callable[[dict[Any, Any]], Iterable[Any]], out: list[str]) -> None:
        self._keys, self._out = keys, out

    def value(self, value: Any, path: list[str | int]) -> None:
        """Of any kind."""
        if isinstance(value, str):
            self._out.append(_text(value))
        elif value is None or isinstance(value, bool):
            self._out.append(_WORDS[value])
        elif isinstance(value, (int, Decimal, float)):
            self._out.append(_number(value, path))
        elif len(path) >= MAX_DEPTH:
            raise InvalidDocument.at(_pointer(path), "nesting", TOO_DEEP)
        elif isinstance(value, Written) and self._keys is sorted:
            self._out.append(value.text)
        elif isinstance(value, (list, tuple)):
            self._list(value, path)
        elif isinstance(value, dict):
            self._mapping(value, path)
        elif type(value).__module__ == "numpy" and not isinstance(plain := value.tolist(), type(value)):
            self.value(plain, path)
        else:
            message = (
                f"{type(value).__name__} is not plain data: numbers, texts, lists, objects, NumPy's arrays of them"
            )
            raise InvalidDocument.at(_pointer(path), "type", message)

    def _list(self, value: Sequence[Any], path: list[str | int]) -> None:
        path.append(0)
        for index, item in enumerate(value):
            self._out.append("," if index else "[")
            path[-1] = index
            self.value(item, path)
        path.pop()
        self._out.append("]" if value else "[]")

    def _mapping(self, value: dict[Any, Any], path: list[str | int]) -> None:
        for key in value:
            if not isinstance(key, str):
                raise InvalidDocument.at(_pointer(path), "key", f"keys are strings, not {type(key).__name__}")
        path.append("")
        for index, key in enumerate(self._keys(value)):
            self._out.append(("," if index else "{") + _text(key) + ":")
            path[-1] = key
            self.value(value[key], path)
        path.pop()
        self._out.append("}" if value else "{}")


def _pointer(path: Iterable[str | int]) -> str:
    return "".join(map(pointer_step, path))


def _number(value: int | Decimal | float, path: Iterable[str | int]) -> str:
    try:
        return plain_text(value)
    except RefusedNumberError as error:
        raise InvalidDocument.at(_pointer(path), "number", str(error)) from None
