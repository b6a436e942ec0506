"""What an evaluation is asked for: arguments that are checked, with the values of all symbols."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from substructures.compile.kernel import NO_PLACES, Places
from substructures.errors import InvalidArgument, TooLarge
from substructures.formats.packing import packed_elements
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.derivative_directions import Direction, direction_values
from substructures.quantities.numbers.states import (
    ArgumentsByName,
    StateInput,
    States,
    ValueInput,
    known_values,
    read_states,
    require,
)
from substructures.quantities.numbers.workspace import momentum
from substructures.quantities.quantity import REACTIONS, TABLE
from substructures.quantities.sources import Sources, read_quantities, require_there, steps


@dataclass(frozen=True, slots=True)
class Form:
    """What results look like."""

    packed: bool
    float32: bool

    def places(self, sources: Sources, names: Sequence[str]) -> Places:
        """The elements of the outputs that are packed."""
        n, rule = sources.model.dof, sources.christoffel_rule
        kinds = {"metric": "symmetric", "christoffel": rule}
        return {x: packed_elements(x, n, kinds[x]) for x in names if x in kinds} if self.packed else NO_PLACES

    def shown(self, result: Any) -> Any:
        """Results in the precision wanted."""
        if not self.float32:
            return result
        if isinstance(result, dict):
            return {name: self.shown(x) for name, x in result.items()}
        with np.errstate(over="ignore"):  # then it is a failure
            return result.astype(np.float32)

    def is_beyond(self, result: Any, state: int) -> bool:
        """Whether a result that is not finite is so only in the precision wanted."""
        each = result.values() if isinstance(result, dict) else (result,)
        return self.float32 and all(bool(np.isfinite(x[state]).all()) for x in each)


@dataclass(frozen=True, slots=True)
class Asked:
    """Arguments that were checked, with the values of all symbols; ``chosen``, ``inputs``: names of those given."""

    sources: Sources
    names: Sequence[str]
    form: Form
    evaluator: Evaluator
    states: States
    values: Mapping[str, Any]
    chosen: Sequence[str]
    inputs: Sequence[str]


def read_arguments(
    sources: Sources,
    quantities: str | Sequence[str],
    given: ArgumentsByName,
    form: Form,
    limit: int | None,
    evaluator: Evaluator,
) -> Asked:
    """Check all arguments; ``given``: those of :func:`substructures.quantities.numbers.evaluation.evaluate` by name.

    Raises as it.
    """
    names = read_quantities(quantities)
    sources = _of_joints(sources, names, given.get("joints"))
    states = read_states(sources.model, given, limit)
    values = _values(sources, given, given.get("along"), states, names)
    if any(TABLE[name].of_momenta for name in names):
        values |= _momenta(sources, evaluator, values, states.count)
    chosen, inputs = (tuple(given.get(field) or ()) for field in ("parameters", "inputs"))
    return Asked(sources, names, form, evaluator, states, values, chosen, inputs)


def _of_joints(sources: Sources, names: Sequence[str], joints: Sequence[str] | None) -> Sources:
    """The sources with the rows of reactions that are wanted. Raises InvalidArgument for unknown ones."""
    if joints is None:
        return sources
    if REACTIONS not in names:
        raise InvalidArgument.at("/joints", "not-supported", "'joints' goes with the quantity 'reactions'")
    found = replace(sources, joints=(joints,) if isinstance(joints, str) else tuple(joints))
    found.of(REACTIONS)
    return found


def _momenta(sources: Sources, evaluator: Evaluator, values: Mapping[str, Any], count: int) -> dict[str, Any]:
    """p_a = g_ab q'^b of the states, by their symbols."""
    name, coordinates = "generalised_momenta", sources.model.coordinates
    program = sources.program(name)
    require(program, [name], values)
    found = evaluator(program, values, [name], count)[name]
    return {momentum(c): found[:, a] for a, c in enumerate(coordinates)}


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
    joints: Sequence[str] | None = None,
    **_form: bool,
) -> States:
    """The states, when :func:`evaluate` would accept the arguments; nothing is computed.

    Raises as :func:`evaluate`, but for formulas that are too large to be made here, or take too long.
    """
    names = read_quantities(quantities)
    sources = _of_joints(sources, names, joints)
    given = {"q": q, "qd": qd, "qdd": qdd, "inputs": inputs, "parameters": parameters, "t": t}
    states = read_states(sources.model, given, None)
    with suppress(TooLarge, TimeoutError):
        values = _values(sources, given, along, states, names)
        for source, program, outputs in steps(sources, names):
            if program is not None and source != REACTIONS:
                require(program, outputs, values | dict.fromkeys(map(momentum, sources.model.coordinates), 0.0))
    return states


def _values(
    sources: Sources, given: ArgumentsByName, along: Direction | None, states: States, quantities: Sequence[str]
) -> dict[str, Any]:
    """Values of all symbols. Raises InvalidArgument for an argument that a quantity needs."""
    model = sources.model
    require_there(model, quantities)
    # the first quantity that needs an argument is the one that a message names
    needed = {field: name for name in reversed(quantities) for field in TABLE[name].requires}
    if "qdd" in needed and states.qdd is None and model.dof:
        raise InvalidArgument.at("/qdd", "missing", f"{needed['qdd']} needs accelerations 'qdd'")
    if "reactions" in quantities and states.qdd is not None and model.closures:
        message = "reactions of a tree with closures are those of its own motion: leave 'qdd' out"
        raise InvalidArgument.at("/qdd", "not-supported", message)
    parameters = sources.parameters(quantities)
    defaults = sources.defaults if parameters is model.parameters else None
    values = known_values(model, given, states, parameters, defaults)
    if "along" in needed:
        values |= direction_values(model, along, states)
    return values
