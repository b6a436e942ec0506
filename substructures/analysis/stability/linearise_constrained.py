"""Linearisation of a tree with velocity constraints B q' + b = 0 about a motion, in quasi-velocities v.

x = (q, v): q' = T v + r and g* v' + bias = forces give

    M dv' + D dv + K dq = F du,  dq' = T dv + R dq        A = [[R, T], [-M^-1 K, -M^-1 D]],  B = [[0], [M^-1 F]]

Coordinates on which nothing depends, but for rates of such coordinates, are ignorable: the place on the plane, the
heading, the angle of a wheel. A motion is steady where v' = 0 and all others rest: what is left of A is constant along
it, and its eigenvalues are those of the motion's neighbours that keep the gaps (E. J. Routh, Advanced Rigid Dynamics,
1884; J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, Proc. R. Soc. A 463, 2007, for the bicycle).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.equations.meetings import with_sides
from substructures.analysis.equations.nonholonomic.linearised import linearised
from substructures.analysis.equations.nonholonomic.positions import start_velocities
from substructures.analysis.equations.nonholonomic.quasi_velocities import Choice, QuasiVelocities
from substructures.analysis.motion.problems.kinds import ConstrainedMotion, require_constrained
from substructures.analysis.stability.linearisation_result import ConstrainedLinearisation
from substructures.analysis.stability.operating_point import OperatingPoint, fault_of
from substructures.analysis.stability.vibrations import NEUTRAL, Mode, Stability, normed, stability
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.document import require_ungiven

NEEDS = ("metric", "bias", "forces")
MATRICES = ("metric", "damping", "stiffness", "input", "residual", "T", "rates_by_position")
#: what rounding leaves of derivatives that are zero, of the largest of their kind
NOTHING = 1e-10
#: quasi-accelerations and rates of a steady motion, of what a unit change causes
STEADY = 1e-8
#: how far the fastest has moved where rates are compared [rad, m]
LATER = (0.37, 1.9, 4.3)
#: how far beside a steady motion others are looked for [rad, m, 1/s, ...], in how many steps, and what rounding leaves
BESIDE, STEPS, ROUNDED = 0.1, 40, 1e-12


def linearise_constrained(point: OperatingPoint, kind: ConstrainedMotion) -> ConstrainedLinearisation:
    """A, B, C, D, and M, D, K, F about one state ``q`` with quasi-velocities ``kind.v`` or velocities ``qd`` that meet
    the constraints, or at rest; ``modes`` and ``stability`` where the motion is steady. A state at which the velocities
    are not determined is ``failed``, with advice. Raises InvalidInput as quasi_velocity_equations, and MissingValue.
    """
    model = point.model
    require_constrained(kind)
    require_ungiven(model, "take the tree without 'driven'")
    values, chosen = values_at(point), point.chosen_inputs()
    place = {name: values[name] for name in model.coordinates}
    equations, matrices = linearised(model, tuple(kind.constraints), choice_of(kind, place))
    qd = None if point.qd is None else read_states(model, {"q": point.q, "qd": point.qd}, 1).qd[0]
    v = start_velocities(equations, values, qd, kind.v)
    values |= dict(zip(equations.velocities, v.tolist(), strict=True))
    found = interpret(equations.program, values, ["metric", "bias", "forces", "rates"])
    vd = _solved(found["metric"], found["forces"] - found["bias"])
    values |= {f"{name}'": x for name, x in zip(equations.velocities, vd.tolist(), strict=True)}
    values |= {f"{name}'": x for name, x in zip(model.coordinates, found["rates"].tolist(), strict=True)}
    _require_closed(equations, values)
    wanted = [*MATRICES, *(["gaps_by_position"] if equations.gaps else [])]
    moved = [*model.coordinates, *equations.velocities]
    result = with_sides(lambda at: interpret(matrices, at, wanted), values, moved)
    result["input"] = result["input"][:, [inputs_of(model).index(name) for name in chosen]]
    result["C"], result["Dy"] = (x[0] for x in point.output_matrices(chosen, values, 1))
    linear = _assembled(equations, (chosen, tuple(point.outputs)), result, (values, vd))
    message = fault_of([*model.coordinates, *equations.velocities], vd, linear.D, linear.K)
    if message:
        return replace(linear, status="failed", message=message)
    return _judged(linear, equations, matrices, values)


def values_at(point: OperatingPoint) -> dict[str, Any]:
    """Numbers of all symbols but velocities. Raises InvalidInput, MissingValue."""
    if point.qdd is not None:
        message = "the accelerations follow from the motion: leave 'qdd' out"
        raise InvalidArgument.at("/qdd", "not-supported", message)
    given = {"q": point.q, **point.conditions}
    states = read_states(point.model, given, None)
    if not states.single:
        message = f"{states.count} states: with velocity constraints it is one state 'q' of shape ({point.model.dof},)"
        raise InvalidArgument.at("/q", "one-state", message)
    found = symbol_values(point.model, given, states, NEEDS)
    return {name: float(np.ravel(x)[0]) for name, x in found.items()}


def choice_of(kind: ConstrainedMotion, place: Mapping[str, float]) -> Choice:
    """The velocities that are given, or those near a ``place``."""
    if kind.velocities is None and kind.independent is None:
        return None, None, tuple(place.items())
    velocities = None if kind.velocities is None else tuple(kind.velocities.items())
    return velocities, None if kind.independent is None else tuple(kind.independent), None


def _require_closed(equations: QuasiVelocities, values: Mapping[str, float]) -> None:
    """Raises InvalidArgument for a position that leaves a closure open."""
    rows = [f"{closure.name}.{row}" for closure in equations.model.closures for row in closure.rows]
    if not rows:
        return
    gaps = dict(zip(equations.gaps, interpret(equations.program, values, ["gaps"])["gaps"].tolist(), strict=True))
    worst = max((name for name in rows if name in gaps), key=lambda name: abs(gaps[name]), default=None)
    if worst is not None and abs(gaps[worst]) > STEADY:
        message = f"the closures are not met: '{worst}' is open by {gaps[worst]:.3g}; take a position of loop states"
        raise InvalidArgument.at("/q", "open-closure", message)


def _solved(M: Array, right: Array) -> Array:
    """M^-1 right; not finite where there is none."""
    try:
        return np.asarray(np.linalg.solve(M, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)


def _assembled(
    equations: QuasiVelocities,
    names: tuple[tuple[str, ...], tuple[str, ...]],
    found: Mapping[str, Array],
    state: tuple[Mapping[str, float], Array],
) -> ConstrainedLinearisation:
    """All matrices; ``names``: of inputs and outputs; ``state``: values of all symbols, and v'."""
    model, (values, vd) = equations.model, state
    n = model.dof
    M, D, K, F, T, R, C = (found[name] for name in (*MATRICES[:4], "T", "rates_by_position", "C"))
    lower = -_solved(M, np.hstack([K, D]))
    q, qd, v = (
        np.array([values[name] for name in some])
        for some in (model.coordinates, [f"{name}'" for name in model.coordinates], equations.velocities)
    )
    return ConstrainedLinearisation(
        model.coordinates,
        *names,
        *(M, D, K, F),
        A=np.vstack([np.hstack([R, T]), lower]),
        B=np.vstack([np.zeros((n, F.shape[1])), _solved(M, F)]),
        # y(q, q', u) with dq' = T dv + R dq
        C=np.hstack([C[:, :n] + C[:, n:] @ R, C[:, n:] @ T]),
        Dy=found["Dy"],
        qdd=T @ vd + R @ qd,
        residual=found["residual"],
        velocities=equations.velocities,
        constraints=equations.constraints,
        q=q,
        qd=qd,
        v=v,
        vd=vd,
        R=R,
        T=T,
        gaps=found.get("gaps_by_position", np.zeros((0, n))),
        ignorable=(),
    )


