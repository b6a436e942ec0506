"""States with ball joints along motions: lengths of quaternions, what must hold, and how far coordinates go."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from substructures.analysis.motion.judges.states import (
    ROUNDING,
    Condition,
    MotionStates,
    spread,
)
from substructures.analysis.verdict import About
from substructures.array import Array
from substructures.quantities.numbers.limits import reached
from substructures.quantities.numbers.quaternions import quaternions_in
from substructures.tree.model import Model

NORMS = "|Q| = 1 of all quaternions: Q' = 1/2 Q (0, w) keeps their lengths"
BALANCE = "T + V changes by the work of forces without potential"


def with_lengths(model: Model, q: Array) -> Array:
    """States (..., m) with quaternions of length 1."""
    result = q.copy()
    for some in quaternions_in(model.positions, model.balls):
        result[..., some] /= np.linalg.norm(q[..., some], axis=-1, keepdims=True)
    return result


def conditions_in_rates(model: Model, states: MotionStates, is_balanced: bool) -> Iterator[Condition]:
    """What must hold along many motions (..., K): the balance of energy, if it is known, and the norms of quaternions,
    which are as they were integrated.
    """
    everywhere, ones = np.ones(states.t.shape[:-1], dtype=bool), np.ones(states.t.shape[:-1])
    if is_balanced and states.work is not None:
        found = states.found(model, model.program, ["metric", "potential_energy"])
        kinetic = 0.5 * np.einsum("...kab,...ka,...kb->...k", found["metric"], states.qd, states.qd)
        potential, work = found["potential_energy"], states.work
        energy = kinetic + potential
        known = ROUNDING * np.abs(energy).max(axis=-1, initial=0)
        sizes = [np.abs(x).max(axis=-1, initial=0) for x in (kinetic, potential - potential[..., :1], work)]
        scale = np.max(sizes, axis=0)
        about: About = ("energy", "constant", BALANCE, "J")
        drift = spread(energy - work)
        yield Condition(about, drift, np.where(scale > known, scale, known / ROUNDING), known, everywhere)
    places = quaternions_in(model.positions, model.balls)
    norms = np.stack([np.linalg.norm(states.q[..., some], axis=-1) for some in places])
    yield Condition(("quaternions", "zero", NORMS, ""), np.abs(norms - 1).max(axis=0), ones, 0 * ones, everywhere)


def reached_in_rates(model: Model, t: Array, x: Array) -> tuple[Array, Array]:
    """Lowest and highest values of the coordinates at x (K, m + n) or longer; of rates of ball joints, which have no
    limits, 0.
    """
    places, m = {name: i for i, name in enumerate(model.positions)}, len(model.positions)
    found = np.zeros((2, model.dof))
    own = [a for a, name in enumerate(model.coordinates) if name in places]
    found[:, own] = reached(t, x[:, [places[model.coordinates[a]] for a in own]], x[:, [m + a for a in own]])
    return found[0], found[1]
