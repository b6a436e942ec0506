"""The search for steady motions with ball joints, and their linearisation (see :mod:`.steady_balls`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.precession import Turning
from substructures.analysis.stability.equilibrium_search import NEEDS, NOTHING, RESIDUAL, SAME, BallSearch, SearchRange
from substructures.analysis.stability.linearisation_result import BallLinearisation, Linearisation
from substructures.analysis.stability.operating_point import RestConditions
from substructures.analysis.stability.vibrations import modes, stability
from substructures.array import Array
from substructures.mechanics.state_names import resting_state
from substructures.quantities.numbers.quaternions import by_displacements, moved_on
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

Linearised = Callable[[RestConditions, Array, Array], Linearisation]
#: of displacements, by which rates are differentiated, and what of a root may be imaginary
STEP, REAL = 6e-6, 1e-7
#: what momenta may differ from those that are given, of the largest
MET = 1e-9
#: of a turn, from where places that may be one are slid together [rad]
THIRDS = (0.0, 2.1, 4.2)


class TurningSearch(BallSearch):
    """At rates that turn with the places. ``resting``: numbers of q on which nothing depends, where these are known."""

    resting: Sequence[int] = ()

    def __init__(
        self, within: SearchRange, conditions: RestConditions, turning: Turning, vary: Sequence[str] = ()
    ) -> None:
        """``vary``: a parameter that has other values later, if there is one."""
        model = turning.model
        n, self.given, self.varied = model.dof, turning, (list(vary), np.zeros((1, len(vary))))
        self.varied[1][0] = [conditions.parameters.get(name, 0.0) for name in vary]
        self.v, self.second = np.zeros((1, n)), np.zeros((1, n))
        self.D, self.M = np.zeros((1, n, n)), np.zeros((1, n, n))
        # of a place, and of those beside it
        self.g, self.L = np.zeros((1 + 2 * n, n, n)), np.zeros((1 + 2 * n, n, 3))
        self.at_q = np.zeros((1 + 2 * n, len(model.positions)))
        values = values_at(model, conditions, np.array(resting_state(model.positions, model.balls)), np.zeros(n))
        outputs = {"metric": self.g, "angular_momentum": self.L}
        columns = [(list(model.positions), self.at_q), (self.varied[0], np.repeat(self.varied[1], 1 + 2 * n, axis=0))]
        self.more = columns[1][1]
        self.inertia = program_kernel(model.program.select(list(outputs))).bind(outputs, values, columns=columns)
        super().__init__(model, within, conditions)

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        """The rates and their derivatives, and what these multiply."""
        moving = (("'", self.v), ("''", self.second))
        named = [([f"{name}{mark}" for name in self.model.coordinates], x) for mark, x in moving]
        return {"damping": self.D, "metric": self.M}, [*named, self.varied]

    def put(self, name: str, value: float) -> None:
        """Another value of a parameter, or of a rate or momentum that is given."""
        if name in self.varied[0]:
            self.varied[1][0] = self.more[:] = value
            self.conditions = replace(self.conditions, parameters={**self.conditions.parameters, name: value})
        else:
            cyclic = [self.model.coordinates[c] for c in self.given.cyclic]
            self.given.wanted[cyclic.index(name) if name in cyclic else -1] = value

    def motion(self, q: Array) -> tuple[Array, Array, Array, float]:
        """v, S, g and Omega at a place."""
        self.at_q[:] = q
        self.inertia()
        return self.given.motion(self.g[0], self.L[0])

    def _ran(self, values: Mapping[str, Array]) -> dict[str, Array]:
        v, S, _, turn = self.motion(values["q"])
        self.v[0], self.second[0] = v, -S @ v
        found = super()._ran(values)
        if turn or self.given.field == "momenta":
            # of what changes with the place: D dv/dq + M dv'/dq
            model, ways = self.model, STEP * np.eye(self.model.dof)
            state = model.positions, model.coordinates, model.balls
            self.at_q[1:] = moved_on(
                *state, np.repeat(values["q"][None], 2 * model.dof, axis=0), np.vstack((ways, -ways))
            )
            self.inertia()
            sides = np.array([self._changed(k) for k in range(1, 1 + 2 * model.dof)])
            slopes = (sides[: model.dof] - sides[model.dof :]).T / (2 * STEP)
            by = np.hstack((self.D[0], self.M[0])) @ slopes
            found["K"] = found["K"] + by @ by_displacements(*state, values["q"])
        return found

    def _changed(self, k: int) -> Array:
        """v and v' (2n,) at one of the places that were evaluated."""
        v, S, _, _ = self.given.motion(self.g[k], self.L[k])
        return np.concatenate((v, -S @ v))

    def _slopes(self, q: Array) -> Array:
        """Of the largest: where momenta cannot be had they have no bound."""
        found = super()._slopes(q)
        return found / (np.abs(found).max(initial=0) or 1.0)

    def is_singular(self, q: Array) -> bool:
        """Whether the momenta that are given cannot be had at a place: upright all turning is spin."""
        wanted, v = self.given.wanted, self.motion(q)[0]
        left = np.abs(self.given.momenta(self.g[0], self.L[0]) @ v - wanted).max(initial=0)
        return self.given.field == "momenta" and bool(left > MET * np.abs(wanted).max(initial=0))

    def is_same(self, q: Array, other: Array, moving: Sequence[int]) -> bool:
        """Also where one is the other turned far about the axis of the world, or in itself."""
        if super().is_same(q, other, moving):
            return True
        (v, *_, g, turn), energy = self.motion(q), self._energy(q)
        if not turn or abs(self._energy(other) - energy) > SAME * energy:
            return False
        state = self.model.positions, self.model.coordinates, self.model.balls
        ways = [g, *(np.eye(self.model.dof)[c] for c in self.given.blocks)][:2]
        for turns in product(THIRDS, repeat=len(ways)):
            there = moved_on(*state, q, sum((x * way for x, way in zip(turns, ways, strict=True)), 0.0 * v))
            if any(turns) and super().is_same(self.wound(there), other, moving):
                return True
        return False

    def _energy(self, q: Array) -> float:
        """Twice the kinetic one, which turning does not change."""
        v = self.motion(q)[0]
        return float(v @ self.g[0] @ v)

    def precessions(self, q: Array) -> list[float]:
        """All Omega that keep a place: ID is quadratic in it; none where it has no finite value."""
        rows = []
        for turn in (-1.0, 0.0, 1.0):
            self.given.wanted[-1] = turn
            rows.append(self.at(q)[0])
        square, linear = (rows[0] + rows[2]) / 2 - rows[1], (rows[2] - rows[0]) / 2
        k = int(np.abs(np.stack((square, linear))).max(axis=0).argmax())
        terms, found = np.array([square[k], linear[k], rows[1][k]]), []
        if not np.isfinite(terms).all():
            return []
        terms[np.abs(terms) <= NOTHING * np.abs(terms).max()] = 0
        for root in np.roots(terms):
            self.given.wanted[-1] = float(root.real)
            F, K = self.at(q)
            is_kept = (np.abs(F) <= RESIDUAL * np.fmax(1.0, np.abs(K * self.length).max(axis=1, initial=0))).all()
            if abs(root.imag) <= REAL * abs(root) and is_kept:
                found.append(float(root.real))
        return sorted(found)


def places_of(search: TurningSearch) -> list[Array]:
    """Those that the search finds."""
    starts = search.starts()
    search.resting = search.held(starts)
    starts[:, search.resting] = starts[0, search.resting]
    return search.places(starts, [a for a in range(search.n) if a not in search.resting])[0]


def values_at(model: Model, conditions: RestConditions, q: Array, v: Array) -> dict[str, float]:
    """Of all symbols."""
    states = read_states(model, {"q": q, "qd": v}, None)
    found = symbol_values(model, vars(conditions), states, NEEDS)
    return {name: float(np.ravel(x)[0]) for name, x in found.items()}


def linearised_at(search: TurningSearch, q: Array, linearised: Linearised) -> Linearisation:
    """In axes that do not spin: dv' -> dv' - S dv."""
    v, S, _, turn = search.motion(q)
    at = linearised(search.conditions, q, v)
    if not (turn and isinstance(at, BallLinearisation) and at.status != "failed"):
        return at
    told, D = modes(at.M, at.D - at.M @ S, at.K, at.R + S), at.D - at.M @ S
    return replace(at, modes=told, D=D, stability=stability(told, D, at.K, has_potential=False))
