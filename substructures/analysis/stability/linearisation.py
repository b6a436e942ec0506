"""What linearisations of trees and of closed loops share: the request, the result, outputs, faults, and judgements."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from substructures.analysis.equations.energy import energy_rule
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.equations.perturbation import require_inputs
from substructures.analysis.stability.vibrations import Mode, Stability
from substructures.array import Array
from substructures.documents import DocumentPart
from substructures.documents.fields import Number
from substructures.errors import InvalidInput
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.tree.model import Model

#: accelerations of an equilibrium, relative to the accelerations that its forces would cause one by one
AT_REST = 1e-8
MATRICES = ("metric", "damping", "stiffness", "input", "residual")


class LinearisationRequest(DocumentPart):
    """A state, or states along a trajectory; ``qdd``: default that of the motion.

    With closures one state, which is moved onto them, and no ``qdd``.
    """

    q: Any
    qd: Any = None
    qdd: Any = None
    t: Any = 0
    parameters: dict[str, Any] = Field({}, description="in place of their defaults; numbers, or one for each state")
    inputs: dict[str, Any] = Field({}, description="about which is linearised, 0 by default; or one for each state")
    outputs: dict[str, Number] = Field({}, max_length=1000, description="y: expressions in q, q', inputs and t")
    of_inputs: tuple[str, ...] | None = Field(None, description="columns of B and D; default all inputs")


@dataclass(frozen=True)
class Linearisation:
    """M dq'' + D dq' + K dq = F du and dx' = A dx + B du, dy = C dx + Dy du, x = (q, q'), at one state or (N, ...).

    ``residual``: g q'' + Gamma q' q' - Q. ``status`` ``failed``: ``message`` says what to change, and the matrices
    are not finite. At an equilibrium (one state, q' = q'' = 0, residual 0) also ``modes`` and ``stability``.
    """

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    M: Array
    D: Array
    K: Array
    F: Array
    A: Array
    B: Array
    C: Array
    Dy: Array
    qdd: Array
    residual: Array
    modes: tuple[Mode, ...] = ()
    stability: Stability | None = None
    status: str = "finished"
    message: str = ""

    @property
    def is_equilibrium(self) -> bool:
        """Whether modes and stability were found."""
        return self.stability is not None

    def summary(self) -> dict[str, Any]:
        """As plain data."""
        names = ("M", "D", "K", "F", "A", "B", "C", "Dy", "qdd", "residual")
        verdict = None if self.stability is None else vars(self.stability)
        return {
            "coordinates": list(self.coordinates),
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            **{name: getattr(self, name) for name in names},
            "is_equilibrium": self.is_equilibrium,
            "modes": [mode.plain() for mode in self.modes],
            "stability": verdict,
            "status": self.status,
            "message": self.message,
        }


def chosen_inputs(model: Model, read: LinearisationRequest) -> tuple[str, ...]:
    """The columns of B and D. Raises InvalidDocument (``/of_inputs/i``)."""
    chosen = inputs_of(model) if read.of_inputs is None else read.of_inputs
    try:
        require_inputs(model, chosen)
    except InvalidInput as error:
        raise error.moved(lambda pointer: pointer.replace("/inputs", "/of_inputs")) from None
    return chosen


def output_matrices(
    model: Model, read: LinearisationRequest, chosen: Iterable[str], values: Mapping[str, Any], count: int
) -> tuple[Array, Array]:
    """C (N, k, 2n) and D (N, k, m) in all coordinates and velocities."""
    given = [(x, f"/outputs/{name}") for name, x in read.outputs.items()]
    source = output_jacobian(model, read_expressions(model, {"output": given}, inputs=True), tuple(chosen))
    found = interpret_in_blocks(source, values, ["C", "D"], count)
    return found["C"], found["D"]


def output_jacobian(model: Model, source: Program, inputs: tuple[str, ...]) -> Program:
    """C (k, 2n) and D (k, m) of the output ``output`` (k,)."""
    graph = Graph()
    k, m = source.outputs["output"].shape[0], len(inputs)
    entries = replay(source, graph, {})["output"].entries
    rows = [x if isinstance(x := entries.get((i,), graph.zero), Expr) else graph.number(x) for i in range(k)]
    names = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    C, D = gradient(rows, names), gradient(rows, inputs)
    outputs = {
        "C": array((k, len(names)), lambda i, j: C[i][j]),
        "D": array((k, m), lambda i, j: D[i][j]),
    }
    return program(graph, outputs, {s.name: s for s in source.symbols})


def fault_of(coordinates: Sequence[str], qdd: Array, D: Array, K: Array) -> str:
    """What is not finite, with its place and what to change; else nothing. Leading axes of states are allowed."""
    if not np.isfinite(qdd).all():
        return "the metric is singular or not positive definite here: change masses, inertias or the state"
    for matrix, by in ((D, "the velocity of "), (K, "")):
        bad = np.argwhere(~np.isfinite(matrix))
        if len(bad):
            *_, a, b = bad[0]
            return (
                f"the derivative of the force on '{coordinates[a]}' by {by}'{coordinates[b]}' is not finite here: a "
                "load has a root or a quotient at zero; add a small number under the root, or move the state away from "
                "there"
            )
    return ""


def is_small(qdd: NDArray[Any], K: Array, M: Array) -> bool:
    """Accelerations that are rounding: below 1e-8 of what a unit displacement causes (or of 1)."""
    scale = max(1.0, float(np.abs(np.linalg.solve(M, K)).max(initial=0)))
    return bool(np.abs(qdd).max(initial=0) <= AT_REST * scale)


def has_potential(model: Model, read: LinearisationRequest) -> bool:
    """Whether the forces have a potential, but for dampers that are linear in the velocities.

    A constant actuator force tau_a has one, too: -tau_a q^a.
    """
    driven = [name for name, value in read.inputs.items() if np.any(value) and not name.startswith("tau.")]
    zero = [name for name, value in read.parameters.items() if not np.any(value)]
    return energy_rule(model, driven, zero) in ("constant", "falling")
