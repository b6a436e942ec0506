"""The index of a part's formulas: two columns of JSON, of which the view ``formulas`` makes a row for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import orjson
from sqlalchemy import Connection, select

from service.content.integrity import damaged, digest_of, reading
from service.database.tables import parts


@dataclass(frozen=True, slots=True)
class FormulaRow:
    """One stored formula; ``shape`` and ``entry`` (its leading index within the output) are JSON."""

    position: int
    quantity: str
    body: str | None
    coordinate: str | None
    shape: str
    symmetry: str
    operations: int
    output: str
    entry: str


def packed(rows: Sequence[FormulaRow]) -> dict[str, str]:
    """The columns for formulas in their order: what those of an output have in common, and what each has for itself."""
    outputs = list(dict.fromkeys((row.quantity, row.output, row.shape, row.symmetry) for row in rows))
    number = {output: k for k, output in enumerate(outputs)}
    common = [(quantity, output, orjson.Fragment(shape), symmetry) for quantity, output, shape, symmetry in outputs]
    own = [
        (
            number[row.quantity, row.output, row.shape, row.symmetry],
            row.body,
            row.coordinate,
            orjson.Fragment(row.entry),
            row.operations,
        )
        for row in rows
    ]
    texts = {"outputs": _json(common), "formulas": _json(own)}
    return {**texts, "index_digest": index_digest(**texts)}


def index_digest(outputs: str, formulas: str) -> str:
    """The digest of both columns, which the seal of the part covers."""
    return digest_of(f"{outputs}\n{formulas}".encode())


def list_formulas(
    connection: Connection,
    part: str,
    quantities: Sequence[str] = (),
    body: str | None = None,
    coordinate: str | None = None,
) -> list[FormulaRow]:
    """The stored formulas of a part in their order: all, or those of these quantities, body and coordinate.

    Raises Refused (``damaged-content``).
    """
    columns = parts.c.outputs, parts.c.formulas, parts.c.index_digest
    stored = connection.execute(select(*columns).where(parts.c.digest == part)).first()
    if stored is None:
        return []
    if index_digest(stored.outputs, stored.formulas) != stored.index_digest:
        raise damaged("the index of the formulas of a part", part, "it is another one than was stored")
    with reading("the index of the formulas of a part", part):
        rows = read_index(stored.outputs, stored.formulas)
    return [
        row
        for row in rows
        if (not quantities or row.quantity in quantities)
        and body in (None, row.body)
        and coordinate in (None, row.coordinate)
    ]


def read_index(outputs: str, formulas: str) -> list[FormulaRow]:
    """The formulas out of both columns. Raises ValueError, TypeError, IndexError for what is none."""
    common = [(quantity, output, _json(shape), symmetry) for quantity, output, shape, symmetry in orjson.loads(outputs)]
    rows = []
    for position, (number, body, coordinate, entry, operations) in enumerate(orjson.loads(formulas)):
        quantity, output, shape, symmetry = common[number]
        place = position, quantity, body, coordinate
        rows.append(FormulaRow(*place, shape, symmetry, operations, output, _json(entry)))
    return rows


def _json(value: object) -> str:
    return orjson.dumps(value).decode()
