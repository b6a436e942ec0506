"""Numbers of a model for one state or many."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from substructures.array import Array
from substructures.errors import InvalidArgument, TooLarge
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED, cholesky_solve, closed_solve
from substructures.quantities.derivative_directions import Direction, direction_values
from substructures.quantities.derivatives import FD, SINGULAR
from substructures.quantities.formulas import DYNAMICS
from substructures.quantities.result import Evaluation, Failure, ParameterColumns, failures_of, without_axis
from substructures.quantities.states import (
    ArgumentsByName,
    StateInput,
    States,
    ValueInput,
    known_values,
    read_states,
    require,
)
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
from substructures.quantities.warnings import value_warnings
from substructures.tree.model import Model

__all__ = [
    "QUANTITIES",
    "REGRESSOR",
    "Direction",
    "Evaluation",
    "Evaluator",
    "Failure",
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


_OPEN = (
    "the state does not meet the closures (also their velocities), or they lose rank there, or the metric is singular: "
    "take consistent states from loop states"
)


def _advice(singular: str) -> Callable[[str], str]:
    """What to say about a quantity without a finite result; ``singular``: where it takes the inverse metric."""
    return lambda name: singular if QUANTITIES[name].pivots else "the result is not finite"


ADVICE, OPEN_ADVICE = _advice(SINGULAR), _advice(_OPEN)

#: outputs of a program for (program, values, names, number of states)
Evaluator = Callable[[Program, Mapping[str, Any], list[str], int], dict[str, Array]]


def interpreted(program: Program, values: Mapping[str, Any], names: list[str], states: int) -> dict[str, Array]:
    """The engine that needs nothing: the reference interpreter, in blocks of states."""
    return interpret_in_blocks(program, values, names, states)


def evaluate(
    model: Model,
    quantities: str | Sequence[str],
    q: StateInput | None,
    qd: StateInput | None = None,
    qdd: StateInput | None = None,
    *,
    inputs: ValueInput | None = None,
    parameters: ValueInput | None = None,
    t: ArrayLike | None = 0.0,
    along: Direction | None = None,
    limit: int | None = None,
    evaluator: Evaluator = interpreted,
    sources: Sources | None = None,
) -> Evaluation:
    """Numbers of quantities, one name of QUANTITIES or several, for one state or N.

    ``q`` [rad, m], ``qd`` [rad/s, m/s], ``qdd`` [rad/s^2, m/s^2]: (n,), (N, n), or by coordinate name a number or (N,);
    velocities that are not given are zero. ``inputs`` [N m, N], ``parameters`` [SI]: by name a number or (N,), inputs
    that are not given are zero, parameters have their defaults. ``t`` [s]: a number or (N,). ``along``: the direction
    of derivatives. The results have the axis N first, but for one state with ``q`` (n,).

    ``forward_dynamics`` of a model with closures are the accelerations on them, in states that meet them
    (:func:`substructures.mechanics.accelerations.closed_solve`); other quantities are those of the tree without them.

    ``limit``: most states; ``evaluator``: what computes outputs of programs; ``sources``: the programs (default: formed
    when they are first needed, and kept). Raises InvalidArgument (pointers start with the name of the argument),
    MissingValue (a parameter without a value), TooLarge, and InvalidDocument for closures where they are not taken.
    States without a finite result are no exceptions but ``failures``.

    >>> from substructures import Definition, TreeSpec, catalogue, couple, derive
    >>> part = derive(Definition.read(catalogue.load("simple-pendulum")))
    >>> tree = TreeSpec.read({"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]})
    >>> evaluate(couple(tree, {"p": part}), ["metric", "forces"], q=[[0.0], [0.1]])
    Evaluation of 2 state(s) of p.q1
      metric (2, 1, 1), forces (2, 1)
    """
    names = read_quantities(quantities)
    sources = sources or Sources(model)
    given = {"q": q, "qd": qd, "qdd": qdd, "inputs": inputs, "parameters": parameters, "t": t}
    states = read_states(model, given, limit)
    values = _values(sources, given, along, states, names)
    found = _computed(sources, names, values, evaluator, states)
    results = {name: _result(QUANTITIES[name], found[QUANTITIES[name].source]) for name in names}
    columns = sources.columns() if REGRESSOR in found else None
    chosen = {name: values[name] for name in parameters or ()}
    return Evaluation(
        model.coordinates,
        states.count,
        model.program.digest,
        {name: without_axis(value) for name, value in results.items()} if states.single else results,
        failures_of(results, OPEN_ADVICE if model.closures else ADVICE),
        model.frames if "kinematics" in results else None,
        None if columns is None else ParameterColumns(columns.names, columns.units),
        states.single,
        tuple(value_warnings(sources, chosen, inputs or (), states.q, others=columns.parameters if columns else ())),
    )


def check(
    sources: Sources,
    quantities: str | Sequence[str],
    q: StateInput | None,
    qd: StateInput | None = None,
    qdd: StateInput | None = None,
    *,
    inputs: ValueInput | None = None,
    parameters: ValueInput | None = None,
    t: ArrayLike | None = 0.0,
    along: Direction | None = None,
) -> States:
    """The states, when :func:`evaluate` would accept the arguments; nothing is computed.

    Raises as :func:`evaluate`, but for formulas that are too large to be made here.
    """
    names = read_quantities(quantities)
    given = {"q": q, "qd": qd, "qdd": qdd, "inputs": inputs, "parameters": parameters, "t": t}
    states = read_states(sources.model, given, None)
    with suppress(TooLarge):
        values = _values(sources, given, along, states, names)
        for _, program, outputs in steps(sources, names):
            if program is not None:
                require(program, outputs, values)
    return states


def _computed(
    sources: Sources, quantities: Sequence[str], values: Mapping[str, Any], evaluator: Evaluator, states: States
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
            found[source] = _closed(sources.model, program, values, evaluator, states)
        elif program is sources.model.program and source == FD:
            found[source] = _solved(sources.model, values, evaluator, count)
        else:
            found[source] = evaluator(program, values, names, count)
    return found


def _solved(model: Model, values: Mapping[str, Any], evaluator: Evaluator, count: int) -> dict[str, Array]:
    """Forward dynamics of a model too large for formulas of it: g q'' = Q - Gamma q' q' by numbers, in blocks."""
    result, size = np.empty((count, model.dof)), max(1, BLOCK // model.dof**2)
    for start in range(0, count, size):
        part = slice(start, start + size)
        some = {name: x[part] if np.shape(x) == (count,) else x for name, x in values.items()}
        found = evaluator(model.program, some, list(DYNAMICS), len(result[part]))
        # g_ab q''^b = Q_a - Gamma_abc q'^b q'^c
        result[part] = cholesky_solve(found["metric"], found["forces"] - found["bias"])
    return {FD: result, "pivots": np.ones((count, model.dof))}


def _closed(
    model: Model, program: Program, values: Mapping[str, Any], evaluator: Evaluator, states: States
) -> dict[str, Array]:
    """Forward dynamics of a tree with closures."""
    # g q'' = Q - Gamma q' q' + G^T lambda and G q'' + G' q' = 0; closure.acceleration is G' q'
    outputs = evaluator(program, values, [*DYNAMICS, *CLOSED], states.count)

    def second(velocities: Array) -> Array:
        """G' q' at other velocities."""
        given = {f"{name}'": velocities[:, a] for a, name in enumerate(model.coordinates)}
        return evaluator(program, {**values, **given}, [CLOSED[2]], states.count)[CLOSED[2]]

    found = closed_solve(outputs, states.q, states.qd, second)
    return {FD: found, "pivots": np.ones_like(found)}


def _values(
    sources: Sources, given: ArgumentsByName, along: Direction | None, states: States, quantities: Sequence[str]
) -> dict[str, Any]:
    """Values of all symbols. Raises InvalidArgument for an argument that a quantity needs."""
    model = sources.model
    # the first quantity that needs an argument is the one that a message names
    needed = {field: name for name in reversed(quantities) for field in QUANTITIES[name].requires}
    if "qdd" in needed and states.qdd is None and model.dof:
        raise InvalidArgument.at("/qdd", "missing", f"{needed['qdd']} needs accelerations 'qdd'")
    values = known_values(model, given, states, sources.parameters(quantities))
    if "along" in needed:
        values |= direction_values(model, along, states)
    return values


def _result(quantity: Quantity, found: Mapping[str, Array]) -> Any:
    """The arrays of a quantity; NaN where the metric could not be inverted."""
    if quantity.fields:
        return {field: found[name] for field, name in zip(quantity.fields, quantity.outputs, strict=True)}
    result = found[quantity.outputs[0]]
    for name in quantity.pivots:
        # g = L^T D L is positive definite where all D_k are: here D_k / |g_kk| beyond the rounding of n steps
        n = found[name].shape[1]
        usable = found[name].min(axis=1, initial=1) > 8 * n * np.finfo(np.float64).eps
        result = np.where(usable[:, None], result, np.nan)
    return result
