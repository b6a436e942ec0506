"""Problems of optimal control: what is controlled, what it costs, and for how long.

    minimise  J = integral of l(q, q', u, t, p) dt + phi(q, q', t, p) at the end
    subject to  g_ab q''^b + Gamma_abc q'^b q'^c = Q_a(q, q', u, t, p)

``l`` and ``phi`` are given in the grammar of expressions (substructures.expr.parse); they may name the coordinates,
velocities (``x.q1'``), inputs (``tau.x.q1``), free parameters and ``t``.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.analysis.arguments import NumberOrExpression, by_name, exact, one_of, positive, real, whole
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.given import StateArray, numbers, require_known, unknown
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.graph import Expr
from substructures.expr.program import Symbol
from substructures.loads.scope import Scope
from substructures.quantities.measured import numeric
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

MAX_INTERVALS = 10_000
MAX_STEPS = 10_000
#: numbers that are kept of a motion, for the way back
MAX_NUMBERS = 50_000_000

#: relative error by the size of steps that a right result may have
ERROR_LIMIT = 1e-3

#: how a control runs between its nodes
Hold = Literal["constant", "linear"]
HOLDS = ("constant", "linear")
#: what is given by control, by its argument
KIND = {"values": "value", "guess": "guess"}


@dataclass(frozen=True)
class Cost:
    """``running``: l(q, q', u, t, parameters), per second; ``terminal``: phi(q, q', t, parameters) at the end."""

    running: NumberOrExpression = "0"
    terminal: NumberOrExpression = "0"


#: l = phi = 0
NO_COST = Cost()


@dataclass(frozen=True, kw_only=True)
class ControlProblem:
    """What is controlled, what it costs, and how the equations of motion are discretised.

    ``controls``: names of inputs, none where parameters or the horizon are sought alone. A control is constant in each
    of the ``intervals`` of the ``horizon`` [s] (``hold``: constant) or linear between its ends (linear); ``steps``:
    Runge-Kutta steps in each of them. The motion starts at
    ``q`` [rad, m] with ``qd`` [rad/s, m/s] (default: at rest) at the time ``t`` [s]; ``inputs``: constant values of the
    other inputs [N m, N] (default: their own, or 0); ``parameters`` instead of their defaults. Raises InvalidArgument.
    """

    controls: Sequence[str]
    horizon: float
    intervals: int
    q: StateArray
    cost: Cost = NO_COST
    steps: int = 1
    hold: Hold = "linear"
    qd: StateArray | None = None
    t: float = 0.0
    inputs: Mapping[str, float] | None = None
    parameters: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.controls, str) or not isinstance(self.controls, Collection):
            raise InvalidArgument.at("/controls", "list-expected", "a list of inputs is needed")
        object.__setattr__(self, "controls", tuple(self.controls))
        object.__setattr__(self, "horizon", positive(self.horizon, "horizon"))
        whole(self.intervals, "intervals", 1, MAX_INTERVALS)
        whole(self.steps, "steps", 1, MAX_STEPS)
        one_of(self.hold, "hold", HOLDS)
        object.__setattr__(self, "t", real(self.t, "/t"))
        object.__setattr__(self, "inputs", numbers(self.inputs, "inputs"))
        object.__setattr__(self, "parameters", numbers(self.parameters, "parameters"))

    @property
    def nodes(self) -> int:
        """Values that each control has."""
        return self.intervals + (self.hold == "linear")


def require_solvable(model: Model, problem: ControlProblem) -> None:
    """Raises InvalidInput for names that the model does not have, and too many steps."""
    require_untied(model, "optimal-controls")
    known, controls = inputs_of(model), problem.controls
    faults = [
        Fault(f"/controls/{i}", "unknown-input", f"unknown input '{str(name)[:80]}'{among(name, known, i)}")
        for i, name in enumerate(controls)
        if name not in known
    ]
    faults += [
        Fault(f"/controls/{i}", "repeated", f"'{name[:80]}' occurs twice")
        for i, name in enumerate(controls)
        if name in controls[:i]
    ]
    faults += unknown("inputs", "input", problem.inputs or {}, set(known) - set(controls))
    faults += unknown("parameters", "parameter", problem.parameters or {}, model.parameters)
    steps, most = problem.intervals * problem.steps, MAX_NUMBERS // (4 * model.dof * (model.dof + 3) or 1)
    if steps > most:
        message = f"{steps:,} steps; the limit for {model.dof} coordinates is {most:,}"
        faults.append(Fault("/steps", "too-many-steps", message))
    if faults:
        raise InvalidArgument(faults)


def per_node(problem: ControlProblem, given: Mapping[str, Any], field: str) -> Array:
    """Values of the controls from lists (or one number each) by name, (nodes, controls). Raises InvalidArgument."""
    values = np.zeros((problem.nodes, len(problem.controls)))
    require_known(field, KIND[field], by_name(given, field), problem.controls)
    for name, value in given.items():
        pointer = f"/{field}/{escape(name)}"
        numbers = numeric(value, pointer)
        if numbers.shape not in ((), (problem.nodes,)):
            message = f"shape {numbers.shape} found; one number or {problem.nodes} numbers are needed"
            raise InvalidArgument.at(pointer, "wrong-length", message)
        values[:, problem.controls.index(name)] = numbers
    return values


def read_costs(model: Model, cost: Cost, scope: Scope) -> tuple[Expr, Expr]:
    """l and phi in the graph of ``scope``, which knows the model's symbols. Raises InvalidInput."""
    moving = {*model.positions, *(f"{name}'" for name in model.coordinates), *model.parameters, "t"}
    names = {name: scope.names[name] for name in (*moving, *inputs_of(model))}
    running = scope.read(exact(cost.running, "/cost/running"), "/cost/running", names.get)
    at_end = {name: names[name] for name in moving}
    terminal = scope.read(exact(cost.terminal, "/cost/terminal"), "/cost/terminal", at_end.get)
    scope.finish()
    return running, terminal


def declared(model: Model, scope: Scope, symbols: Mapping[str, Symbol]) -> None:
    """Declare all symbols that costs may name; ``symbols``: those of the equations of motion."""
    for symbol in symbols.values():
        scope.declare(symbol.name, symbol.kind, symbol.unit)
    for name, joint in zip(model.coordinates, model.joints, strict=True):
        unit = "m" if joint == "P" else "rad"
        scope.declare(f"{name}'", "velocity", f"{unit}/s")
        scope.declare(f"{name}''", "acceleration", f"{unit}/s^2")
    for name, unit in model.state_units["q"].items():
        scope.declare(name, "coordinate", unit)
    scope.declare("t", "time", "s")
    for kind, unused in (("parameter", model.parameters), ("input", model.inputs)):
        for name, given in unused.items():
            if name not in scope.names:
                scope.declare(name, kind, str(given.get("unit", "")))
