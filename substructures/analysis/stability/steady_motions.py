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
from dataclasses import dataclass, replace

import numpy as np

from substructures.analysis.arguments import one_of, whole
from substructures.analysis.equations.energy import has_even_dissipation
from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.given import numbers
from substructures.analysis.stability.constrained_search import ConstrainedSearch
from substructures.analysis.stability.energy_integrals import bounded_by_integrals
from substructures.analysis.stability.equilibrium_search import RestConditions, SearchRange
from substructures.analysis.stability.found_places import FoundPlaces, confirmed, still
from substructures.analysis.stability.steady_conditions import (
    Held,
    SteadyConditions,
    ends_of,
    given_of,
    require_no_velocities,
    require_rates,
)
from substructures.analysis.stability.steady_families import STATIC, Kind, families
from substructures.analysis.stability.steady_search import SteadySearch
from substructures.analysis.stability.vibrations import AT_RATES, ROUTH, Mode, Stability, modes, normed, stability
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.states import with_input_defaults
from substructures.tree.document import require_undriven, require_unignored
from substructures.tree.model import Model

#: of a range
STEPS = (2, 1000)
#: where in it is looked which coordinates are free
WITHIN = 0.38
#: a singular value of differences that is rounding, relative to the largest or 1
SINGULAR = 1e-6


@dataclass(frozen=True, repr=False)
class SteadyMotion:
    """``q`` (n,): the coordinates, 0 where they move [rad, m]; ``rates`` (m,) of the ``moving`` ones [rad/s, m/s] and
    their ``momenta`` (m,) [N m s, N s].

    ``M``, ``D``, ``K`` (r, r): of M dy'' + D dy' + K dy = 0 for disturbances of the r ``independent`` others, with
    ``modes``, slowest first, whose shapes are those of all others, and ``qdd`` (r,) their accelerations in the motion,
    which are none but for rounding. With velocity constraints of the tree ``independent`` are the p quasi-velocities,
    M, D (p, p) and K (p, n) those of M dv' + D dv + K dq = 0, and momenta are not kept. ``stability`` is None where
    there is no linearisation; ``message`` says why.
    """

    coordinates: tuple[str, ...]
    moving: tuple[str, ...]
    independent: tuple[str, ...]
    q: Array
    rates: Array
    momenta: Array
    M: Array
    D: Array
    K: Array
    qdd: Array
    modes: tuple[Mode, ...] = ()
    stability: Stability | None = None
    message: str = ""
    value: float | None = None
    branch: int | None = None

    def __repr__(self) -> str:
        still = [name for name in self.coordinates if name not in self.moving]
        at = dict(zip(self.coordinates, self.q.tolist(), strict=True))
        place = ", ".join(f"{name}={at[name]:.6g}" for name in still)
        rates = ", ".join(f"{name}'={w:.6g}" for name, w in zip(self.moving, self.rates.tolist(), strict=True))
        finding = self.message if self.stability is None else f"{self.stability.verdict}: {self.stability.reason}"
        return f"SteadyMotion({', '.join(filter(None, (place, rates)))})\n{finding}"

    @property
    def verdict(self) -> str:
        """Of its stability; ``failed`` where there is none."""
        return "failed" if self.stability is None else self.stability.verdict

    def check(self) -> Check:
        """That it is steady, by the equations of motion of the model, which the search had not."""
        place = ", ".join(f"{x:.6g}" for x in self.q.tolist())
        name = f"steady at {place}"
        if self.stability is None or not self.independent:
            why = self.message or "nothing is left to move"
            return Check.left_out(name, "zero", why, needed=self.stability is None)
        return still(name, "what is still is not accelerated", self.qdd, self.M, self.K)


@dataclass(frozen=True)
class Bifurcation:
    """Where a family of steady motions turns back, meets others or changes its stability: ``at``, with the ``value`` of
    what varies; its ``kind`` by the names of :mod:`substructures.analysis.stability.steady_families`, and the reason.
    ``least``: the least singular value of the equations by x, by differences, over the largest or 1; 0 but for rounding
    where families turn back or meet.
    """

    kind: Kind
    reason: str
    at: SteadyMotion
    least: float

    def checks(self) -> tuple[Check, ...]:
        """That it is steady, and that neighbours branch or turn back there."""
        name = f"{self.kind} at {self.at.value:.6g}"
        reason = "the equations of steady motions, by differences, are singular where families turn back or meet"
        branches = Check.at((name, "zero", reason, ""), self.least, 0.0, 1.0, SINGULAR)
        return (self.at.check(), branches) if self.kind in STATIC else (self.at.check(),)


