"""Steady motions (relative equilibria): cyclic coordinates move at constant rates, all others keep still.

A governor at its speed, a body that turns about a principal axis, a top in regular precession. They are found by
Newton's method on Gamma_xbc w^b w^c = Q_x, and each is told whether it is stable, and by which argument:

1. the eigenvalues of M dx'' + D dx' + K dx = 0 at constant momenta (or rates) decide, where one has a positive real
   part, or all have negative ones;
2. else the amended potential, where it has a strict minimum (Routh, Salvadori);
3. else the energy, where it has a strict extremum at constant other first integrals (Routh, Lyapunov):
   :mod:`substructures.analysis.stability.energy_integrals`;
4. else it is undecided, and the reason says what the linear equations leave open.

E. J. Routh, Stability of a given state of motion, 1877; L. Salvadori, Rend. Accad. Sci. Napoli 20, 1953.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from substructures.analysis.arguments import one_of, real, whole
from substructures.analysis.equations.energy import has_even_dissipation
from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.equations.precession import TURNING, BallRequest, Precession
from substructures.analysis.given import numbers
from substructures.analysis.stability.constrained_families import constrained_motions
from substructures.analysis.stability.constrained_search import ConstrainedSearch
from substructures.analysis.stability.energy_integrals import bounded_by_integrals, shifts_along
from substructures.analysis.stability.equilibrium_search import SearchRange
from substructures.analysis.stability.found_places import confirmed
from substructures.analysis.stability.linearisation_result import Linearisation
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.operating_point import RestConditions
from substructures.analysis.stability.steady_balls import steady_with_balls
from substructures.analysis.stability.steady_conditions import (
    SteadyConditions,
    ends_of,
    given_of,
    require_no_precession,
    require_no_velocities,
    require_of_balls,
    require_rates,
)
from substructures.analysis.stability.steady_families import DIFFERENCE, SINGULAR, FamilySearch
from substructures.analysis.stability.steady_result import Bifurcation, Held, SteadyMotion, SteadyMotions
from substructures.analysis.stability.steady_search import SteadySearch
from substructures.analysis.stability.vibrations import (
    AT_RATES,
    NEUTRAL,
    ROUTH,
    Mode,
    Stability,
    first_order,
    modes,
    normed,
    stability,
)
from substructures.array import Array, ComplexArray
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.tree.document import require_undriven, require_unignored
from substructures.tree.model import Model

#: eigenvalues of K that count as zero, and what K - K^T may have, relative to the largest element
ZERO, SYMMETRIC = 1e-11, 1e-8
#: of a range
STEPS = (2, 1000)
#: where in it is looked which coordinates are free
WITHIN = 0.38


def steady_motions(
    model: Model,
    *,
    rates: Mapping[str, float] | None = None,
    momenta: Mapping[str, float] | None = None,
    held: Held = "momenta",
    starts: Sequence[float] | Sequence[Sequence[float]] | Array | None = None,
    count: int = 32,
    reach: float = 1.0,
    seed: int = 0,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    vary: str | None = None,
    between: tuple[float, float] | None = None,
    steps: int = 50,
    velocities: Mapping[str, str] | None = None,
    independent: Sequence[str] | None = None,
    precession: Precession = None,
) -> SteadyMotions:
    """Steady motions: Gamma_xbc w^b w^c = Q_x with s' = w constant and all other coordinates x still; with closures
    Gamma_xbc w^b w^c = Q_x + lambda_k G_kx and phi_k = 0.

    Given are either ``rates`` w [rad/s, m/s] or ``momenta`` [N m s, N s] of cyclic coordinates by name, also of those
    that are so but for the rounding of decimals; those that are not named have 0. ``held``: ``momenta`` keep their
    values when the motion is disturbed, since nothing acts on cyclic coordinates; or ``rates`` do, those of the named
    coordinates, which are driven then and need not be cyclic as long
    as nothing else depends on them. The search is that of equilibria: ``starts`` (N, n), zero, ``count`` random places
    within ``reach`` [m]. ``parameters`` in place of their defaults, constant ``inputs`` [N m, N]. That none is found is
    a result with advice.

    ``vary``: a parameter, or a moving coordinate, whose rate or momentum, whichever are given, varies ``between`` two
    values: families of steady motions, followed with ``steps`` or more points from those at both ends, and where they
    bifurcate: :mod:`substructures.analysis.stability.steady_families`.

    With ball and floating joints the cyclic rates, or momenta, are those of bodies that are the same turned about an
    axis of their joint (the spin of a top), and of wheels. ``precession``: the rate at which all turns about the
    vertical [rad/s], or "any": all those with which the ``starts``, as they are, are kept (of Lagrange's top at a tilt
    t and the given rate w the roots of A cos t p^2 - C w p + m g l = 0); among ``momenta`` it is
    ``angular_momentum.z`` [N m s]. Each may ``vary``.

    In reduced systems (``ignored``) all others keep still: ``rates`` {}, ``vary`` a parameter of the momenta. With
    velocity constraints of the tree all coordinates keep still but those on which nothing depends (the place on a
    plane, headings, angles of wheels), of which ``rates`` are given, or of quasi-velocities: others follow. Where ways
    are left free the motion near to each of ``starts`` and to zero is taken. Quasi-velocities that are constant then
    are given by ``velocities`` or ``independent`` (see quasi_velocity_equations), where those of coordinates that are
    chosen by default are not; ``vary`` may be one of them. Raises InvalidInput (``/rates``, ``/rates/name``,
    ``/momenta/name``, ``/vary``, ``/between``, ``not-smooth``) and MissingValue. Source: notation.md, section 7.
    """
    require_moving(model, "steady-motions")
    whole(steps, "steps", *STEPS)
    if model.velocity_constraints:
        conditions = _conditions(model, parameters, inputs)
        require_rates(rates, momenta, held)
        ends = ends_of(model, vary, between, tuple(velocities or ()))
        given = dict(rates or {}) | ({} if vary is None or vary in model.parameters else {vary: ends[0]})
        around = SearchRange(starts, count, reach, seed)
        constrained = ConstrainedSearch(model, around, conditions, given, velocities, independent)
        return constrained_motions(constrained, vary, ends, steps)
    require_no_velocities(velocities, independent)
    require_undriven(model.driven, "take the tree without it, or equilibria, which are relative to the drives")
    one_of(held, "held", ("momenta", "rates"))
    if model.balls:
        request = BallRequest(
            None if rates is None else numbers(rates, "rates"),
            None if momenta is None else numbers(momenta, "momenta"),
            precession if precession in (None, "any") else real(precession, "/precession"),
        )
        require_of_balls(request, held, vary)
        about = SearchRange(starts, count, reach, seed), _conditions(model, parameters, inputs)
        family = vary, ends_of(model, vary, between, TURNING), steps
        return steady_with_balls(model, request, *about, partial(_linearised, model), family)
    require_no_precession(precession)
    ends = ends_of(model, vary, between)
    given, field = given_of(rates, momenta, held)
    constant = numbers(parameters, "parameters"), with_input_defaults(model.inputs, inputs or {})
    asked = SteadyConditions(model, given, field, held, *constant, vary)
    # a coordinate may be free at one end only, where what acts on it is 0
    moving = asked.moving(ends[0] + WITHIN * (ends[-1] - ends[0]))
    if moving:
        require_unignored(model.ignored)
    within = SearchRange(starts, count, reach, seed)
    searches = [asked.search(moving, within, value) for value in ends]
    found = [search.places(search.starts(), list(range(search.n))) for search in searches]
    singular = _singular(sum(count for _, count in found))
    names = tuple(model.coordinates[s] for s in moving)
    if vary is None:
        motions, left_out = confirmed([_described(searches[0], x, held) for x in found[0][0]])
        more: tuple[Bifurcation, ...] = ()
    else:
        # forces are measured by those of the end where most moves
        search = searches[int(abs(ends[1]) >= abs(ends[0]))]
        some, more, left_out = _families(search, vary, (ends[0], ends[1]), [x for x, _ in found], steps, held)
        motions, others = confirmed(some)
        left_out = "; ".join(filter(None, (left_out, others)))
    message = "" if motions else "no steady motion was found: give 'starts' near one, other rates, or raise 'count'"
    message = "; ".join(filter(None, (message, singular, left_out)))
    return SteadyMotions(motions, names, held, vary, more, message=message)


def _conditions(
    model: Model, parameters: Mapping[str, float] | None, inputs: Mapping[str, float] | None
) -> RestConditions:
    return RestConditions(0.0, parameters or {}, with_input_defaults(model.inputs, inputs or {}))


def _linearised(model: Model, about: RestConditions, q: Array, v: Array) -> Linearisation:
    return linearise(model, q, qd=v, parameters=about.parameters, inputs=about.inputs)


def _singular(count: int) -> str:
    return f"{count} places were left out where these coordinates are singular" if count else ""


def _families(
    search: SteadySearch, vary: str, between: tuple[float, float], starts: list[list[Array]], steps: int, held: Held
) -> tuple[list[SteadyMotion], tuple[Bifurcation, ...], str]:
    """The motions of all families, their bifurcations, and what is to be said."""
    with np.errstate(all="ignore"):
        found = _TreeFamilies(search, vary, between, steps, held == "momenta").run(starts)

    def described(x: Array, value: float, branch: int) -> SteadyMotion:
        """A point of a family."""
        search.put(vary, value)
        return replace(_described(search, search.wound(x), held), value=value, branch=branch)

    motions = [described(x, value, k) for k, branch in enumerate(found.branches) for x, value in branch]
    bifurcations = tuple(
        Bifurcation(one.kind, one.reason, described(one.x, one.value, one.branch), one.least)
        for one in found.bifurcations
    )
    return motions, bifurcations, "; ".join(found.messages)


def _described(search: SteadySearch, x: Array, held: Held) -> SteadyMotion:
    """With matrices, modes and the verdict."""
    model, at = search.model, search.matrices(x, held == "momenta")
    names = tuple(model.coordinates[s] for s in search.moving)
    independent = tuple(model.coordinates[a] for a in at.independent)
    named = (model.coordinates, names, independent)
    qdd = search.accelerations(x, at)
    motion = SteadyMotion(*named, search.whole(x), at.rates, at.momenta, at.M, at.D, at.K, qdd)
    if not all(np.isfinite(m).all() for m in (at.M, at.D, at.K)):
        message = "a derivative of the forces is not finite here, or the metric is singular: there is no linearisation"
        return replace(motion, message=message)
    # shapes of all coordinates that keep still: dx = N dy
    found = tuple(replace(mode, shape=normed(at.tangent @ mode.shape)) for mode in modes(at.M, at.D, at.K))
    return replace(motion, modes=found, stability=_judged(search, x, held, found, at.D, at.K))


def _judged(search: SteadySearch, x: Array, held: Held, found: tuple[Mode, ...], D: Array, K: Array) -> Stability:
    """The verdict of the module's docstring."""
    model, values = search.model, search.values(x)
    driven = [name for name, value in search.conditions.inputs.items() if value and not name.startswith("tau.")]
    zero = [name for name, value in search.conditions.parameters.items() if not value]
    kept = f"at constant {held}"
    first = stability(found, D, K, has_even_dissipation(model, values, driven, zero))
    if first.verdict == "stable" and found:
        return Stability("stable", ROUTH if held == "momenta" else AT_RATES)
    if first.verdict != "undecided":
        return Stability(first.verdict, f"linearised {kept}: {first.reason}" if found else first.reason)
    if held == "momenta" and not model.closures and not any(search.conditions.inputs.values()):
        shifts = shifts_along(model, values, np.eye(model.dof)[list(search.moving)])
        reason = bounded_by_integrals(model, values, shifts, zero)
        if reason is not None:
            return Stability("stable", reason)
    return Stability("undecided", f"linearised {kept}: {first.reason}")


