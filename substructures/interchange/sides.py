"""What is compared: a tree, or a part alone at the world under any gravity, with numbers of its links and joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from substructures.array import Array
from substructures.expr.interpret import interpret_in_blocks
from substructures.mechanics.state_names import resting_state
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

#: a tree and the parts of its instances
Parts = tuple[TreeSpec, Mapping[str, Part]]
INSTANCE = "x"
CLOSURES = ("closure.residual", "closure.jacobian")
#: of a part alone; in general position, so that nothing escapes along an axis
GRAVITY = {"gx": "0.7", "gy": "-1.3", "gz": "-9.5"}


@dataclass(frozen=True)
class Side:
    """One of two models. ``names``: of its coordinates as they are compared, without the name of a single instance."""

    spec: TreeSpec
    parts: Mapping[str, Part]
    model: Model
    names: tuple[str, ...]
    single: str  #: the name of a single instance with a dot

    @classmethod
    def of_tree(cls, spec: TreeSpec, parts: Mapping[str, Part]) -> Side:
        """A tree with the parts of its instances. Raises InvalidDocument, TooLarge as :func:`couple`."""
        model = couple(spec, parts)
        require_untied(model, "equivalences")
        single = f"{spec.instances[0].name}." if len(spec.instances) == 1 else ""
        return cls(spec, parts, model, tuple(c.removeprefix(single) for c in model.coordinates), single)

    @classmethod
    def of_part(cls, part: Part, like: TreeSpec | None = None) -> Side:
        """A part at the world, with the gravity of a tree ``like`` which it is compared with; default: any gravity."""
        return cls.of_tree(alone(part.definition, like), {INSTANCE: part})

    @cached_property
    def regressor(self) -> RegressorModel:
        """Y and pi, made when they are first needed."""
        return regressor(self.spec, self.parts)

    @cached_property
    def parameters(self) -> dict[str, str]:
        """The free parameters that have an effect, by their names as they are compared."""
        names = self.model.parameters.keys() & self.model.effective
        return {name.removeprefix(self.single): name for name in sorted(names)}

    def given(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values by names as they are compared, by this model's names; those that it does not have are left out."""
        return {self.parameters[name]: x for name, x in values.items() if name in self.parameters}

    @cached_property
    def resting(self) -> Array:
        """The state q in which nothing is moved or turned."""
        return np.array(resting_state(self.model.positions, self.model.balls))

    def states(self, rng: np.random.Generator, count: int) -> Array:
        """Random states q (count, n), with unit quaternions."""
        q = rng.uniform(-1, 1, (count, len(self.resting)))
        for ball in self.model.balls:
            some = [self.model.positions.index(name) for name in ball["positions"][-4:]]
            q[:, some] /= np.linalg.norm(q[:, some], axis=1, keepdims=True)
        return q

    def evaluate(
        self, names: list[str], parameters: Mapping[str, float], q: Array, qd: Array | None = None, **more: Any
    ) -> Any:
        """Numbers of quantities for these parameters, by their names as they are compared; ``more``: t, inputs."""
        return evaluate(self.model, names, q, qd, parameters=self.given(parameters), **more)

    def closures(self, parameters: Mapping[str, float], q: Array, **more: Any) -> dict[str, Array]:
        """Residuals phi (N, m) and Jacobians dphi/dq (N, m, n) of all closures; nothing where there are none."""
        if not self.model.closures:
            return {}
        given = {"q": q, "parameters": self.given(parameters), **more}
        values = symbol_values(self.model, given, read_states(self.model, given, None), CLOSURES)
        return interpret_in_blocks(self.model.program, values, CLOSURES, len(q))


def sides(*given: Part | Parts) -> list[Side]:
    """Models to be compared: a part gets the gravity of the first tree among them."""
    like = next((x[0] for x in given if not isinstance(x, Part)), None)
    return [Side.of_part(x, like) if isinstance(x, Part) else Side.of_tree(*x) for x in given]


def alone(definition: Definition, like: TreeSpec | None = None) -> TreeSpec:
    """The tree of a part at the world, under the gravity of another tree or one of three free parameters."""
    instance = {"name": INSTANCE, "definition": definition.model_dump(exclude_defaults=True, by_alias=True)}
    if like is None:
        free = {name: {"value": value, "unit": "m/s^2"} for name, value in GRAVITY.items()}
        gravity: dict[str, Any] = {"gravity": list(GRAVITY), "parameters": free}
    else:
        given = like.model_dump(exclude_defaults=True, by_alias=True)
        gravity = {name: given[name] for name in ("gravity", "parameters") if name in given}
    return TreeSpec.stored({"name": "alone", **gravity, "instances": [instance]})


class Matched(NamedTuple):
    """Of every coordinate of a model, and of every position, the number of the one in another model."""

    coordinates: list[int]
    positions: list[int]


def matching(a: Side, b: Side, order: list[int]) -> Matched | None:
    """``order``: of every coordinate of a the number of the one in b. None where joints with quaternions are others."""
    found = {name: b.model.coordinates[k] for name, k in zip(a.model.coordinates, order, strict=True)}
    theirs = {tuple(ball["velocities"]): ball["positions"] for ball in b.model.balls}
    for ball in a.model.balls:
        other = theirs.pop(tuple(found[name] for name in ball["velocities"]), None)
        if other is None:
            return None
        found |= dict(zip(ball["positions"], other, strict=True))
    return None if theirs else Matched(order, [b.model.positions.index(found[name]) for name in a.model.positions])


@dataclass(frozen=True)
class Carriers:
    """Numbers where all coordinates are zero, in the world.

    ``screws`` (n, 6): of every coordinate the direction omega and the velocity v of the world's origin, for q' = 1;
    ``carrier``: of every frame the last coordinate that moves it, -1 for none; ``R``, ``r``: its axes and place.
    """

    screws: Array
    carrier: dict[str, int]
    R: dict[str, Array]
    r: dict[str, Array]

    @classmethod
    def of(cls, side: Side, order: list[int], parameters: Mapping[str, float]) -> Carriers:
        """``order``: numbers of the coordinates that are compared, one by one."""
        n = side.model.dof
        found = side.evaluate(["kinematics"], parameters, q=side.resting[None])
        kinematics = {name: np.asarray(x[0], dtype=float) for name, x in found["kinematics"].items()}
        R, r = kinematics["rotation"], kinematics["position"]
        omega = np.einsum("fij,faj->fai", R, kinematics["Omega"])
        # v of the point at the world's origin = v of the frame's origin - omega x r
        v = np.einsum("fij,faj->fai", R, kinematics["U"]) - np.cross(omega, r[:, None, :])
        twists = np.concatenate([omega, v], axis=2)[:, order]
        frames = side.model.frames
        moves = np.abs(twists).max(axis=2, initial=0) > 1e-12
        place = np.argsort(order) if n else np.zeros(0, dtype=int)
        last = {f: max((a for a in range(n) if moves[i, place[a]]), default=-1) for i, f in enumerate(frames)}
        screws = np.zeros((n, 6))
        for a in range(n):
            carried = [i for i in range(len(frames)) if moves[i, a]]
            if carried:
                screws[a] = twists[carried[0], a]
        carrier = {f: int(place[a]) if a >= 0 else -1 for f, a in last.items()}
        return cls(screws, carrier, dict(zip(frames, R, strict=True)), dict(zip(frames, r, strict=True)))
