"""The members of an ensemble: starts, parameters and inputs, one for all or one for each, and their right-hand side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.equations.formulas import require_tree
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import Conditions, read_conditions, state_names
from substructures.analysis.motion.problems.problem import Start
from substructures.analysis.motion.problems.signals import Table
from substructures.analysis.motion.right_hand_side import ACCELERATION, POWER, forward_kernel
from substructures.analysis.motion.simulation import DYNAMICS
from substructures.array import Array
from substructures.documents import escape
from substructures.ensembles.columns import INTEGRANDS
from substructures.ensembles.lanes import Places
from substructures.errors import InvalidArgument
from substructures.expr.program import Program
from substructures.quantities.numbers.states import StateInput, given_values, read_states, with_input_defaults
from substructures.tree.model import Model

#: by name: a number, (M,) one for each member, or (inputs) an expression in coordinates, velocities, parameters and t
Given = Mapping[str, Any]


@dataclass(frozen=True)
class Members:
    """``count`` = M motions from ``start`` (M, 2n), x = (q, q'); ``varied``: values (M,) of parameters and constant
    inputs that are not the same for all; ``conditions``: what is, as of the first member.
    """

    model: Model
    count: int
    start: Array
    varied: Mapping[str, Array]
    conditions: Conditions

    @property
    def zero(self) -> frozenset[str]:
        """Names of inputs and parameters that are 0 for all."""
        return self.conditions.zero - set(self.varied)

    @property
    def constants(self) -> dict[str, float]:
        """Numbers of all symbols that are the same for all."""
        return {name: x for name, x in self.conditions.values.items() if name not in self.varied}


def read_members(
    model: Model,
    q: StateInput | None,
    qd: StateInput | None,
    parameters: Given,
    inputs: Given,
    span: tuple[float, float],
) -> Members:
    """Check what is given: (n,) or (M, n) of ``q`` and ``qd``, or by name; numbers or (M,) of the others.

    Raises InvalidInput (``has-closures``; pointers ``/q``, ``/parameters/name``, ...) and MissingValue.
    """
    require_tree(model, "ensembles")
    given = with_input_defaults(model, inputs)
    for name, x in given.items():
        if isinstance(x, Table):
            message = "a table is not taken in an ensemble: give an expression in t, or simulate one after the other"
            raise InvalidArgument.at(f"/inputs/{escape(name)}", "not-supported", message)
    numbers = {name: x for name, x in given.items() if not isinstance(x, str)}
    states = read_states(model, {"q": q, "qd": qd, "parameters": parameters, "inputs": numbers}, None)
    count = states.count
    values = given_values(parameters, "parameters", "/parameters", count, model.parameters, model.units)
    values |= given_values(numbers, "inputs", "/inputs", count, model.input_names, model.units)
    varied = {name: x for name, x in values.items() if np.ndim(x) and len(x) == count and count > 1}
    first = {name: float(np.ravel(x)[0]) for name, x in values.items()}
    start = np.concatenate([np.broadcast_to(x, (count, model.dof)) for x in (states.q, states.qd)], axis=1)
    begin = Start(
        start[0, : model.dof],
        start[0, model.dof :],
        {name: first[name] for name in parameters},
        {name: x if isinstance(x, str) else first[name] for name, x in given.items()},
    )
    conditions = read_conditions(model, begin, span, DYNAMICS)
    return Members(model, count, start, varied, conditions)


class KernelRates:
    """x' = (q', q'', power, integrands) of many members as calls of kernels, x = (q, q', W, integrals); W only where
    there is any power.

    ``first``: the member that is number 0 of :meth:`load`; ``integrands``: a program with one output, INTEGRANDS.
    """

    def __init__(
        self,
        members: Members,
        lanes: int,
        folder: Path | None = None,
        integrands: Program | None = None,
        first: int = 0,
    ) -> None:
        self.members, self.first, model = members, first, members.model
        self.n = model.dof
        self.kernel = forward_kernel(model, members.zero, folder)
        self.has_power = bool(self.kernel.outputs[POWER].entries)
        self._names = state_names(model)
        self._values = {name: np.zeros(lanes) for name in members.varied}
        self._formulas = members.conditions.formulas
        self._inputs = program_kernel(members.conditions.expressions, folder) if self._formulas else None
        self._integrands = None if integrands is None else program_kernel(integrands, folder)
        self.integrals = 0 if integrands is None else integrands.outputs[INTEGRANDS].shape[0]

    @property
    def size(self) -> int:
        """Length of a state."""
        return 2 * self.n + self.has_power + self.integrals

    def load(self, lanes: Places, members: Places) -> None:
        """The parameters of ``members`` become those of ``lanes``."""
        for name, column in self._values.items():
            column[lanes] = self.members.varied[name][self.first + members]

    def bound(self, t: Array, x: Array, found: Array) -> Callable[[], None]:
        """What writes x' (L, m) at t (L,), x (L, m) into ``found``."""
        n, values = self.n, self.members.constants | self._values | {"t": t}
        columns = [(self._names, x[:, : 2 * n])]
        laws: Callable[[], None] | None = None
        if self._inputs is not None:
            followed = np.zeros((len(t), len(self._formulas)))
            laws = self._inputs.bind({"inputs": followed}, values, columns=columns)
            columns = [*columns, (list(self._formulas), followed)]
        outputs = {ACCELERATION: found[:, n : 2 * n]} | ({POWER: found[:, 2 * n]} if self.has_power else {})
        runs = [self.kernel.bind(outputs, values, columns=columns)]
        if self._integrands is not None:
            places = {INTEGRANDS: found[:, self.size - self.integrals :]}
            runs.append(self._integrands.bind(places, values, columns=columns))
        rates, velocities = found[:, :n], x[:, n : 2 * n]

        def go() -> None:
            """Once more."""
            rates[:] = velocities
            if laws is not None:
                laws()
            for run in runs:
                run()

        return go


def along(members: Members, chosen: slice, t: Array, x: Array) -> dict[str, float | Array]:
    """Values of all symbols but the state of some members along their motions ``x`` (M, K, m): numbers, or (M, K)."""
    count, times = x.shape[:2]
    values: dict[str, float | Array] = dict(members.constants)
    for name, column in members.varied.items():
        values[name] = np.repeat(column[chosen, None], times, axis=1)
    values["t"] = np.tile(t, (count, 1))
    conditions, n = members.conditions, members.model.dof
    if conditions.formulas:
        flat = {name: np.ravel(v) if np.ndim(v) else v for name, v in values.items()}
        kernel, state = program_kernel(conditions.expressions), np.ascontiguousarray(x[..., : 2 * n]).reshape(-1, 2 * n)
        found = kernel.evaluate(flat, ["inputs"], columns=[(state_names(members.model), state)])["inputs"]
        values |= {name: found[:, k].reshape(count, times) for k, name in enumerate(conditions.formulas)}
    return values
