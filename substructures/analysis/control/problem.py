"""Problems of optimal control as documents: what is controlled, what it costs, and for how long.

    minimise  J = integral of l(q, q', u, t, p) dt + phi(q, q', t, p) at the end
    subject to  g_ab q''^b + Gamma_abc q'^b q'^c = Q_a(q, q', u, t, p)

``l`` and ``phi`` are given in the grammar of expressions (substructures.expr.parse); they may name the coordinates,
velocities (``x.q1'``), inputs (``tau.x.q1``), free parameters and ``t``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from pydantic import Field

from substructures.analysis.equations.formulas import inputs_of
from substructures.array import Array
from substructures.documents import DocumentPart, escape, read_model
from substructures.errors import Fault, InvalidDocument
from substructures.expr.graph import Expr
from substructures.expr.program import Symbol
from substructures.part.scope import Scope
from substructures.quantities.states import numeric, read_states
from substructures.tree.model import Model, require_open

MAX_INTERVALS = 10_000
#: numbers that are kept of a motion, for the way back
MAX_NUMBERS = 50_000_000

#: what takes closures
LINEAR = "use the state space of linearisations, and simulations to try controls"

Finite = Annotated[float, Field(allow_inf_nan=False)]


class Cost(DocumentPart):
    """l and phi."""

    running: str = Field("0", description="l(q, q', u, t, parameters), per second")
    terminal: str = Field("0", description="phi(q, q', t, parameters)")


class ControlProblem(DocumentPart):
    """The parts of a request that say what is controlled, and how the equations of motion are discretised.

    A control is constant in each of the ``intervals`` (``hold``: constant) or linear between its ends (linear);
    ``steps``: Runge-Kutta steps in each of them.
    """

    controls: tuple[str, ...] = Field(min_length=1, description="names of inputs")
    cost: Cost = Cost()
    horizon: float = Field(gt=0, allow_inf_nan=False, description="s")
    intervals: int = Field(ge=1, le=MAX_INTERVALS)
    steps: int = Field(1, ge=1, le=10_000, description="Runge-Kutta steps in each interval")
    hold: Literal["constant", "linear"] = "linear"
    q: Any = Field(description="where the motion starts: (n,) or by coordinate; rad, m")
    qd: Any = Field(None, description="rad/s, m/s; default: at rest")
    t: float = Field(0.0, allow_inf_nan=False, description="when it starts, s")
    inputs: dict[str, Finite] = Field({}, description="constant values of the other inputs; default: zero")
    parameters: dict[str, Finite] = Field({}, description="instead of their defaults")

    @property
    def nodes(self) -> int:
        """Values that each control has."""
        return self.intervals + (self.hold == "linear")


P = TypeVar("P", bound=ControlProblem)


def read_problem(kind: type[P], model: Model, data: Mapping[str, Any]) -> P:
    """A request of this kind, with all names checked. Raises InvalidDocument with pointers."""
    require_open(model.closures, LINEAR)
    problem = read_model(kind, data)
    known = inputs_of(model)
    faults = [
        Fault(f"/controls/{i}", "unknown-input", f"unknown input '{name[:80]}'; there are {', '.join(known)}")
        for i, name in enumerate(problem.controls)
        if name not in known
    ]
    faults += [
        Fault(f"/controls/{i}", "repeated", f"'{name[:80]}' occurs twice")
        for i, name in enumerate(problem.controls)
        if name in problem.controls[:i]
    ]
    faults += _unknown("inputs", problem.inputs, set(known) - set(problem.controls))
    faults += _unknown("parameters", problem.parameters, model.parameters)
    steps, most = problem.intervals * problem.steps, MAX_NUMBERS // (4 * model.dof * (model.dof + 3) or 1)
    if steps > most:
        message = f"{steps:,} steps; the limit for {model.dof} coordinates is {most:,}"
        faults.append(Fault("/steps", "too-many-steps", message))
    if faults:
        raise InvalidDocument(faults)
    return problem


def _unknown(field: str, given: Mapping[str, Any], known: Iterable[str]) -> list[Fault]:
    known = set(known)
    return [
        Fault(f"/{field}/{escape(name)}", f"unknown-{field[:-1]}", f"unknown {field[:-1]} '{name[:80]}'")
        for name in given
        if name not in known
    ]


def initial_state(model: Model, problem: ControlProblem) -> Array:
    """(q, q') at the start, (2 n,). Raises InvalidDocument."""
    states = read_states(model, {"q": problem.q, "qd": problem.qd}, 1)
    return np.concatenate([states.q[0], states.qd[0]])


def per_node(problem: ControlProblem, given: Mapping[str, Any], field: str) -> Array:
    """Values of the controls from lists (or one number each) by name, (nodes, controls). Raises InvalidDocument."""
    values = np.zeros((problem.nodes, len(problem.controls)))
    faults = _unknown(field, given, problem.controls)
    if faults:
        raise InvalidDocument(faults)
    for name, value in given.items():
        pointer = f"/{field}/{escape(name)}"
        numbers = numeric(value, pointer)
        if numbers.shape not in ((), (problem.nodes,)):
            message = f"shape {numbers.shape} found; one number or {problem.nodes} numbers are needed"
            raise InvalidDocument.at(pointer, "wrong-length", message)
        values[:, problem.controls.index(name)] = numbers
    return values


def read_costs(model: Model, cost: Cost, scope: Scope) -> tuple[Expr, Expr]:
    """l and phi in the graph of ``scope``, which knows the model's symbols. Raises InvalidDocument."""
    moving = {*model.coordinates, *(f"{name}'" for name in model.coordinates), *model.parameters, "t"}
    names = {name: scope.names[name] for name in (*moving, *inputs_of(model))}
    running = scope.read(cost.running, "/cost/running", names.get)
    terminal = scope.read(cost.terminal, "/cost/terminal", {name: names[name] for name in moving}.get)
    scope.finish()
    return running, terminal


def declared(model: Model, scope: Scope, symbols: Mapping[str, Symbol]) -> None:
    """Declare all symbols that costs may name; ``symbols``: those of the equations of motion."""
    for symbol in symbols.values():
        scope.declare(symbol.name, symbol.kind, symbol.unit)
    for name, joint in zip(model.coordinates, model.joints, strict=True):
        unit = "m" if joint == "P" else "rad"
        scope.declare(name, "coordinate", unit)
        scope.declare(f"{name}'", "velocity", f"{unit}/s")
        scope.declare(f"{name}''", "acceleration", f"{unit}/s^2")
    scope.declare("t", "time", "s")
