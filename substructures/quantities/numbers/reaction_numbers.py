"""Reactions in numbers: of given accelerations, or of the motion that states have by themselves, closures included."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED
from substructures.mechanics.closure_rows import ranks
from substructures.quantities.accelerations import Evaluator, closure_sizes
from substructures.quantities.formulas import CLOSED_DYNAMICS, DYNAMICS
from substructures.quantities.numbers.states import require
from substructures.quantities.part_models import OUTPUTS
from substructures.quantities.quantity import REACTIONS
from substructures.tree.model import Model


def reaction_numbers(
    model: Model,
    programs: Callable[[str], Program],
    values: Mapping[str, Any],
    motion: Array | None,
    evaluator: Evaluator,
    count: int,
) -> dict[str, Array]:
    """OUTPUTS (N, rows, 3) at states; ``motion``: q'' (N, n) where ``values`` have none; ``programs``: by source.

    Closures act by the multipliers of least norm; NaN in states without accelerations. Raises MissingValue.
    """
    known, program = dict(values), programs(REACTIONS)
    seconds = [f"{name}''" for name in model.coordinates]
    if motion is not None and not all(name in known for name in seconds):
        known |= {name: motion[:, a] for a, name in enumerate(seconds)}
        if model.closures:
            found = _multipliers(model, programs(CLOSED_DYNAMICS), known, motion, evaluator, count)
            names = [f"lambda.{rows.name}.{row}" for rows in model.closures for row in rows.rows]
            known |= {name: found[:, k] for k, name in enumerate(names)}
    require(program, list(OUTPUTS), known)
    return evaluator(program, known, list(OUTPUTS), count)


def _multipliers(
    model: Model, program: Program, values: Mapping[str, Any], motion: Array, evaluator: Evaluator, count: int
) -> Array:
    """lambda (N, m) of least norm [N, N m] with G^T lambda = g q'' + Gamma q' q' - Q."""
    found = evaluator(program, values, [*DYNAMICS, *CLOSED], count)
    q = np.stack([np.broadcast_to(values[name], (count,)) for name in model.coordinates], axis=1)
    reach = closure_sizes(model, program, values, evaluator, q).reach
    G, g = found["closure.jacobian"], found["metric"]
    right = np.einsum("nab,nb->na", g, motion) + found["bias"] - found["forces"]
    result = np.full((count, G.shape[1]), np.nan)
    finite = np.isfinite(G).all(axis=(1, 2)) & np.isfinite(right).all(axis=1)
    for i in np.flatnonzero(finite):
        result[i] = least_norm(G[i], reach[i], right[i])
    return result


def least_norm(G: Array, reach: Array, right: Array) -> Array:
    """lambda (m,) of least norm with G^T lambda = right, the rank judged by the rows of G over their reach."""
    if not len(G):
        return np.zeros(0)
    left, sizes, turned = np.linalg.svd(G / reach[:, None])
    rank = int(ranks(sizes))
    # (G / reach)^T (reach lambda) = right
    found: Array = left[:, :rank] @ ((turned[:rank] @ right) / sizes[:rank]) / reach
    if rank < len(G):
        # less what closures that depend on each other may add: of least norm in N and N m
        basis = np.linalg.qr(left[:, rank:] / reach[:, None])[0]
        found = found - basis @ (basis.T @ found)
    return found
