"""Linearisation in numbers: M, D, K, A, B, C, D at a state, along a trajectory, and what follows at an equilibrium."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from substructures.analysis.expressions import read_expressions
from substructures.analysis.first_integrals import first_integrals
from substructures.analysis.formulas import inputs_of, require_tree
from substructures.analysis.perturbation import perturbation, require_inputs
from substructures.analysis.vibrations import Mode, Stability, first_order, modes, stability
from substructures.definition import Model as Document
from substructures.definition import Number, read_model
from substructures.errors import InvalidDocument
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.model import Model
from substructures.solve import cholesky_solve
from substructures.states import Array, States, read_states, symbol_values

DYNAMICS = ("metric", "bias", "forces")
#: accelerations of an equilibrium, relative to the accelerations that its forces would cause one by one
AT_REST = 1e-8
MATRICES = ("metric", "damping", "stiffness", "input", "residual")


class LinearisationRequest(Document):
    """A state, or states along a trajectory; ``qdd``: default that of the motion."""

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


def linearise(model: Model, request: Mapping[str, Any]) -> Linearisation:
    """Perturbation equations and state-space matrices about states of a model; ``request``: see LinearisationRequest.

    ``q`` (n,) or (N, n): arrays of the result have the leading axis N in the second case. Raises InvalidDocument
    (pointers; ``not-smooth`` for forces without derivative) and MissingValue.
    """
    require_tree(model)
    read = read_model(LinearisationRequest, request)
    states = read_states(model, {"q": read.q, "qd": read.qd, "qdd": read.qdd}, None)
    chosen = inputs_of(model) if read.of_inputs is None else read.of_inputs
    try:
        require_inputs(model, chosen)
    except InvalidDocument as error:
        moved = [replace(f, pointer=f.pointer.replace("/inputs", "/of_inputs")) for f in error.faults]
        raise InvalidDocument(moved) from None
    source = perturbation(model)
    given = {"parameters": read.parameters, "inputs": read.inputs, "t": read.t}
    values = symbol_values(model, given, states, DYNAMICS)
    qdd = _accelerations(model, values, states)
    values |= {f"{name}''": qdd[:, a] for a, name in enumerate(model.coordinates)}
    found = interpret_in_blocks(source, values, list(MATRICES), len(qdd))
    found["input"] = found["input"][:, :, [inputs_of(model).index(name) for name in chosen]]
    by_output = _outputs(model, read, chosen, values, len(qdd))
    result = _assembled(model, chosen, tuple(read.outputs), found, by_output, qdd)
    result = _checked(result)
    if not states.single:
        return result
    return _at_equilibrium(model, read, states, _single(result))


def _accelerations(model: Model, values: Mapping[str, Any], states: States) -> Array:
    if states.qdd is not None:
        return np.array(states.qdd)
    found = interpret_in_blocks(model.program, values, list(DYNAMICS), len(states.q))
    return cholesky_solve(found["metric"], found["forces"] - found["bias"])


def _outputs(
    model: Model, read: LinearisationRequest, chosen: Iterable[str], values: Mapping[str, Any], count: int
) -> tuple[Array, Array]:
    """C and D."""
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


def _assembled(
    model: Model,
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    found: Mapping[str, Array],
    by_output: tuple[Array, Array],
    qdd: Array,
) -> Linearisation:
    M, D, K, F = (found[name] for name in ("metric", "damping", "stiffness", "input"))
    pairs = []
    for m, d, k, f in zip(M, D, K, F, strict=True):
        try:
            pairs.append((first_order(m, d, k), np.vstack([np.zeros_like(f), np.linalg.solve(m, f)])))
        except np.linalg.LinAlgError:
            n = len(m)
            pairs.append((np.full((2 * n, 2 * n), np.nan), np.full((2 * n, f.shape[1]), np.nan)))
    A, B = np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])
    return Linearisation(model.coordinates, inputs, outputs, M, D, K, F, A, B, *by_output, qdd, found["residual"])


def _checked(result: Linearisation) -> Linearisation:
    """What is not finite is told with its place and what to change."""
    if not np.isfinite(result.qdd).all():
        message = "the metric is singular or not positive definite here: change masses, inertias or the state"
        return replace(result, status="failed", message=message)
    for matrix, by in ((result.D, "the velocity of"), (result.K, "")):
        bad = np.argwhere(~np.isfinite(matrix))
        if len(bad):
            _, a, b = bad[0]
            message = (
                f"the derivative of the force on '{result.coordinates[a]}' by {by} '{result.coordinates[b]}' is not "
                "finite here: a load has a root or a quotient at zero; add a small number under the root, or move the "
                "state away from there"
            )
            return replace(result, status="failed", message=" ".join(message.split()))
    return result


def _single(result: Linearisation) -> Linearisation:
    names = ("M", "D", "K", "F", "A", "B", "C", "Dy", "qdd", "residual")
    return replace(result, **{name: getattr(result, name)[0] for name in names})


def _at_equilibrium(model: Model, read: LinearisationRequest, states: States, result: Linearisation) -> Linearisation:
    still = not states.qd.any() and result.status == "finished"
    if not still or not is_small(result.qdd, result.K, result.M):
        return result
    if not is_small(np.linalg.solve(result.M, result.residual), result.K, result.M):
        return result
    found = modes(result.M, result.D, result.K)
    return replace(result, modes=found, stability=stability(found, result.D, result.K, has_potential(model, read)))


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
    found = first_integrals(model, driven, zero)
    return any(i.kind == "energy" and i.rule in ("constant", "falling") for i in found.integrals)
