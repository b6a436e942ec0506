"""The columns of a sweep: read once, and computed for many rows of one shape at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.ensembles.quantity_columns import TAKEN, QuantityColumn, check_quantity, numbers_of, require_columns
from substructures.errors import InvalidArgument, InvalidDocument, among
from substructures.expr.steps import RESERVED
from substructures.late import Table
from substructures.mechanics.state_names import resting_state
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.states import given_values, longest, read_states, read_times
from substructures.quantities.quantity import TABLE
from substructures.sweeps.conditions import Condition, Expression, read_condition, read_expression
from substructures.sweeps.document import (
    AnalysisColumn,
    Column,
    ReachColumn,
    SimulationColumn,
    SweepDocument,
)
from substructures.sweeps.grouped import alike, inside
from substructures.sweeps.shapes import Shape

#: what a tree has without a state
STATIC = ("mass", "dof", "operations")
#: quantities that the Christoffel symbols stand in
WITH_CHRISTOFFEL = (
    "christoffel",
    "coriolis",
    "christoffel_second_kind",
    "canonical_equations",
    "Gamma_ab0",
    "Gamma_a00",
)
#: what computes the columns of an analysis, all of one kind together: shape, columns by name, parameters, rows
ANALYSES: Table[Callable[[Shape, Any, Mapping[str, Any], int], dict[str, Array]]] = Table(
    "ANALYSES",
    {
        "linearisation": "substructures.sweeps.linear",
        "equilibrium": "substructures.sweeps.rest",
        "reach": "substructures.sweeps.reach",
        "simulation": "substructures.sweeps.motions",
    },
)


@dataclass(frozen=True)
class Columns:
    """All columns of a sweep, of which expressions may name those before them and the samples, and its condition."""

    static: tuple[str, ...]
    quantities: Mapping[str, QuantityColumn]
    analyses: Mapping[str, AnalysisColumn]
    expressions: Mapping[str, Expression]
    names: tuple[str, ...]
    where: Condition
    statics: Mapping[str, str]  #: the static number that a column is, by its name

    @property
    def need_christoffel(self) -> bool:
        """Whether a program without the Christoffel symbols is not enough."""
        needing = [c for c in self.analyses.values() if not isinstance(c, ReachColumn)]
        return bool(needing) or any(c.quantity.startswith(WITH_CHRISTOFFEL) for c in self.quantities.values())

    @property
    def outputs(self) -> frozenset[str] | None:
        """The outputs of a model that are enough; None where all may be needed, or are counted."""
        if self.analyses or "operations" in self.statics.values():
            return None
        rows = [TABLE[each.quantity.partition(".")[0]] for each in self.quantities.values()]
        more = ["christoffel"] if self.need_christoffel else []
        return frozenset([*more, *(name for row in rows for name in (*row.outputs, *row.written, *row.needs.split()))])

    @property
    def of_motions(self) -> set[str]:
        """The columns of simulations, and those that are made of them: exact to the tolerance of the integration."""
        found = {name for name, column in self.analyses.items() if isinstance(column, SimulationColumn)}
        for name, expression in self.expressions.items():
            if found & set(expression.needs):
                found.add(name)
        return found

    def of(
        self, shape: Shape, parameters: Mapping[str, Any], samples: Mapping[str, Array], rows: int
    ) -> dict[str, Array]:
        """All columns of so many rows, (rows,) each. ``parameters``: all of the tree, one number or one a row.

        Raises InvalidInput, MissingValue for what the tree of this shape does not have.
        """
        found: dict[str, Array] = {}
        for name, what in self.statics.items():
            found[name] = np.broadcast_to(np.asarray(_static(shape, what, parameters), dtype=np.float64), (rows,))
        for same in alike({n: c.over for n, c in self.quantities.items()}):
            found |= _quantities(shape, {name: self.quantities[name] for name in same}, parameters, rows)
        for kind in ANALYSES:
            if chosen := {name: c for name, c in self.analyses.items() if c.analysis == kind}:
                found |= ANALYSES[kind](shape, chosen, parameters, rows)
        known = {**samples, **found}
        for name, expression in self.expressions.items():
            known[name] = found[name] = expression.of(known, rows)
        return {name: found[name] for name in self.names}

    def condition(self, shape: Shape) -> float:
        """The largest condition number of the mass matrix at the states of the columns, with the defaults of a tree."""
        overs = [c.over for c in self.quantities.values()] + [getattr(c, "at", {}) for c in self.analyses.values()]
        states = [over["q"] for over in overs if over.get("q") is not None]
        found = [evaluate(shape.sources, "condition", q)["condition"] for q in states]
        return max((float(np.max(x)) for x in found), default=1.0)


def read_columns(document: SweepDocument) -> Columns:
    """The columns of a sweep, as far as they can be read without its trees. Raises InvalidDocument."""
    found = columns_of(document.columns, list(document.samples.of) if document.samples else [], document.where)
    if document.pareto is not None:
        for goal in ("minimise", "maximise"):
            for k, name in enumerate(getattr(document.pareto, goal)):
                if name not in document.columns:
                    message = f"unknown column '{name}'{among(name, document.columns)}"
                    raise InvalidDocument.at(f"/pareto/{goal}/{k}", "unknown-column", message)
    return found


def columns_of(columns: Mapping[str, Column], samples: Sequence[str], where: str = "") -> Columns:
    """Columns with a condition; ``samples``: names that expressions may have beside. Raises InvalidDocument."""
    known, statics = [*samples], dict[str, str]()
    quantities, analyses = dict[str, QuantityColumn](), dict[str, AnalysisColumn]()
    expressions = dict[str, Expression]()
    for name, column in columns.items():
        pointer = f"/columns/{name}"
        if name in RESERVED:
            raise InvalidDocument.at(pointer, "reserved-name", f"'{name}' has a fixed meaning in expressions")
        if name in samples:
            raise InvalidDocument.at(pointer, "duplicate-name", f"'{name}' is a parameter that varies, too")
        if isinstance(column, str):
            if column in STATIC and column not in known:
                statics[name] = column
            else:
                expressions[name] = read_expression(column, known, pointer)
        elif isinstance(column, QuantityColumn):
            check_quantity(column, pointer)
            quantities[name] = column
        else:
            analyses[name] = column
        known.append(name)
    condition = read_condition(where, known, "/where")
    return Columns(tuple(statics), quantities, analyses, expressions, tuple(columns), condition, statics)


def _static(shape: Shape, what: str, parameters: Mapping[str, Any]) -> Any:
    match what:
        case "mass":
            judge = shape.sources.judge
            return np.nan if judge is None else judge.masses(parameters)
        case "dof":
            return shape.model.dof
    return shape.model.operations["total"]


def _quantities(
    shape: Shape, columns: Mapping[str, QuantityColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """Columns over the same states: rows times states are evaluated, all states of a row one after the other."""
    first = next(iter(columns))
    over, model = columns[first].over, shape.model
    asked = require_columns({name: c.quantity for name, c in columns.items()}, model)
    with inside(f"/columns/{first}/over"):
        given = {name: over.get(name) for name in ("q", "qd", "qdd")}
        if given["q"] is None:
            given["q"] = resting_state(model.positions, model.balls)  # of what does not depend on it
        states = read_states(model, given, None)
        if not states.count:
            raise InvalidArgument.at("/q", "missing", "a state is needed")
        steps = max(states.count, longest({**over, "q": given["q"]}))
        arguments: dict[str, Any] = {"q": _tiled(states.q, rows, steps), "qd": _tiled(states.qd, rows, steps)}
        if states.qdd is not None:
            arguments["qdd"] = _tiled(states.qdd, rows, steps)
        inputs = given_values(over.get("inputs"), "inputs", "/inputs", steps, model.input_names, model.units)
        arguments["inputs"] = {name: _along(x, rows, steps) for name, x in inputs.items()}
        arguments["t"] = _along(read_times(over.get("t"), steps), rows, steps)
        repeated = {name: np.repeat(x, steps) if np.ndim(x) else x for name, x in parameters.items()}
        options = EvaluationOptions(evaluator=shape.evaluate)
        answer = evaluate(shape.sources, asked, parameters=repeated, options=options, **arguments)
    found = {}
    for name, column in columns.items():
        numbers = numbers_of(column, answer, model, f"/columns/{name}").reshape(rows, -1)
        if not numbers.shape[1]:
            message = f"'{column.quantity}' has no numbers in this tree"
            raise InvalidArgument.at(f"/columns/{name}/quantity", "no-numbers", message)
        take = column.take or ("value" if numbers.shape[1] == 1 else None)
        if take is None or (take == "value" and numbers.shape[1] > 1):
            message = f"{numbers.shape[1]} numbers a row: say which ('of'), and what to 'take' of them"
            raise InvalidArgument.at(f"/columns/{name}/take", "several-numbers", message)
        found[name] = TAKEN[take](numbers)
    return found


def _tiled(states: Array, rows: int, steps: int) -> Array:
    return np.tile(np.broadcast_to(states, (steps, states.shape[1])), (rows, 1))


def _along(numbers: Array, rows: int, steps: int) -> Array:
    """One number, or numbers over the states of a row, for all rows."""
    return np.tile(np.broadcast_to(numbers, (steps,)), rows) if np.ndim(numbers) else numbers
