"""Closed loops at a state: redundancy, degrees of freedom, independent coordinates, accelerations, reaction forces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.arguments import real
from substructures.analysis.closed.constrained import SINGULAR, Constrained, Singular, require_fixed
from substructures.analysis.closed.pivoting import pivoted
from substructures.analysis.closed.projection import CLOSED, Consistent, consistent_state
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array
from substructures.mechanics.closure_rows import RANK, rank_of, ranks
from substructures.quantities.numbers.reaction_numbers import least_norm
from substructures.tree.model import Model

#: size of the tangent step that tells a singular position from a redundant closure [rad, m]
NEARBY = 1e-3
#: residuals of a right state: of positions and velocities over the width of their rows and their largest number or 1,
#: and of equations over terms
MET, SOLVED = 1e-9, 1e-8
#: rows of closures that transmit forces; the others transmit moments
ALONG = ("x", "y", "z", "length")


@dataclass(frozen=True)
class Mobility:
    """What the closures leave free at a state.

    ``counted`` = coordinates - rows, as in the formulas of Gruebler and Kutzbach; ``degrees_of_freedom`` = coordinates
    - ``rank``, from the singular values above 1e-8 of the largest. ``dependent``: rows (closure.row) that can be left
    out; ``entangled``: all rows whose reactions are not unique, by closure. ``singular``: the rank is lower here than
    nearby, so that the motion is not determined (a dead centre, a branching).
    """

    rank: int
    degrees_of_freedom: int
    counted: int
    dependent: tuple[str, ...]
    entangled: Mapping[str, tuple[str, ...]]
    independent_coordinates: tuple[str, ...]
    singular: bool

    @property
    def redundant(self) -> bool:
        """Whether closures depend on each other."""
        return bool(self.dependent)


@dataclass(frozen=True)
class Reaction:
    """Force [N] and moment [N m] that a closure exerts on its frame ``to``, in the axes of its frame ``from``, at the
    origin of ``to``; the opposite acts on ``from``. ``not_unique``: rows of which only sums are determined; the least
    ones are given.
    """

    closure: str
    force: Array
    moment: Array
    not_unique: tuple[str, ...]


@dataclass(frozen=True)
class LoopState:
    """Accelerations (n,), multipliers (m,) of least norm, reactions and actuator forces of prescribed coordinates."""

    consistent: Consistent
    mobility: Mobility
    qdd: Array
    multipliers: Array
    reactions: tuple[Reaction, ...]
    actuation: Mapping[str, float]
    message: str = ""
    checks: tuple[Check, ...] = ()

    @property
    def is_right(self) -> bool | None:
        """Whether the state is closed and obeys the equations of motion; None where the ``message`` says why not."""
        return verdict(self.checks, not self.message)

    def plain(self) -> dict[str, Any]:
        """The members of its parts beside each other, but for the mobility."""
        names = "q", "qd", "residual", "velocity_residual", "iterations"
        return {
            **{name: getattr(self.consistent, name) for name in names},
            "qdd": self.qdd,
            "multipliers": self.multipliers,
            "actuation": self.actuation,
            "mobility": {**vars(self.mobility), "redundant": self.mobility.redundant},
            "reactions": self.reactions,
            "message": self.message,
            "is_right": self.is_right,
            "checks": self.checks,
        }

    def __repr__(self) -> str:
        place, state = self.mobility, self.consistent
        names = ", ".join(reaction.closure for reaction in self.reactions)
        return (
            f"LoopState: {len(state.q)} coordinates, {place.degrees_of_freedom} free; {place.rank} independent rows, "
            f"redundant: {', '.join(place.dependent) or 'none'}\n"
            f"residual {state.residual:.2g}; reactions: {names or 'none'}; {self.message or 'closed'}"
        )


def loop_state(
    model: Model,
    q: StateVector | None,
    *,
    qd: StateVector | None = None,
    t: float = 0.0,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, Signal] | None = None,
    fixed: Sequence[str] = (),
    prescribed: Mapping[str, Signal] | None = None,
    folder: Path | None = None,
) -> LoopState:
    """Close the loops of a model at a state and say what moves and what holds.

    ``q`` [rad, m], ``qd`` [rad/s, m/s; 0 by default]: near a closed position, (n,) or by name; ``t`` [s]. The
    coordinates ``fixed`` keep their values while the loops are closed; ``prescribed`` ones move as given: a number, an
    expression in t or a Table [rad, m]. ``parameters``: in place of their defaults; ``inputs`` [N m, N]: numbers,
    expressions or tables, 0 by default. ``folder``: a cache of compiled kernels.

    Raises InvalidInput (pointers start with names of arguments) and MissingValue; loops that cannot be closed, and
    singular positions, are messages in the result.
    """
    t = real(t, "/t")
    require_fixed(model, fixed)
    s = Constrained(model, Start(q, qd, parameters or {}, inputs or {}), (t, t), prescribed, folder=folder)
    state = consistent_state(s, t, s.conditions.q, s.conditions.qd, fixed)
    place = mobility(s, t, state.q)
    s.move(t, state.q, state.qd)
    nothing = np.full(s.n, np.nan), np.full(len(s.labels), np.nan)
    message = state.message or ("the position is singular: " + SINGULAR if place.singular else "")
    try:
        qdd, _ = s.accelerations(s.independent_rows())
        multipliers = least_multipliers(s, qdd)
    except Singular as error:
        (qdd, multipliers), message = nothing, message or str(error)
    actuation = zip(s.labels[s.closed :], multipliers[s.closed :], strict=True)
    forces = {label.removeprefix("motion."): float(x) for label, x in actuation}
    checks = tuple(_checks(s, state, qdd, multipliers))
    return LoopState(state, place, qdd, multipliers, reactions(s, multipliers, place), forces, message, checks)


def _checks(s: Constrained, state: Consistent, qdd: Array, multipliers: Array) -> Iterator[Check]:
    """Residuals of the closures, and of the equations that the accelerations and multipliers solve, where s is."""
    size, speed = (max(1.0, float(np.abs(x).max(initial=0))) for x in (state.q, state.qd))
    met: About = ("position residual", "zero", "the closures (and prescribed motions) are met", "1")
    yield Check.at(met, s.opening, s.t, size, MET)
    moved: About = ("velocity residual", "zero", "G q' + phi_t = 0", "1/s")
    yield Check.at(moved, s.opening_rate, s.t, speed, MET)
    # what forces cause where nothing holds: accelerations that the closures cancel are rounding beside it
    free = float(np.abs(s.f).max(initial=0)) / (float(np.abs(s.g).max(initial=0)) or 1.0)
    largest = np.abs(s.G) @ (np.abs(qdd) + free)
    dynamics = "equations of motion", "g q'' + Gamma q'q' = Q + G^T lambda", ("N m", "N")
    yield _solved(dynamics, s, (s.g @ qdd, -s.f, -s.G.T @ multipliers), s.turns)
    second = "acceleration residual", "G q'' + c = 0", ("1/s^2", "m/s^2")
    yield _solved(second, s, (s.G @ qdd, s.c), _turning(s), largest)


def _solved(
    what: tuple[str, str, tuple[str, str]],
    s: Constrained,
    terms: tuple[Array, ...],
    turns: NDArray[np.bool_],
    least: Array | float = 0.0,
) -> Check:
    """The sum of the terms is zero beside the largest of them, or ``least``: of rows about rotations, and of those
    about translations, which have another unit; the worse of the two.
    """
    name, reason, units = what
    error, scale = np.abs(np.sum(terms, axis=0)), np.maximum(np.abs(terms).max(axis=0), least)
    checks = []
    for unit, of in zip(units, (turns, ~turns), strict=True):
        worst, most = (float(x[of].max(initial=0)) for x in (error, scale))
        checks.append(Check.at((name, "zero", reason, unit), worst, s.t, most, SOLVED))
    return max(checks, key=lambda check: (not check.holds, check.worst / (check.scale or 1.0)))


def _turning(s: Constrained) -> NDArray[np.bool_]:
    """Whether a row is about a rotation, by closures and prescribed coordinates."""
    of = dict(zip((f"motion.{name}" for name in s.model.coordinates), s.turns, strict=True))
    closed = [label.rpartition(".")[2] not in ALONG for label in s.labels[: s.closed]]
    return np.array([*closed, *(of[label] for label in s.labels[s.closed :])], dtype=np.bool_)


def mobility(s: Constrained, t: float, q: Array) -> Mobility:
    """Rank, redundancy and independent coordinates at a position that meets the closures."""
    s.move(t, q, np.zeros(s.n))
    G = s.balanced
    rank, m = rank_of(G), len(s.labels)
    chosen = set(s.independent_rows().tolist())
    dependent = tuple(label for k, label in enumerate(s.labels) if k not in chosen)
    entangled: dict[str, tuple[str, ...]] = {}
    for k in np.flatnonzero(_ambiguous(G)):
        closure, _, row = s.labels[k].rpartition(".")
        entangled[closure] = (*entangled.get(closure, ()), row)
    names = tuple(s.model.coordinates[a] for a in independent_coordinates(G))
    return Mobility(rank, s.n - rank, s.n - m, dependent, entangled, names, _is_singular(s, t, q, G, rank))


def independent_coordinates(G: Array) -> NDArray[np.int64]:
    """Coordinates whose velocities determine all others, by QR with pivoting of the balanced Jacobian; in order."""
    # G P = Q R: the first columns of the permutation P are dependent coordinates, G_y y' = -G_x x'
    rank = rank_of(G)
    if not rank:
        return np.arange(G.shape[1])
    return np.sort(pivoted(G, rank)[rank:])


def _ambiguous(G: Array) -> NDArray[np.bool_]:
    """Rows that take part in a dependency: G^T lambda = 0 with a lambda that is not zero there."""
    if not G.size:
        return np.zeros(len(G), dtype=np.bool_)
    # lambda with G^T lambda = 0 can be added to any multipliers
    left, sizes, _ = np.linalg.svd(G)
    free = left[:, int(ranks(sizes)) :]
    return np.asarray(np.abs(free).max(axis=1, initial=0) > np.sqrt(RANK))


def _is_singular(s: Constrained, t: float, q: Array, G: Array, rank: int) -> bool:
    """Whether the rank is higher at a closed position nearby, in some direction along the closures."""
    _, _, rows = scipy.linalg.svd(G) if G.size else (None, None, np.eye(s.n))
    # directions t with G t = 0
    tangent = rows[rank:]
    rng = np.random.default_rng(5)
    for _ in range(2 if rank < min(G.shape) else 0):
        step = rng.standard_normal(len(tangent)) @ tangent
        step *= NEARBY / float(np.linalg.norm(step))
        beside = consistent_state(s, t, q + step, np.zeros(s.n))
        s.move(t, beside.q, np.zeros(s.n))
        if s.opening <= CLOSED and s.rank() > rank:
            return True
    return False


def least_multipliers(s: Constrained, qdd: Array) -> Array:
    """lambda of least norm with G^T lambda = g q'' + Gamma q'q' - Q."""
    # G^T lambda = g q'' - f, f = Q - Gamma q'q'
    return least_norm(s.G, s.reach, s.g @ qdd - s.f)


def reactions(s: Constrained, multipliers: Array, place: Mobility) -> tuple[Reaction, ...]:
    """Forces and moments of the closures from their multipliers, at the state where s is."""
    direction = s.directions()
    result, k = [], 0
    for rows in s.model.closures:
        load = np.zeros((2, 3))
        for row in rows.rows:
            # force or moment of a row: lambda_k times its direction
            load[int(row not in ALONG)] += multipliers[k] * direction[k]
            k += 1
        result.append(Reaction(rows.name, load[0], load[1], place.entangled.get(rows.name, ())))
    return tuple(result)
