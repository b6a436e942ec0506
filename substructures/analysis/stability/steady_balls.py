"""Steady motions with ball and floating joints: cyclic rates are constant, and everything else keeps still.

A rate of a ball joint is cyclic where its body is the same turned about this axis of its own (the spin of a top), a
coordinate where nothing depends on it (a wheel). Where the angular momentum L about an axis of the world is constant,
all may turn about it, too, at a rate Omega (a precession). With g = M^-1 dL/dv, the rates v of turning about it alone,
and the axes e_c of cyclic rates a motion is steady where

    ID(q, v, v') = 0      v = Omega g + sigma_c e_c      v' = -sigma_c e_c x v in the joint of a spin c

(:mod:`substructures.analysis.equations.precession`). Places are searched in all numbers of q, and disturbances are
those of all displacements and rates; of bodies that spin in axes that do not, dq' = dv + (R + S) dq with S = sigma_c
e_c x, in which the coefficients are constant (relative equilibria: J. E. Marsden, Lectures on Mechanics, 1992).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.equations.precession import BallRequest
from substructures.analysis.stability.energy_integrals import bounded_by_integrals, shifts_along
from substructures.analysis.stability.equilibrium_search import SearchRange
from substructures.analysis.stability.found_places import confirmed
from substructures.analysis.stability.operating_point import RestConditions
from substructures.analysis.stability.steady_ball_search import (
    Linearised,
    TurningSearch,
    linearised_at,
    places_of,
    values_at,
)
from substructures.analysis.stability.steady_families import DIFFERENCE, NEAR, SINGULAR, FamilySearch
from substructures.analysis.stability.steady_result import BallSteadyMotion, Bifurcation, SteadyMotions
from substructures.analysis.stability.vibrations import NEUTRAL, Stability
from substructures.array import Array, ComplexArray
from substructures.quantities.numbers.quaternions import by_displacements
from substructures.tree.model import Model

CHANGES = "its disturbances do not keep their equations along the motion: there are no modes, and no verdict by them"


def steady_with_balls(
    model: Model,
    request: BallRequest,
    within: SearchRange,
    conditions: RestConditions,
    linearised: Linearised,
    family: tuple[str | None, tuple[float, ...], int],
) -> SteadyMotions:
    """As the ``request`` says; ``linearised``: about a state (q, v); ``family``: what varies between which ends, and in
    how many steps. Raises InvalidInput (``/rates/name``, ``/precession``), MissingValue.
    """
    require_smooth(model)
    vary, ends, steps = family
    if vary in model.parameters:
        conditions = replace(conditions, parameters={**conditions.parameters, str(vary): ends[0]})
    else:
        request = request.beginning(vary, ends[0])
    acting = [name for name, value in conditions.inputs.items() if value]
    zero = [name for name, value in conditions.parameters.items() if not value]
    integrals = first_integrals(model, acting, zero)
    search = TurningSearch(
        within, conditions, request.turning(model, integrals), [x for x in model.parameters if x == vary]
    )
    more: tuple[Bifurcation, ...] = ()
    advice, said = "no steady motion was found: give 'starts' near one, other rates, or raise 'count'", list[str]()
    if request.precession == "any":
        starts = search.starts()
        found = [(q, turn) for q in starts[: len(starts) - 1 - within.count] for turn in search.precessions(q)]
        some = [described_at(search, q, turn, linearised) for q, turn in found]
        advice = "no rate of precession keeps the 'starts', which 'any' takes as they are: give other places or rates"
    elif vary is None:
        some = [described_at(search, q, search.motion(q)[-1], linearised) for q in places_of(search)]
    else:
        with np.errstate(all="ignore"):
            some, more, said = _families(search, vary, (ends[0], ends[-1]), steps, linearised)
    motions, left_out = confirmed(some)
    message = "; ".join(filter(None, ("" if motions else advice, left_out, *said)))
    return SteadyMotions(motions, integrals.cyclic, "momenta", vary, more, message=message)


def _families(
    search: TurningSearch, vary: str, ends: tuple[float, float], steps: int, linearised: Linearised
) -> tuple[list[BallSteadyMotion], tuple[Bifurcation, ...], list[str]]:
    """The motions of all families, their bifurcations, and what is to be said."""
    starts = []
    for value in ends:
        search.put(vary, value)
        starts.append(places_of(search))

    def described(q: Array, value: float, branch: int) -> BallSteadyMotion:
        """A point of a family."""
        search.put(vary, value)
        q = search.wound(q)
        return replace(described_at(search, q, search.motion(q)[-1], linearised), value=value, branch=branch)

    found = BallFamilies(search, vary, ends, steps, linearised).run(starts)
    some = [described(q, value, k) for k, branch in enumerate(found.branches) for q, value in branch]
    more = tuple(
        Bifurcation(one.kind, one.reason, described(one.x, one.value, one.branch), one.least)
        for one in found.bifurcations
    )
    return some, more, found.messages


def described_at(search: TurningSearch, q: Array, turn: float, linearised: Linearised) -> BallSteadyMotion:
    """A steady motion with its linearisation."""
    model, turning = search.model, search.given
    if turning.axis is not None and turning.field == "rates":
        turning.wanted[-1] = turn
    v, S, _, turn = search.motion(q)
    at, moving = linearised_at(search, q, linearised), list(turning.cyclic)
    message = at.message if at.status == "failed" else "" if at.stability is not None else CHANGES
    names = tuple(model.coordinates[c] for c in moving)
    named = model.coordinates, names, model.coordinates
    about = 0.0 if turning.axis is None else float(search.L[0][:, turning.axis] @ v)
    judged = _judged(search, q, at.stability)
    return BallSteadyMotion(
        *named, q, v[moving], (at.M @ v)[moving], at.M, at.D, at.K, at.qdd + S @ v, at.modes, judged, message,
        positions=model.positions, v=v, axis="" if turning.axis is None else "xyz"[turning.axis], precession=turn,
        angular_momentum=about,
    )  # fmt: skip


def _judged(search: TurningSearch, q: Array, judged: Stability | None) -> Stability | None:
    """By the energy, where eigenvalues leave it open."""
    model, turning, conditions = search.model, search.given, search.conditions
    if judged is None or judged.verdict != "undecided" or any(conditions.inputs.values()):
        return judged
    v, _, g, turn = search.motion(q)
    values, moving = values_at(model, conditions, q, v), list(turning.cyclic)
    shifts = shifts_along(model, values, np.vstack((np.eye(model.dof)[moving], *([g] if turn else []))))
    for k, unit in enumerate(np.eye(len(moving))):
        # rates turn in the axes of a body that is turned in itself
        shifts[k, len(model.positions) :] = -turning.spin(unit) @ v
    zero = [name for name, value in conditions.parameters.items() if not value]
    reason = bounded_by_integrals(model, values, shifts, zero)
    return judged if reason is None else Stability("stable", reason)


class BallFamilies(FamilySearch[TurningSearch]):
    """F: ID over its units, |Q|^2 = 1, and what keeps a family from turning along its motions or shifting where nothing
    depends on it. On the way the sign of det P F_q is watched, P: rows that are independent where the family begins.
    """

    def __init__(
        self, search: TurningSearch, vary: str, between: tuple[float, float], steps: int, linearised: Linearised
    ) -> None:
        super().__init__(search, vary, between, steps)
        self.linearised = linearised
        self.begun, self.still, self.rows = np.zeros(0), np.zeros((0, search.n)), np.zeros((0, 0))

    def _follow(self, u: Array, direction: Array) -> None:
        search, self.begun = self.search, self._put(u)
        model, g = search.model, search.motion(self.begun)[2]
        ways = [*(np.eye(model.dof)[c] for c in search.given.cyclic), *([g] if search.given.axis is not None else [])]
        state = model.positions, model.coordinates, model.balls
        displaced = by_displacements(*state, self.begun)
        shifts = np.array(ways).reshape(-1, model.dof) @ np.linalg.pinv(displaced).T
        self.still = np.vstack((shifts, np.eye(search.n)[list(search.resting)]))
        self.rows = np.linalg.svd(self._equations(u)[1][:, :-1])[0][:, : search.n].T
        super()._follow(u, direction)

    def _all(self, q: Array) -> tuple[Array, Array]:
        """F and F_q."""
        F, K = self.search.at(q)
        turns = [(q[some] @ q[some] - 1) / 2 for some in self.search.quaternions]
        normals = np.zeros((len(turns), len(q)))
        for row, some in zip(normals, self.search.quaternions, strict=True):
            row[some] = q[some]
        return np.concatenate((F, turns, self.still @ (q - self.begun))), np.vstack((K, normals, self.still))

    def _equations(self, u: Array) -> tuple[Array, Array]:
        last = DIFFERENCE * np.eye(len(u))[-1]
        above, below = (self._all(self._put(u + side * last))[0] for side in (1, -1))
        q = self._put(u)
        F, J = self._all(q)
        J = np.nan_to_num(np.column_stack((J * self.search.length, (above - below) / (2 * DIFFERENCE))))
        return (np.full_like(F, np.nan) if self.search.is_singular(q) else F), J

    def _signature(self, u: Array) -> tuple[int, ...]:
        F, J = self._equations(u)
        eigenvalues = self._eigenvalues(u)
        if not (np.isfinite(F).all() and len(eigenvalues)):
            return SINGULAR
        growing = int((eigenvalues.real > NEUTRAL * np.abs(eigenvalues).max(initial=0)).sum())
        return int(np.linalg.slogdet(self.rows @ J[:, :-1])[0] < 0), 0, growing

    def _eigenvalues(self, u: Array) -> ComplexArray:
        q = self._put(u)
        at = linearised_at(self.search, self.search.wound(q), self.linearised)
        upper = [mode.eigenvalue for mode in at.modes]
        return np.array([*upper, *(z.conjugate() for z in upper if z.imag)], dtype=np.complex128)

    def _is_at(self, u: Array, other: Array) -> bool:
        """Also where one is turned along its motion."""
        if abs(float(u[-1] - other[-1])) >= NEAR:
            return False
        q = self._put(u)
        moving = [a for a in range(self.search.n) if a not in self.search.resting]
        return self.search.is_same(self.search.wound(q), self.search.wound(self._x(other)), moving)

    def _least(self, u: Array) -> float:
        h, n, q = DIFFERENCE * self.search.length, self.search.n, self._put(u)
        sides = [[self._all(q + side * h * e)[0] for e in np.eye(n)] for side in (1, -1)]
        sizes = np.linalg.svd((np.array(sides[0]) - sides[1]) / (2 * DIFFERENCE), compute_uv=False)
        return float(sizes[n - 1] / sizes.max(initial=1))
