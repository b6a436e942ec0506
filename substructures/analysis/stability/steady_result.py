"""Steady motions, and families of them with their bifurcations, as they are found."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from substructures.analysis.stability.found_places import FoundPlaces, still
from substructures.analysis.stability.vibrations import Mode, Stability
from substructures.analysis.verdict import Check
from substructures.array import Array

#: what keeps its values in a disturbed motion
Held = Literal["momenta", "rates"]
Kind = Literal["fold", "pitchfork", "transcritical", "branch-point", "zero-eigenvalue", "hopf", "hamiltonian-hopf"]
#: at which families cross, and at which the equations of the search are singular
CROSSED: tuple[Kind, ...] = ("pitchfork", "transcritical")
STATIC: tuple[Kind, ...] = (*CROSSED, "fold", "branch-point")
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


@dataclass(frozen=True, repr=False)
class BallSteadyMotion(SteadyMotion):
    """``q`` (m,) by ``positions``; M, D, K (n, n) are those of M dv' + D dv + K dq = 0, dq' = dv + (R + S) dq, for
    displacements dq and all rates v. ``precession``: the rate of all about the ``axis`` of the world [rad/s], and the
    ``angular_momentum`` about it [N m s]; ``v`` (n,): the rates, which turn with sigma_c where there is a precession.
    """

    positions: tuple[str, ...] = ()
    v: Array = field(default_factory=lambda: np.zeros(0))
    axis: str = ""
    precession: float = 0.0
    angular_momentum: float = 0.0

    def __repr__(self) -> str:
        place = ", ".join(f"{name}={x:.6g}" for name, x in zip(self.positions, self.q.tolist(), strict=True))
        rates = ", ".join(f"{name}'={w:.6g}" for name, w in zip(self.moving, self.rates.tolist(), strict=True))
        about = f"precession={self.precession:.6g}" if self.precession else ""
        finding = self.message if self.stability is None else f"{self.stability.verdict}: {self.stability.reason}"
        return f"SteadyMotion({', '.join(filter(None, (place, rates, about)))})\n{finding}"


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