@dataclass(frozen=True, repr=False)
class SteadyMotions(FoundPlaces[SteadyMotion]):
    """All that were found. ``moving``: coordinates with constant rates, ``held``: what keeps its values in a disturbed
    motion. The ``message`` also says how many places were left out because the coordinates are singular there (a
    spherical joint at a pitch of +-pi/2). Where something varies (``vary``), those of one ``branch`` after the other,
    each from the one before, and the ``bifurcations`` of these families.
    """

    moving: tuple[str, ...]
    held: Held
    vary: str | None = None
    bifurcations: tuple[Bifurcation, ...] = ()

    def __repr__(self) -> str:
        places = tuple(f"{one.kind} at {one.at.value:.6g}" for one in self.bifurcations)
        return self._shown(moving=self.moving, **({"bifurcations": places} if self.vary else {}))

    @property
    def checks(self) -> tuple[Check, ...]:
        """One for each, and those of the bifurcations."""
        return (*super().checks, *(check for one in self.bifurcations for check in one.checks()))


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

    In reduced systems (``ignored``) all others keep still: ``rates`` {}, ``vary`` a parameter of the momenta. With
    velocity constraints of the tree all coordinates keep still but those on which nothing depends (the place on a
    plane, headings, angles of wheels), of which ``rates`` are given, or of quasi-velocities: others follow. Where ways
    are left free the motion near to each of ``starts`` and to zero is taken. Quasi-velocities that are constant then
    are given by ``velocities`` or ``independent`` (see quasi_velocity_equations), where those of coordinates that are
    chosen by default are not. Raises InvalidInput (``/rates``, ``/rates/name``, ``/momenta/name``, ``/vary``,
    ``/between``, ``not-smooth``) and MissingValue. Source: notation.md, section 7.
    """
    require_moving(model, "steady-motions")
    if model.velocity_constraints:
        conditions = RestConditions(0.0, parameters or {}, with_input_defaults(model, inputs or {}))
        require_rates(rates, momenta, held, vary)
        around = SearchRange(starts, count, reach, seed)
        return _constrained(ConstrainedSearch(model, around, conditions, rates or {}, velocities, independent))
    require_no_velocities(velocities, independent)
    require_undriven(model.driven, "take the tree without it, or equilibria, which are relative to the drives")
    one_of(held, "held", ("momenta", "rates"))
    whole(steps, "steps", *STEPS)
    ends = ends_of(model, vary, between)
    given, field = given_of(rates, momenta, held)
    constant = numbers(parameters, "parameters"), with_input_defaults(model, inputs or {})
    asked = SteadyConditions(model, given, field, held, *constant, vary)
    # a coordinate may be free at one end only, where what acts on it is 0
    moving = asked.moving(ends[0] + WITHIN * (ends[-1] - ends[0]))
    if moving:
        require_unignored(model.ignored)
    within = SearchRange(starts, count, reach, seed)
    searches = [asked.search(moving, within, value) for value in ends]
    found = [search.places(search.starts(), list(range(search.n))) for search in searches]
    failing = sum(count for _, count in found)
    singular = f"{failing} places were left out where these coordinates are singular" if failing else ""
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


def _constrained(search: ConstrainedSearch) -> SteadyMotions:
    """With velocity constraints."""
    model, names, some = search.model, search.named(search.moving), []
    found = search.found()
    for state in found:
        at, places = state.at, search.moving
        q = np.where(np.isin(np.arange(model.dof), search.ignorable), 0.0, at.q)
        values = search.known | dict(zip(model.coordinates, q.tolist(), strict=True))
        momenta = interpret(model.program, values, ["metric"])["metric"] @ at.qd
        matrices = at.qd[places], momenta[places], at.M, at.D, at.K, at.vd
        some.append(SteadyMotion(model.coordinates, names, at.velocities, q, *matrices, at.modes, at.stability))
    motions, left_out = confirmed(some)
    message = "" if motions else "no steady motion was found: give 'starts' near one, other rates, or raise 'count'"
    free = max((state.free for state in found), default=0)
    beside = f"beside some are families of up to {free} parameters with the same rates: name rates of more coordinates"
    message = "; ".join(filter(None, (message, left_out, beside if free else "")))
    return SteadyMotions(motions, names, "momenta", message=message)


def _families(
    search: SteadySearch, vary: str, between: tuple[float, float], starts: list[list[Array]], steps: int, held: Held
) -> tuple[list[SteadyMotion], tuple[Bifurcation, ...], str]:
    """The motions of all families, their bifurcations, and what is to be said."""
    found = families(search, vary, between, starts, steps, held == "momenta")

    def described(x: Array, value: float, branch: int) -> SteadyMotion:
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
        reason = bounded_by_integrals(model, values, search.moving, zero)
        if reason is not None:
            return Stability("stable", reason)
    return Stability("undecided", f"linearised {kept}: {first.reason}")
