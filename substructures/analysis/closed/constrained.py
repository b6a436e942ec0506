"""A model with closures and prescribed coordinates in numbers: everything a state needs in one compiled call.

With rows of closures and rows q_a - s(t) of prescribed coordinates:

    g q'' + Gamma q'q' = Q + G^T lambda        phi(q, t) = 0        G q' + phi_t = 0        G q'' + c = 0

where c = G' q' for closures and -s'' for prescribed coordinates, whose multipliers are the forces of their actuators.
Closures depend on the time where coordinates are driven.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.arguments import NumberOrExpression
from substructures.analysis.closed.jacobian import Jacobian
from substructures.analysis.closed.pivoting import pivoted
from substructures.analysis.closed.prescribed import Prescribed
from substructures.analysis.closed.work import POWER, with_power
from substructures.analysis.motion.conditions import read_conditions, state_names
from substructures.analysis.motion.corners import Laws, follow
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates, SaddlePoint
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret
from substructures.expr.known import Known
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED
from substructures.mechanics.closure_rows import RowBounds, rank_of, row_sizes
from substructures.quantities.closure_columns import row_bounds
from substructures.tree.model import Model

ALL = slice(None)
#: of given motions: powers of the free velocities in T
DRIVES = ("T_2", "T_0")
NEEDS = ("metric", "bias", "forces", "potential_energy")
SINGULAR = (
    "the closures lose rank there, so that the motion is not determined; keep away from this dead centre or branching "
    "(another start, a shorter time span), or change the lengths"
)


class Equations(NamedTuple):
    """Which rows of the closures, independent of each other, and which coordinates make accelerations: what does not
    move has none.
    """

    rows: NDArray[np.int64]
    moving: NDArray[np.int64]


class Singular(ArithmeticError):
    """The equations of a state have no unique solution; internal, every caller turns it into a failure value."""


class Constrained:
    """A state at a time and what follows from it, in arrays that the next :meth:`move` overwrites.

    ``g`` (n, n), ``f`` = Q - Gamma q'q' (n,), ``phi`` (m,), ``G`` (m, n), ``c`` (m,), ``phi_t`` (m,);
    ``labels``: the names of the m rows, ``closure.row`` and ``motion.coordinate``. ``reach`` (m,): how long the rows of
    G are in other positions, by which ranks and conditions are judged: a row that vanishes alone is singular, too;
    ``width`` (m,): how far they are open there, by which it is judged whether they are closed.
    """

    def __init__(
        self,
        model: Model,
        start: Start,
        span: tuple[float, float],
        prescribed: Mapping[str, Signal] | None = None,
        *,
        events: Sequence[Event] = (),
        series: Mapping[str, NumberOrExpression] | None = None,
        folder: Path | None = None,
    ) -> None:
        """``span`` [s]: the times at which states will be; (t, t) for one. ``prescribed``: coordinates whose motion is
        given [rad, m]; ``folder``: a cache of compiled kernels.

        Raises InvalidInput (``/q``, ``/inputs/name``, ``/prescribed/name``, ...) and MissingValue.
        """
        self.model, self.n, start = model, model.dof, start.with_defaults(model)
        needs = self._needs(bool(model.closures))
        self.conditions = read_conditions(model, start, span, needs, events, series)
        self.prescribed = Prescribed(model, prescribed or {}, span)
        self.labels = tuple(f"{rows.name}.{row}" for rows in model.closures for row in rows.rows)
        self.closed = len(self.labels)
        self.labels += tuple(f"motion.{model.coordinates[a]}" for a in self.prescribed.index)
        self._arrays()
        self._bind(list(start.inputs), folder)
        self.reach, self.width = self._sizes(span[0])

    def _arrays(self) -> None:
        n, m = self.n, len(self.labels)
        self.t, self.q, self.qd = np.nan, np.zeros(n), np.zeros(n)
        self.turns = np.array([joint == "R" for joint in self.model.joints], dtype=bool)
        self.f, self.phi, self.c, self.phi_t = np.zeros(n), np.zeros(m), np.zeros(m), np.zeros(m)
        self.G = np.zeros((m, n))
        self._jacobian: Jacobian | None = None
        # of q_a - s(t): d phi / d q_a = 1
        for k, a in enumerate(self.prescribed.index):
            self.G[self.closed + k, a] = 1

    def _needs(self, is_closed: bool) -> list[str]:
        """Outputs of the model."""
        drives = [*DRIVES, *(("closure.rate",) if is_closed else ())] if self.model.given else []
        return [*NEEDS, *(CLOSED if is_closed else ()), *drives]

    def _bind(self, inputs: list[str], folder: Path | None) -> None:
        self._folder = folder
        outputs = self._needs(bool(self.closed))
        known = Known(self.model.program.digest, self.model)
        source, kernel = _compiled(known, tuple(outputs), frozenset(inputs), folder)
        self.is_still = not self.prescribed.index and not (self.closed and self.model.driven)
        self.conservative = not source.outputs[POWER].entries and self.is_still
        self._t, self._x = np.zeros(1), np.zeros((1, 2 * self.n))
        state, others = [(state_names(self.model), self._x)], self.prescribed.tables
        self.inputs = VaryingInputs(self.conditions, self._t, state, folder, others)
        # rows of closures are written where they are wanted, before those of prescribed coordinates
        rows = dict(zip((*CLOSED, "closure.rate"), (self.phi, self.G, self.c, self.phi_t), strict=True))
        self._out = {
            name: rows[name][None, : self.closed] if name in rows else np.zeros((1, *source.outputs[name].shape))
            for name in [*outputs, POWER]
        }
        columns = [(state_names(self.model), self._x), *self.inputs.columns]
        self._laws = Laws(source, kernel, self._out, self.conditions.values | {"t": self._t}, columns)
        self.g = self._out["metric"][0]

    def _sizes(self, t: float) -> tuple[Array, Array]:
        """The reach and the width of every row, beside the start; 1 of prescribed coordinates."""
        rest = np.zeros(self.n)

        def look(places: Array) -> tuple[Array, Array]:
            """G and phi there."""
            found = []
            for q in places:
                self.move(t, q, rest)
                found.append((self.G.copy(), self.phi.copy()))
            return np.array([G for G, _ in found]), np.array([phi for _, phi in found])

        if not self.labels:
            return np.ones(0), np.ones(0)
        found = row_sizes(self.model.joints, self.conditions.q[None], look, self._bounds)
        width = found.width[0]
        # of prescribed coordinates the value says nothing
        width[self.closed :] = 1.0
        return found.reach[0], width

    def _bounds(self, places: Array) -> RowBounds:
        """What the geometry allows; rows of prescribed coordinates are as long as they are."""
        columns, spans = np.zeros((len(places), *self.G.shape)), np.zeros((len(places), len(self.labels)))
        if self.closed:
            names = self.model.coordinates
            values = self.conditions.values | {name: places[:, a] for a, name in enumerate(names)}
            found = row_bounds(self.model, values, len(places))
            columns[:, : self.closed], spans[:, : self.closed] = found
        return RowBounds(columns, spans)

    def move(self, t: float, q: Array, qd: Array, *, jacobian: Jacobian | None = None) -> None:
        """Evaluate everything at a state. ``jacobian``: as it is at t and q, where that is known."""
        n, x, out = self.n, self._x[0], self._out
        self.t, self.q, self.qd, self._jacobian = t, q, qd, jacobian
        x[:n], x[n:], self._t[0] = q, qd, t
        self.inputs.fill()
        self._laws.run()
        # f = Q - Gamma q'q'
        np.subtract(out["forces"][0], out["bias"][0], out=self.f)
        if self.prescribed.index:
            # phi = q_a - s(t), phi_t = -s'(t), c = -s''(t)
            m, motion = self.closed, self.prescribed.at(t)
            self.phi[m:] = q[list(self.prescribed.index)] - motion[:, 0]
            self.phi_t[m:], self.c[m:] = -motion[:, 1], -motion[:, 2]

    def corners(self, t: float, x: Array, folder: Path | None) -> list[Watch]:
        """Follow force laws on one side of their corners, from (q, q', ...) on; the corners are to be watched."""
        moving = ("t", *state_names(self.model), *self.inputs.moving)
        return follow([*self.inputs.laws, self._laws], moving, self._move, self._rates, (t, x), folder)

    def plain(self) -> None:
        """Force laws as they are."""
        for laws in (*self.inputs.laws, self._laws):
            laws.plain()

    def _move(self, t: float, x: Array) -> None:
        self.move(t, *np.split(x[: 2 * self.n], 2))

    def _rates(self, t: float, x: Array) -> Array:
        """(q', q'', 0) of (q, q', work); not finite where the accelerations are not determined."""
        self._move(t, x)
        try:
            q2, _ = self.accelerations(self.independent_rows())
        except Singular:
            q2 = np.full(self.n, np.nan)
        return np.concatenate((self.qd, q2, (0.0,)))

    def compiled(self, chosen: Equations) -> CompiledRates | None:
        """(q', q'', power) of (t, q, q') with these rows, which may change, in machine code; None where more than
        kernels is called.
        """
        given, moved = self.inputs.runs(), self._moved
        runs = [*(given or ()), self._laws.run, *(moved or ())]
        calls = tuple(run for run in runs if isinstance(run, BoundCall))
        if given is None or moved is None or len(calls) < len(runs):
            return None
        out = self._out
        saddle = SaddlePoint(self.g, self.G, self.c, out["forces"][0], out["bias"][0], *chosen)
        if not self.is_still:
            # what moves rows does the work of their forces
            saddle = replace(saddle, velocities=self._x[0, self.n :], power=out[POWER])
        written = np.zeros((1, self.n))
        return CompiledRates(calls, self._t, self._x, written, out[POWER], self._folder, saddle, self.inputs.tables)

    @cached_property
    def _moved(self) -> tuple[Callable[[], None], ...] | None:
        """What is called for c of prescribed coordinates; None where that is more than kernels."""
        return self.prescribed.bound(self._t, self.c[None, self.closed :])

    @property
    def velocity_residual(self) -> Array:
        """G q' + phi_t."""
        return self.G @ self.qd + self.phi_t

    @property
    def opening(self) -> float:
        """The largest |phi| over its width."""
        return float(np.abs(self.phi / self.width).max(initial=0))

    @property
    def opening_rate(self) -> float:
        """The largest |G q' + phi_t| over the width of its row [per s]."""
        return float(np.abs(self.velocity_residual / self.width).max(initial=0))

    @property
    def jacobian(self) -> Jacobian:
        """G with its rows over their ``reach``: numbers without unit, about 1 away from singular positions."""
        if self._jacobian is None:
            self._jacobian = Jacobian(self.G / self.reach[:, None])
        return self._jacobian

    @property
    def balanced(self) -> Array:
        """The numbers of :attr:`jacobian` (m, n)."""
        return self.jacobian.G

    def share(self, rank: int) -> float:
        """The rank-th singular value of the balanced G, over the largest there, or elsewhere."""
        return self.jacobian.share(rank) if rank else 1.0

    @property
    def energies(self) -> tuple[float, float]:
        """T and V [J]; at given motions T_2 - T_0 and V, of Jacobi's energy."""
        if self.model.given:
            T_2, T_0, V = (float(self._out[name][0]) for name in (*DRIVES, "potential_energy"))
            return T_2 - T_0, V
        # T = q'^T g q' / 2
        return 0.5 * float(self.qd @ self.g @ self.qd), float(self._out["potential_energy"][0])

    @property
    def effort(self) -> float:
        """|Q_a| |q^a|, angles no less than 1: what forces do on the way to here, by which rounding is known [J]."""
        way = np.where(self.turns, np.maximum(np.abs(self.q), 1.0), np.abs(self.q))
        return float(np.abs(self._out["forces"][0]) @ way)

    @property
    def lost_power(self) -> float:
        """(Q + dV/dq) q' + dV/dt: power of the applied forces that have no constant potential [W]."""
        return float(self._out[POWER][0])

    def directions(self) -> Array:
        """Force or moment on ``to`` of unit multipliers of the closures, in the axes of ``from`` (m, 3)."""
        return self._closure_output("closure.direction", (0, 3))

    def upside_down(self) -> str:
        """The name of a closure that holds all three directions but is closed with axes turned round; else ''."""
        aligned = self._closure_output("closure.alignment", (0,))
        k = 0
        for rows in self.model.closures:
            end = k + len(rows.rows)
            if "rz" in rows.rows and aligned[k:end].min() < 0:
                return rows.name
            k = end
        return ""

    def _closure_output(self, name: str, empty: tuple[int, ...]) -> Array:
        """An output that is seldom needed, at the present state."""
        if not self.closed:
            return np.zeros(empty)
        rates = [f"{name}'" for name in self.model.coordinates]
        values = self.conditions.values | dict(zip(rates, self.qd, strict=True)) | {"t": self.t}
        values |= dict(zip(self.model.coordinates, self.q, strict=True))
        return interpret(self.model.program, values, [name])[name]

    def factor(self, rows: NDArray[np.int64], moving: NDArray[np.int64] | slice = ALL) -> Factor:
        """The factors of [g G^T; G 0] for these independent rows and some coordinates. Raises Singular."""
        n, r = len(self.f[moving]), len(rows)
        # A = A^T = [g G^T; G 0]
        A = np.zeros((n + r, n + r))
        A[:n, :n] = self.g[moving][:, moving]
        if r:
            A[n:, :n] = G = self.G.take(rows, axis=0)[:, moving]
            A[:n, n:] = G.T
        lu, pivots, info = scipy.linalg.lapack.dgetrf(A.T, overwrite_a=True)
        if info:
            raise Singular("the metric is singular along the motions that are left free: check masses and inertias")
        return Factor(n, lu, pivots)

    def equations(self, rows: NDArray[np.int64]) -> Equations:
        """What these independent rows and everything that is held here leave. Raises Singular."""
        return Equations(rows, np.arange(self.n))

    def accelerations(self, rows: NDArray[np.int64]) -> tuple[Array, Array]:
        """q'' (n,) and the multipliers of the given rows. Raises Singular."""
        return self.solved(self.equations(rows))

    def solved(self, chosen: Equations) -> tuple[Array, Array]:
        """q'' (n,) and the multipliers of the chosen rows. Raises Singular."""
        rows, q2 = chosen.rows, np.zeros(self.n)
        if not len(chosen.moving):
            return q2, np.zeros(0)
        moving = ALL if len(chosen.moving) == self.n else chosen.moving
        # g q'' + G^T (-lambda) = f, G q'' = -c
        q2[moving], minus = self.factor(rows, moving).solve(self.f[moving], -self.c.take(rows))
        if not np.isfinite(q2).all():
            raise Singular("the accelerations are not finite: check masses, inertias and loads")
        return q2, -minus

    def rank(self) -> int:
        """Number of independent rows here."""
        return rank_of(self.balanced)

    def independent_rows(self) -> NDArray[np.int64]:
        """Indices of as many independent rows as there are, chosen by QR with pivoting of G^T; in order."""
        rank = self.rank()
        if not rank:
            return np.zeros(0, dtype=np.int64)
        # G^T P = Q R: rows in the order of what they add to those before
        return np.sort(pivoted(self.balanced.T, rank)[:rank])


class Factor(NamedTuple):
    """Factors of [g G^T; G 0]."""

    n: int
    lu: Array
    pivots: NDArray[np.int32]

    def solve(self, a: Array, b: Array) -> tuple[Array, Array]:
        """x, y with g x + G^T y = a and G x = b."""
        x, _ = scipy.linalg.lapack.dgetrs(self.lu, self.pivots, np.concatenate((a, b)))
        return x[: self.n], x[self.n :]


@lru_cache(maxsize=32)
def _compiled(
    known: Known, outputs: tuple[str, ...], inputs: frozenset[str], folder: Path | None
) -> tuple[Program, Kernel]:
    """Outputs of a model with their POWER, once for the same model."""
    source = with_power(known.source, outputs, inputs)
    return source, compile_program(source, [*outputs, POWER], folder, single=True)


def require_fixed(model: Model, fixed: Sequence[str]) -> None:
    """Raises InvalidArgument (``/fixed/i``) for names that are no coordinates of the model."""
    for i, name in enumerate(fixed):
        if name not in model.coordinates:
            message = f"unknown coordinate '{name[:80]}'{among(name, model.coordinates)}"
            raise InvalidArgument.at(f"/fixed/{i}", "unknown-coordinate", message)
