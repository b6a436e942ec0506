"""Steady motions with velocity constraints as results, and families of them over a parameter or a rate.

The equations F(y, s) = 0 of :mod:`.constrained_search` are more than the unknowns, and some follow from others: their
Jacobian has the rank n of the unknowns y where the given rates leave no way free, so that pseudo-arclength takes steps
by its pseudo-inverse. On the way are watched the sign of det P F_y, P: n rows that are independent where the family
begins, and how many eigenvalues of the neighbours that keep the gaps have positive real parts. Where a real one passes
through 0, or a pair through the imaginary axis, the motion gains or loses its stability: the speed of a rolling disc
(E. J. Routh, Advanced Rigid Dynamics, 1884, article 244), the weave and capsize speeds of a bicycle (J. P. Meijaard,
J. M. Papadopoulos, A. Ruina, A. L. Schwab, Proc. R. Soc. A 463, 2007).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from substructures.analysis.stability.constrained_search import ConstrainedSearch
from substructures.analysis.stability.found_places import confirmed
from substructures.analysis.stability.linearisation_result import ConstrainedLinearisation
from substructures.analysis.stability.steady_families import DIFFERENCE, SINGULAR, FamilySearch
from substructures.analysis.stability.steady_result import Bifurcation, SteadyMotion, SteadyMotions
from substructures.analysis.stability.vibrations import NEUTRAL
from substructures.array import Array, ComplexArray
from substructures.expr.interpret import interpret

#: part of the largest row of a Jacobian that counts as none
NOTHING = 1e-9
NONE = "no steady motion was found: give 'starts' near one, other rates, or raise 'count'"


def constrained_motions(
    search: ConstrainedSearch, vary: str | None, ends: Sequence[float], steps: int
) -> SteadyMotions:
    """All that a search finds; or the families from those at both ``ends`` of the range of what varies."""
    names, more, said = search.named(search.moving), tuple[Bifurcation, ...](), list[str]()
    if vary is None:
        found = search.found()
        some, free = [_motion(search, state.at) for state in found], max((state.free for state in found), default=0)
    else:
        with np.errstate(all="ignore"):
            some, more, free, said = _families(search, vary, (ends[0], ends[-1]), steps)
    motions, left_out = confirmed(some)
    beside = f"beside some are families of up to {free} parameters with the same rates: name rates of more coordinates"
    texts = ["" if motions else NONE, left_out, beside if free else "", *said]
    return SteadyMotions(motions, names, "momenta", vary, more, message="; ".join(filter(None, texts)))


def _motion(search: ConstrainedSearch, at: ConstrainedLinearisation) -> SteadyMotion:
    model, places = search.model, search.moving
    q = np.where(np.isin(np.arange(model.dof), search.ignorable), 0.0, at.q)
    values = search.known | dict(zip(model.coordinates, q.tolist(), strict=True))
    momenta = interpret(model.program, values, ["metric"])["metric"] @ at.qd
    matrices = at.qd[places], momenta[places], at.M, at.D, at.K, at.vd
    names = search.named(places)
    return SteadyMotion(model.coordinates, names, at.velocities, q, *matrices, at.modes, at.stability)


def _families(
    search: ConstrainedSearch, vary: str, ends: tuple[float, float], steps: int
) -> tuple[list[SteadyMotion], tuple[Bifurcation, ...], int, list[str]]:
    """The motions of all families, their bifurcations, how many ways were left free at most, and what is to be said."""
    starts, free = list[list[Array]](), 0
    for value in ends:
        search.put(vary, value)
        found = search.found()
        # beside others with the same rates there is no one family
        starts.append([search.place(state.at) for state in found if not state.free])
        free = max([free, *(state.free for state in found)])
    search.measure(np.abs([y for some in starts for y in some]).max(initial=1.0))
    families = _ConstrainedFamilies(search, vary, ends, steps).run(starts)

    def described(y: Array, value: float, branch: int) -> SteadyMotion:
        """A point of a family."""
        search.put(vary, value)
        return replace(_motion(search, search.linearised(search.wound(y))), value=value, branch=branch)

    motions = [described(y, value, k) for k, branch in enumerate(families.branches) for y, value in branch]
    bifurcations = tuple(
        Bifurcation(one.kind, one.reason, described(one.x, one.value, one.branch), one.least)
        for one in families.bifurcations
    )
    return motions, bifurcations, free, families.messages


class _ConstrainedFamilies(FamilySearch[ConstrainedSearch]):
    def __init__(self, search: ConstrainedSearch, vary: str, between: tuple[float, float], steps: int) -> None:
        super().__init__(search, vary, between, steps)
        self.unit: Array | None = None
        self.rows: Array | None = None
        self.last: tuple[bytes, tuple[Array, Array]] | None = None

    def _follow(self, u: Array, direction: Array) -> None:
        # rows that are independent where the family begins
        self.rows = np.linalg.svd(self._equations(u)[1][:, :-1])[0][:, : self.search.n].T
        super()._follow(u, direction)

    def _eigenvalues(self, u: Array) -> ComplexArray:
        """Of the neighbours that keep the gaps."""
        at = self.search.linearised(self._put(u))
        upper = [mode.eigenvalue for mode in at.modes]
        return np.array([*upper, *(z.conjugate() for z in upper if z.imag)], dtype=np.complex128)

    def _signature(self, u: Array) -> tuple[int, ...]:
        """The sign of det P F_y, and the number of growing disturbances."""
        F, J = self._equations(u)
        if not (np.isfinite(F).all() and np.isfinite(J).all()) or self.rows is None:
            return SINGULAR
        eigenvalues = self._eigenvalues(u)
        growing = int((eigenvalues.real > NEUTRAL * np.abs(eigenvalues).max(initial=0)).sum())
        return int(np.linalg.slogdet(self.rows @ J[:, :-1])[0] < 0), 0, growing

    def _equations(self, u: Array) -> tuple[Array, Array]:
        """F and F_u, over the sizes of its rows where the first family begins."""
        if self.last is None or self.last[0] != u.tobytes():
            self.last = u.tobytes(), self._evaluated(u)
        return self.last[1]

    def _evaluated(self, u: Array) -> tuple[Array, Array]:
        search, last = self.search, np.eye(len(u))[-1]
        if search.is_rate(self.vary):
            by_value = search.by_rate(self.vary) * (self.between[1] - self.between[0])
        else:
            sides = [search.equations_at(self._put(u + side * DIFFERENCE * last))[0] for side in (1, -1)]
            by_value = (sides[0] - sides[1]) / (2 * DIFFERENCE)
        F, J = search.equations_at(self._put(u))
        J = np.column_stack((J * search.length, by_value))
        if self.unit is None:
            sizes = np.abs(J).max(axis=1, initial=0)
            largest = float(sizes.max(initial=0)) or 1.0
            # what rounding leaves of a row that is zero there is no unit
            self.unit = np.where(sizes > NOTHING * largest, sizes, largest)
        return F / self.unit, np.nan_to_num(J / self.unit[:, None])

    def _least(self, u: Array) -> float:
        h, n = DIFFERENCE * self.search.length, self.search.n
        y = self._put(u)
        unit = np.ones(1) if self.unit is None else self.unit
        sides = [[self.search.equations_at(y + side * h * e)[0] / unit for e in np.eye(n)] for side in (1, -1)]
        sizes = np.linalg.svd((np.array(sides[0]) - sides[1]) / (2 * DIFFERENCE), compute_uv=False)
        return float(sizes[n - 1] / sizes.max(initial=1))
