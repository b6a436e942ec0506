"""States with ball joints along motions: lengths of quaternions, what must hold, and how far coordinates go."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from substructures.analysis.motion.judges.states import (
    ROUNDING,
    Condition,
    MotionStates,
    spread,
)
from substructures.analysis.motion.trajectory import Crossing
from substructures.analysis.verdict import About, Check
from substructures.array import Array
from substructures.quantities.numbers.limits import reached
from substructures.quantities.numbers.quaternions import quaternions_in
from substructures.tree.model import Model

NORMS: About = "quaternions", "zero", "|Q| = 1 of all quaternions: Q' = 1/2 Q (0, w) keeps their lengths", ""
BALANCE = "T + V changes by the work of forces without potential"


def energies(found: Mapping[str, Array], v: Array) -> dict[str, Array]:
    """Kinetic and potential energy (..., K) [J], of the metric and the potential energy that were ``found``, and rates
    v (..., K, n).
    """
    kinetic = 0.5 * np.einsum("...kab,...ka,...kb->...k", found["metric"], v, v)
    return {"kinetic_energy": kinetic, "potential_energy": found["potential_energy"]}


def norms(model: Model, q: Array) -> Array:
    """By how much quaternions at states (..., m) are not of length 1, the largest of each state (...)."""
    places = quaternions_in(model.positions, model.balls)
    lengths = np.stack([np.linalg.norm(q[..., some], axis=-1) for some in places])
    return np.asarray(np.abs(lengths - 1).max(axis=0))


def kept_lengths(model: Model, t: Array, x: Array, limit: float) -> tuple[Check, ...]:
    """Whether a motion keeps the norms of its quaternions, if it has some; states x (K, ...)."""
    return (Check.of(NORMS, norms(model, x), t, 1.0, limit),) if model.balls else ()


def with_lengths(model: Model, q: Array) -> Array:
    """States (..., m) with quaternions of length 1."""
    result = q.copy()
    for some in quaternions_in(model.positions, model.balls):
        result[..., some] /= np.linalg.norm(q[..., some], axis=-1, keepdims=True)
    return result


def told_with_lengths(model: Model, event: Crossing) -> Crossing:
    """The same of an event: at its state, and at that after it."""
    after = None if event.after is None else (with_lengths(model, event.after[0]), event.after[1])
    return replace(event, q=with_lengths(model, event.q), after=after)


def conditions_in_rates(model: Model, states: MotionStates, is_balanced: bool) -> Iterator[Condition]:
    """What must hold along many motions (..., K): the balance of energy, if it is known, and the norms of quaternions,
    which are as they were integrated.
    """
    everywhere, ones = np.ones(states.t.shape[:-1], dtype=bool), np.ones(states.t.shape[:-1])
    if is_balanced and states.work is not None:
        found = states.found(model, model.program, ["metric", "potential_energy"])
        (kinetic, potential), work = energies(found, states.qd).values(), states.work
        energy = kinetic + potential
        known = ROUNDING * np.abs(energy).max(axis=-1, initial=0)
        sizes = [np.abs(x).max(axis=-1, initial=0) for x in (kinetic, potential - potential[..., :1], work)]
        scale = np.max(sizes, axis=0)
        about: About = ("energy", "constant", BALANCE, "J")
        drift = spread(energy - work)
        yield Condition(about, drift, np.where(scale > known, scale, known / ROUNDING), known, everywhere)
    yield Condition(NORMS, norms(model, states.q), ones, 0 * ones, everywhere)


def reached_in_rates(model: Model, t: Array, x: Array) -> tuple[Array, Array]:
    """Lowest and highest values of the coordinates at x (K, m + n) or longer; of rates of ball joints, which have no
    limits, 0.
    """
    places, m = {name: i for i, name in enumerate(model.positions)}, len(model.positions)
    found = np.zeros((2, model.dof))
    own = [a for a, name in enumerate(model.coordinates) if name in places]
    found[:, own] = reached(t, x[:, [places[model.coordinates[a]] for a in own]], x[:, [m + a for a in own]])
    return found[0], found[1]
