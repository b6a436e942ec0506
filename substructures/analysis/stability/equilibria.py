"""Equilibria from the force formulas, by Newton's method with the exact Jacobian: Q_a(q, q' = 0) = 0, and with closures
Q_a + lambda_k G_ka = 0, phi_k(q) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from substructures.analysis.equations.formulas import require_moving, unsteady
from substructures.analysis.stability.closed_search import ClosedSearch
from substructures.analysis.stability.constrained_search import ConstrainedSearch
from substructures.analysis.stability.equilibrium_search import BallSearch, RestSearch, SearchRange
from substructures.analysis.stability.found_places import FoundPlaces, confirmed, still
from substructures.analysis.stability.linearisation_result import (
    BallLinearisation,
    ClosedLinearisation,
    ConstrainedLinearisation,
    Linearisation,
)
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.operating_point import RestConditions
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.errors import InvalidDocument
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.tree.document import require_undriven
from substructures.tree.model import Model

#: singular values of M^-1 K below this share of the largest leave a direction undetermined
SINGULAR = 1e-9


@dataclass(frozen=True, repr=False)
class Equilibrium:
    """``q`` (n,): angles in (-pi, pi] [rad], distances [m]; with ball joints (m,) with quaternions, of a family one.
    ``free`` (k, n): directions of length one in which the forces do not decide (K singular); with closures those that
    keep them.

    ``at``: the linearisation there with modes and stability.
    """

    q: Array
    free: Array
    at: Linearisation

    def __repr__(self) -> str:
        names = self.at.positions if isinstance(self.at, BallLinearisation) else self.at.coordinates
        place = ", ".join(f"{name}={x:.6g}" for name, x in zip(names, self.q.tolist(), strict=True))
        return f"Equilibrium({place})\n{self.at.message or self.verdict}, {len(self.free)} undetermined directions"

    @property
    def verdict(self) -> str:
        """What the linearisation says about its stability; ``failed`` where there is none."""
        return "failed" if self.at.stability is None else self.at.stability.verdict

    def check(self) -> Check:
        """That nothing accelerates there, by the equations of motion of the linearisation, which the search had not."""
        place = ", ".join(f"{x:.6g}" for x in self.q.tolist())
        if self.at.status == "failed" or not len(self.at.K):
            why = self.at.message or "nothing is left to move"
            return Check.left_out(f"rest at {place}", "zero", why, needed=self.at.status == "failed")
        if isinstance(self.at, ConstrainedLinearisation):
            return still(f"rest at {place}", "no accelerations at rest", self.at.vd, self.at.M, self.at.K)
        names = self.at.independent if isinstance(self.at, ClosedLinearisation) else self.at.coordinates
        qdd = self.at.qdd[[self.at.coordinates.index(name) for name in names]]
        return still(f"rest at {place}", "no accelerations at rest", qdd, self.at.M, self.at.K)


@dataclass(frozen=True, repr=False)
class Equilibria(FoundPlaces[Equilibrium]):
    """All that were found. ``held``: coordinates on which no force and no closure depends, kept at their start; with
    velocity constraints those that are ignorable.
    """

    held: tuple[str, ...]

    def __repr__(self) -> str:
        return self._shown(held=self.held)


def equilibria(
    model: Model,
    *,
    starts: Sequence[float] | Sequence[Sequence[float]] | Array | None = None,
    count: int = 32,
    reach: float = 1.0,
    seed: int = 0,
    t: float = 0.0,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
) -> Equilibria:
    """Positions of rest of a model: Q_a(q, q' = 0) = 0, with closures Q_a + lambda_k G_ka = 0 and phi_k(q) = 0.

    Newton's method begins at the ``starts`` (N, n) [rad, m], at zero, and at ``count`` random places: angles in +-pi,
    distances in +-``reach`` [m], ball joints in any attitude, drawn with ``seed``. ``t`` [s], ``parameters`` (in place
    of their defaults) and ``inputs`` [N m, N] (their defaults, or 0) stay as they are. Starts of closed loops are first
    moved onto the closures; with velocity constraints of the tree contacts are closed whose planes pass through the
    origin of the world, and of families the places near ``starts`` and zero are found. An equilibrium in a singular
    position has a linearisation that is ``failed``, and is not judged. That none is found is a result with advice.
    Raises InvalidInput (``/starts``, ``/inputs/name``, ...; ``not-smooth`` for forces without derivative,
    ``not-steady`` for given motions that make them vary) and MissingValue. Source: notation.md, section 7.
    """
    conditions = RestConditions(t, parameters or {}, with_input_defaults(model.inputs, inputs or {}))
    return equilibria_within(model, SearchRange(starts, count, reach, seed), conditions)


def equilibria_within(model: Model, within: SearchRange, conditions: RestConditions) -> Equilibria:
    """The same, from the starts of a range."""
    require_moving(model, "equilibria")
    if model.closures:
        require_undriven(model.driven, "take simulations, or loop states")
    if why := unsteady(model, conditions.inputs):
        raise InvalidDocument.at("", "not-steady", f"{why}: nothing stays at rest; use periodic orbits, or simulations")
    if model.velocity_constraints:
        return _constrained(ConstrainedSearch(model, within, conditions, None))
    kind = ClosedSearch if model.closures else BallSearch if model.balls else RestSearch
    places = (search := kind(model, within, conditions)).starts()
    held = search.held(places)
    moving = [a for a in range(search.n) if a not in held]
    places[:, held] = places[0, held]
    found, _ = search.places(places, moving)
    names = tuple(model.positions[a] for a in held)
    results, left_out = confirmed([_described(model, conditions, q) for q in found])
    return Equilibria(results, names, message=left_out if results or left_out else search.advice(places[0], held))


def _constrained(search: ConstrainedSearch) -> Equilibria:
    """At v = 0."""
    places = []
    for state in search.found():
        at = state.at
        # K dq = 0 for dq = T dv
        free = _free(at.M, at.K @ at.T) @ at.T.T
        free = free / np.linalg.norm(free, axis=1, keepdims=True)
        places.append(Equilibrium(at.q, free, at))
    results, message = confirmed(places)
    advice = "no equilibrium was found: give 'starts' near one, or raise 'count' and 'reach'"
    return Equilibria(results, search.named(search.ignorable), message=message if results or message else advice)


def _free(M: Array, K: Array) -> Array:
    """Directions (k, r) in which M^-1 K is nothing beside its largest, or 1 [1/s^2], up to rounding."""
    _, sizes, rows = np.linalg.svd(np.linalg.solve(M, K))
    return np.asarray(rows[sizes <= SINGULAR * max(1.0, float(sizes.max(initial=0)))])


def _described(model: Model, conditions: RestConditions, q: Array) -> Equilibrium:
    """With its singular directions and its linearisation."""
    at = linearise(model, q, t=conditions.t, parameters=conditions.parameters, inputs=conditions.inputs)
    if isinstance(at, ClosedLinearisation):
        q = at.q
    if at.status == "failed" or not len(at.K):
        return Equilibrium(q, np.zeros((0, model.dof)), at)
    free = _free(at.M, at.K)
    if isinstance(at, ClosedLinearisation):
        # dq = N dy
        free = free @ at.tangent.T
        free /= np.linalg.norm(free, axis=1, keepdims=True)
    return Equilibrium(q, free, at)
