"""Friction by the load of joints: what the force R that a joint transmits adds to its dry friction.

A joint with such a friction has, beside the smooth law of the formulas, the force

    -(c |R beside its axis| + c_a |R along it|) tanh(v/v_0)     c = mu r, c_a = mu r_a; of prismatic joints mu and 0

on its coordinate. R depends on the accelerations, which depend on this force: at every state both are iterated from
each other until they agree. Where they do not, too much friction jams the mechanism (P. Painleve, Lecons sur le
frottement, 1895), and there is no motion that this law determines.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.friction.dry_friction import FrictionLaws, friction_laws
from substructures.analysis.motion.judges.states import MotionStates
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.verdict import About, Check
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.mechanics.accelerations import definite_solve
from substructures.quantities.formulas import DYNAMICS
from substructures.quantities.numbers.states import require
from substructures.quantities.part_models import ReactionModel
from substructures.tree.model import Model

FORCE = "reaction_force"
#: rounds until friction and reactions agree, to this share of the largest friction
ROUNDS, AGREED = 100, 1e-13
JAMMED = (
    f"friction and the reactions that it depends on do not agree after {ROUNDS} rounds: the mechanism jams there; "
    "lower the 'coefficient' or the radii of its friction"
)


@dataclass(frozen=True)
class FrictionLoads:
    """Of the coordinates ``places`` (k,), called ``names``: c, c_a (k, 2) [m, 1] and v_0 (k,) [rad/s, m/s]; ``smooth``:
    the dry friction of the formulas.
    """

    places: NDArray[np.int64]
    names: tuple[str, ...]
    arms: Array
    velocity: Array
    smooth: FrictionLaws

    def sizes(self, reactions: Array) -> Array:
        """c |(R_1, R_2)| + c_a |R_3| (..., k) of the forces (..., k, 3) that the joints transmit, in their axes."""
        beside = np.hypot(reactions[..., 0], reactions[..., 1])
        return np.asarray(self.arms[:, 0] * beside + self.arms[:, 1] * np.abs(reactions[..., 2]))

    def ways(self, rates: Array) -> Array:
        """-tanh(v/v_0)."""
        return np.asarray(-np.tanh(rates / self.velocity))


def friction_loads(model: Model, values: dict[str, float]) -> FrictionLoads:
    """The friction of a model by the load of its joints, in numbers.

    Raises InvalidArgument (``/friction``) where there is none, and (``/parameters``) where one is negative.
    """
    if "friction_load" not in model.program.outputs:
        message = "no joint of the tree has a 'friction' with a 'load': leave it out, or give one to some joint"
        raise InvalidArgument.at("/friction", "no-friction", message)
    output = model.program.outputs["friction_load"]
    require(model.program, ["friction_load"], values)
    places = sorted({index[0] for index in output.index})
    arms = interpret(model.program, values, ["friction_load"])["friction_load"][places]
    if not (arms >= 0).all():
        message = "with these parameters a friction by the load of a joint is negative"
        raise InvalidArgument.at("/parameters", "bad-friction", message)
    smooth = friction_laws(model, values)
    velocity = smooth.velocity[np.searchsorted(smooth.places, places)]
    names = tuple(model.coordinates[a] for a in places)
    return FrictionLoads(np.array(places, dtype=np.int64), names, np.asarray(arms, dtype=np.float64), velocity, smooth)


class LoadedRightHandSide(RightHandSide):
    """x' = f(t, x) with friction by the load of joints as well; ``force`` (k,): what the last evaluation found.

    ``bearings``: the reactions of the tree. Raises as RightHandSide and :func:`friction_loads`.
    """

    def __init__(
        self,
        model: Model,
        values: Mapping[str, float],
        zero: Iterable[str],
        conditions: Conditions,
        bearings: ReactionModel,
        folder: Path | None = None,
    ) -> None:
        super().__init__(model, values, zero, conditions, folder)
        self.has_power = True
        self.loads = friction_loads(model, conditions.values)
        self.pushed = self.loads.names
        self.force = np.zeros(len(self.loads.places))
        self.reactions = bearings.of(self.loads.names).program.select([FORCE])
        self._model = model
        self._second, self._g = np.zeros((1, self.n)), np.zeros((1, self.n, self.n))
        self._R = np.zeros((1, len(self.loads.places), 3))
        known = dict(values) | {"t": self._t}
        metric = program_kernel(model.program.select(["metric"]), folder)
        self._metric = metric.bind({"metric": self._g}, known, columns=[(state_names(model), self._x)])
        columns = [(state_names(model), self._x), (_seconds(model), self._second)]
        columns += [] if self.inputs is None else self.inputs.columns
        require(self.reactions, [FORCE], dict.fromkeys([*known, *(name for names, _ in columns for name in names)]))
        self._look = program_kernel(self.reactions, folder).bind({FORCE: self._R}, known, columns=columns)

    def compiled(self) -> None:
        """Not: friction and reactions are found together."""

    def evaluate(self, t: float, x: Array) -> tuple[Array, Array, float]:
        """(q'', pivots of the metric, power). Raises ArithmeticError where friction and reactions do not agree."""
        free, pivots, power = super().evaluate(t, x)
        places, v = self.loads.places, x[self.m + self.loads.places]
        self._metric()
        unit = np.zeros((self.n, len(places)))
        unit[places, np.arange(len(places))] = 1.0
        W = np.linalg.solve(self._g[0], unit)
        force, way = np.zeros(len(places)), self.loads.ways(v)
        for _ in range(ROUNDS):
            # q'' = g^-1 (Q - Gamma q'q' + f), f = f(R(q''))
            self._second[0] = free + W @ force
            self._look()
            size = self.loads.sizes(self._R[0])
            before, force = force, size * way
            if np.abs(force - before).max() <= AGREED * size.max():
                self.force = force
                return free + W @ force, pivots, power + float(force @ v)
        raise ArithmeticError(JAMMED)

    def along(self, t: Array, x: Array) -> tuple[Array, Array]:
        """q'' (K, n) and the friction by loads on all coordinates (K, n) at states x (K, ...); not finite where there
        is none.
        """
        second, force = np.full((len(t), self.n), np.nan), np.zeros((len(t), self.n))
        for i, (at, state) in enumerate(zip(t.tolist(), x, strict=True)):
            try:
                second[i], force[i, self.loads.places] = self.evaluate(at, state)[0], self.force
            except ArithmeticError:
                force[i, self.loads.places] = np.nan
        return second, force

    def check(self, states: MotionStates, force: Array, limit: float) -> Check:
        """The forces (K, n) are those of the law, by the formulas of the model and of its reactions."""
        model, places = self._model, self.loads.places
        values: dict[str, Any] = {s.name: 0.0 for s in model.program.symbols if s.kind == "input"}
        values |= states.symbols(model)
        found = interpret_in_blocks(model.program, values, list(DYNAMICS), len(states.t))
        second, _ = definite_solve(found["metric"], found["forces"] - found["bias"] + force)
        values |= {name: second[:, a] for a, name in enumerate(_seconds(model))}
        R = interpret_in_blocks(self.reactions, values, [FORCE], len(states.t))[FORCE]
        law = self.loads.sizes(R) * self.loads.ways(states.qd[:, places])
        error = np.abs(law - force[:, places]).max(axis=1, initial=0)
        about: About = (
            "friction-load",
            "zero",
            "friction is what the law makes of the reactions found with it",
            "N m, N",
        )
        return Check.of(about, error, states.t, float(np.abs(force).max(initial=0)) or 1.0, limit)


def _seconds(model: Model) -> list[str]:
    return [f"{name}''" for name in model.coordinates]


def with_loads(series: dict[str, Array], f: LoadedRightHandSide, states: MotionStates, x: Array, limit: float) -> Check:
    """Accelerations and friction as further series; whether that is the law of the reactions."""
    second, force = f.along(states.t, x)
    if "power" in series:
        series["power"] = series["power"] + (force * states.qd).sum(axis=1)
    whole, smooth = force.copy(), f.loads.smooth
    whole[:, smooth.places] += smooth.smooth(states.qd[:, smooth.places])
    series |= {"qdd": second, "friction": whole}
    return f.check(states, force, limit)
