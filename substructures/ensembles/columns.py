"""What a member of an ensemble is worth: numbers of its motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.arguments import by_name
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import state_names
from substructures.array import Array
from substructures.compile.kernel import NO_PLACES, Places
from substructures.ensembles.motion_column import MotionColumn
from substructures.ensembles.quantity_columns import TAKEN, QuantityColumn, check_quantity, numbers_of, require_columns
from substructures.errors import InvalidArgument
from substructures.expr.program import Program
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import TABLE
from substructures.quantities.sources import Sources

INTEGRANDS = "integrands"  # output of a program
FORWARD = "forward_dynamics"  #: the accelerations of a motion
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
_TAKEN: dict[str, Callable[[Array], Array]] = {**TAKEN, "end": lambda x: x[:, -1]}


@dataclass(frozen=True)
class MotionColumns:
    """All columns of an ensemble, read."""

    columns: Mapping[str, MotionColumn]
    sources: Sources
    expressions: Program
    integrands: Program | None

    @property
    def integrals(self) -> list[str]:
        """The columns that are integrals over the time, in the order of the output ``integrands``."""
        return [name for name, column in self.columns.items() if column.take == "integral"]

    @classmethod
    def read(cls, sources: Sources, columns: Mapping[str, MotionColumn]) -> MotionColumns:
        """Check them against a model. Raises InvalidInput (pointers ``/columns/name/...``)."""
        for name, column in by_name(columns, "columns").items():
            if column.quantity is not None:
                check_quantity(_as_quantity(column), f"/columns/{name}")
        texts = {
            name: [(column.expression, f"/columns/{name}/expression")]
            for name, column in columns.items()
            if column.expression is not None
        }
        followed = {name: text for name, text in texts.items() if columns[name].take != "integral"}
        integrated = [text for name, (text,) in texts.items() if columns[name].take == "integral"]
        model, integrands = sources.model, None
        if integrated:
            integrands = read_expressions(model, {INTEGRANDS: integrated}, inputs=True)
        return cls(columns, sources, read_expressions(model, followed, inputs=True), integrands)

    def of(
        self,
        values: Mapping[str, float | Array],
        x: Array,
        integrals: Array,
        second: Callable[[], Array] | None = None,
        wanted: int | None = None,
    ) -> dict[str, Array]:
        """The columns (M,) of motions ``x`` (M, K, 2n), not a number of those that have not come to their ends;
        ``values``: of all other symbols, numbers or (M, K); ``integrals`` (M, k): of :attr:`integrands` up to the end;
        ``second``: the accelerations (M K, n) where they are not those of the tree; ``wanted``: how many of the times
        are looked at, all by default.
        """
        found = {name: np.full(len(x), np.nan) for name in self.columns}
        whole = np.isfinite(x).all(axis=(1, 2))
        if whole.any():
            some = {name: v[whole] if isinstance(v, np.ndarray) else v for name, v in values.items()}
            moved = second and (lambda: second().reshape(*x.shape[:2], -1)[whole].reshape(-1, self.sources.model.dof))
            for name, column in self._of_whole(some, x[whole], integrals[whole], moved, wanted).items():
                found[name][whole] = column
        return found

    def _of_whole(
        self,
        values: Mapping[str, float | Array],
        x: Array,
        integrals: Array,
        second: Callable[[], Array] | None,
        wanted: int | None,
    ) -> dict[str, Array]:
        """The same of motions that have come to their ends."""
        model, (rows, times) = self.sources.model, x.shape[:2]
        state = np.ascontiguousarray(x).reshape(rows * times, -1)
        flat = {name: np.ravel(v) if np.ndim(v) else v for name, v in values.items()}
        followed = program_kernel(self.expressions).evaluate(flat, columns=[(state_names(model), state)])
        answer = self._evaluated(flat, state, second)
        found = {name: integrals[:, k] for k, name in enumerate(self.integrals)}
        for name, column in self.columns.items():
            if name in found:
                continue
            if answer is None or column.quantity is None:
                numbers = np.broadcast_to(followed[name].reshape(-1), (rows * times,))
            else:
                numbers = numbers_of(_as_quantity(column), answer, model, f"/columns/{name}")
            if numbers.size != rows * times:
                message = f"'{column.quantity}' is several numbers: say which by 'of'"
                raise InvalidArgument.at(f"/columns/{name}/of", "several-numbers", message)
            with np.errstate(invalid="ignore"):
                found[name] = _TAKEN[column.take](numbers.reshape(rows, times)[:, :wanted])
        return found

    def _evaluated(
        self, values: Mapping[str, Any], state: Array, second: Callable[[], Array] | None
    ) -> Evaluation | None:
        """All quantities of the columns at all states, None where there are none."""
        wanted = {name: c.quantity for name, c in self.columns.items() if c.quantity is not None}
        if not wanted:
            return None
        model, m = self.sources.model, len(self.sources.model.positions)
        asked = require_columns(wanted, model)
        given: dict[str, Any] = {
            "inputs": {name: values[name] for name in model.input_names if name in values},
            "parameters": {name: values[name] for name in model.parameters if name in values},
            "t": values["t"],
            "options": EvaluationOptions(evaluator=_compiled),
        }
        if any("qdd" in TABLE[name].requires for name in asked):
            if second is None:
                moved = evaluate(self.sources, FORWARD, state[:, :m], state[:, m:], **given)
                given["qdd"] = moved[FORWARD].reshape(-1, model.dof)
            else:
                given["qdd"] = second()
        return evaluate(self.sources, asked, state[:, :m], state[:, m:], **given)


def _compiled(
    program: Program, values: Mapping[str, Any], names: list[str], _states: int, places: Places = NO_PLACES, /
) -> dict[str, Array]:
    """The engine of evaluations: kernels."""
    return program_kernel(program.select(names)).evaluate(values, places=places)


def _as_quantity(column: MotionColumn) -> QuantityColumn:
    return QuantityColumn(quantity=str(column.quantity), of=column.of)


def deviation(values: Array) -> float | None:
    """The standard deviation of a sample (n,), sqrt(sum (x - mean)^2 / (n - 1)); None of fewer than two values."""
    return float(values.std(ddof=1)) if len(values) > 1 else None


def statistics(column: Array) -> dict[str, Any]:
    """Mean, :func:`deviation`, extremes and quantiles of the members that have a number, and how many these are."""
    known = column[np.isfinite(column)]
    if not len(known):
        return {"count": 0}
    levels = np.quantile(known, QUANTILES)
    return {
        "count": len(known),
        "mean": float(known.mean()),
        "deviation": deviation(known),
        "least": float(known.min()),
        "largest": float(known.max()),
        "quantiles": {f"{level:g}": float(x) for level, x in zip(QUANTILES, levels, strict=True)},
    }
