"""The columns of a sweep: read once, and computed for many rows of one shape at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.documents import write_json
from substructures.errors import InvalidArgument, InvalidDocument, InvalidInput, among, meant
from substructures.quantities.numbers.evaluation import Evaluation, EvaluationOptions, evaluate
from substructures.quantities.numbers.states import longest, read_states
from substructures.quantities.quantity import QUANTITIES, TABLE, labels_of
from substructures.sweeps.conditions import Condition, Expression, read_condition, read_expression
from substructures.sweeps.document import LinearColumn, QuantityColumn, SweepDocument
from substructures.sweeps.linear import linear_columns
from substructures.sweeps.shapes import Shape
from substructures.tree.model import Model

#: what a tree has without a state
STATIC = ("mass", "dof", "operations")
#: quantities that the Christoffel symbols stand in
WITH_CHRISTOFFEL = ("christoffel", "coriolis", "christoffel_second_kind")
_ARGUMENTS = ("q", "qd", "qdd", "inputs", "t")
TAKEN = {
    "value": lambda x: x[:, 0],
    "largest": lambda x: x.max(axis=1),
    "smallest": lambda x: x.min(axis=1),
    "largest_absolute": lambda x: np.abs(x).max(axis=1),
    "mean": lambda x: x.mean(axis=1),
    "rms": lambda x: np.sqrt((x**2).mean(axis=1)),
}


@dataclass(frozen=True)
class Columns:
    """All columns of a sweep, of which expressions may name those before them and the samples, and its condition."""

    static: tuple[str, ...]
    quantities: Mapping[str, QuantityColumn]
    linear: Mapping[str, LinearColumn]
    expressions: Mapping[str, Expression]
    names: tuple[str, ...]
    where: Condition
    statics: Mapping[str, str]  #: the static number that a column is, by its name

    @property
    def need_christoffel(self) -> bool:
        """Whether a program without the Christoffel symbols is not enough."""
        return bool(self.linear) or any(c.quantity.startswith(WITH_CHRISTOFFEL) for c in self.quantities.values())

    def of(
        self, shape: Shape, parameters: Mapping[str, Any], samples: Mapping[str, Array], rows: int
    ) -> dict[str, Array]:
        """All columns of so many rows, (rows,) each. ``parameters``: all of the tree, one number or one a row.

        Raises InvalidInput, MissingValue for what the tree of this shape does not have.
        """
        found: dict[str, Array] = {}
        for name, what in self.statics.items():
            found[name] = np.broadcast_to(np.asarray(_static(shape, what, parameters), dtype=np.float64), (rows,))
        for same in _alike({n: c.over for n, c in self.quantities.items()}):
            found |= _quantities(shape, {name: self.quantities[name] for name in same}, parameters, rows)
        for same in _alike({n: {"at": c.at, "held": c.held} for n, c in self.linear.items()}):
            takes = {self.linear[name].take for name in same}
            with _inside(f"/columns/{same[0]}/at"):
                one = self.linear[same[0]]
                taken = linear_columns(shape, one.at, one.held, parameters, rows, takes)
            found |= {name: taken[self.linear[name].take] for name in same}
        known = {**samples, **found}
        for name, expression in self.expressions.items():
            known[name] = found[name] = expression.of(known, rows)
        return {name: found[name] for name in self.names}

    def condition(self, shape: Shape) -> float:
        """The largest condition number of the mass matrix at the states of the columns, with the defaults of a tree."""
        overs = [c.over for c in self.quantities.values()] + [c.at for c in self.linear.values()]
        states = [over["q"] for over in overs if "q" in over]
        found = [evaluate(shape.sources, "condition", q)["condition"] for q in states]
        return max((float(np.max(x)) for x in found), default=1.0)


def read_columns(document: SweepDocument) -> Columns:
    """The columns of a sweep, as far as they can be read without its trees. Raises InvalidDocument."""
    samples = list(document.samples.of) if document.samples else []
    known, statics = [*samples], dict[str, str]()
    quantities, linear, expressions = dict[str, QuantityColumn](), dict[str, LinearColumn](), dict[str, Expression]()
    for name, column in document.columns.items():
        pointer = f"/columns/{name}"
        if isinstance(column, str):
            if column in STATIC and column not in known:
                statics[name] = column
            else:
                expressions[name] = read_expression(column, known, pointer)
        elif isinstance(column, LinearColumn):
            linear[name] = column
        else:
            check_quantity(column, pointer)
            quantities[name] = column
        known.append(name)
    where = read_condition(document.where, known, "/where")
    if document.pareto is not None:
        for goal in ("minimise", "maximise"):
            for k, name in enumerate(getattr(document.pareto, goal)):
                if name not in document.columns:
                    message = f"unknown column '{name}'{among(name, document.columns)}"
                    raise InvalidDocument.at(f"/pareto/{goal}/{k}", "unknown-column", message)
    names = tuple(document.columns)
    return Columns(tuple(statics), quantities, linear, expressions, names, where, statics)


def check_quantity(column: QuantityColumn, pointer: str) -> None:
    """Raise InvalidDocument for what a column cannot be of."""
    name = row_of(column.quantity)
    if name is None:
        message = f"unknown quantity '{column.quantity[:80]}'{meant(column.quantity, QUANTITIES)}; there are "
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


def row_of(quantity: str) -> str | None:
    """The row of the table of a quantity, or of one of its fields."""
    if quantity in QUANTITIES:
        return quantity
    name, _, field = quantity.rpartition(".")
    return name if name in QUANTITIES and field in TABLE[name].fields else None


def _static(shape: Shape, what: str, parameters: Mapping[str, Any]) -> Any:
    match what:
        case "mass":
            judge = shape.sources.judge
            return np.nan if judge is None else judge.masses(parameters)
        case "dof":
            return shape.model.dof
    return shape.model.operations["total"]


def _alike(given: Mapping[str, Mapping[str, Any]]) -> Iterator[list[str]]:
    """Names with equal documents, together."""
    groups: dict[bytes, list[str]] = {}
    for name, each in given.items():
        groups.setdefault(write_json(dict(each)), []).append(name)
    yield from groups.values()


@contextmanager
def _inside(place: str) -> Iterator[None]:
    """Faults that are found here have pointers relative to this place."""
    try:
        yield
    except InvalidInput as error:
        raise error.below(place) from None


def _quantities(
    shape: Shape, columns: Mapping[str, QuantityColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """Columns over the same states: rows times states are evaluated, all states of a row one after the other."""
    first = next(iter(columns))
    over, model = columns[first].over, shape.model
    with _inside(f"/columns/{first}/over"):
        given = {name: over.get(name) for name in ("q", "qd", "qdd")}
        if given["q"] is None:
            given["q"] = [0.0] * model.dof  # of what does not depend on it
        states = read_states(model, given, None)
        steps = max(states.count, longest({**over, "q": given["q"]}))
        arguments: dict[str, Any] = {"q": _tiled(states.q, rows, steps), "qd": _tiled(states.qd, rows, steps)}
        if states.qdd is not None:
            arguments["qdd"] = _tiled(states.qdd, rows, steps)
        if "inputs" in over:
            arguments["inputs"] = {name: _along(x, rows) for name, x in over["inputs"].items()}
        arguments["t"] = _along(over.get("t", 0.0), rows)
        repeated = {name: np.repeat(x, steps) if np.ndim(x) else x for name, x in parameters.items()}
        asked = list(dict.fromkeys(row_of(c.quantity) or c.quantity for c in columns.values()))
        options = EvaluationOptions(evaluator=shape.evaluate)
        answer = evaluate(shape.sources, asked, parameters=repeated, options=options, **arguments)
    found = {}
    for name, column in columns.items():
        numbers = numbers_of(column, answer, model, f"/columns/{name}").reshape(rows, -1)
        take = column.take or ("value" if numbers.shape[1] == 1 else None)
        if take is None or (take == "value" and numbers.shape[1] > 1):
            message = f"{numbers.shape[1]} numbers a row: say which ('of'), and what to 'take' of them"
            raise InvalidArgument.at(f"/columns/{name}/take", "several-numbers", message)
        found[name] = TAKEN[take](numbers)
    return found


def numbers_of(column: QuantityColumn, answer: Evaluation, model: Model, pointer: str) -> Array:
    """The numbers of a column in an evaluation, with the axis of states first. Raises InvalidArgument."""
    row, _, part = column.quantity.partition(".") if column.quantity not in TABLE else (column.quantity, "", "")
    array = answer[row][part] if part else answer[row]
    return _element(np.asarray(array), column, {"coordinates": model.coordinates, **answer.labels}, pointer)


def _tiled(states: Array, rows: int, steps: int) -> Array:
    return np.tile(np.broadcast_to(states, (steps, states.shape[1])), (rows, 1))


def _along(given: Any, rows: int) -> Any:
    """Numbers over the states of a row, for all rows."""
    return np.tile(np.asarray(given, dtype=np.float64), rows) if isinstance(given, (list, tuple)) else given


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


__all__ = ["STATIC", "TAKEN", "Columns", "check_quantity", "numbers_of", "read_columns", "row_of"]
