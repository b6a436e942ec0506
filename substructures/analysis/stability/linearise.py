"""Linearisation of a model in numbers: of open trees here, of closed loops by :mod:`.linearise_closed`, with velocity
constraints by :mod:`.linearise_constrained`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.analysis.arguments import NumberOrExpression
from substructures.analysis.equations.formulas import inputs_of, require_moving, unsteady
from substructures.analysis.equations.meetings import with_sides
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.given import StateArray
from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.problems.kinds import ConstrainedMotion
from substructures.analysis.stability.linearisation_result import BallLinearisation, Linearisation
from substructures.analysis.stability.linearise_closed import linearise_closed
from substructures.analysis.stability.linearise_constrained import linearise_constrained
from substructures.analysis.stability.operating_point import (
    AT_REST,
    MATRICES,
    OperatingPoint,
    fault_of,
    is_small,
    rounding,
)
from substructures.analysis.stability.vibrations import DIRICHLET, ROUTH, first_order, input_matrix, modes, stability
from substructures.array import Array
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.mechanics.accelerations import cholesky_solve
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.quantities.numbers.quaternions import moved_on
from substructures.quantities.numbers.states import States, read_states, symbol_values
from substructures.tree.model import Model

DYNAMICS = ("metric", "bias", "forces")
#: R of dq' = dv + R dq of ball joints
TURNING = "rates_by_position"
#: turns [rad] after which matrices are compared, and how much of them may change along a steady motion
LATER, STEADY = (0.37, 1.9, 4.3), 1e-9


def linearise(
    model: Model,
    q: StateArray,
    *,
    qd: StateArray | None = None,
    qdd: StateArray | None = None,
    t: float | Sequence[float] | Array = 0,
    parameters: Mapping[str, Any] | None = None,
    inputs: Mapping[str, Any] | None = None,
    outputs: Mapping[str, NumberOrExpression] | None = None,
    of_inputs: Sequence[str] | None = None,
    kind: ConstrainedMotion | None = None,
) -> Linearisation:
    """Perturbation equations and state-space matrices of a model about a state, or states along a trajectory.

        M dq'' + D dq' + K dq = F du        dx' = A dx + B du,  dy = C dx + Dy du,  x = (q, q')

    ``q``, ``qd``, ``qdd`` (n,) or (N, n), or by coordinate [rad, m, s]; ``qd`` is 0 by default, ``qdd`` that of the
    motion. ``t`` [s], ``parameters`` (in place of their defaults) and ``inputs`` [N m, N] (their defaults, or 0): one
    number, or (N,). ``outputs``: y by name, expressions in q, q', inputs, parameters and t; ``of_inputs``: the columns
    of B and D (default all). With ball joints a BallLinearisation, with closures a ClosedLinearisation (of the closed
    state nearest to one); ``kind``: velocity constraints (the tree's); ConstrainedLinearisation, one motion.

    Numerical failures (a singular metric, loops that cannot be closed) are results with status ``failed`` and advice.
    Raises InvalidInput (``/q``, ``/outputs/y``, ``/of_inputs/i``, ...; ``not-smooth`` for forces without derivative)
    and MissingValue. Source: P. C. Mueller and W. O. Schiehlen, Linear Vibrations, 1985; notation.md, section 7.

    >>> from substructures import couple, derive
    >>> tree = {"name": "c", "gravity": [0, 0, -9.81], "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
    >>> hanging = linearise(couple(tree, {"p": derive("simple-pendulum")}), [0.0])
    >>> float(hanging.K[0, 0]), hanging.stability.verdict
    (9.81, 'stable')
    """
    require_moving(model)
    given = with_input_defaults(model.inputs, inputs or {})
    point = OperatingPoint(model, q, qd, qdd, t, parameters or {}, given, outputs or {}, of_inputs)
    if kind is not None or model.velocity_constraints:
        return linearise_constrained(point, kind or ConstrainedMotion(constraints_of(model)))
    return linearise_closed(point) if model.closures else _linearise_tree(point)


def _linearise_tree(point: OperatingPoint) -> Linearisation:
    """M, D, K, F of a tree without closures, and A, B, C, D."""
    model = point.model
    states = read_states(model, {"q": point.q, "qd": point.qd, "qdd": point.qdd}, None)
    chosen = point.chosen_inputs()
    source = perturbation(model)
    values = symbol_values(model, point.conditions, states, DYNAMICS)
    qdd = _accelerations(model, values, states)
    # M, D, K, F and the residual at (q, q', q'', u, t)
    values |= {f"{name}''": qdd[:, a] for a, name in enumerate(model.coordinates)}
    moved, wanted = state_names(model), [name for name in (*MATRICES, TURNING) if name in source.outputs]
    found = with_sides(lambda at: interpret_in_blocks(source, at, wanted, len(qdd)), values, moved)
    found["input"] = found["input"][:, :, [inputs_of(model).index(name) for name in chosen]]
    by_output = point.output_matrices(chosen, values, len(qdd))
    result = _assembled(model, (chosen, tuple(point.outputs)), found, by_output, qdd)
    if isinstance(result, BallLinearisation):
        result = replace(result, qd=np.broadcast_to(states.qd, qdd.shape))
    message = fault_of(model.coordinates, result.qdd, result.D, result.K, result.A)
    if message:
        result = replace(result, status="failed", message=message)
    return _judged(point, states, _single(result), values) if states.single else result


def _accelerations(model: Model, values: Mapping[str, Any], states: States) -> Array:
    if states.qdd is not None:
        return np.array(np.broadcast_to(states.qdd, (states.count, model.dof)))
    found = interpret_in_blocks(model.program, values, list(DYNAMICS), states.count)
    # g q'' = Q - Gamma q' q'
    return cholesky_solve(found["metric"], found["forces"] - found["bias"])


def _assembled(
    model: Model,
    names: tuple[tuple[str, ...], tuple[str, ...]],
    found: Mapping[str, Array],
    by_output: tuple[Array, Array],
    qdd: Array,
) -> Linearisation:
    """All matrices, states first; ``names``: of inputs and outputs."""
    M, D, K, F = (found[name] for name in ("metric", "damping", "stiffness", "input"))
    R = found.get(TURNING, np.zeros_like(M))
    pairs = []
    for m, d, k, f, r in zip(M, D, K, F, R, strict=True):
        try:
            pairs.append((first_order(m, d, k, r), input_matrix(m, f)))
        except np.linalg.LinAlgError:  # M^-1 does not exist: a failure, told below
            n = len(m)
            pairs.append((np.full((2 * n, 2 * n), np.nan), np.full((2 * n, f.shape[1]), np.nan)))
    A, B = np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])
    fields = model.coordinates, *names, M, D, K, F, A, B, *by_output, qdd, found["residual"]
    return (
        BallLinearisation(*fields, positions=model.positions, R=R, qd=np.zeros_like(qdd))
        if TURNING in found
        else Linearisation(*fields)
    )


def _single(result: Linearisation) -> Linearisation:
    names = ("M", "D", "K", "F", "A", "B", "C", "Dy", "qdd", "residual", "R", "qd")
    return replace(result, **{name: getattr(result, name)[0] for name in names if hasattr(result, name)})


def _judged(point: OperatingPoint, states: States, result: Linearisation, values: Mapping[str, Any]) -> Linearisation:
    """With modes and stability where the state is an equilibrium, with ball joints also where its motion is steady."""
    is_moving = states.qd.any()
    if result.status == "failed" or (is_moving and not isinstance(result, BallLinearisation)):
        return result
    if not is_small(result.qdd, result.K, result.M) or unsteady(point.model, point.inputs):
        return result
    # a given q'' = 0 is an equilibrium only where M^-1 (g q'' + Gamma q' q' - Q) vanishes, too
    if not is_small(np.linalg.solve(result.M, result.residual), result.K, result.M):
        return result
    if isinstance(result, BallLinearisation) and is_moving:
        if not _is_constant(point.model, result, states.q[0], values):
            return result
        found = modes(result.M, result.D, result.K, result.R)
        return replace(result, modes=found, stability=stability(found, result.D, result.K, has_potential=False))
    K, minimum = _without_rounding(point.model, result, values), ROUTH if point.model.ignored else DIRICHLET
    found = modes(result.M, result.D, K)
    told = stability(found, result.D, K, point.has_potential(values), minimum)
    return replace(result, modes=found, stability=told)


def _without_rounding(model: Model, result: Linearisation, values: Mapping[str, Any]) -> Array:
    """K, with zeros for what is nothing but rounding in coordinates that hardly anything draws back."""
    rows = np.abs(np.linalg.solve(result.M, result.K)).max(axis=1, initial=0)
    if not ((rows > 0) & (rows <= AT_REST)).any():
        return result.K
    noise = rounding(perturbation(model), values, ["stiffness"])["stiffness"]
    return np.where(np.abs(result.K) <= noise, 0.0, result.K)


def _is_constant(model: Model, result: BallLinearisation, q: Array, values: Mapping[str, Any]) -> bool:
    """Whether M, D, K and what is left over are the same wherever constant rates lead, as they are at states in general
    position there.
    """
    source, scale = perturbation(model), float(np.abs(result.qd).max())
    # M w^2, D w, K and residuals are of one size
    size = max(float(np.abs(x).max()) for x in (result.M * scale**2, result.D * scale, result.K))
    parts = {"metric": (result.M, scale**2), "damping": (result.D, scale)}
    parts |= {"stiffness": (result.K, 1.0), "residual": (result.residual, 1.0)}
    if "t" in source.needs(parts):
        return False
    for t in LATER:
        place = moved_on(model.positions, model.coordinates, model.balls, q, result.qd * (t / scale))
        there = {**values, **dict(zip(model.positions, place.tolist(), strict=True))}
        found = interpret(source, {name: float(np.ravel(x)[0]) for name, x in there.items()}, list(parts))
        if any(np.abs(found[name] - x).max() * unit > STEADY * size for name, (x, unit) in parts.items()):
            return False
    return True
