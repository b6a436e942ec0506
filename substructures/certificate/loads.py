"""Forces and energies of the loads of a definition, by virtual power: F . (velocity of its point for q'^a = 1).

A new type of load is a function in :data:`LOADS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flint import arb, fmpq

from substructures.certificate.bodies import NONE, Bodies, Frame
from substructures.certificate.linear import Ball, Matrix, cross, dot, zeros
from substructures.certificate.numbers import Numbers, Plain


class Forces:
    """Of one definition in a world of bodies.

    ``applied``: Q_a of joint laws, actuators, joint loads and springs; ``wrenches``: Q_a of forces and torques on
    bodies; ``potential``: of all springs; ``places``: point and vector of every force and torque, as they are stored.
    ``joints``: of the definition; ``prefix``: of its names.
    """

    def __init__(self, bodies: Bodies, numbers: Numbers, joints: range, prefix: str = "") -> None:
        self.bodies, self.numbers, self.joints, self.prefix = bodies, numbers, joints, prefix
        self.applied: dict[int, Ball] = {}
        self.wrenches: dict[int, Ball] = {}
        self.potential = arb(0)
        self.places: list[tuple[Matrix, Matrix]] = []
        self.index = {joint.coordinate: a for a, joint in enumerate(bodies.joints)}

    def rate(self, a: int) -> Ball:
        """q'^a."""
        return self.numbers.names[self.bodies.joints[a].coordinate.rpartition(".")[2] + "'"]

    def point(self, end: Plain) -> tuple[Frame, Matrix, dict[int, Matrix]]:
        """Of ``body`` and ``at``: the body's frame, the point in the world, its velocity for every q'^a = 1."""
        frame = self.bodies.frames[f"{self.prefix}{end['body']}"]
        x = frame.p + frame.A * self.numbers.vector(end.get("at", NONE))
        path = self.bodies.path(frame.carrier)
        return frame, x, {a: self.bodies.joints[a].v + cross(self.bodies.joints[a].w, x) for a in path}


def forces(bodies: Bodies, definition: Plain, numbers: Numbers, joints: range, prefix: str = "") -> Forces:
    """All loads of a definition; ``joints``: its own. Raises LookupError for a type of load that is not known here."""
    found = Forces(bodies, numbers, joints, prefix)
    for a in joints:
        _joint_law(found, a)
    for load in definition.get("loads", ()):
        LOADS[load["type"]](found, load)
    return found


def _add(sums: dict[int, Ball], terms: Mapping[int, Any]) -> None:
    for a, term in terms.items():
        sums[a] = sums.get(a, arb(0)) + term


def _joint_law(found: Forces, a: int) -> None:
    """Q = tau - k (q - rest) - c q',   V = k (q - rest)^2 / 2."""
    joint, names = found.bodies.joints[a], found.numbers.names
    name = joint.coordinate.rpartition(".")[2]
    stretch = names[name] - joint.rest
    _add(found.applied, {a: names[f"tau.{name}"] - joint.stiffness * stretch - joint.damping * found.rate(a)})
    found.potential += joint.stiffness * stretch * stretch * arb(fmpq(1, 2))


def _joint_load(found: Forces, load: Plain) -> None:
    _add(found.applied, {found.index[found.prefix + load["coordinate"]]: found.numbers.read(load["force"])})


def _force(found: Forces, load: Plain) -> None:
    """Q_a = F . u_a."""
    frame, x, u = found.point(load)
    given = found.numbers.vector(load["vector"])
    F = given if load.get("frame") == "world" else frame.A * given
    _add(found.wrenches, {a: dot(F, u_a) for a, u_a in u.items()})
    _keep(found, frame, x, load, given)


def _torque(found: Forces, load: Plain) -> None:
    """Q_a = M . w_a."""
    frame = found.bodies.frames[found.prefix + load["body"]]
    given = found.numbers.vector(load["vector"])
    M = given if load.get("frame") == "world" else frame.A * given
    _add(found.wrenches, {a: dot(M, found.bodies.joints[a].w) for a in found.bodies.path(frame.carrier)})
    _keep(found, frame, None, load, given)


def _keep(found: Forces, frame: Frame, x: Matrix | None, load: Plain, given: Matrix) -> None:
    """The point in the carrier's body frame; the vector in its axes, or in those of the world."""
    A, origin = found.bodies.carrier(frame.carrier)
    back = A.transpose()
    at = zeros(3, 1) if x is None else back * (x - origin)
    found.places.append((at, given if load.get("frame") == "world" else back * frame.A * given))


def _spring(found: Forces, load: Plain) -> None:
    """Q_a = -(k (l - l0) + c l') dl/dq^a,   V = k (l - l0)^2 / 2,   dl/dq^a = e . (u_to,a - u_from,a).

    A host moves both ends like one body, so that a is a joint of the definition itself.
    """
    (_, start, u_start), (_, end, u_end) = found.point(load["from"]), found.point(load["to"])
    k, c, l0 = (found.numbers.read(load.get(name, 0)) for name in ("stiffness", "damping", "length"))
    x = end - start
    length = dot(x, x).sqrt()
    e, slopes = x / length, dict.fromkeys(found.joints, arb(0))
    _add(slopes, {a: dot(e, u) for a, u in u_end.items() if a in slopes})
    _add(slopes, {a: -dot(e, u) for a, u in u_start.items() if a in slopes})
    # l' = dl/dq^a q'^a
    speed = sum((slope * found.rate(a) for a, slope in slopes.items()), arb(0))
    tension = k * (length - l0) + c * speed
    _add(found.applied, {a: -tension * slope for a, slope in slopes.items()})
    found.potential += k * (length - l0) * (length - l0) * arb(fmpq(1, 2))


#: what the loads of each type add to the forces
LOADS: dict[str, Callable[[Forces, Plain], None]] = {
    "joint": _joint_load,
    "force": _force,
    "torque": _torque,
    "spring": _spring,
}
