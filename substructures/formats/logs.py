"""Measured motions out of the files of data loggers: CSV, npz, Arrow streams; with a unit beside each name.

A column is called after what was measured: ``arm.q1`` or ``q.arm.q1`` the coordinate, ``arm.q1'`` or ``qd.arm.q1`` its
velocity, ``arm.q1''`` or ``qdd.arm.q1`` its acceleration, ``tau.arm.q1`` the force of its actuator; a unit stands in
brackets behind it, ``arm.q1 [deg]``, else it is SI. Arrays ``q``, ``qd``, ``qdd`` and ``tau`` (N, n) have a column for
each coordinate. The time, ``t`` or ``time``, is passed over. Simulations are written like that.
"""

from __future__ import annotations

import base64
import binascii
import csv
import io
from collections.abc import Callable, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.documents import pointer_step
from substructures.errors import InvalidDocument, meant
from substructures.formats import arrow
from substructures.formats.arrays import read_npz

MEASURED = ("q", "qd", "qdd", "tau")
TIMES = ("t", "time")
_PRIMED = {"": "q", "'": "qd", "''": "qdd"}


def log_of(file: str | Path, columns: Mapping[str, str] | None = None) -> dict[str, Any]:
    """The member ``log`` of a request about a measured motion: a file .csv, .npz or .arrow.

    ``columns``: what columns of the file are that are called otherwise, ``{"j1_pos": "arm.q1 [deg]"}``; then no others
    are read. Raises ValueError for other files, OSError.
    """
    path = Path(file)
    form = path.suffix.removeprefix(".").lower()
    if form not in FORMS:
        raise ValueError(f"{path}: a log is a file {', '.join(f'.{known}' for known in FORMS)}")
    content = path.read_bytes()
    text = content.decode("utf-8-sig") if form == "csv" else base64.b64encode(content).decode()
    return {form: text, **({"columns": dict(columns)} if columns else {})}


def motion_of(form: str, text: str, columns: Mapping[str, str], limit: int) -> dict[str, Any]:
    """The members ``q``, ``qd``, ``qdd``, ``tau`` of a request: columns by coordinate, with their units, or arrays.

    ``form``, ``text``, ``columns``: as :func:`log_of` gives them; ``limit``: bytes of the file unpacked. Raises
    InvalidDocument with the pointer of a column, TooLarge.
    """
    read = FORMS[form](text, limit)
    missing = [name for name in columns if name not in read]
    if missing:
        message = f"the log has no column '{missing[0][:80]}'{meant(missing[0], read)}"
        raise InvalidDocument.at(f"/columns{pointer_step(missing[0][:80])}", "unknown-column", message)
    found: dict[str, Any] = {}
    for name in columns or read:
        what, coordinate, unit = _meaning(columns.get(name, name))
        if what in TIMES:
            continue
        place = pointer_step(name[:80])
        given = {"value": read[name].tolist(), "unit": unit} if unit is not None else read[name]
        some = found.setdefault(what, {}) if coordinate else found
        if not isinstance(some, dict) or (coordinate or what) in some:
            raise InvalidDocument.at(place, "given-twice", f"'{name[:80]}' is given twice")
        some[coordinate or what] = given
    return found


def _meaning(text: str) -> tuple[str, str, str | None]:
    """What was measured (``q``, ..., ``t``), of which coordinate (empty: of all, or none), in which unit."""
    name, bracket, rest = text.strip().partition("[")
    unit = rest[:-1] if bracket and rest.endswith("]") else None
    name = name.rstrip() if bracket == "" or unit is not None else text
    if name in (*MEASURED, *TIMES):
        return name, "", unit
    head, _, rest = name.partition(".")
    if head in MEASURED and rest:
        return head, rest, unit
    coordinate = name.rstrip("'")
    return _PRIMED.get(name[len(coordinate) :], "q"), coordinate or name, unit


def _csv(text: str, _limit: int) -> dict[str, Array]:
    """Columns by the names in the first line; separated by commas, semicolons or tabs."""
    lines = text.removeprefix("\ufeff").splitlines()
    head = lines[0] if lines else ""
    separator = max(",;\t", key=head.count)
    try:
        names, *rows = ([cell.strip() for cell in row] for row in csv.reader(lines, delimiter=separator) if any(row))
    except (csv.Error, ValueError) as error:
        raise InvalidDocument.at("", "csv", f"not a table: {error}") from None
    if len(set(names)) < len(names):
        raise InvalidDocument.at("", "csv", "the first line of a log has the names of its columns, each once")
    for k, row in enumerate(rows):
        if len(row) != len(names):
            raise InvalidDocument.at("", "csv", f"row {k + 1} has {len(row)} values, the first line {len(names)} names")
    try:
        values = np.array(list(map(float, chain.from_iterable(rows)))).reshape(len(rows), len(names))
    except ValueError:
        raise InvalidDocument.at("", "csv", _no_number(rows, names)) from None
    return dict(zip(names, values.T, strict=True))


def _no_number(rows: list[list[str]], names: list[str]) -> str:
    for k, row in enumerate(rows):
        for name, cell in zip(names, row, strict=True):
            try:
                float(cell)
            except ValueError:
                return f"row {k + 1}, column '{name[:80]}': '{cell[:40]}' is no number"
    return "a value is no number"


def _npz(text: str, limit: int) -> dict[str, Array]:
    read = read_npz(io.BytesIO(_bytes(text)), limit)
    for name, array in read.items():
        if array.dtype.kind not in "fiu":
            raise InvalidDocument.at(pointer_step(name[:80]), "column-type", f"array '{name[:80]}' has no numbers")
    return {name: array.astype(np.float64) for name, array in read.items()}


def _arrow(text: str, limit: int) -> dict[str, Array]:
    if not arrow.is_available():
        raise InvalidDocument.at("", "arrow", "there is no Arrow here: send the log as csv or npz")
    batches = list(arrow.Reader(io.BytesIO(_bytes(text)), limit))
    if not batches:
        raise InvalidDocument.at("", "arrow", "the stream has no rows")
    return {name: np.concatenate([batch[name] for batch in batches]) for name in batches[0]}


def _bytes(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error as error:
        raise InvalidDocument.at("", "base64", f"not base64: {error}") from None


#: what a log can be, by the names in requests and the endings of files; all but csv as base64
FORMS: dict[str, Callable[[str, int], dict[str, Array]]] = {"csv": _csv, "npz": _npz, "arrow": _arrow}