def _judged(
    linear: ConstrainedLinearisation, equations: QuasiVelocities, matrices: Program, values: Mapping[str, float]
) -> ConstrainedLinearisation:
    """With what is ignorable, and with modes and stability where the motion is steady."""
    order, _ = ignorable_coordinates(linear.coordinates, linear.velocities, matrices, values)
    names = tuple(linear.coordinates[a] for a in sorted(order))
    linear = replace(linear, ignorable=names)
    kept = np.setdiff1d(np.arange(len(linear.coordinates)), order)
    moves = np.abs(linear.vd) > STEADY * np.fmax(1.0, np.abs(linear.A[len(linear.q) :]).max(axis=1, initial=0))
    if "t" in matrices.needs(matrices.outputs) or moves.any() or (np.abs(linear.qd[kept]) > STEADY).any():
        return linear
    modes = _modes(linear, kept, order)
    found = stability(modes, linear.D, linear.K, has_potential=False)
    if found.verdict == "undecided":
        found = _beside_others(modes, found, _Neighbours(linear, equations, values, kept))
    varying = _varying(linear, matrices, values) if linear.qd.any() else ()
    return replace(linear, modes=modes, stability=found, varying=varying)


def _varying(linear: ConstrainedLinearisation, matrices: Program, values: Mapping[str, float]) -> tuple[str, ...]:
    """Coordinates whose rows of R and T are others where those lead that move."""
    changed, scale = np.zeros(len(linear.q)), float(np.abs(linear.qd).max())
    for t in LATER:
        there = dict(zip(linear.coordinates, (linear.q + linear.qd * (t / scale)).tolist(), strict=True))
        found = interpret(matrices, {**values, **there}, ["T", "rates_by_position"])
        for name, x in (("T", linear.T), ("rates_by_position", linear.R)):
            changed = np.fmax(changed, np.abs(found[name] - x).max(axis=1, initial=0) / (np.abs(x).max(initial=0) or 1))
    return tuple(name for name, x in zip(linear.coordinates, changed, strict=True) if x > STEADY)


