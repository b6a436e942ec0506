"""The members of an ensemble: starts, parameters and inputs, one for all or one for each, and their right-hand side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.equations.nonholonomic.solved import ACCELERATION as QUASI_ACCELERATION
from substructures.analysis.equations.nonholonomic.solved import RATES, solved
from substructures.analysis.motion.conditions import DYNAMICS, Conditions, read_conditions, state_names
from substructures.analysis.motion.problems.kinds import ConstrainedMotion, TreeMotion, usual_kind
from substructures.analysis.motion.problems.signals import Table
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.right_hand_side import ACCELERATION, CHANGES, POWER, forward_kernel
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.documents import escape
from substructures.ensembles.columns import INTEGRANDS
from substructures.ensembles.constrained import constrained_start, full_states, rows_of
from substructures.ensembles.lanes import Places
from substructures.errors import InvalidArgument
from substructures.expr.program import Program
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.quantities.numbers.states import StateInput, given_values, read_states
from substructures.tree.model import Model

#: by name: a number, (M,) one for each member, or (inputs) an expression in coordinates, velocities, parameters and t
Given = Mapping[str, Any]


@dataclass(frozen=True)
class Members:
    """``count`` = M motions from ``start`` (M, 2n), x = (q, q'), with ball joints (M, m+n), x = (q, v); ``varied``:
    values (M,) of parameters and constant inputs that are not the same for all; ``conditions``: what is, as of the
    first member; ``equations``: of motions with constraints in p quasi-velocities, where ``start`` is (M, n+p),
    x = (q, v); ``first``: what is given of the first member.
    """

    model: Model
    count: int
    start: Array
    varied: Mapping[str, Array]
    conditions: Conditions
    first: Start
    equations: QuasiVelocities | None = None

    def start_of(self, k: int) -> Start:
        """What is given of a member of a tree without constraints."""
        own = {name: float(x[k]) for name, x in self.varied.items()}
        q, qd = np.hsplit(self.start[k], [len(self.model.positions)])
        return Start(
            q,
            qd,
            {name: own.get(name, x) for name, x in self.first.parameters.items()},
            {name: own.get(name, x) for name, x in self.first.inputs.items()},
        )

    @property
    def zero(self) -> frozenset[str]:
        """Names of inputs and parameters that are 0 for all."""
        return self.conditions.zero - set(self.varied)

    @property
    def columns(self) -> list[str]:
        """What is in a state, by name."""
        if self.equations is None:
            return state_names(self.model)
        return [*self.model.coordinates, *self.equations.velocities]

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
    kind: ConstrainedMotion | TreeMotion | None = None,
) -> Members:
    """Check what is given: (n,) or (M, n) of ``q`` and ``qd``, or by name; numbers or (M,) of the others; ``kind``: of
    motions with constraints, whose quasi-velocities at the start are (p,) or (M, p), or by name.

    Raises InvalidInput (pointers ``/q``, ``/parameters/name``, ``/v/name``, ...) and MissingValue.
    """
    require_moving(model, "ensembles")
    kind = usual_kind(model, None if isinstance(kind, TreeMotion) else kind)
    given = with_input_defaults(model.inputs, inputs)
    _require_no_tables(given)
    numbers = {name: x for name, x in given.items() if not isinstance(x, str)}
    # one q stands for as many states as there are quasi-velocities
    rates = {} if kind is None or kind.v is None else {"t": np.zeros(rows_of(kind.v))}
    states = read_states(model, {"q": q, "qd": qd, "parameters": parameters, "inputs": numbers, **rates}, None)
    count = states.count
    values = given_values(parameters, "parameters", "/parameters", count, model.parameters, model.units)
    values |= given_values(numbers, "inputs", "/inputs", count, model.input_names, model.units)
    varied = {name: x for name, x in values.items() if np.ndim(x) and len(x) == count and count > 1}
    first = {name: float(np.ravel(x)[0]) for name, x in values.items()}
    start = np.concatenate([np.broadcast_to(x, (count, x.shape[1])) for x in (states.q, states.qd)], axis=1)
    begin = Start(
        states.q[0],
        states.qd[0],
        {name: first[name] for name in parameters},
        {name: x if isinstance(x, str) else first[name] for name, x in given.items()},
    )
    conditions = read_conditions(model, begin, span, DYNAMICS)
    if kind is None:
        return Members(model, count, start, varied, conditions, begin)
    values, (q, velocities) = {**conditions.values, **varied, "t": span[0]}, np.hsplit(start, [model.dof])
    equations, start = constrained_start(model, kind, values, q, None if qd is None else velocities)
    return Members(model, count, start, varied, conditions, begin, equations)


def _require_no_tables(inputs: Given) -> None:
    if not isinstance(inputs, Mapping):
        raise InvalidArgument.at("/inputs", "object-expected", "an object of numbers by name is needed")
    for name, x in inputs.items():
        if isinstance(x, Table):
            message = "a table is not taken in an ensemble: give an expression in t, or simulate one after the other"
            raise InvalidArgument.at(f"/inputs/{escape(name)}", "not-supported", message)


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
        #: of positions, which are not n with ball joints
        self.n = len(model.positions)
        #: length of (q, q'), or of (q, v), and names of what is in it
        self.held, self._own = members.start.shape[1], members.columns
        self.kernel, self._kinematics = _kernels(members, folder)
        self.has_power = bool(self.kernel.outputs[POWER].entries)
        self._values = {name: np.zeros(lanes) for name in members.varied}
        self._formulas = members.conditions.formulas
        self._inputs = program_kernel(members.conditions.expressions, folder) if self._formulas else None
        self._integrands = None if integrands is None else program_kernel(integrands, folder)
        self.integrals = 0 if integrands is None else integrands.outputs[INTEGRANDS].shape[0]

    @property
    def size(self) -> int:
        """Length of a state."""
        return self.held + self.has_power + self.integrals

    def load(self, lanes: Places, members: Places) -> None:
        """The parameters of ``members`` become those of ``lanes``."""
        for name, column in self._values.items():
            column[lanes] = self.members.varied[name][self.first + members]

    def bound(self, t: Array, x: Array, found: Array) -> Callable[[], None]:
        """What writes x' (L, m) at t (L,), x (L, m) into ``found``."""
        n, held, values = self.n, self.held, self.members.constants | self._values | {"t": t}
        own = [(self._own, x[:, :held])]
        rates, moving = found[:, :n], own
        if self._kinematics is not None:
            # q' of (q, v), which stands in x' anyway
            names = state_names(self.members.model)
            moving = [(names[:n], x[:, :n]), (names[n:], rates)]
            runs = [self._kinematics.bind({RATES: rates}, values, columns=own)]
        elif self.members.model.balls:
            runs = []
        else:
            velocities = x[:, n:held]
            runs = [lambda: np.copyto(rates, velocities)]
        columns = own
        if self._inputs is not None:
            followed = np.zeros((len(t), len(self._formulas)))
            runs.append(self._inputs.bind({"inputs": followed}, values, columns=moving))
            columns, moving = ([*some, (list(self._formulas), followed)] for some in (own, moving))
        second = ACCELERATION if self._kinematics is None else QUASI_ACCELERATION
        outputs = {second: found[:, n:held]} | ({POWER: found[:, held]} if self.has_power else {})
        outputs |= {CHANGES: rates} if self.members.model.balls else {}
        runs.append(self.kernel.bind(outputs, values, columns=columns))
        if self._integrands is not None:
            places = {INTEGRANDS: found[:, self.size - self.integrals :]}
            runs.append(self._integrands.bind(places, values, columns=moving))

        def go() -> None:
            """Once more."""
            for run in runs:
                run()

        return go


def _kernels(members: Members, folder: Path | None) -> tuple[Kernel, Kernel | None]:
    """Of accelerations and power, and of q' where that is no part of the state."""
    if members.equations is None:
        return forward_kernel(members.model, members.zero, folder), None
    source = solved(members.equations, members.zero)
    return (
        compile_program(source, (QUASI_ACCELERATION, POWER), folder),
        compile_program(source, (RATES,), folder),
    )


def along(members: Members, chosen: slice, t: Array, x: Array) -> tuple[dict[str, float | Array], Array]:
    """Of some members along their motions ``x`` (M, K, m): values of all symbols but the state, numbers or (M, K), and
    (q, q') (M, K, 2n).
    """
    count, times = x.shape[:2]
    values: dict[str, float | Array] = dict(members.constants)
    for name, column in members.varied.items():
        values[name] = np.repeat(column[chosen, None], times, axis=1)
    values["t"] = np.tile(t, (count, 1))
    flat = {name: np.ravel(v) if np.ndim(v) else v for name, v in values.items()}
    conditions, names = members.conditions, state_names(members.model)
    state = np.ascontiguousarray(x[..., : members.start.shape[1]]).reshape(count * times, -1)
    if members.equations is not None:
        state = full_states(members.equations, flat, state)
    if conditions.formulas:
        kernel = program_kernel(conditions.expressions)
        found = kernel.evaluate(flat, ["inputs"], columns=[(names, state)])["inputs"]
        values |= {name: found[:, k].reshape(count, times) for k, name in enumerate(conditions.formulas)}
    return values, state.reshape(count, times, -1)