class _TreeFamilies(FamilySearch[SteadySearch]):
    def __init__(self, search: SteadySearch, vary: str, between: tuple[float, float], steps: int, held: bool) -> None:
        super().__init__(search, vary, between, steps)
        self.held = held

    def _least(self, u: Array) -> float:
        h, n = DIFFERENCE * self.search.length, self.search.n
        x = self._put(u)
        sides = [[self.search.equations(x + side * h * e)[0] for e in np.eye(n)] for side in (1, -1)]
        sizes = np.linalg.svd((np.array(sides[0]) - sides[1]) / (2 * DIFFERENCE), compute_uv=False)
        return float(sizes[n - 1] / sizes.max(initial=1))

    def _eigenvalues(self, u: Array) -> ComplexArray:
        """Of the disturbances of a motion."""
        at = self.search.matrices(self._put(u), self.held)
        return np.linalg.eigvals(first_order(at.M, at.D, at.K)).astype(np.complex128)

    def _signature(self, u: Array) -> tuple[int, ...]:
        """What the module watches, but for whether the value rises."""
        x = self._put(u)
        if self.search.is_singular(x):
            return SINGULAR
        given, held = (self.search.matrices(x, held) for held in (self.search.of_momenta, self.held))
        if not all(np.isfinite(matrix).all() for matrix in (given.K, held.K, held.D)):
            return SINGULAR
        eigenvalues = np.linalg.eigvals(first_order(held.M, held.D, held.K))
        growing = int((eigenvalues.real > NEUTRAL * np.abs(eigenvalues).max(initial=0)).sum())
        return _negative(given.K), _negative(held.K), growing

    def _equations(self, u: Array) -> tuple[Array, Array]:
        """F and F_u; not a number where the coordinates are singular."""
        sides = []
        for side in (1, -1):
            x = self._put(u + side * DIFFERENCE * np.eye(len(u))[-1])
            sides.append(self.search.equations(x)[0])
        x = self._put(u)
        F, J = self.search.equations(x)
        by_value = (sides[0] - sides[1]) / (2 * DIFFERENCE)
        J = np.nan_to_num(np.column_stack((J * self.search.length, by_value)))
        return (np.full_like(F, np.nan) if self.search.is_singular(x) else F), J


def _negative(K: Array) -> int:
    """How many eigenvalues of K are negative, of K that is not symmetric whether the number is odd."""
    size = float(np.abs(K).max(initial=0))
    if not size:
        return 0
    if np.abs(K - K.T).max() > SYMMETRIC * size:
        return int(np.linalg.slogdet(K)[0] < 0)
    return int((np.linalg.eigvalsh((K + K.T) / 2) < -ZERO * size).sum())
