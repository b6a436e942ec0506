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
from typing import Literal

import numpy as np

from substructures.analysis.arguments import one_of
from substructures.analysis.equations.energy import has_even_dissipation
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.equations.steady import require_free
from substructures.analysis.given import numbers
from substructures.analysis.stability.energy_integrals import bounded_by_integrals
from substructures.analysis.stability.equilibrium_search import RestConditions, SearchRange
from substructures.analysis.stability.found_places import FoundPlaces, confirmed, still
from substructures.analysis.stability.nearly_cyclic import nearly_cyclic
from substructures.analysis.stability.steady_search import ClosedSteadySearch, SteadySearch
from substructures.analysis.stability.vibrations import Mode, Stability, modes, normed, stability
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument
from substructures.quantities.numbers.states import with_input_defaults
from substructures.tree.model import Model

Held = Literal["momenta", "rates"]


@dataclass(frozen=True, repr=False)
class SteadyMotion:
    """``q`` (n,): the coordinates, 0 where they move [rad, m]; ``rates`` (m,) of the ``moving`` ones [rad/s, m/s] and
    their ``momenta`` (m,) [N m s, N s].

    ``M``, ``D``, ``K`` (r, r): of M dy'' + D dy' + K dy = 0 for disturbances of the r ``independent`` others, with
    ``modes``, slowest first, whose shapes are those of all others, and ``qdd`` (r,) their accelerations in the motion,
    which are none but for rounding. ``stability`` is None where there is no linearisation; ``message`` says why.
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


@dataclass(frozen=True, repr=False)
class SteadyMotions(FoundPlaces[SteadyMotion]):
    """All that were found. ``moving``: coordinates with constant rates, ``held``: what keeps its values in a disturbed
    motion. The ``message`` also says how many places were left out because the coordinates are singular there (a
    spherical joint at a pitch of +-pi/2).
    """

    moving: tuple[str, ...]
    held: Held

    def __repr__(self) -> str:
        return self._shown(moving=self.moving)


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
) -> SteadyMotions:
    """Steady motions: Gamma_xbc w^b w^c = Q_x with s' = w constant and all other coordinates x still; with closures
    Gamma_xbc w^b w^c = Q_x + lambda_k G_kx and phi_k = 0.

    Given are either ``rates`` w [rad/s, m/s] or ``momenta`` [N m s, N s] of cyclic coordinates by name, also of those
    that are so but for the rounding of decimals; those that are not named have 0. ``held``: ``momenta`` keep their
    values when the motion is disturbed, since nothing acts on cyclic coordinates; or ``rates`` do, those of the named
    coordinates, which are driven then and need not be cyclic as long
    as nothing else depends on them. The search is that of equilibria: ``starts`` (N, n), zero, ``count`` random places
    within ``reach`` [m]. ``parameters`` in place of their defaults, constant ``inputs`` [N m, N]. That none is found is
    a result with advice. Raises InvalidInput (``/rates``, ``/rates/name``, ``/momenta/name``, ``not-smooth``)
    and MissingValue. Source: notation.md, section 7.
    """
    require_moving(model)
    one_of(held, "held", ("momenta", "rates"))
    conditions = RestConditions(0.0, parameters or {}, with_input_defaults(model, inputs or {}))
    given, field = _given(rates, momenta, held)
    moving = _moving(model, conditions, given, field, held)
    wanted = np.array([given.get(model.coordinates[s], 0.0) for s in moving])
    within = SearchRange(starts, count, reach, seed)
    kind = ClosedSteadySearch if model.closures else SteadySearch
    search = kind(model, moving, within, conditions, wanted, field == "momenta")
    found, failing = search.places(search.starts(), list(range(search.n)))
    motions, left_out = confirmed([_described(search, x, held) for x in found])
    names = tuple(model.coordinates[s] for s in moving)
    message = "" if motions else "no steady motion was found: give 'starts' near one, other rates, or raise 'count'"
    singular = f"{failing} places were left out where these coordinates are singular" if failing else ""
    message = "; ".join(filter(None, (message, singular, left_out)))
    return SteadyMotions(motions, names, held, message=message)


def _given(
    rates: Mapping[str, float] | None, momenta: Mapping[str, float] | None, held: Held
) -> tuple[dict[str, float], Literal["rates", "momenta"]]:
    """What is given, by coordinate, and what it is. Raises InvalidArgument."""
    if (rates is None) == (momenta is None):
        raise InvalidArgument.at("/rates", "rates-or-momenta", "give either 'rates' or 'momenta'")
    if momenta is not None and held == "rates":
        raise InvalidArgument.at("/momenta", "not-supported", "rates that are held are given as 'rates'")
    return (numbers(momenta, "momenta"), "momenta") if rates is None else (numbers(rates, "rates"), "rates")


def _moving(model: Model, conditions: RestConditions, given: Mapping[str, float], field: str, held: Held) -> list[int]:
    """The coordinates s. Raises InvalidArgument for names that are none, or not free to move at constant rates."""
    acting = [name for name, value in conditions.inputs.items() if value]
    free = {*first_integrals(model, acting).cyclic, *nearly_cyclic(model, conditions)} if held == "momenta" else set()
    cyclic = [name for name in model.coordinates if name in free]
    known = model.coordinates if held == "rates" else cyclic
    what = "coordinate" if held == "rates" else "cyclic coordinate"
    faults = [
        Fault(f"/{field}/{name}", "not-cyclic", f"'{name[:80]}' is no {what}; there are: {', '.join(known) or 'none'}")
        for name in given
        if name not in known
    ]
    if faults:
        raise InvalidArgument(faults)
    moving = sorted(model.coordinates.index(name) for name in (given if held == "rates" else cyclic))
    if not moving:
        raise InvalidArgument.at(
            f"/{field}", "no-cyclic-coordinate", "there is no coordinate that moves at a constant rate"
        )
    if held == "rates":
        require_free(model, moving)
    return moving


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
        what = "the amended potential V + 1/2 p g^-1 p" if held == "momenta" else "V - 1/2 w g w"
        return Stability("stable", f"{what} has a strict minimum {kept} (Routh, Salvadori)")
    if first.verdict != "undecided":
        return Stability(first.verdict, f"linearised {kept}: {first.reason}" if found else first.reason)
    if held == "momenta" and not model.closures and not any(search.conditions.inputs.values()):
        reason = bounded_by_integrals(model, values, search.moving, zero)
        if reason is not None:
            return Stability("stable", reason)
    return Stability("undecided", f"linearised {kept}: {first.reason}")
