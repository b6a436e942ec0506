"""Sums of forces and energies of the loads of a definition, and the frames that they act between."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import arb, fmpq

from substructures.certificate.bodies import NONE, Bodies, Frame
from substructures.certificate.by_coordinate import gathered
from substructures.certificate.linear import Ball, Matrix, cross
from substructures.certificate.loads.between import Between, MeasuredNames, Slopes
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.texts import Steps, depends_on, names_of, slope
from substructures.expr.direct import steps_of
from substructures.expr.steps import measured


class Forces:
    """Of one definition in a world of bodies.

    ``applied``: Q_a of joint laws, actuators, joint loads, springs and potentials; ``wrenches``: Q_a of forces and
    torques on bodies; ``places``: point and vector of every force and torque, as they are stored.
    ``potential``: V of springs, stops and potentials in closed form, ``slopes`` its -dV/dq^a; ``dead``, ``dead_slopes``
    the same of forces that are constant in the world.
    Of two kinds of forces potentials may have been found: ``given`` as formulas, by joint; ``bent``, of springs whose
    stiffness or length depends on coordinates, as far as they are gradients. ``steady``: the same of forces and torques
    on bodies that depend on coordinates and parameters alone.
    ``joints``: of the definition; ``prefix``: of its names; ``like``: the forces at a random state, where these are at
    one at which numbers may not change with coordinates that they depend on.
    """

    def __init__(
        self,
        bodies: Bodies,
        definition: Plain,
        numbers: Numbers,
        joints: range,
        prefix: str = "",
        like: Forces | None = None,
    ) -> None:
        self.bodies, self.joints, self.prefix = bodies, joints, prefix
        #: frames of the definition and measures of them, with which laws are read; ``constants``: numbers without them
        self.constants, self.between = numbers, _OwnFrames(self, numbers)
        self.numbers = self.between.numbers
        self.definition, self.somewhere = definition, like.constants.names if like else numbers.names
        self.applied: dict[int, Ball] = {}
        self.wrenches: dict[int, Ball] = {}
        self.potential = self.dead = arb(0)
        self.slopes: dict[int, Ball] = {}
        self.dead_slopes: dict[int, Ball] = {}
        self.given: dict[int, list[Steps]] = {}
        self.bent: list[dict[int, Ball]] = []
        self.steady: list[dict[int, Ball]] = []
        self.places: list[tuple[Matrix, Matrix]] = []
        self.index = {joint.coordinate: a for a, joint in enumerate(bodies.joints)}
        left = [a for a in joints if bodies.joints[a].coordinate == bodies.joints[a].mover]
        self.coordinates = {bodies.joints[a].coordinate.rpartition(".")[2]: a for a in left}

    def depends(self, *given: Any) -> bool:
        """Whether numbers depend on a coordinate or a velocity of the definition."""
        return any(
            depends_on(x, self.somewhere, name)
            for x in given
            for name in names_of(steps_of(x))
            if name.removesuffix("'") in self.coordinates
        )

    def rate(self, a: int) -> Ball:
        """q'^a."""
        return self.numbers.names[self.bodies.joints[a].coordinate.rpartition(".")[2] + "'"]

    def point(self, end: Plain) -> tuple[Frame, Matrix, dict[int, Matrix]]:
        """Of ``body`` and ``at``: the body's frame, the point in the world, its velocity for every q'^a = 1."""
        frame = self.bodies.frames[f"{self.prefix}{end['body']}"]
        x = frame.p + frame.A * self.numbers.vector(end.get("at", NONE))
        path = self.bodies.path(frame.carrier)
        return frame, x, {a: self.bodies.joints[a].v + cross(self.bodies.joints[a].w, x) for a in path}


class _OwnFrames(Between):
    """Between two bodies or ports of one definition: a host moves both like one body."""

    def __init__(self, forces: Forces, numbers: Numbers) -> None:
        self.forces, self.bodies = forces, forces.bodies
        self.numbers = Numbers(MeasuredNames(self, numbers.names))

    def frame(self, at: str) -> Frame:
        """A body or port."""
        return self.bodies.frames[f"{self.forces.prefix}{at}"]

    def ends(self, load: Plain) -> tuple[Frame, Frame]:
        """Both bodies or ports."""
        return self.frame(load.get("from", "base")), self.frame(load["to"])

    def rate(self, changes: Slopes) -> Ball:
        """By the joints of the definition."""
        return sum((x * self.forces.rate(a) for a, x in changes.items() if a in self.forces.joints), arb(0))

    def add(self, law: Ball, changes: Slopes) -> None:
        """To what is applied."""
        add_to(self.forces.applied, {a: law * x for a, x in changes.items() if a in self.forces.joints})

    def keep(self, energy: Ball, law: Ball, changes: Slopes) -> None:
        """To the potential."""
        self.forces.potential += energy
        add_to(self.forces.slopes, {a: law * x for a, x in changes.items() if a in self.forces.joints})

    def stretch(self, load: Plain, length: Ball, changes: Slopes) -> None:
        """A host moves all frames like one body, so that a is a joint of the definition itself."""
        found, (k, c, l0) = self.forces, self.law(load)
        reach = {a: changes.get(a, arb(0)) for a in found.joints}
        # l' = dl/dq^a q'^a
        tension = k * (length - l0) + c * self.rate(reach)
        add_to(found.applied, {a: -tension * w for a, w in reach.items()})
        pulls = {a: -k * (length - l0) * w for a, w in reach.items()}
        if measures_in(load.get("stiffness", 0), load.get("length", 0)):
            return
        if found.depends(load.get("stiffness", 0), load.get("length", 0)):
            if not any(self.bodies.joints[a].group for a in found.joints) and _is_gradient(
                found, load, (k, length - l0), gathered(self.bodies, reach)
            ):
                found.bent.append(gathered(self.bodies, pulls))
        else:
            found.potential += k * (length - l0) * (length - l0) * arb(fmpq(1, 2))
            add_to(found.slopes, pulls)

    def is_steady(self, *given: Any) -> bool:
        """Whether numbers name no measures, coordinates and velocities."""
        names = {name for x in given for name in names_of(steps_of(x))}
        return not any(measured(name) or name.removesuffix("'") in self.forces.coordinates for name in names)


def add_to(sums: dict[int, Ball], terms: Mapping[int, Any]) -> None:
    """Terms to sums by index."""
    for a, term in terms.items():
        sums[a] = sums.get(a, arb(0)) + term


def measures_in(*given: Any) -> list[str]:
    """The measures of frames that numbers name; what depends on them is a force without potential."""
    return sorted({name for x in given for name in names_of(steps_of(x)) if measured(name)})


def _is_gradient(found: Forces, load: Plain, law: tuple[Ball, Ball], reach: Mapping[int, Ball]) -> bool:
    """Whether Q_a = f dl/dq^a with f = -k (l - l0) has a potential where k and l0 depend on coordinates q, and on no
    velocity: df/dq^b dl/dq^a = df/dq^a dl/dq^b, of the derivatives of f at fixed l. ``law``: k and l - l0.
    """
    k, stretch = law
    names, given = found.numbers.names, (load.get("stiffness", 0), load.get("length", 0))

    def by(name: str) -> Ball:
        """df by a name at fixed l."""
        return k * slope(given[1], names, name) - stretch * slope(given[0], names, name)

    if any(depends_on(x, names, f"{name}'") for name in found.coordinates for x in given):
        return False
    pairs = [(by(name), reach.get(a, arb(0))) for name, a in found.coordinates.items()]
    return all((f * v - g * w).contains(0) for f, w in pairs for g, v in pairs)
