"""Families of steady motions over a parameter, a rate or a momentum, with their bifurcations.

Families are followed by pseudo-arclength from all steady motions at both ends of the range, and from where others
cross. On the way four integers are watched: whether the value rises, how many negative eigenvalues K has at what is
given and at what is held, and how many eigenvalues of M dx'' + D dx' + K dx = 0 have positive real parts. Where one
changes is a bifurcation:

    fold               the value is extreme, the family turns back
    pitchfork          another family crosses whose value is extreme there
    transcritical      another family crosses
    branch-point       more eigenvalues vanish together, or second derivatives do not tell who meets
    zero-eigenvalue    K is singular at constant momenta, not at the rates that are given: momenta are extreme
    hopf               a pair of complex eigenvalues passes through the imaginary axis
    hamiltonian-hopf   two pairs on the imaginary axis meet and leave it

R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. 2010, chapters 2, 4 and 5; J.-C. van der Meer, The
Hamiltonian Hopf Bifurcation, 1985.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

import numpy as np

from substructures.analysis.continuation import LOST, Change, Continuation
from substructures.analysis.stability.steady_result import CROSSED, Kind
from substructures.analysis.stability.vibrations import NEUTRAL
from substructures.array import Array, ComplexArray

#: what is nearer is one place; a part of the range along which a value counts as extreme
NEAR, VERTICAL = 1e-4, 1e-3
#: imaginary parts of eigenvalues that count as none, relative to the largest eigenvalue
REAL = 1e-6
#: step of differences of equations by the value, of the range
DIFFERENCE = 1e-6
#: families that are followed
MOST = 64
#: what is watched where the coordinates are singular
SINGULAR = (-1, -1, -1)


@dataclass(eq=False)
class Found:
    """A bifurcation at ``x`` (k,) and the ``value``, met by the family ``branch``; why."""

    kind: Kind
    reason: str
    x: Array
    value: float
    branch: int
    u: Array
    #: the least singular value of the equations' Jacobian by differences, over the largest or 1
    least: float
    #: directions in which families leave that are not known yet
    ways: list[Array] = field(default_factory=list)


@dataclass(frozen=True)
class Families:
    """The families, each as its points (x, value), where they bifurcate, and what is to be said of them."""

    branches: list[list[tuple[Array, float]]]
    bifurcations: list[Found]
    messages: list[str]


class Searched(Protocol):
    """What families need of a search: ``n`` unknowns x and the ``length`` (n,) of each."""

    n: int
    length: Array

    def put(self, name: str, value: float) -> None:
        """What varies has another value."""

    def wound(self, x: Array, /) -> Array:
        """Angles by the shorter way round."""

    def distance(self, x: Array, y: Array, /) -> float:
        """How far two places are apart."""


S = TypeVar("S", bound=Searched)


class FamilySearch(ABC, Generic[S]):
    """The families of one search, with what is watched on the way."""

    def __init__(self, search: S, vary: str, between: tuple[float, float], steps: int) -> None:
        self.search, self.vary, self.between = search, vary, between
        self.curve = Continuation(self._equations, self._signature, 1 / steps)
        self.branches: list[list[Array]] = []
        self.bifurcations: list[Found] = []
        self.messages: list[str] = []

    def run(self, starts: list[list[Array]]) -> Families:
        """The families from both ends, each with those that cross it."""
        forward = np.eye(self.search.n + 1)[-1]
        for end, places in enumerate(starts):
            for x in places:
                u = np.append(x / self.search.length, float(end))
                if len(self.branches) < MOST and not any(
                    self._is_at(u, branch[k]) for branch in self.branches for k in (0, -1)
                ):
                    self._follow(u, -forward if end else forward)
                    self._follow_crossing()
        if len(self.branches) == MOST:
            self.messages.append(f"{MOST} families were followed, and no others")
        found = [[(self._x(u), self._value(u)) for u in branch] for branch in self.branches]
        return Families(found, self.bifurcations, self.messages)

    def _follow_crossing(self) -> None:
        """The families that leave from bifurcations, and those that leave from theirs."""
        for one in self.bifurcations:  # which become more
            while one.ways and len(self.branches) < MOST:
                way = one.ways.pop(0)
                beside = self.curve.beside(one.u, way)
                if beside is not None and 0 <= beside[-1] <= 1:
                    self._follow(beside, way)

    def _follow(self, u: Array, direction: Array) -> None:
        """One family, to the end of the range, or to a place where families are known to meet."""
        branch: list[Array] = []
        self.branches.append(branch)
        for point, changes in self.curve.follow(u, direction):
            known = len(self.bifurcations)
            for change in changes:
                if SINGULAR in (change.before[1][1:], change.after[1][1:]):
                    self._ended(LOST)
                    return
                one = self._bifurcation(change)
                met = next((other for other in self.bifurcations if self._is_known(one, other)), None)
                if met is None:
                    self.bifurcations.append(one)
                elif met in self.bifurcations[:known] and met.kind in CROSSED:
                    self._arrived(met, branch[-1])
                    return
            branch.append(point)
        if self.curve.message:
            self._ended(self.curve.message)

    def _ended(self, why: str) -> None:
        number = len(self.branches) - 1
        value = self._value(self.branches[number][-1])
        self.messages.append(f"family {number} ends at {self.vary} = {value:.6g}: {why}")

    def _arrived(self, at: Found, last: Array) -> None:
        """The way from a bifurcation along which a family came is known."""
        # by the shorter way round
        came = np.append(self.search.wound(self._x(last - at.u)) / self.search.length, last[-1] - at.u[-1])
        at.ways = [way for way in at.ways if way @ came < 0.7 * np.linalg.norm(came)]

    def _is_known(self, one: Found, other: Found) -> bool:
        """Whether it is the other one; where K is singular an eigenvalue is 0, which is placed less well."""
        if one.kind == "zero-eigenvalue":
            return bool(np.linalg.norm(one.u - other.u) < self.curve.step / 10)
        return self._is_at(one.u, other.u)

    def _bifurcation(self, change: Change) -> Found:
        u, ways = change.u, list[Array]()
        if change.which == 3:
            kind, reason = self._hopf(change)
        elif change.which == 2:
            kind = "zero-eigenvalue"
            reason = "K is singular at constant momenta: as functions of the momenta families branch or turn back here"
        elif (crossing := self.curve.crossing(u)) is None:
            kind, reason = self._single(change)
        else:
            u = crossing
            kind, reason, ways = self._crossing(u, change.seen_from)
        return Found(kind, reason, self._x(u), self._value(u), len(self.branches) - 1, u, self._least(u), ways)

    def _single(self, change: Change) -> tuple[Kind, str]:
        """Of one family, as far as is known."""
        if abs(change.tangent[-1]) < VERTICAL:
            return "fold", f"{self.vary} is extreme along the family, which turns back"
        return "branch-point", "more than one eigenvalue of K is 0, or all derivatives: who meets here is not told"

    def _crossing(self, u: Array, seen_from: Array) -> tuple[Kind, str, list[Array]]:
        """Of two families, with the ways along which the other one leaves."""
        tangents = self.curve.tangents(u)
        if not tangents:
            return "branch-point", "K is singular, and second derivatives do not tell which families meet", []
        other = min(tangents, key=lambda d: abs(d @ seen_from))
        ways = [other, -other]
        if min(abs(d[-1]) for d in tangents) < VERTICAL:
            return "pitchfork", f"a family crosses along which {self.vary} is extreme here", ways
        return "transcritical", "another family crosses", ways

    def _hopf(self, change: Change) -> tuple[Kind, str]:
        u = max(change.before, change.after, key=lambda side: side[1][3])[0]
        eigenvalues = self._eigenvalues(u)
        scale = float(np.abs(eigenvalues).max())
        z = min(eigenvalues[eigenvalues.real > NEUTRAL * scale], key=lambda z: z.real)
        if abs(z.imag) <= REAL * scale:
            return "zero-eigenvalue", "a real eigenvalue passes through 0"
        # without damping -z is an eigenvalue where z is, and both are with their conjugates
        if np.abs(eigenvalues + np.conj(z)).min() < z.real / 2:
            reason = f"two pairs of eigenvalues meet at {abs(z.imag):.6g} rad/s and leave the imaginary axis"
            return "hamiltonian-hopf", reason
        return "hopf", f"a pair of eigenvalues passes through the imaginary axis at {abs(z.imag):.6g} rad/s"

    @abstractmethod
    def _equations(self, u: Array) -> tuple[Array, Array]:
        """F and F_u; not a number where the coordinates are singular."""

    @abstractmethod
    def _signature(self, u: Array) -> tuple[int, ...]:
        """What the module watches, but for whether the value rises."""

    @abstractmethod
    def _eigenvalues(self, u: Array) -> ComplexArray:
        """Of the disturbances of a motion."""

    @abstractmethod
    def _least(self, u: Array) -> float:
        """The least singular value of F_x by differences, over the largest or 1."""

    def _put(self, u: Array) -> Array:
        """The coordinates of a point, when the search has its value."""
        self.search.put(self.vary, self._value(u))
        return self._x(u)

    def _x(self, u: Array) -> Array:
        return np.asarray(u[:-1] * self.search.length, dtype=np.float64)

    def _value(self, u: Array) -> float:
        first, last = self.between
        return float((1 - u[-1]) * first + u[-1] * last)

    def _is_at(self, u: Array, other: Array) -> bool:
        """Whether two points are one."""
        apart = self.search.distance(self._x(u), self._x(other))
        return max(apart, abs(float(u[-1] - other[-1]))) < NEAR
