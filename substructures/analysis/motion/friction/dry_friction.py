"""Dry friction that sticks exactly: set-valued at rest, found anew wherever a joint stops or breaks away.

A joint that slips has the force -s (F_c + (F_s - F_c) exp(-(v/v_s)^2)), s the sign of its rate v, in place of the
smooth law of the formulas. One that sticks keeps v = 0 by what that needs, f, with |f| <= F_s. Which ones stick when
some are at rest is told by Gauss's principle: of all accelerations a those with the least

    1/2 (a - a_free)^T g (a - a_free) + sum_i F_s,i |a_i|      (sum over the joints at rest)

This is strictly convex, so there is one answer; its dual, least 1/2 f^T W f + a_free^T f with |f_i| <= F_s,i and
W = (g^-1) of the joints at rest, is a linear complementarity problem (P. Loetstedt, SIAM J. Appl. Math. 42, 1982),
solved as bounded least squares by an active set (P. B. Stark and R. L. Parker, Computational Statistics 10, 1995).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.motion.conditions import Conditions
from substructures.analysis.motion.friction.dry_rates import DryRates
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.array import Array
from substructures.compile.motion import CompiledRates
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.states import require
from substructures.tree.model import Model

#: of the rate v_0 of the smooth law: what counts as rest
REST = 1e-9
#: of F_s: so near to it a joint breaks away, and so far beyond it one that sticks is watched
EDGE = 1e-9
#: by joint with friction: 1 and -1 slip that way, 0 sticks
Signs = NDArray[np.int64]


@dataclass(frozen=True)
class FrictionLaws:
    """Of the coordinates ``places`` (k,): F_c, F_s [N m, N], v_s (0: none) and v_0 [rad/s, m/s], (k,) each."""

    places: NDArray[np.int64]
    coulomb: Array
    static: Array
    stribeck: Array
    velocity: Array

    def slipping(self, rates: Array) -> Array:
        """The size of the force of joints that slip, (..., k)."""
        more, width = self._bump
        # F_c + (F_s - F_c) exp(-(v/v_s)^2)
        return np.asarray(self.coulomb + more * np.exp(-np.square(rates / width)))

    @property
    def numbers(self) -> Array:
        """F_c, F_s - F_c and v_s (0 and 1 where there is none), and v_0, (k, 4)."""
        return np.column_stack((self.coulomb, *self._bump, self.velocity))

    @cached_property
    def _bump(self) -> tuple[Array, Array]:
        """F_s - F_c and v_s; 0 and 1 where there is none."""
        some = self.stribeck > 0
        return np.where(some, self.static - self.coulomb, 0.0), np.where(some, self.stribeck, 1.0)

    def smooth(self, rates: Array) -> Array:
        """What the formulas of the model have, (..., k)."""
        return np.asarray(-self.slipping(rates) * np.tanh(rates / self.velocity))

    def rest(self, k: int, m: int, sign: int) -> Watch:
        """Where a joint of a motion (q, q', ...) of m numbers q that slips comes to rest: its rate against its way, so
        that a start the wrong way counts, too.
        """
        place, least = m + int(self.places[k]), REST * self.velocity[k]
        return Watch("rest", lambda _, x: float(sign * x[place] + least), -1)


def friction_laws(model: Model, values: dict[str, float]) -> FrictionLaws:
    """The friction of a model in numbers. Raises InvalidArgument (``/friction``) where there is none."""
    if "friction" not in model.program.outputs:
        message = "no joint of the tree has 'friction': leave it out, or give some joint a friction"
        raise InvalidArgument.at("/friction", "no-friction", message)
    output = model.program.outputs["friction"]
    require(model.program, ["friction"], values)
    rows = interpret(model.program, values, ["friction"])["friction"]
    places = np.array(sorted({index[0] for index in output.index}), dtype=np.int64)
    found = np.asarray(rows, dtype=np.float64)[places]
    if not ((found[:, :3] >= 0).all() and (found[:, 3] > 0).all()):
        message = "with these parameters a joint has a negative friction, or one over a rate that is not positive"
        raise InvalidArgument.at("/parameters", "bad-friction", message)
    return FrictionLaws(places, *found.T)


class DryMotion:
    """x' = f(t, x), x with m numbers q, n rates and W, while the joints with friction slip or stick as ``signs`` say.
    Not for several threads at a time.
    """

    def __init__(self, f: RightHandSide, conditions: Conditions, laws: FrictionLaws) -> None:
        self.f, self.laws, self.n, self.enter = f, laws, f.n, f.enter
        #: of the rates of joints with friction, in a state
        self._places = f.m + laws.places
        self.signs: Signs = np.zeros(len(laws.places), dtype=np.int64)
        self._rates = DryRates(f, conditions.model, tuple(laws.places.tolist()), laws.numbers)

    def compiled(self) -> CompiledRates | None:
        """The same in machine code, as the signs are now; None where more than kernels is called."""
        return self._rates.compiled(self.signs)

    def __call__(self, t: float, x: Array) -> Array:
        """x' at (t, x)."""
        second, _, power = self.moved(t, x, self.signs)
        return self.f.changes(x, second, power)

    def moved(self, t: float, x: Array, signs: Signs) -> tuple[Array, Array, float]:
        """q'' (n,), the friction of the joints that have some (k,), and the power of all forces without potential."""
        places, v = self.laws.places, x[self._places]
        free, W, power = self._freed(t, x)
        force = -signs * self.laws.slipping(v)
        second = free + W @ force
        stuck = np.flatnonzero(signs == 0)
        if len(stuck):
            # W_SS f_S = -a_S
            force[stuck] = np.linalg.solve(W[np.ix_(places[stuck], stuck)], -second[places[stuck]])
            second = second + W[:, stuck] @ force[stuck]
            second[places[stuck]] = 0.0
        return second, force, power + float(force @ v)

    def settled(self, t: float, x: Array) -> Array:
        """q'' (n,) at a state (q, q') where any joint may have come to rest."""
        signs, x = self.decided(t, x)
        return self.moved(t, x, signs)[0]

    def decided(self, t: float, x: Array) -> tuple[Signs, Array]:
        """Who slips and who sticks at a state, and the state with those at rest at rest."""
        laws = self.laws
        x = x.copy()
        v = x[self._places]
        rest = np.flatnonzero(np.abs(v) <= 2 * REST * laws.velocity)
        x[self._places[rest]] = 0.0
        signs = np.sign(v).astype(np.int64)
        signs[rest] = 0
        # at rest the smooth law is zero
        free, W, _ = self._freed(t, x)
        # those that break away have the force of slipping, which may be less, so that others may follow
        while len(rest):
            second = free - W @ (signs * laws.slipping(x[self._places]))
            f = _least(W[np.ix_(laws.places[rest], rest)], second[laws.places[rest]], laws.static[rest])
            away = np.abs(f) >= (1 - EDGE) * laws.static[rest]
            if not away.any():
                break
            signs[rest[away]] = -np.sign(f[away]).astype(np.int64)
            rest = rest[~away]
        return signs, x

    def watches(self) -> list[Watch]:
        """A joint that slips comes to rest; one that sticks needs more than it can have."""

        def breaks_away(k: int) -> Watch:
            """What is left of its static friction."""
            most = (1 + EDGE) * self.laws.static[k]
            return Watch("slip", lambda t, x: float(most - abs(self.moved(t, x, self.signs)[1][k])), -1)

        return [
            breaks_away(k) if sign == 0 else self.laws.rest(k, self.f.m, sign)
            for k, sign in enumerate(self.signs.tolist())
        ]

    def instead(self, force: Array, x: Array) -> Array:
        """What the power (K,) of these forces (K, n) is more than that of the smooth law, at states x (K, ...)."""
        v = x[:, self._places]
        return np.asarray(((force[:, self.laws.places] - self.laws.smooth(v)) * v).sum(axis=1))

    def _freed(self, t: float, x: Array) -> tuple[Array, Array, float]:
        """q'' without friction (n,), the columns (n, k) of g^-1 for the joints with friction, and the power."""
        acceleration, _, power = self.f.evaluate(t, x)
        self._rates.dynamics()
        unit = np.zeros((self.n, len(self.laws.places)))
        unit[self.laws.places, np.arange(len(self.laws.places))] = 1.0
        W = np.linalg.solve(self._rates.metric[0], unit)
        v = x[self._places]
        smooth = self.laws.smooth(v)
        # the smooth law, which the formulas have, taken off
        return acceleration - W @ smooth, W, power - float(smooth @ v)


def _least(W: Array, free: Array, most: Array) -> Array:
    """f with the least 1/2 f^T W f + free^T f and |f| <= most."""
    bound = np.maximum(most, 1e-300)
    if len(free) == 1:
        return np.clip(-free / W[0], -bound, bound)
    # W = L L^T: least |L^T f + L^-1 free|
    L = np.linalg.cholesky(W)
    right = -scipy.linalg.solve_triangular(L, free, lower=True)
    found: Any = scipy.optimize.lsq_linear(L.T, right, bounds=(-bound, bound), method="bvls", tol=1e-14)
    return np.asarray(found.x, dtype=np.float64)
