"""Forces and energies of the loads of a tree at one state (:mod:`.between`).

A new type of load is a function in :data:`LOADS`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flint import arb

from substructures.certificate.bodies import GROUND, NONE, Bodies, Frame
from substructures.certificate.linear import Ball, dot, identity, zeros
from substructures.certificate.loads.between import (
    HALF,
    Between,
    MeasuredNames,
    Slopes,
    bushing,
    cable,
    distance,
    force_changes,
    in_world,
    torque_changes,
)
from substructures.certificate.loads.joint_laws import friction_force
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.texts import names_of, slope
from substructures.expr.direct import steps_of
from substructures.expr.steps import measured


class TreeForces(Between):
    """``applied``: Q_a of all loads; ``potential``: V of those that have one, ``slopes`` its -dV/dq^a.

    ``numbers``: of the tree; ``constants``: the names of all parameters.
    """

    def __init__(self, tree: Plain, bodies: Bodies, numbers: Numbers, constants: frozenset[str]) -> None:
        self.bodies, self.parameters = bodies, numbers
        self.coordinates = {joint.coordinate: a for a, joint in enumerate(bodies.joints)}
        self.numbers = Numbers(MeasuredNames(self, numbers.names))
        self.constants = constants
        self.applied: Slopes = {}
        self.slopes: Slopes = {}
        self.potential = arb(0)
        for load in tree.get("loads", ()):
            LOADS[load["type"]](self, load)

    def frame(self, at: str) -> Frame:
        """A frame of the tree, or the world."""
        return Frame(GROUND, identity(), zeros(3, 1)) if at == "world" else self.bodies.frames[at]

    def ends(self, load: Plain) -> tuple[Frame, Frame]:
        """The frames between which a load acts."""
        return self.frame(load.get("from", "world")), self.frame(load["to"])

    def rate(self, changes: Slopes) -> Ball:
        """What changes so changes in time."""
        names = self.parameters.names
        joints = ((self.bodies.joints[a], x) for a, x in changes.items())
        return sum((x * joint.slope * names[f"{joint.mover}'"] for joint, x in joints), arb(0))

    def add(self, law: Ball, changes: Slopes) -> None:
        """Q_a of a force on what changes."""
        for a, x in changes.items():
            self.applied[a] = self.applied.get(a, arb(0)) + law * x

    def keep(self, energy: Ball, law: Ball, changes: Slopes) -> None:
        """An energy, whose -dV/dq^a a law is."""
        self.potential += energy
        for a, x in changes.items():
            self.slopes[a] = self.slopes.get(a, arb(0)) + law * x

    def is_steady(self, *given: Any) -> bool:
        """Whether numbers name nothing that moves."""
        return not any(
            measured(name) or name.removesuffix("'") in self.coordinates
            for x in given
            for name in names_of(steps_of(x))
        )

    def stretch(self, load: Plain, length: Ball, changes: Slopes) -> None:
        """With a potential if neither stiffness nor rest length moves."""
        k, c, l0 = self.law(load)
        self.add(-k * (length - l0) - c * self.rate(changes), changes)
        if self.is_steady(load.get("stiffness", 0), load.get("length", 0)):
            self.keep(k * (length - l0) * (length - l0) * HALF, -k * (length - l0), changes)


def _spring(found: TreeForces, load: Plain) -> None:
    A, B = found.ends(load)
    x, y = (F.p + F.A * found.parameters.vector(load.get(f, NONE)) for F, f in ((A, "from_at"), (B, "to_at")))
    found.stretch(load, *distance(found, A, x, B, y))


def _force(found: TreeForces, load: Plain) -> None:
    """Q_a = F . (u_Ba - u_Aa) of what is of both bodies at the place of the force; V = -F . x."""
    _, B = found.ends(load)
    x, F = B.p + B.A * found.parameters.vector(load.get("at", NONE)), in_world(found, load)
    changes = force_changes(found, load, F, x)
    found.add(arb(1), changes)
    names = frozenset().union(*(names_of(steps_of(F_i)) for F_i in load["vector"]))
    is_dead = load.get("from", "world") == "world" and load.get("axes", "to") != "to"
    if is_dead and changes and names <= found.constants:
        found.keep(-dot(F, x), arb(1), changes)


def _torque(found: TreeForces, load: Plain) -> None:
    """Q_a = M . (w_Ba - w_Aa)."""
    found.add(arb(1), torque_changes(found, load, in_world(found, load)))


def _joint_load(found: TreeForces, load: Plain) -> None:
    found.add(found.numbers.read(load["force"]), {found.coordinates[load["coordinate"]]: arb(1)})


def _friction(found: TreeForces, load: Plain) -> None:
    a = found.coordinates[load["coordinate"]]
    rate = found.parameters.names[f"{load['coordinate']}'"]
    found.add(-friction_force(found.parameters, load, rate), {a: arb(1)})


def _potential(found: TreeForces, load: Plain) -> None:
    """Q_a = -dV/dq^a."""
    found.potential += found.numbers.read(load["potential"])
    for name in sorted(names_of(steps_of(load["potential"]))):
        if name in found.coordinates or measured(name):
            changes = found.measure(name)[1] if measured(name) else {found.coordinates[name]: arb(1)}
            law = -slope(load["potential"], found.numbers.names, name)
            found.add(law, changes)
            found.keep(arb(0), law, changes)


#: what the loads of each type add to the forces
LOADS: dict[str, Callable[[TreeForces, Plain], None]] = {
    "spring": _spring,
    "bushing": bushing,
    "cable": cable,
    "force": _force,
    "torque": _torque,
    "joint": _joint_load,
    "friction": _friction,
    "potential": _potential,
}
