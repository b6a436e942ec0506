"""Linearisation of a tree with closures in independent coordinates y, where the others follow from G q' = 0.

Variations that keep the closures are dq = N dy with G N = 0 and N = 1 in the rows of y. Along the motion that begins in
the state also G N' = -G' N and G N'' = -G'' N - 2 G' N', with N' = N'' = 0 in the rows of y, so that
dq' = N dy' + N' dy and dq'' = N dy'' + 2 N' dy' + N'' dy. Because N^T G^T = 0 the variation of the multipliers leaves
the perturbation equations (see :mod:`substructures.analysis.equations.perturbation`), and

    N^T M N dy'' + N^T (D N + 2 M N') dy' + N^T (K N + D N' + M N'') dy = N^T F du

which at rest is N^T M N, N^T D N, N^T K N with K = -dQ/dq - lambda_k d2phi_k. Where closures depend on each other, any
multipliers that balance the state give the same. y is chosen by pivots of G (R. A. Wehage and E. J. Haug, ASME J. Mech.
Design 104, 1982).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import SINGULAR, Constrained, Singular
from substructures.analysis.closed.loops import independent_coordinates, least_multipliers, mobility
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.equations.formulas import inputs_of, multipliers_of
from substructures.analysis.equations.meetings import with_sides
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.stability.linearisation_result import ClosedLinearisation
from substructures.analysis.stability.operating_point import MATRICES, OperatingPoint, fault_of, is_small
from substructures.analysis.stability.vibrations import first_order, input_matrix, modes, normed, stability
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.mechanics.accelerations import condition
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.document import require_undriven

NEEDS = ("metric", "bias", "forces", "closure.residual", "closure.jacobian", "closure.acceleration")
ALONG = ("closure.jacobian", "closure.jacobian_rate", "closure.jacobian_second")


def linearise_closed(point: OperatingPoint) -> ClosedLinearisation:
    """Perturbation equations and state-space matrices about the closed state nearest to the given one.

    The point is one state ``q`` (n,), at rest or moving as the equations of motion say. x = (y, y'). At an equilibrium
    also ``modes`` and ``stability``. Loops that cannot be closed and singular positions are ``failed``, with advice.
    Raises InvalidInput (``one-state`` for a trajectory, ``not-smooth``) and MissingValue.
    """
    require_undriven(point.model.driven, "take simulations, or loop states")
    model, values = point.model, _values(point)
    chosen = point.chosen_inputs()
    s = _constrained(point, values)
    state = consistent_state(s, values["t"], s.conditions.q, s.conditions.qd)
    place = mobility(s, values["t"], state.q)
    message = state.message or ("the position is singular: " + SINGULAR if place.singular else "")
    s.move(values["t"], state.q, state.qd)
    qdd, multipliers = np.full(s.n, np.nan), np.full(len(s.labels), np.nan)
    try:
        qdd, _ = s.accelerations(s.independent_rows())
        # G^T lambda = g q'' + Gamma q' q' - Q
        multipliers = least_multipliers(s, qdd)
    except Singular as error:
        message = message or str(error)
    _put(s, values, qdd, multipliers)
    moved = [f"{name}{prime}" for name in model.coordinates for prime in ("", "'")]
    found = with_sides(lambda at: interpret(perturbation(model), at, [*MATRICES, *ALONG]), values, moved)
    message = message or fault_of(model.coordinates, qdd, found["damping"], found["stiffness"])
    found["input"] = found["input"][:, [inputs_of(model).index(name) for name in chosen]]
    found["C"], found["Dy"] = (x[0] for x in point.output_matrices(chosen, values, 1))
    result = _reduced(s, found, (chosen, tuple(point.outputs)), qdd, multipliers)
    return _failed(result, message) if message else _judged(point, result, values)


def _values(point: OperatingPoint) -> dict[str, float]:
    """Numbers of all symbols. Raises InvalidInput, MissingValue."""
    model = point.model
    if point.qdd is not None:
        message = "the accelerations of closed loops follow from their motion: leave 'qdd' out"
        raise InvalidArgument.at("/qdd", "not-supported", message)
    given = {"q": point.q, "qd": point.qd, **point.conditions}
    states = read_states(model, given, None)
    if not states.single:
        message = f"{states.count} states: closed loops are linearised about one state 'q' of shape ({model.dof},)"
        raise InvalidArgument.at("/q", "one-state", message)
    found = symbol_values(model, given, states, NEEDS)
    return {name: float(np.ravel(x)[0]) for name, x in found.items()}


def _constrained(point: OperatingPoint, values: Mapping[str, float]) -> Constrained:
    q, qd = ([values[f"{name}{prime}"] for name in point.model.coordinates] for prime in ("", "'"))
    parameters, inputs = ({name: values[name] for name in given} for given in (point.parameters, point.inputs))
    return Constrained(point.model, Start(q, qd, parameters, inputs), (values["t"], values["t"]))


def _put(s: Constrained, values: dict[str, float], qdd: Array, multipliers: Array) -> None:
    """The state where s is, its accelerations and multipliers among the values."""
    for prime, numbers in (("", s.q), ("'", s.qd), ("''", qdd)):
        values |= {f"{name}{prime}": float(x) for name, x in zip(s.model.coordinates, numbers, strict=True)}
    values |= dict(zip(multipliers_of(s.model), multipliers.tolist(), strict=True))


def _reduced(
    s: Constrained,
    found: Mapping[str, Array],
    names: tuple[tuple[str, ...], tuple[str, ...]],
    qdd: Array,
    multipliers: Array,
) -> ClosedLinearisation:
    """Everything at the state where s is, in independent coordinates; ``names``: of inputs and outputs."""
    coordinates, n = s.model.coordinates, s.n
    M, D, K, F, C = (found[name] for name in ("metric", "damping", "stiffness", "input", "C"))
    # dq = N dy by the pivots of G
    y = independent_coordinates(s.balanced)
    N, rate, second = _tangent(s.independent_rows(), y, *(found[name] for name in ALONG))
    with np.errstate(invalid="ignore"):
        # of dy'', du, dy' and dy in the equation above
        m, f = N.T @ M @ N, N.T @ F
        d, k = N.T @ (D @ N + 2 * M @ rate), N.T @ (K @ N + D @ rate + M @ second)
        # C_q dq + C_q' dq' with dq = N dy, dq' = N dy' + N' dy
        output = np.hstack([C[:, :n] @ N + C[:, n:] @ rate, C[:, n:] @ N])
    return ClosedLinearisation(
        coordinates,
        *names,
        *(m, d, k, f),
        *_state_space(m, d, k, f),
        *(output, found["Dy"], qdd, found["residual"]),
        independent=tuple(coordinates[a] for a in y),
        constraints=s.labels,
        q=s.q,
        qd=s.qd,
        tangent=N,
        multipliers=multipliers,
    )


def _tangent(
    rows: NDArray[np.int64], y: NDArray[np.int64], G: Array, rate: Array, second: Array
) -> tuple[Array, Array, Array]:
    """N, N', N'' (n, r) (notation.md, section 10)."""
    n = G.shape[1]
    others = np.setdiff1d(np.arange(n), y)
    G, rate, second = G[rows], rate[rows], second[rows]
    N, N1, N2 = (np.zeros((n, len(y))) for _ in range(3))
    # G_z N_z = -G_y,  G_z N'_z = -G' N,  G_z N''_z = -G'' N - 2 G' N'  for the other coordinates z
    N[y] = np.eye(len(y))
    N[others] = -np.linalg.solve(G[:, others], G[:, y])
    N1[others] = -np.linalg.solve(G[:, others], rate @ N)
    N2[others] = -np.linalg.solve(G[:, others], second @ N + 2 * rate @ N1)
    return N, N1, N2


def _state_space(M: Array, D: Array, K: Array, F: Array) -> tuple[Array, Array]:
    r = len(M)
    regular = r == 0 or condition(M[None])[0] < 1 / (r * np.finfo(float).eps)
    if not np.isfinite([x.sum() for x in (M, D, K, F)]).all() or not regular:
        return np.full((2 * r, 2 * r), np.nan), np.full((2 * r, F.shape[1]), np.nan)
    return first_order(M, D, K), input_matrix(M, F)


def _failed(result: ClosedLinearisation, message: str) -> ClosedLinearisation:
    """Matrices that are not finite, and the advice."""
    names = ("M", "D", "K", "F", "A", "B", "C", "Dy", "tangent")
    nothing: dict[str, Any] = {name: np.full_like(getattr(result, name), np.nan) for name in names}
    return replace(result, status="failed", message=message, **nothing)


def _judged(point: OperatingPoint, result: ClosedLinearisation, values: Mapping[str, float]) -> ClosedLinearisation:
    """With modes and stability where the closed state is an equilibrium."""
    moving = [result.coordinates.index(name) for name in result.independent]
    if result.qd.any() or not is_small(result.qdd[moving], result.K, result.M):
        return result
    # shapes in all coordinates: dq = N dy
    found = tuple(
        replace(mode, shape=normed(result.tangent @ mode.shape)) for mode in modes(result.M, result.D, result.K)
    )
    return replace(result, modes=found, stability=stability(found, result.D, result.K, point.has_potential(values)))
