"""A column that is a quantity at given states: an element of it, and what becomes of several numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from pydantic import Field

from substructures.array import Array
from substructures.documents import DocumentPart
from substructures.errors import InvalidArgument, InvalidDocument, among, meant
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import QUANTITIES, TABLE, labels_of
from substructures.quantities.sources import require_there
from substructures.tree.model import Model

Take = Literal["value", "largest", "smallest", "largest_absolute", "mean", "rms"]
#: what some tree can be asked for in numbers
ASKED = {name: row for name, row in TABLE.items() if row.is_number}
_ARGUMENTS = ("q", "qd", "qdd", "inputs", "t")
TAKEN = {
    "value": lambda x: x[:, 0],
    "largest": lambda x: x.max(axis=1),
    "smallest": lambda x: x.min(axis=1),
    "largest_absolute": lambda x: np.abs(x).max(axis=1),
    "mean": lambda x: x.mean(axis=1),
    "rms": lambda x: np.sqrt((x**2).mean(axis=1)),
}


class QuantityColumn(DocumentPart):
    """A number of a quantity (``inverse_dynamics``, ``mass_centre.position``) at states ``over``, for each row.

    ``of``: which element, by the names of its axes; left out: all of them. ``over``: arguments of an evaluation (``q``,
    ``qd``, ``qdd``, ``inputs``, ``t``), for one state or many. ``take``: what becomes of several numbers.
    """

    quantity: str
    of: str | list[str] | None = None
    over: dict[str, Any] = Field(default_factory=dict)
    take: Take | None = None


def check_quantity(column: QuantityColumn, pointer: str) -> None:
    """Raise InvalidDocument for what a column cannot be of."""
    name = row_of(column.quantity)
    if name is None:
        message = f"unknown quantity '{column.quantity[:80]}'{meant(column.quantity, ASKED)}; there are "
        raise InvalidDocument.at(f"{pointer}/quantity", "unknown-quantity", message + ", ".join(QUANTITIES))
    row = TABLE[name]
    if row.fields and name == column.quantity:
        fields = ", ".join(f"{name}.{field}" for field in row.fields)
        message = f"'{name}' is several arrays: choose one of {fields}"
        raise InvalidDocument.at(f"{pointer}/quantity", "several-arrays", message)
    if "along" in row.requires:
        raise InvalidDocument.at(f"{pointer}/quantity", "not-supported", f"'{name}' needs a direction: not in a sweep")
    for field in column.over:
        if field not in _ARGUMENTS:
            message = f"unknown field '{field[:80]}'{among(field, _ARGUMENTS)}"
            raise InvalidDocument.at(f"{pointer}/over", "unknown-field", message)


def require_columns(columns: Mapping[str, str], model: Model) -> list[str]:
    """The quantities of columns by name, each once.

    Raises InvalidArgument (``/columns/name/quantity``, ``not-of-tree``) for what only other trees have.
    """
    asked = {name: row_of(quantity) or quantity for name, quantity in columns.items()}
    for name, quantity in asked.items():
        try:
            require_there(model, [quantity])
        except InvalidArgument as error:
            raise error.moved(lambda _, name=name: f"/columns/{name}/quantity") from None  # type: ignore[misc]
    return list(dict.fromkeys(asked.values()))


def row_of(quantity: str) -> str | None:
    """The row of the table of a quantity, or of one of its fields."""
    if quantity in ASKED:
        return quantity
    name, _, field = quantity.rpartition(".")
    return name if name in ASKED and field in TABLE[name].fields else None


def numbers_of(column: QuantityColumn, answer: Evaluation, model: Model, pointer: str) -> Array:
    """The numbers of a column in an evaluation, with the axis of states first. Raises InvalidArgument."""
    row, _, part = column.quantity.partition(".") if column.quantity not in TABLE else (column.quantity, "", "")
    array = answer[row][part] if part else answer[row]
    return _element(np.asarray(array), column, {"coordinates": model.coordinates, **answer.labels}, pointer)


def _element(array: Array, column: QuantityColumn, told: Mapping[str, Any], pointer: str) -> Array:
    """The element that a column is of, with the axis of states first; all elements where it does not say which."""
    if column.of is None:
        return array
    axes = labels_of(column.quantity, told)
    names: Sequence[str] = [column.of] if isinstance(column.of, str) else column.of
    if len(names) != len(axes):
        message = f"'{column.quantity}' has {len(axes)} axes, and {len(names)} names are given"
        raise InvalidArgument.at(f"{pointer}/of", "wrong-length", message)
    for k, (name, axis) in enumerate(zip(names, axes, strict=True)):
        if name not in axis:
            message = f"there is no '{name[:80]}'{among(name, axis)}"
            raise InvalidArgument.at(f"{pointer}/of" + (f"/{k}" if len(axes) > 1 else ""), "unknown-name", message)
        array = array[:, axis.index(name)]  # the axis of states stays first
    return array
