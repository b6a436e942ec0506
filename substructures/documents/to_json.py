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
    try:
        text = _written(data, keys)
    except (InvalidDocument, RefusedNumberError, TypeError):
        text = _Writing(keys).value(data, 0)  # says where the fault is
    try:
        return text.encode("utf-8")
    except UnicodeEncodeError:
        raise InvalidDocument.at("", "encoding", SURROGATE) from None


def _written(value: Any, keys: Callable[[dict[Any, Any]], Iterable[Any]], depth: int = 0) -> str:
    """What :class:`_Writing` makes of plain data; of all else, and where something is wrong, it is asked itself."""
    kind = type(value)
    if kind is str:
        return _text(value)
    if kind is int or kind is Decimal or kind is float:
        return plain_text(value)
    if kind is dict and depth < MAX_DEPTH:
        inner = depth + 1
        return f"{{{','.join([f'{_text(key)}:{_written(value[key], keys, inner)}' for key in keys(value)])}}}"
    if (kind is list or kind is tuple) and depth < MAX_DEPTH:
        inner = depth + 1
        return f"[{','.join([_written(each, keys, inner) for each in value])}]"
    return _Writing(keys).value(value, depth)


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
    """Texts of values at a ``depth``; where a fault is, is told by those that it is in."""

    def __init__(self, keys: Callable[[dict[Any, Any]], Iterable[Any]]) -> None:
        self._keys = keys

    def value(self, value: Any, depth: int) -> str:
        """Of any kind."""
        if isinstance(value, str):
            return _text(value)
        if value is None or isinstance(value, bool):
            return _WORDS[value]
        if isinstance(value, (int, Decimal, float)):
            return _number(value)
        if depth >= MAX_DEPTH:
            raise InvalidDocument.at("", "nesting", TOO_DEEP)
        if isinstance(value, Written) and self._keys is sorted:
            return value.text
        if isinstance(value, (list, tuple)):
            return self._list(value, depth + 1)
        if isinstance(value, dict):
            return self._mapping(value, depth + 1)
        if type(value).__module__ == "numpy" and not isinstance(plain := value.tolist(), type(value)):
            return self.value(plain, depth)
        message = f"{type(value).__name__} is not plain data: numbers, texts, lists, objects, NumPy's arrays of them"
        raise InvalidDocument.at("", "type", message)

    def _list(self, value: Sequence[Any], depth: int) -> str:
        return f"[{','.join([self._at(index, item, depth) for index, item in enumerate(value)])}]"

    def _mapping(self, value: dict[Any, Any], depth: int) -> str:
        for key in value:
            if not isinstance(key, str):
                raise InvalidDocument.at("", "key", f"keys are strings, not {type(key).__name__}")
        texts = [f"{_text(key)}:{self._at(key, value[key], depth)}" for key in self._keys(value)]
        return f"{{{','.join(texts)}}}"

    def _at(self, step: str | int, value: Any, depth: int) -> str:
        try:
            return self.value(value, depth)
        except InvalidDocument as error:
            raise error.below(pointer_step(step)) from None


def _number(value: int | Decimal | float) -> str:
    try:
        return plain_text(value)
    except RefusedNumberError as error:
        raise InvalidDocument.at("", "number", str(error)) from None