def _beside_others(modes: tuple[Mode, ...], found: Stability, neighbours: _Neighbours) -> Stability:
    """Where some eigenvalues are 0 and all others have negative real parts, the motion is stable if as many parameters
    lead to other steady motions, and each disturbance ends in one of these (A. M. Lyapunov; I. G. Malkin, Theory of
    Stability of Motion, 1952, section 32).
    """
    scale = NEUTRAL * max((mode.frequency for mode in modes), default=0.0)
    zero = [mode for mode in modes if mode.frequency <= scale]
    damped = [mode for mode in modes if mode.eigenvalue.real < -scale]
    if not zero or len(zero) + len(damped) < len(modes):
        return found
    count = "one eigenvalue is" if len(zero) == 1 else f"{len(zero)} eigenvalues are"
    reason = f"{count} 0, all others have negative real parts"
    if neighbours.are_a_family(len(zero)):
        why = "as it belongs to steady motions of as many parameters, and disturbances end in these (Lyapunov, Malkin)"
        return Stability("stable", f"{reason}, {why}")
    return Stability("undecided", f"{reason}: terms of higher order decide")


@dataclass(frozen=True)
class _Neighbours:
    """Steady motions beside one: y = (coordinates that are not ignorable, v) with y' = 0 and the same gaps."""

    linear: ConstrainedLinearisation
    equations: QuasiVelocities
    values: Mapping[str, float]
    kept: NDArray[np.int64]

    def are_a_family(self, count: int) -> bool:
        """Whether there are such in all directions of the null space of dy'/dy, which has this dimension."""
        n, p = len(self.linear.q), len(self.linear.v)
        rest = np.concatenate((self.kept, np.arange(n, n + p)))
        gaps = self.linear.gaps
        still = np.hstack([gaps[:, self.kept], np.zeros((len(gaps), p))])
        J = np.vstack([self.linear.A[np.ix_(rest, rest)], still])
        ways = scipy.linalg.null_space(J, rcond=STEADY)
        if ways.shape[1] != count:
            return False
        back, start = np.linalg.pinv(J, rcond=STEADY), np.concatenate((self.linear.q[self.kept], self.linear.v))
        zero, limit = self._missing(start), ROUNDED * float(np.abs(J).max(initial=1))
        for way in [*ways.T, *(-ways.T), ways.sum(axis=1)]:
            # Newton's steps with the derivative at the start, across the null space
            y = start + BESIDE * way
            for _ in range(STEPS):
                left = self._missing(y) - zero
                if np.abs(left).max(initial=0) < limit:
                    break
                y = y - back @ left
            else:
                return False
        return True

    def _missing(self, y: Array) -> Array:
        """y' and the gaps."""
        names = [self.linear.coordinates[a] for a in self.kept]
        at = {**self.values, **dict(zip([*names, *self.equations.velocities], y.tolist(), strict=True))}
        wanted = ["metric", "bias", "forces", "rates", *(["gaps"] if self.equations.gaps else [])]
        found = interpret(self.equations.program, at, wanted)
        vd = _solved(found["metric"], found["forces"] - found["bias"])
        return np.concatenate([found["rates"][self.kept], vd, found.get("gaps", np.zeros(0))])


