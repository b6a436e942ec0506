"""Numbers of a model for one state or many."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from substructures.array import Array
from substructures.errors import InvalidArgument, TooLarge
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.quantities.accelerations import (
    Evaluator,
    accelerations,
    accelerations_on_closures,
    conditions,
)
from substructures.quantities.conditioning import Doubt, Look, closed_doubts, doubts, is_usable, solved_anew
from substructures.quantities.derivative_directions import Direction, direction_values
from substructures.quantities.derivatives import FD
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
    CONDITION,
    MODEL,
    PARTS,
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

_OPEN = (
    "the state does not meet the closures (also their velocities), or they lose rank there, or the metric is singular: "
    "take consistent states from loop states"
)
_ENDLESS = "the metric is singular to rounding, or not positive definite, or not finite: it has no condition number"
_NOT_FINITE = "the result is not finite: numbers overflow, or a formula divides by zero in this state"


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
    first: int = 0,
) -> Evaluation:
    """Numbers of quantities, one name of QUANTITIES or several, for one state or N.

    ``q`` [rad, m], ``qd`` [rad/s, m/s], ``qdd`` [rad/s^2, m/s^2]: (n,), (N, n), or by coordinate name a number or (N,);
    velocities that are not given are zero. ``inputs`` [N m, N], ``parameters`` [SI]: by name a number or (N,), inputs
    that are not given are zero, parameters have their defaults. ``t`` [s]: a number or (N,). ``along``: the direction
    of derivatives. The results have the axis N first, but for one state with ``q`` (n,).

    ``forward_dynamics`` of a model with closures are the accelerations on them, in states that meet them
    (:func:`substructures.mechanics.accelerations.closed_solve`); other quantities are those of the tree without them.

    ``limit``: most states; ``evaluator``: what computes outputs of programs; ``sources``: the programs (default: formed
    when they are first needed, and kept); ``first``: the number of the first state in warnings, if they are part of
    more. Raises InvalidArgument (pointers start with the name of the argument), MissingValue (a parameter without a
    value), TooLarge, and InvalidDocument for closures where they are not taken.
    States without a finite result are no exceptions but ``failures``; accelerations that rounding changes noticeably,
    as the metric is nearly singular, are ``warnings`` (``condition`` is the number that tells).

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
    told = _told(names, found, results, _looking(model, values, states.count))
    columns = sources.columns() if REGRESSOR in found else None
    chosen = {name: values[name] for name in parameters or ()}
    return Evaluation(
        model.coordinates,
        states.count,
        model.program.digest,
        {name: without_axis(value) for name, value in results.items()} if states.single else results,
        failures_of(results, lambda name, state: _advice(name, told.get(name, {}).get(state))),
        model.frames if "kinematics" in results else None,
        None if columns is None else ParameterColumns(columns.names, columns.units),
        states.single,
        (
            *value_warnings(sources, chosen, inputs or (), states.q, columns.parameters if columns else (), first),
            *_warnings(results, told, states.single),
        ),
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
    count, model = states.count, sources.model
    look = _looking(model, values, count)
    found: dict[str, dict[str, Array]] = {}
    for source, program, names in steps(sources, quantities):
        if source == PARTS and sources.numbers is not None:
            found[MODEL] = sources.numbers(values, names, count)
            continue
        if program is None:
            nothing = {name: np.full((count, model.dof), np.nan) for name in names}
            found[source] = nothing | {"pivots": np.zeros((count, model.dof))}
            continue
        require(program, names, values)
        if source == CONDITION:
            found[source] = {CONDITION: conditions(model, values, evaluator, count)}
        elif source == FD and model.closures:
            found[source] = accelerations_on_closures(model, program, values, evaluator, count)
        elif program is model.program and source == FD:
            found[source] = accelerations(model, values, evaluator, count)
        else:
            found[source] = found.get(source, {}) | evaluator(program, values, names, count)
            if "inertias" in names:
                found[source] = solved_anew(found[source], source, look)
    return found


def _looking(model: Model, values: Mapping[str, Any], count: int) -> Look:
    """Outputs of the model at some of the states."""

    def look(states: NDArray[np.int64], names: list[str]) -> Mapping[str, Array]:
        """The outputs there."""
        # symbols without a value, which no result depends on, are not numbers
        known = {s.name: np.nan for s in model.program.symbols} | dict(values)
        some = {name: x[states] if np.shape(x) == (count,) else x for name, x in known.items()}
        return interpreted(model.program, some, names, len(states))

    return look


def _values(
    sources: Sources, given: ArgumentsByName, along: Direction | None, states: States, quantities: Sequence[str]
) -> dict[str, Any]:
    """Values of all symbols. Raises InvalidArgument for an argument that a quantity needs."""
    model = sources.model
    # the first quantity that needs an argument is the one that a message names
    needed = {field: name for name in reversed(quantities) for field in QUANTITIES[name].requires}
    if "qdd" in needed and states.qdd is None and model.dof:
        raise InvalidArgument.at("/qdd", "missing", f"{needed['qdd']} needs accelerations 'qdd'")
    parameters = sources.parameters(quantities)
    defaults = sources.defaults if parameters is model.parameters else None
    values = known_values(model, given, states, parameters, defaults)
    if "along" in needed:
        values |= direction_values(model, along, states)
    return values


def _result(quantity: Quantity, found: Mapping[str, Array]) -> Any:
    """The arrays of a quantity; NaN where the metric could not be inverted."""
    if quantity.fields:
        return {field: found[name] for field, name in zip(quantity.fields, quantity.outputs, strict=True)}
    result = found[quantity.outputs[0]]
    if "pivots" in quantity.pivots and "pivots" in found:
        usable = is_usable(found["pivots"])
        result = result if usable.all() else np.where(usable[:, None], result, np.nan)
    return result


def _told(
    names: Sequence[str],
    found: Mapping[str, Mapping[str, Array]],
    results: Mapping[str, Any],
    look: Look,
) -> dict[str, dict[int, Doubt]]:
    """What is to be said of accelerations and their derivatives, by quantity and state."""
    told = {}
    for name in names:
        outputs = found[QUANTITIES[name].source]
        if not QUANTITIES[name].pivots:
            continue
        if CONDITION in outputs:
            told[name] = closed_doubts(results[name], outputs[CONDITION], _OPEN)
        elif "pivots" in outputs:
            told[name] = doubts(results[name], outputs["pivots"], look)
    return told


def _advice(name: str, doubt: Doubt | None) -> tuple[str, str]:
    """Code and message of a failure."""
    if doubt is not None:
        return doubt.code, doubt.message
    return "not-finite", _ENDLESS if name == CONDITION else _NOT_FINITE


def _warnings(
    results: Mapping[str, Any], told: Mapping[str, Mapping[int, Doubt]], single: bool
) -> Iterator[dict[str, Any]]:
    """A warning for every state with results that are doubtful."""
    for name, by_state in told.items():
        for state, doubt in by_state.items():
            if np.isfinite(results[name][state]).all():
                place = "/q" if single else f"/q/{state}"
                told_of = {"pointer": place, "code": doubt.code, "message": doubt.message}
                yield {**told_of, "state": state, "quantity": name}
