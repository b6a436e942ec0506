"""The YAML reader: plain data from the events of PyYAML's safe loader, without its constructors.

The YAML accepted is a subset without surprises: block and flow collections and scalars of YAML 1.2's core schema with
decimal numbers only. ``on`` and ``yes`` are strings, so are ``0o17``, ``010``, ``1:30`` and ``2001-01-01``; anchors,
aliases, tags and several documents in one stream are refused.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, NoReturn

import yaml

from substructures.documents.numbers import INTEGER, REAL, RefusedNumberError, decimal, integer, not_finite
from substructures.documents.text import MAX_DEPTH, SURROGATE, TOO_DEEP, decoded, encodes, fault_at, pointer_to
from substructures.errors import Fault, InvalidDocument

_QUICK: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml, where PyYAML was built with it
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_TOLD = re.compile(r"\(line \d+, column \d+\)$")
_WORDS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}


def read_yaml(data: bytes, is_ours: bool = False) -> Any:
    """Plain data of a YAML document, numbers exact. ``is_ours``: nobody else wrote it, so that faults need no place
    and libyaml, which is quicker and has messages of its own, may read it.

    Raises :class:`InvalidDocument` with a pointer and, in the message, line and column.
    """
    text = decoded(data)
    builder = _Builder()
    try:
        for event in yaml.parse(text, Loader=_QUICK if is_ours else yaml.SafeLoader):
            builder.feed(event)
    except yaml.reader.ReaderError as error:
        raise InvalidDocument.at("", "encoding", f"character {error.position}: {error.reason}") from None
    except yaml.MarkedYAMLError as error:
        line, column = _place(error.problem_mark or error.context_mark)
        raise fault_at(line, column, "syntax", error.problem or "not YAML", builder.pointer()) from None
    except yaml.YAMLError as error:
        raise InvalidDocument.at("", "syntax", str(error)) from None
    except (ValueError, OverflowError) as error:
        # PyYAML converts escapes such as "\UFFFFFFFF" and %YAML version numbers without checking them
        raise InvalidDocument.at(builder.pointer(), "syntax", f"not YAML: {error}") from None
    return builder.value


def places(data: bytes) -> dict[str, tuple[int, int]]:
    """Line and column, from 1, of every value of a YAML or JSON document by its pointer; of one that cannot be read
    those before the fault.

    >>> places(b"a: {b: 1}")["/a/b"]
    (1, 8)
    """
    builder, found = _Builder(), dict[str, tuple[int, int]]()
    try:
        for event in yaml.parse(decoded(data), Loader=yaml.SafeLoader):
            if isinstance(event, yaml.NodeEvent) and not isinstance(event, yaml.AliasEvent):
                found.setdefault(builder.pointer(), _place(event.start_mark))
            builder.feed(event)
    except (InvalidDocument, yaml.YAMLError, ValueError, OverflowError):
        pass
    return found


def located(faults: Iterable[Fault], data: bytes) -> list[Fault]:
    """Faults of a YAML or JSON document with line and column behind what they say.

    >>> located([Fault("/a/b", "x", "wrong")], b"a: {b: 1}")[0].message
    'wrong (line 1, column 8)'
    """
    known = places(data)
    return [replace(fault, message=fault.message + _where(fault, known)) for fault in faults]


def _where(fault: Fault, known: Mapping[str, tuple[int, int]]) -> str:
    """Line and column of the innermost place there is of a pointer; nothing where the fault says it itself."""
    pointer = fault.pointer
    while pointer and pointer not in known:
        pointer = pointer.rpartition("/")[0]
    if _TOLD.search(fault.message) or not fault.pointer or pointer not in known:
        return ""
    return " (line {}, column {})".format(*known[pointer])


def _place(mark: Any) -> tuple[int, int]:
    return (mark.line + 1, mark.column + 1) if mark is not None else (1, 1)


class _Builder:
    """Collects the value of a document and knows the path to where it stands."""

    def __init__(self) -> None:
        self.value: Any = None
        self._documents = 0
        self._open: list[dict[str, Any] | list[Any]] = []
        self._keys: list[str | None] = []  # of every open mapping: the key that waits for its value

    def pointer(self) -> str:
        """The RFC 6901 pointer to where the next value belongs."""
        # an item that is open itself is already counted in its list
        last = len(self._open) - 1
        return pointer_to(
            len(opened) - (level < last) if isinstance(opened, list) else self._keys[level]
            for level, opened in enumerate(self._open)
        )

    def feed(self, event: yaml.Event) -> None:
        """Take the next event. Raises InvalidDocument for what the subset does not hold."""
        if isinstance(event, yaml.DocumentStartEvent):
            self._documents += 1
            if self._documents > 1:
                self._refuse(event, "syntax", "more than one document")
        elif isinstance(event, yaml.CollectionEndEvent):
            self._open.pop()
            self._keys.pop()
            if self._keys:
                self._keys[-1] = None
        elif isinstance(event, yaml.NodeEvent):
            self._node(event)

    def _node(self, event: yaml.NodeEvent) -> None:
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            self._refuse(event, "anchor", "anchors and aliases are not allowed")
        if (tag := getattr(event, "tag", None)) is not None:
            self._refuse(event, "tag", f"tags are not allowed: {tag}")
        if isinstance(event, yaml.ScalarEvent):
            self._put(event, self._scalar(event))
            return
        if len(self._open) >= MAX_DEPTH:
            self._refuse(event, "nesting", TOO_DEEP)
        collection: dict[str, Any] | list[Any] = {} if isinstance(event, yaml.MappingStartEvent) else []
        self._put(event, collection)
        self._open.append(collection)
        self._keys.append(None)

    def _put(self, event: yaml.NodeEvent, value: Any) -> None:
        if not self._open:
            self.value = value
        elif isinstance(into := self._open[-1], list):
            into.append(value)
        elif (key := self._keys[-1]) is None:
            self._keys[-1] = self._checked_key(event, into, value)
        else:
            into[key] = value
            if not isinstance(value, dict | list):
                self._keys[-1] = None

    def _checked_key(self, event: yaml.NodeEvent, into: dict[str, Any], key: Any) -> str:
        if not isinstance(key, str):
            self._refuse(event, "key", f"keys are strings: put {getattr(event, 'value', 'this one')} into quotes")
        if key in into:
            self._keys[-1] = key
            self._refuse(event, "duplicate-key", f"duplicate key '{key}'")
        return key

    def _scalar(self, event: yaml.ScalarEvent) -> Any:
        text: str = event.value
        if not encodes(text):
            self._refuse(event, "encoding", SURROGATE)
        if not event.implicit[0]:  # quoted or a block scalar
            return text
        if text in _WORDS:
            return _WORDS[text]
        try:
            return _plain(text)
        except RefusedNumberError as error:
            self._refuse(event, "number", str(error))

    def _refuse(self, event: yaml.Event, code: str, message: str) -> NoReturn:
        line, column = _place(event.start_mark)
        raise fault_at(line, column, code, message, self.pointer())


def _plain(text: str) -> Any:
    if _NOT_FINITE.fullmatch(text):
        not_finite(text)
    if INTEGER.fullmatch(text):
        return integer(text)
    return decimal(text) if REAL.fullmatch(text) else text
