"""Requests for evaluations as columns, as npz files and Arrow streams have them: names are joined by dots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.documents import pointer_step
from substructures.errors import InvalidDocument

ColumnRequest = Mapping[str, Any]
#: fields whose columns may also be given one by one: ``q.<coordinate>``, ``parameters.<name>``, ...
_GROUPS = ("along.inputs", "along.q", "along.qd", "along.qdd", "along", "q", "qd", "qdd", "inputs", "parameters")
_STATES = ("/q", "/qd", "/qdd", "/along/q", "/along/qd", "/along/qdd")


def request_of(constants: ColumnRequest, columns: ColumnRequest) -> dict[str, Any]:
    """The request with nested objects, from columns whose names are joined by dots. Raises InvalidDocument."""
    request = {name: dict(value) if isinstance(value, Mapping) else value for name, value in constants.items()}
    for name, column in columns.items():
        *steps, place = _path(name)
        holder: Any = request
        for step in steps:
            holder = holder.setdefault(step, {}) if isinstance(holder, dict) else None
        if not isinstance(holder, dict) or place in holder:
            raise InvalidDocument.at(pointer_step(name), "given-twice", f"'{name}' is given twice")
        holder[place] = column
    return request


def _path(name: str) -> tuple[str, ...]:
    """Where a column belongs in the nested request."""
    if name in _GROUPS:
        return tuple(name.split("."))
    group = next((each for each in _GROUPS if name.startswith(f"{each}.") and name != f"{each}."), None)
    return (name,) if group is None else (*group.split("."), name[len(group) + 1 :])


def pointer_of(name: str) -> str:
    """The JSON pointer of a column in the nested request."""
    return "".join(map(pointer_step, _path(name)))


def has_rows(value: Any, pointer: str) -> bool:
    """Whether an array may have an entry for every state: (N, n) for states, (N,) for all others."""
    return isinstance(value, np.ndarray) and value.ndim == (2 if pointer in _STATES else 1)


def parted(columns: ColumnRequest) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
    """The columns with a row for every state, which are the longest, and what is the same for all states."""
    lengths = {name: len(x) for name, x in columns.items() if has_rows(x, pointer_of(name))}
    count = max(lengths.values(), default=1)
    rows = {name: columns[name] for name, length in lengths.items() if length == count}
    return rows, {name: x for name, x in columns.items() if name not in rows}
