"""What a model is linearised about, and what linearisations of trees and of closed loops share: columns of inputs,
rows of outputs, faults, and whether a state is at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, ctx
from numpy.typing import NDArray

from substructures.analysis.arguments import NumberOrExpression, by_name, exact, real
from substructures.analysis.equations.energy import has_even_dissipation
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.given import StateArray, numbers, require_known
from substructures.array import Array
from substructures.certificate.stored import operations_in_balls
from substructures.expr.differentiate import gradient, in_directions
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.model import Model

#: accelerations of an equilibrium, relative to the accelerations that its forces would cause one by one
AT_REST = 1e-8
#: bits of doubles
DOUBLE = 53
#: outputs of the perturbation equations
MATRICES = ("metric", "damping", "stiffness", "input", "residual")


@dataclass(frozen=True)
class OperatingPoint:
    """The arguments of :func:`substructures.analysis.stability.linearise.linearise`."""

    model: Model
    q: StateArray
    qd: StateArray | None
    qdd: StateArray | None
    t: Any
    parameters: Mapping[str, Any]
    inputs: Mapping[str, Any]
    outputs: Mapping[str, NumberOrExpression]
    of_inputs: Sequence[str] | None

    @property
    def conditions(self) -> dict[str, Any]:
        """What holds beside the state."""
        return {"parameters": self.parameters, "inputs": self.inputs, "t": self.t}

    def chosen_inputs(self) -> tuple[str, ...]:
        """The columns of B and D. Raises InvalidArgument (``/of_inputs/i``)."""
        known = inputs_of(self.model)
        if self.of_inputs is None:
            return known
        require_known("of_inputs", "input", self.of_inputs, known)
        return tuple(self.of_inputs)

    def output_matrices(self, chosen: tuple[str, ...], values: Mapping[str, Any], count: int) -> tuple[Array, Array]:
        """C (N, k, 2n) and D (N, k, m) in all coordinates and velocities. Raises InvalidInput (``/outputs/y``)."""
        named = by_name(self.outputs, "outputs").items()
        given = [(exact(x, f"/outputs/{name}"), f"/outputs/{name}") for name, x in named]
        y = read_expressions(self.model, {"output": given}, inputs=True)
        found = interpret_in_blocks(output_jacobian(self.model, y, chosen), values, ["C", "D"], count)
        return found["C"], found["D"]

    def has_potential(self, values: Mapping[str, Any]) -> bool:
        """Whether the forces have a potential near the state, but for dampers that are linear in the velocities and
        even; ``values``: of all symbols there."""
        # a constant actuator force has one, too: V = -tau_a q^a
        driven = [name for name, value in self.inputs.items() if np.any(value) and not name.startswith("tau.")]
        zero = [name for name, value in self.parameters.items() if not np.any(value)]
        at = {name: float(np.ravel(x)[0]) for name, x in values.items()}
        return has_even_dissipation(self.model, at, driven, zero)


@dataclass(frozen=True)
class RestConditions:
    """What holds at rest: the time [s], ``parameters`` in place of their defaults, constant ``inputs`` [N m, N].

    Raises InvalidArgument.
    """

    t: float
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "t", real(self.t, "/t"))
        object.__setattr__(self, "parameters", numbers(self.parameters, "parameters"))
        object.__setattr__(self, "inputs", numbers(self.inputs, "inputs"))


def output_jacobian(model: Model, source: Program, inputs: tuple[str, ...]) -> Program:
    """C (k, 2n) = dy/d(q, q') and D (k, m) = dy/du of the output ``output`` (k,); of ball joints by displacements."""
    workspace = Workspace(model)
    graph, k, m = workspace.graph, source.outputs["output"].shape[0], len(inputs)
    entries = replay(source, graph, {})["output"].entries
    rows = [x if isinstance(x := entries.get((i,), graph.zero), Expr) else graph.number(x) for i in range(k)]
    states = [*workspace.displacements, *({f"{name}'": graph.one} for name in model.coordinates)]
    C, D = in_directions(rows, states), gradient(rows, inputs)
    outputs = {
        "C": array((k, len(states)), lambda i, j: C[i][j]),
        "D": array((k, m), lambda i, j: D[i][j]),
    }
    return program(graph, outputs, {s.name: s for s in source.symbols} | workspace.symbols)


def fault_of(coordinates: Sequence[str], qdd: Array, D: Array, K: Array, A: Array | None = None) -> str:
    """What is not finite, with its place and what to change; else nothing. Leading axes of states are allowed; ``A``:
    of first order, not finite where M has no inverse.
    """
    if not np.isfinite(qdd).all():
        return (
            "the accelerations are not finite here: the metric is singular or not positive definite, or numbers "
            "overflow (beyond 1.8e308); change masses, inertias or the state"
        )
    for matrix, by in ((D, "the velocity of "), (K, "")):
        bad = np.argwhere(~np.isfinite(matrix))
        if len(bad):
            *_, a, b = bad[0]
            return (
                f"the derivative of the force on '{coordinates[a]}' by {by}'{coordinates[b]}' is not finite here: a "
                "load has a root or a quotient at zero; add a small number under the root, or move the state away from "
                "there"
            )
    if A is not None and not np.isfinite(A).all():
        return (
            "the metric is singular here, up to rounding: a motion of the coordinates moves no mass (axes meet, or "
            "bodies have no inertia); add rotor inertias, or move the state away from there"
        )
    return ""


def rounding(source: Program, values: Mapping[str, Any], names: Sequence[str]) -> dict[str, Array]:
    """What rounding may make of outputs at one state: radii of balls (F. Johansson, Arb, 2017) at the precision of
    doubles, twice for that of decimals.
    """
    some = source.select(list(names))
    with ctx.workprec(DOUBLE):
        given = {symbol.name: arb(float(np.ravel(values[symbol.name])[0])) for symbol in some.symbols}
        radii = [2 * float(x.rad()) for x in operations_in_balls(some, given)]
    found = {name: np.zeros(output.shape) for name, output in some.outputs.items()}
    for name, output in some.outputs.items():
        for index, entry in zip(output.index, output.entries, strict=True):
            found[name][tuple(index)] = radii[entry]
    return found


def forces_that_are(source: Program, values: Mapping[str, Any], sizes: Array, length: Array) -> Array:
    """Sizes (n,) of forces, or of their changes over a ``length`` of each coordinate (m,); 0 where all accelerate
    hardly and are nothing but rounding at a place in general position. ``source``: the perturbation equations.
    """
    if (sizes > AT_REST * np.diag(interpret(source, values, ["metric"])["metric"])).any():
        return sizes
    noise = rounding(source, values, ["residual", "stiffness"])
    far = float(length.max(initial=0))
    most = np.column_stack((noise["residual"], noise["stiffness"] * far)).max(axis=1, initial=0)
    return sizes if (sizes > most).any() else np.zeros_like(sizes)


def is_small(qdd: NDArray[Any], K: Array, M: Array) -> bool:
    """Accelerations that are rounding: each below 1e-8 of what a unit displacement causes there (or of 1)."""
    return bool((np.abs(qdd) <= AT_REST * unit_accelerations(K, M)).all())


def unit_accelerations(K: Array, M: Array) -> Array:
    """Of each coordinate the largest acceleration that a unit displacement of any causes, or 1, (r,)."""
    # max(1, |M^-1 K|) by rows: what is stiff elsewhere excuses nothing here
    return np.asarray(np.fmax(1.0, np.abs(np.linalg.solve(M, K)).max(axis=1, initial=0)), dtype=np.float64)