def ignorable_coordinates(
    coordinates: Sequence[str], velocities: Sequence[str], matrices: Program, values: Mapping[str, float]
) -> tuple[list[int], NDArray[np.bool_]]:
    """Coordinates in the order in which they can be left out: their derivatives are zero at states in general position,
    so everywhere, but in rates of those before them. And of which coordinates (columns) which rates (rows) depend.
    """
    rng, n = np.random.default_rng(5), len(coordinates)
    wanted = [name for name in ("stiffness", "rates_by_position", "gaps_by_position") if name in matrices.outputs]
    columns = np.zeros((0, n))
    moving = [*coordinates, *velocities, *(f"{name}'" for name in velocities)]
    places: list[NDArray[np.bool_]] = []
    for _ in range(2):
        at = {**values, **{name: values.get(name, 0.0) + rng.uniform(0.2, 0.6) for name in moving}}
        found = interpret(matrices, at, wanted)
        rates = found.pop("rates_by_position")
        places.append(np.abs(rates) > NOTHING * np.abs(rates).max(initial=0))
        columns = np.vstack([columns, *(x / (np.abs(x).max(initial=0) or 1.0) for x in found.values())])
    free = np.abs(columns).max(axis=0, initial=0) <= NOTHING
    moved, order = places[0] | places[1], list[int]()
    while True:
        rest = [a for a in range(n) if a not in order]
        more = [a for a in rest if free[a] and not moved[rest, a].any()]
        if not more:
            return order, moved
        order += more


def _modes(linear: ConstrainedLinearisation, kept: NDArray[np.int64], order: Sequence[int]) -> tuple[Mode, ...]:
    """Of the motions that keep the gaps, without coordinates that are ignorable; slowest first."""
    n, p, gaps = len(linear.q), len(linear.v), linear.gaps
    rest = np.concatenate((kept, np.arange(n, n + p)))
    # dq = N y with d(gaps) = 0, which A keeps
    N = scipy.linalg.block_diag(scipy.linalg.null_space(gaps[:, kept]) if len(gaps) else np.eye(len(kept)), np.eye(p))
    values, vectors = np.linalg.eig(N.T @ linear.A[np.ix_(rest, rest)] @ N)
    found = []
    scale = float(np.abs(values).max(initial=0)) or 1.0
    for value, vector in zip(values.tolist(), vectors.T, strict=True):
        z = complex(value.real, value.imag if abs(value.imag) > 1e-9 * scale else 0.0)
        if z.imag >= 0:
            shape = np.zeros(n + p, dtype=np.complex128)
            shape[rest] = N @ vector
            # lambda dq = R dq + T dv, the last that was left out first
            for a in reversed(order):
                shape[a] = linear.A[a] @ shape / z if abs(z) > 1e-9 * scale else 0.0
            found.append(Mode(z, normed(shape[:n])))
    return tuple(sorted(found, key=lambda mode: (abs(mode.eigenvalue), mode.eigenvalue.real)))
