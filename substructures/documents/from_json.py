"""The JSON reader: the standard parser with hooks; places of faults are looked for only when there is one."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from itertools import accumulate
from typing import Any

from substructures.documents.numbers import REAL, RefusedNumberError, decimal, integer, not_finite
from substructures.documents.text import MAX_DEPTH, SURROGATE, TOO_DEEP, decoded, encodes, fault_at, pointer_to
from substructures.errors import InvalidDocument

# a string that is never closed runs to the end, so that scanning stays linear
_STRING = r'"(?:[^"\\]++|\\.)*+(?:"|\\?\Z)'
_NO_BRACKETS = re.compile(rf'(?:{_STRING}|[^"\[\]{{}}]++)++', re.DOTALL)
_STEPS = {"[": 1, "{": 1, "]": -1, "}": -1}
_NESTING = re.compile(_STRING + r"|[\[\]{}]", re.DOTALL)
_WORD = re.compile(_STRING + r'|[\[\]{},:]|[^\s"\[\]{},:]+', re.DOTALL)
_ESCAPED_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")


class _DuplicateKeyError(ValueError):
    """Raised inside the parser, which does not know where it is."""


def read_json(data: bytes) -> Any:
    """Plain data of a JSON document, numbers exact.

    Raises :class:`InvalidDocument` with a pointer and, in the message, line and column.
    """
    text = decoded(data)
    if text.count("[") + text.count("{") > MAX_DEPTH:  # otherwise nothing can be nested deeper
        _check_nesting(text)
    try:
        value = _DECODER.decode(text)
    except json.JSONDecodeError as error:
        raise fault_at(error.lineno, error.colno, "syntax", error.msg) from None
    except (_DuplicateKeyError, RefusedNumberError):
        raise _first_fault(text) from None
    if _ESCAPED_SURROGATE.search(text):
        _check_strings(text)
    return value


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        raise _DuplicateKeyError
    return result


_DECODER = json.JSONDecoder(
    parse_int=integer, parse_float=decimal, parse_constant=not_finite, object_pairs_hook=_mapping
)


def _words(text: str) -> Iterator[tuple[str, int, int]]:
    """The words of the text, each with its line and column."""
    line, line_start, done = 1, 0, 0
    for match in _WORD.finditer(text):
        start = match.start()
        if breaks := text.count("\n", done, start):
            line += breaks
            line_start = text.rfind("\n", done, start) + 1
        done = start
        yield match.group(), line, start - line_start + 1


def _check_nesting(text: str) -> None:
    if max(accumulate(map(_STEPS.__getitem__, _NO_BRACKETS.sub("", text))), default=0) <= MAX_DEPTH:
        return
    depth = 0
    for match in _NESTING.finditer(text):
        first = match.group()[0]
        if first in "[{":
            depth += 1
        elif first in "]}":
            depth -= 1
        if depth > MAX_DEPTH:
            line_start = text.rfind("\n", 0, match.start())
            line = text.count("\n", 0, match.start()) + 1
            raise fault_at(line, match.start() - line_start, "nesting", TOO_DEEP)


def _check_strings(text: str) -> None:
    for word, line, column in _words(text):
        if word[0] == '"' and not encodes(json.loads(word)):
            raise fault_at(line, column, "encoding", SURROGATE)


def _first_fault(text: str) -> InvalidDocument:
    """The first duplicate key or refused number. The text is good JSON up to there."""
    path: list[str | int | None] = []  # of every open array the index, of every open object the key
    keys: list[set[str]] = []
    before = ""
    for word, line, column in _words(text):
        if word in "[{":
            path.append(0 if word == "[" else None)
            keys.append(set())
        elif word in "]}":
            path.pop()
            keys.pop()
        elif word == "," and isinstance(index := path[-1], int):
            path[-1] = index + 1
        elif word[0] == '"' and before in ("{", ",") and not isinstance(path[-1], int):
            key = path[-1] = json.loads(word)
            if key in keys[-1]:
                return fault_at(line, column, "duplicate-key", f"duplicate key '{key}'", pointer_to(path))
            keys[-1].add(key)
        elif (problem := _number_problem(word)) is not None:
            return fault_at(line, column, "number", problem, pointer_to(path))
        before = word
    return InvalidDocument.at("", "syntax", "not JSON")


def _number_problem(word: str) -> str | None:
    """What is wrong with a word that stands where a number may stand; ``None`` when nothing is."""
    try:
        if word in ("NaN", "Infinity", "-Infinity"):
            not_finite(word)
        elif word.lstrip("-").isdecimal():
            integer(word)
        elif REAL.fullmatch(word):
            decimal(word)
    except RefusedNumberError as error:
        return str(error)
    return None
