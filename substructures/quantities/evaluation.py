"""Numbers of a model for one state or many (the HTTP contract, section 4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED, cholesky_solve, closed_solve
from substructures.quantities.derivative_directions import direction_values
from substructures.quantities.derivatives import FD, SINGULAR
from substructures.quantities.formulas import DYNAMICS
from substructures.quantities.states import States, known_values, read_states, require
from substructures.quantities.table import (
    QUANTITIES,
    REGRESSOR,
    Quantity,
    Sources,
    cost,
    numbers_per_state,
    read_quantities,
    steps,
)
from substructures.tree.model import Model

__all__ = [
    "QUANTITIES",
    "REGRESSOR",
    "Evaluator",
    "Sources",
    "check",
    "cost",
    "evaluate",
    "interpreted",
    "numbers_per_state",
    "read_quantities",
    "steps",
]

#: numbers of a block where an intermediate result is larger than the result
BLOCK = 2_000_000


OPEN = (
    "the state does not meet the closures (also their velocities), or they lose rank there, or the metric is singular: "
    "take consistent states from loop states"
)

#: outputs of a program for (program, values, names, number of states)
Evaluator = Callable[[Program, Mapping[str, Any], list[str], int], dict[str, Array]]


def interpreted(program: Program, values: Mapping[str, Any], names: list[str], states: int) -> dict[str, Array]:
    """The engine that needs nothing: the reference interpreter, in blocks of states."""
    return interpret_in_blocks(program, values, names, states)


def evaluate(
    model: Model,
    request: Mapping[str, Any],
    limit: int | None = None,
    engine: Evaluator = interpreted,
    sources: Sources | None = None,
) -> dict[str, Any]:
    """Evaluate quantities for states.

    ``request``: the JSON body of the contract (lists, numbers) or the same with arrays; for derivatives of inverse and
    forward dynamics ``along``: the direction, with ``q, qd, qdd, inputs`` as in the request. The answer holds numpy
    arrays, leading axis N dropped for one state with ``q`` (n,); ``failures`` lists states with a result that is not
    finite; ``frames`` names the rows of kinematics, ``columns`` those of the regressor.
    ``forward_dynamics`` of a model with closures are the accelerations on them, in states that meet them
    (:func:`substructures.mechanics.accelerations.closed_solve`); other quantities are those of the tree without them.
    Raises InvalidDocument (with pointers), MissingValue (a parameter without a value) and TooLarge.
    """
    quantities = read_quantities(request)
    sources = sources or Sources(model)
    states = read_states(model, request, limit)
    values = _values(sources, request, states, quantities)
    found = _computed(sources, quantities, values, engine, states)
    results = {name: _result(QUANTITIES[name], found[QUANTITIES[name].source]) for name in quantities}
    answer: dict[str, Any] = {
        "coordinates": list(model.coordinates),
        "count": states.count,
        "digest": model.program.digest,
    }
    if "kinematics" in results:
        answer["frames"] = list(model.frames)
    if REGRESSOR in found:
        answer["columns"] = {"names": list(sources.columns().names), "units": list(sources.columns().units)}
    answer |= {name: _single(value) if states.single else value for name, value in results.items()}
    return answer | {"failures": _failures(results, bool(model.closures))}


def check(sources: Sources, request: Mapping[str, Any]) -> States:
    """The states of a request, when :func:`evaluate` would accept it; nothing is computed.

    Raises as :func:`evaluate`, but for formulas that are too large to be made here.
    """
    quantities = read_quantities(request)
    states = read_states(sources.model, request, None)
    with suppress(TooLarge):
        values = _values(sources, request, states, quantities)
        for _, program, names in steps(sources, quantities):
            if program is not None:
                require(program, names, values)
    return states


def _computed(
    sources: Sources, quantities: Sequence[str], values: Mapping[str, Any], engine: Evaluator, states: States
) -> dict[str, dict[str, Array]]:
    """Outputs by source."""
    count = states.count
    found: dict[str, dict[str, Array]] = {}
    for source, program, names in steps(sources, quantities):
        if program is None:
            found[source] = {name: np.full((count, sources.model.dof), np.nan) for name in names}
            continue
        require(program, names, values)
        if source == FD and sources.model.closures:
            found[source] = _closed(sources.model, program, values, engine, states)
        elif program is sources.model.program and source == FD:
            found[source] = _solved(sources.model, values, engine, count)
        else:
            found[source] = engine(program, values, names, count)
    return found


def _solved(model: Model, values: Mapping[str, Any], engine: Evaluator, count: int) -> dict[str, Array]:
    """Forward dynamics of a model too large for formulas of it: g q'' = Q - Gamma q' q' by numbers, in blocks."""
    result, size = np.empty((count, model.dof)), max(1, BLOCK // model.dof**2)
    for start in range(0, count, size):
        part = slice(start, start + size)
        some = {name: x[part] if np.shape(x) == (count,) else x for name, x in values.items()}
        found = engine(model.program, some, list(DYNAMICS), len(result[part]))
        result[part] = cholesky_solve(found["metric"], found["forces"] - found["bias"])
    return {FD: result, "pivots": np.ones((count, model.dof))}


def _closed(
    model: Model, program: Program, values: Mapping[str, Any], engine: Evaluator, states: States
) -> dict[str, Array]:
    """Forward dynamics of a tree with closures."""
    outputs = engine(program, values, [*DYNAMICS, *CLOSED], states.count)

    def second(velocities: Array) -> Array:
        given = {f"{name}'": velocities[:, a] for a, name in enumerate(model.coordinates)}
        return engine(program, {**values, **given}, [CLOSED[2]], states.count)[CLOSED[2]]

    found = closed_solve(outputs, states.q, states.qd, second)
    return {FD: found, "pivots": np.ones_like(found)}


def _values(sources: Sources, request: Mapping[str, Any], states: States, quantities: Sequence[str]) -> dict[str, Any]:
    """Values of all symbols. Raises InvalidDocument for a field that a quantity needs."""
    model = sources.model
    needed = {field: name for name in reversed(quantities) for field in QUANTITIES[name].requires}
    if "qdd" in needed and states.qdd is None and model.dof:
        raise InvalidDocument.at("/qdd", "missing", f"{needed['qdd']} needs accelerations 'qdd'")
    values = known_values(model, request, states, sources.parameters(quantities))
    if "along" in needed:
        values |= direction_values(model, request.get("along"), states)
    return values


def _result(quantity: Quantity, found: Mapping[str, Array]) -> Any:
    """The arrays of a quantity; NaN where the metric could not be inverted."""
    if quantity.fields:
        return {field: found[name] for field, name in zip(quantity.fields, quantity.outputs, strict=True)}
    result = found[quantity.outputs[0]]
    for name in quantity.pivots:
        # D_k / |g_kk| that is not positive to rounding
        n = found[name].shape[1]
        usable = found[name].min(axis=1, initial=1) > 8 * n * np.finfo(np.float64).eps
        result = np.where(usable[:, None], result, np.nan)
    return result


def _single(value: Any) -> Any:
    return {name: v[0] for name, v in value.items()} if isinstance(value, dict) else value[0]


def _failures(results: Mapping[str, Any], has_closures: bool) -> list[dict[str, Any]]:
    failures = []
    for name, value in results.items():
        arrays = value.values() if isinstance(value, dict) else (value,)
        bad = np.zeros(0, dtype=np.int64)
        for some in arrays:
            with np.errstate(invalid="ignore", over="ignore"):
                total = some.sum()  # much quicker than a look at every number, and finite only if all are
            if not np.isfinite(total):
                bad = np.union1d(bad, np.flatnonzero(~np.isfinite(some).all(axis=tuple(range(1, some.ndim)))))
        singular = OPEN if has_closures else SINGULAR
        message = singular if QUANTITIES[name].pivots else "the result is not finite"
        failures += [{"state": int(i), "quantity": name, "code": "not-finite", "message": message} for i in bad]
    return failures
