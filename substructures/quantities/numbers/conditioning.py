"""How well accelerations are determined, g q'' = Q - Gamma q' q': states to be solved anew, failures, and warnings.

Formulas of q'' are quick, but products of two entries of g leave the range of numbers where g itself does not yet, and
nothing in their result tells of it, nor of a nearly singular metric. Both are seen beside the result, by the pivots
D_k / |g_kk| and the diagonal of g; where they are suspicious, and there alone, states are looked at by numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.mechanics.accelerations import condition, definite_solve
from substructures.quantities.derivatives import SINGULAR
from substructures.quantities.formulas import DYNAMICS

#: diagonal entries of g whose products with each other, with forces and with inverses are certainly numbers
LEAST, MOST = 1e-100, 1e100
#: diagonal entries that have lost digits already: below 2.2e-308 over the unit of rounding
LOST = 1e-290
#: pivots below which a state is looked at, far before its results are doubtful
SUSPICIOUS = 1e-8
#: estimated relative error above which results are warned of
DOUBTFUL = 1e-6
EPS = float(np.finfo(np.float64).eps)

OVERFLOW = (
    "the {} is not finite: numbers overflow (beyond 1.8e308), or a load divides by zero or has no derivative there; "
    "look at the values of the state and of the parameters, and take units in which they are moderate"
)
UNDERFLOW = (
    "entries of the metric underflow (below 1e-290 doubles lose digits): take units in which masses and lengths are "
    "moderate"
)
RANGE = (
    "the metric has entries beyond 1e-100 to 1e100, whose products leave the range of numbers: take units in which "
    "masses and lengths are moderate"
)

WORDS = {"metric": "metric", "bias": "part of the velocities, Gamma q' q',", "forces": "vector of forces"}

#: outputs of the model by name at some of the states
Look = Callable[[NDArray[np.int64], list[str]], Mapping[str, Array]]


@dataclass(frozen=True)
class Doubt:
    """Why a state has no accelerations, or that they are doubtful: a code for programs, and a message."""

    code: str
    message: str


def is_usable(pivots: Array) -> NDArray[np.bool_]:
    """Whether g is positive definite beyond the rounding of n steps, (N,), by its relative pivots (N, n)."""
    # g = L^T D L is positive definite where all D_k are
    least = 8 * pivots.shape[1] * EPS
    if pivots.size and pivots.min() > least:
        return np.ones(len(pivots), dtype=np.bool_)
    return pivots.min(axis=1, initial=1) > least


def solved_anew(found: dict[str, Array], name: str, look: Look) -> dict[str, Array]:
    """The outputs of formulas of accelerations with those states solved by numbers whose formulas leave the range of
    numbers. A derivative is not computed anew: it has no result there.
    """
    inertias = found["inertias"]
    # one look at all of them; the comparison is false for what is not a number
    if not inertias.size or (inertias.min() >= LEAST and inertias.max() <= MOST):
        return found
    inside = (inertias >= LEAST) & (inertias <= MOST)
    states = np.flatnonzero(~inside.all(axis=1))
    result = {key: np.array(x) for key, x in found.items()}
    numbers = look(states, list(DYNAMICS))
    with np.errstate(all="ignore"):
        x, pivots = definite_solve(numbers["metric"], numbers["forces"] - numbers["bias"])
    lost = np.einsum("nkk->nk", numbers["metric"]).min(axis=1, initial=np.inf) < LOST
    pivots[lost] = np.nan
    result["pivots"][states] = pivots
    result[name][states] = np.nan if name.endswith("_derivative") else x
    return result


def doubts(result: Array, pivots: Array, look: Look) -> dict[int, Doubt]:
    """What is to be said of accelerations or their derivatives (N, n) by state."""
    # two looks at all states, which are all that is needed where nothing is wrong
    if (not pivots.size or pivots.min() > SUSPICIOUS) and np.isfinite(result).all():
        return {}
    failed = np.flatnonzero(~np.isfinite(result).all(axis=1))
    near = np.flatnonzero(~(pivots > SUSPICIOUS).all(axis=1))
    states = np.union1d(failed, near)
    if not len(states):
        return {}
    if not pivots.any():  # in no state is there any inertia
        return dict.fromkeys(states.tolist(), Doubt("not-finite", SINGULAR))
    numbers = look(states, list(DYNAMICS))
    conditions, has_failed = condition(numbers["metric"]), set(failed.tolist())
    told: dict[int, Doubt] = {}
    for k, state in enumerate(states.tolist()):
        if state in has_failed:
            told[state] = _failure({name: numbers[name][k] for name in DYNAMICS}, pivots[state])
        elif EPS * conditions[k] > DOUBTFUL:
            told[state] = ill_conditioned(float(conditions[k]))
    return told


def ill_conditioned(number: float) -> Doubt:
    """The warning for a condition number."""
    error = min(1.0, EPS * number)
    message = (
        f"the metric is nearly singular there (condition number {number:.0e}): rounding alone may change the "
        f"accelerations by a part of about {error:.0e}"
    )
    return Doubt("ill-conditioned", message)


def closed_doubts(result: Array, conditions: Array, advice: str) -> dict[int, Doubt]:
    """The same for accelerations on closures, with their condition numbers (N,); ``advice`` where there are none."""
    finite = np.isfinite(result).all(axis=1)
    told = {state: Doubt("not-finite", advice) for state in np.flatnonzero(~finite).tolist()}
    doubtful = np.flatnonzero(finite & (EPS * conditions > DOUBTFUL))
    return told | {state: ill_conditioned(float(conditions[state])) for state in doubtful.tolist()}


def _failure(numbers: Mapping[str, Array], pivots: Array) -> Doubt:
    """Why a state has no accelerations."""
    for name in WORDS:
        if not np.isfinite(numbers[name]).all():
            return Doubt("not-finite" if name == "forces" else "overflow", OVERFLOW.format(WORDS[name]))
    diagonal = np.diagonal(numbers["metric"])
    if ((diagonal > 0) & (diagonal < LOST)).any():
        return Doubt("underflow", UNDERFLOW)
    if np.isfinite(pivots).all() and is_usable(pivots[None])[0]:
        beyond = diagonal.min() < LEAST or diagonal.max() > MOST
        return Doubt("out-of-range", RANGE) if beyond else Doubt("not-finite", OVERFLOW.format("result"))
    zero = "" if diagonal.all() else " (a diagonal entry is 0: nothing moves there, or it is below 1e-308)"
    return Doubt("not-finite", f"{SINGULAR}{zero}")
