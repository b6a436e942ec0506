"""Exact directional derivatives of inverse and forward dynamics, forward mode on the graph.

With ID_a(q, q', q'', tau) = g_ab q''^b + Gamma_abc q'^b q'^c - Q_a(q, q', tau, t) one walk over the nodes of ID gives

    dID = dID/dq dq + dID/dq' dq' + dID/dq'' dq'' + dID/dtau dtau,        dID/dq'' = g,        dID/dtau_a = -e_a

as formulas again, for a small multiple of the operations of ID. The direction is a symbol beside every coordinate,
velocity, acceleration and input, with the same kind and unit and ``d.`` before its name: ``d.arm.q1`` [rad, m],
``d.arm.q1'`` [rad/s, m/s], ``d.arm.q1''`` [rad/s^2, m/s^2], ``d.tau.arm.q1`` [N m, N], ``d.arm.u`` for an input u.
Forward dynamics q'' = FD(q, q', tau) satisfies ID(q, q', FD, tau) = 0, hence g d(FD) = -dID at q'' = FD with dq'' = 0.
(mathematics.md, section 7: the perturbation equations.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.derived import derived
from substructures.errors import InvalidDocument
from substructures.expr.differentiate import step
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Formulas, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.expr.walk import reachable
from substructures.model import Model
from substructures.solve import cholesky_solve
from substructures.states import Array, States, numeric, read_states, symbol_values

ID = "inverse_dynamics"
#: kinds of symbols that have a direction
VARIED = frozenset(("coordinate", "velocity", "acceleration", "input"))
DYNAMICS = ("metric", "bias", "forces")


def direction(name: str) -> str:
    """The symbol of the variation of ``name``."""
    return f"d.{name}"


class _Dynamics:
    """Inverse dynamics of a model as expressions of a new graph."""

    def __init__(self, model: Model) -> None:
        source = derived(model, ID)
        self.n, self.graph = model.dof, Graph()
        self.symbols = {symbol.name: symbol for symbol in source.symbols}
        entries = replay(source, self.graph, {}, [ID])[ID].entries
        self.rows = [entries.get((a,), self.graph.zero) for a in range(self.n)]
        self.roots = [x for x in self.rows if isinstance(x, Expr)]
        self.nodes = reachable(self.roots)

    def along(self, seeds: Mapping[str, Expr]) -> list[Expr]:
        """d(row) for the variations ``seeds`` of symbols; nodes that do not depend on them cost nothing."""
        d: dict[Expr, Expr] = {}
        zero = self.graph.zero
        for node in self.nodes:
            if node.op == "sym":
                if str(node.value) in seeds:
                    d[node] = seeds[str(node.value)]
            elif any(x in d for x in node.args):
                value = step(self.graph, node, [d.get(x, zero) for x in node.args])
                if not value.is_zero:
                    d[node] = value
        return [d.get(root, zero) for root in self.roots]

    def matrix(self, names: Sequence[str]) -> Formulas:
        """[a, b]: derivative of row a with respect to the symbol of that name."""
        columns = [self.along({name: self.graph.one}) for name in names]
        return array((self.n, len(names)), lambda a, b: columns[b][a])


def inverse_dynamics_derivative(model: Model) -> Program:
    """Inverse dynamics and its directional derivative, one program with two outputs.

    ``inverse_dynamics`` (n,) [N m, N]; ``inverse_dynamics_derivative`` (n,): its derivative along the symbols ``d.*``
    of the module's table (only those appear that the dynamics depend on). Raises ZeroDivisionError where a load has an
    infinite derivative for every value of the symbols.
    """
    dynamics = _Dynamics(model)
    varied = [s for s in dynamics.symbols.values() if s.kind in VARIED]
    seeds = {s.name: dynamics.graph.symbol(direction(s.name)) for s in varied}
    rows = dynamics.along(seeds)
    symbols = dynamics.symbols | {direction(s.name): replace(s, name=direction(s.name)) for s in varied}
    outputs = {
        ID: array((dynamics.n,), lambda a: dynamics.rows[a]),
        f"{ID}_derivative": array((dynamics.n,), lambda a: rows[a]),
    }
    return program(dynamics.graph, outputs, symbols)


def inverse_dynamics_jacobians(model: Model) -> Program:
    """Partial derivatives of inverse dynamics by the state, one program with three outputs.

    ``inverse_dynamics`` (n,); ``inverse_dynamics_q`` (n, n): dID_a/dq^b [N m/rad, N/m, ...] and
    ``inverse_dynamics_qd`` (n, n): dID_a/dq'^b = 2 Gamma_abc q'^c - dQ_a/dq'^b, both at [a, b]. The derivative by q''
    is the metric. One walk for every column, each over what depends on it. Raises as inverse_dynamics_derivative.
    """
    dynamics = _Dynamics(model)
    outputs = {
        ID: array((dynamics.n,), lambda a: dynamics.rows[a]),
        f"{ID}_q": dynamics.matrix(model.coordinates),
        f"{ID}_qd": dynamics.matrix([f"{name}'" for name in model.coordinates]),
    }
    return program(dynamics.graph, outputs, dynamics.symbols)


def forward_dynamics_derivative(
    model: Model, request: Mapping[str, Any], along: Mapping[str, Any], derivative: Program | None = None
) -> Array:
    """d(q'') of forward dynamics along a direction: g d(q'') = -dID, by a Cholesky factor of the metric.

    ``request``: ``q`` and ``qd``, (n,) or (N, n) or by coordinate name, ``parameters``, ``inputs``, ``t`` as for
    ``evaluate``. ``along``: ``q`` and ``qd`` (shapes as there) and ``inputs`` by name (a number, or one for each
    state), zero where not given. ``derivative``: the program of inverse_dynamics_derivative(model), so that many
    calls derive it once. Returns (n,) or (N, n) like ``q`` [rad/s^2, m/s^2 per unit of the direction]; NaN in states
    where the metric is not positive definite. Raises InvalidDocument (pointers into the request, or ``/along/...``)
    and MissingValue.
    """
    states = read_states(model, request, None)
    values = symbol_values(model, request, states, DYNAMICS)
    count = len(states.q)
    found = interpret_in_blocks(model.program, values, DYNAMICS, count)
    qdd = cholesky_solve(found["metric"], found["forces"] - found["bias"])
    values |= {f"{name}''": qdd[:, a] for a, name in enumerate(model.coordinates)}
    values |= _directions(model, along, states)
    source = inverse_dynamics_derivative(model) if derivative is None else derivative
    slope = interpret_in_blocks(source, values, [f"{ID}_derivative"], count)[f"{ID}_derivative"]
    result = cholesky_solve(found["metric"], -slope)
    return result[0] if states.single else result


def _directions(model: Model, along: Mapping[str, Any], states: States) -> dict[str, Any]:
    """Values of all symbols d.*; d(q'') is zero."""
    inputs = _names(model.program.symbols, "input")
    values: dict[str, Any] = {direction(name): 0.0 for name in inputs}
    for field, primes in (("q", ""), ("qd", "'"), ("", "''")):
        given = along.get(field) if field else None
        x = np.zeros_like(states.q) if given is None else _state(model, given, field, len(states.q))
        values |= {direction(f"{name}{primes}"): x[:, a] for a, name in enumerate(model.coordinates)}
    for name, value in (along.get("inputs") or {}).items():
        pointer = f"/along/inputs/{name}"
        if name not in inputs:
            raise InvalidDocument.at(pointer, "unknown-input", f"unknown input '{str(name)[:80]}'")
        number = numeric(value, pointer)
        if number.shape not in ((), (1,), (len(states.q),)):
            raise InvalidDocument.at(pointer, "wrong-length", "one number, or one for each state is needed")
        values[direction(name)] = np.broadcast_to(number, (len(states.q),))
    return values


def _names(symbols: Iterable[Symbol], kind: str) -> set[str]:
    return {s.name for s in symbols if s.kind == kind}


def _state(model: Model, given: Any, field: str, count: int) -> Array:
    """(N, n) of a direction, read like the states of a request."""
    try:
        x = read_states(model, {"q": given}, None).q
    except InvalidDocument as error:
        faults = [replace(f, pointer=f"/along/{field}" + f.pointer.removeprefix("/q")) for f in error.faults]
        raise InvalidDocument(faults) from None
    if len(x) not in (1, count):
        raise InvalidDocument.at(f"/along/{field}", "wrong-length", f"{len(x)} directions for {count} states")
    return np.broadcast_to(x, (count, model.dof))
