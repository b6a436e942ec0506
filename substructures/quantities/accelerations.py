"""Accelerations and condition numbers of many states, by the metric in numbers, in blocks of states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Protocol

import numpy as np

from substructures.array import Array
from substructures.compile.kernel import Places
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED, closed_solve, condition, definite_solve
from substructures.mechanics.closure_rows import POSITIONS, RowSizes, row_sizes
from substructures.quantities.closure_columns import row_bounds
from substructures.quantities.derivatives import FD
from substructures.quantities.formulas import DYNAMICS
from substructures.quantities.quantity import CONDITION
from substructures.tree.model import Model

#: numbers of a block where an intermediate result is larger than the result
BLOCK = 2_000_000


class Evaluator(Protocol):
    """Outputs of a program, arrays (N, ...) by name."""

    def __call__(
        self, program: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = ..., /
    ) -> dict[str, Array]:
        """``states`` = N; ``places``: of some outputs the elements there alone, (N, K)."""
        ...


def _blocks(
    model: Model, values: Mapping[str, Any], count: int, times: int = 1
) -> Iterator[tuple[slice, dict[str, Any], int]]:
    """Parts of the states with their values, so many that matrices of all of them, so many times, fit into memory."""
    size = max(1, BLOCK // (times * max(1, model.dof) ** 2))
    for start in range(0, count, size):
        part = slice(start, min(start + size, count))
        some = {name: x[part] if np.shape(x) == (count,) else x for name, x in values.items()}
        yield part, some, part.stop - start


def conditions(model: Model, values: Mapping[str, Any], evaluator: Evaluator, count: int) -> Array:
    """Condition numbers of the metric (N,)."""
    result = np.empty(count)
    for part, some, size in _blocks(model, values, count):
        result[part] = condition(evaluator(model.program, some, ["metric"], size)["metric"])
    return result


def accelerations(model: Model, values: Mapping[str, Any], evaluator: Evaluator, count: int) -> dict[str, Array]:
    """Forward dynamics of a model too large for formulas of it: g q'' = Q - Gamma q' q' by numbers, in blocks."""
    result, pivots = np.empty((count, model.dof)), np.empty((count, model.dof))
    for part, some, size in _blocks(model, values, count):
        found = evaluator(model.program, some, list(DYNAMICS), size)
        # g_ab q''^b = Q_a - Gamma_abc q'^b q'^c
        result[part], pivots[part] = definite_solve(found["metric"], found["forces"] - found["bias"])
    return {FD: result, "pivots": pivots}


def accelerations_on_closures(
    model: Model, program: Program, values: Mapping[str, Any], evaluator: Evaluator, count: int
) -> dict[str, Array]:
    """Forward dynamics of a tree with closures, in blocks."""
    result, conditions = np.empty((count, model.dof)), np.empty(count)
    for part, some, size in _blocks(model, values, count, POSITIONS):
        result[part], conditions[part] = _closed_block(model, program, some, evaluator, size)
    return {FD: result, CONDITION: conditions}


def _closed_block(
    model: Model, program: Program, values: Mapping[str, Any], evaluator: Evaluator, count: int
) -> tuple[Array, Array]:
    # g q'' = Q - Gamma q' q' + G^T lambda and G q'' + G' q' = 0; closure.acceleration is G' q'
    outputs = evaluator(program, values, [*DYNAMICS, *CLOSED], count)
    acceleration = CLOSED[2]

    def second(velocities: Array) -> Array:
        """G' q' at other velocities."""
        given = {f"{name}'": velocities[:, a] for a, name in enumerate(model.coordinates)}
        return evaluator(program, {**values, **given}, [acceleration], count)[acceleration]

    q, qd = (
        np.stack([np.broadcast_to(values[f"{name}{prime}"], (count,)) for name in model.coordinates], axis=1)
        for prime in ("", "'")
    )
    return closed_solve(outputs, q, qd, closure_sizes(model, program, values, evaluator, q), second)


def closure_sizes(
    model: Model, program: Program, values: Mapping[str, Any], evaluator: Evaluator, q: Array
) -> RowSizes:
    """The sizes beside which the rows of closures are judged, at q (N, n)."""
    residual, jacobian, _ = CLOSED
    count = len(q)

    def at(places: Array) -> dict[str, Any]:
        """The values at other positions."""
        times = len(places) // count
        given = {name: np.tile(x, times) if np.shape(x) == (count,) else x for name, x in values.items()}
        return given | {name: places[:, a] for a, name in enumerate(model.coordinates)}

    def look(places: Array) -> tuple[Array, Array]:
        """G and phi there."""
        there = evaluator(program, at(places), [jacobian, residual], len(places))
        return there[jacobian], there[residual]

    return row_sizes(model.joints, q, look, lambda places: row_bounds(model, at(places), len(places)))
