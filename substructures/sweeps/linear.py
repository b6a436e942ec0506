"""What the linearisation tells of many parameter sets at once: M dq'' + D dq' + K dq = 0 (notation.md, section 7)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.perturbation import perturbation, require_smooth
from substructures.analysis.stability.operating_point import AT_REST
from substructures.analysis.stability.vibrations import NEUTRAL, SYMMETRIC
from substructures.array import Array, ComplexArray
from substructures.errors import InvalidArgument
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.states import known_values, read_states
from substructures.sweeps.shapes import Shape
from substructures.tree.model import require_open

MATRICES = ["metric", "damping", "stiffness"]


def linear_columns(
    shape: Shape, at: Mapping[str, Any], held: bool, parameters: Mapping[str, Any], rows: int, takes: Collection[str]
) -> dict[str, Array]:
    """By what is taken, (rows,): of the linearisation about one state ``at`` with one set of parameters a row; NaN
    where that is no equilibrium, unless it is ``held`` there.

    Raises InvalidInput, MissingValue.
    """
    model = shape.model
    require_open(model.closures, "sweep other columns")
    require_smooth(model)
    given = {**at, "parameters": parameters}
    states = read_states(model, at, 1)
    if states.qd.any():
        raise InvalidArgument.at("/qd", "not-at-rest", "an equilibrium is at rest: leave 'qd' out")
    q, zero = np.broadcast_to(states.q, (rows, model.dof)), np.zeros((rows, model.dof))
    options = EvaluationOptions(evaluator=shape.evaluate)
    more = {name: at[name] for name in ("inputs", "t") if name in at}
    qdd = zero
    if not held:
        found = evaluate(shape.sources, "forward_dynamics", q, zero, parameters=parameters, options=options, **more)
        qdd = found["forward_dynamics"].reshape(rows, -1)
    states = read_states(model, {"q": q, "qd": zero, "qdd": np.nan_to_num(qdd)}, None)
    values = known_values(model, given, states, model.parameters)
    matrices = shape.evaluate(perturbation(model), values, MATRICES, rows)
    M, D, K = (np.asarray(matrices[name]) for name in MATRICES)
    good: NDArray[np.bool_] = np.asarray(np.isfinite(qdd).all(axis=1))
    for matrix in (M, D, K):
        good = good & np.isfinite(matrix).all(axis=(1, 2))
    good = good & (np.abs(np.linalg.det(np.where(good[:, None, None], M, 1.0))) > 0)
    if good.any():  # as for one state: accelerations that are rounding beside what a unit displacement causes
        unit = np.abs(np.linalg.solve(M[good], K[good])).max(axis=2, initial=0)
        good[good] = (np.abs(qdd[good]) <= AT_REST * np.fmax(1.0, unit)).all(axis=1)
    eigenvalues = np.full((rows, 2 * model.dof), np.nan, dtype=np.complex128)
    if good.any():
        eigenvalues[good] = _eigenvalues(M[good], D[good], K[good])
    return {take: np.where(good, _taken(take, eigenvalues), np.nan) for take in takes}


def _eigenvalues(M: Array, D: Array, K: Array) -> ComplexArray:
    """(N, 2 n): of symmetric problems K x = w^2 M x without damping by Cholesky's factor of M, else of dx' = A x."""
    scale = np.abs(K).max(axis=(1, 2))
    symmetric = np.abs(K - K.transpose(0, 2, 1)).max(axis=(1, 2)) <= SYMMETRIC * scale
    found = np.full((len(M), 2 * M.shape[1]), np.nan, dtype=np.complex128)
    simple = symmetric & (np.abs(D).max(axis=(1, 2)) == 0) & _is_positive(M)
    if simple.any():
        L = np.linalg.cholesky(M[simple])
        half = np.linalg.solve(L, K[simple])
        C = np.linalg.solve(L, half.transpose(0, 2, 1))
        squares = np.linalg.eigvalsh((C + C.transpose(0, 2, 1)) / 2)
        # what rounding makes of no restoring force is none
        squares = np.where(np.abs(squares) <= 1e-13 * np.abs(squares).max(axis=1, keepdims=True), 0.0, squares)
        roots = 1j * np.sqrt(squares.astype(np.complex128))
        found[simple] = np.concatenate([roots, -roots], axis=1)
    rest = ~simple
    if rest.any():
        n = M.shape[1]
        A = np.zeros((int(rest.sum()), 2 * n, 2 * n))
        A[:, :n, n:] = np.eye(n)
        A[:, n:, :n] = -np.linalg.solve(M[rest], K[rest])
        A[:, n:, n:] = -np.linalg.solve(M[rest], D[rest])
        found[rest] = np.linalg.eigvals(A)
    return found


def _is_positive(M: Array) -> NDArray[np.bool_]:
    return np.linalg.eigvalsh((M + M.transpose(0, 2, 1)) / 2)[:, 0] > 0


def _taken(take: str, eigenvalues: ComplexArray) -> Array:
    size, real = np.abs(eigenvalues), eigenvalues.real
    match take:
        case "lowest_frequency":
            return size.min(axis=1)
        case "highest_frequency":
            return size.max(axis=1)
        case "largest_real_part":
            return real.max(axis=1)
        case "is_stable":
            stable = real.max(axis=1) <= NEUTRAL * size.max(axis=1)
            return np.where(np.isnan(size).any(axis=1), np.nan, stable.astype(np.float64))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = np.where(size > 0, -real / size, 0.0)
    return np.where(np.isnan(size).any(axis=1), np.nan, ratios.min(axis=1))
