"""Forces and energies of the loads of a tree at one state: each is the power of its law on changing points and axes.

A point x of a body moves with v_a + w_a x x for q'^a = 1, and an axis e with w_a x e, all in the axes of the world;
lengths, components and angles change as these say. A new type of load is a function in :data:`LOADS`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from flint import arb, fmpq

from substructures.certificate.bodies import GROUND, NONE, Bodies, Frame
from substructures.certificate.linear import Ball, Matrix, column, cross, dot, identity, zeros
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.texts import names_of, slope
from substructures.expr.direct import steps_of
from substructures.expr.syntax import measured

HALF = fmpq(1, 2)
Slopes = dict[int, Ball]
_STILL = zeros(3, 1)


class TreeForces:
    """``applied``: Q_a of all loads; ``potential``: V of those that have one, ``slopes`` its -dV/dq^a.

    ``numbers``: of the tree; ``constants``: the names of all parameters.
    """

    def __init__(self, tree: Plain, bodies: Bodies, numbers: Numbers, constants: frozenset[str]) -> None:
        self.bodies, self.parameters = bodies, numbers
        self.coordinates = {joint.coordinate: a for a, joint in enumerate(bodies.joints)}
        self.numbers = Numbers(_Names(self, numbers.names))
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

    def turns(self, frame: Frame) -> dict[int, Matrix]:
        """w_a of all joints that carry a frame."""
        return {a: self.bodies.joints[a].w for a in self.bodies.path(frame.carrier)}

    def moves(self, frame: Frame, x: Matrix) -> dict[int, Matrix]:
        """The velocities of a point that is fixed to a frame."""
        return {a: self.bodies.joints[a].v + cross(w, x) for a, w in self.turns(frame).items()}

    def product(self, A: Mapping[int, Matrix], x: Matrix, B: Mapping[int, Matrix], y: Matrix) -> Slopes:
        """The changes of x . y, of which x changes by ``A`` and y by ``B``."""
        return {a: dot(A.get(a, _STILL), y) + dot(x, B.get(a, _STILL)) for a in {**A, **B}}

    def rate(self, changes: Slopes) -> Ball:
        """What changes so changes in time."""
        rates = self.parameters.names
        return sum((x * rates[f"{self.bodies.joints[a].coordinate}'"] for a, x in changes.items()), arb(0))

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

    def measure(self, name: str) -> tuple[Ball, Slopes]:
        """A measure and its changes, by its name without the mark of a rate."""
        kind, start, end = measured(name) or ("", "", "")
        A, B = self.frame(start), self.frame(end)
        if kind == "distance":
            d, changes = B.p - A.p, _difference(self.moves(B, B.p), self.moves(A, A.p))
            length = dot(d, d).sqrt()
            return length, {a: dot(d, u) / length for a, u in changes.items()}
        # tan(angle) = y / x of the first axis of B
        axis, turn, other = column(B.A, 0), self.turns(B), self.turns(A)
        x, y = (dot(axis, column(A.A, i)) for i in range(2))
        along = {a: cross(w, axis) for a, w in turn.items()}
        dx, dy = (
            self.product(along, axis, {a: cross(w, column(A.A, i)) for a, w in other.items()}, column(A.A, i))
            for i in range(2)
        )
        return arb.atan2(y, x), {a: (x * dy[a] - y * dx[a]) / (x * x + y * y) for a in dx}


class _Names(Mapping[str, Ball]):
    """The names of a tree, measures of frames among them."""

    def __init__(self, forces: TreeForces, names: Mapping[str, Ball]) -> None:
        self.forces, self.names = forces, names

    def __getitem__(self, name: str) -> Ball:
        if not measured(name):
            return self.names[name]
        value, changes = self.forces.measure(name.replace("'", ""))
        return self.forces.rate(changes) if "'" in name else value

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names or (isinstance(name, str) and measured(name) is not None)


def _difference(x: Mapping[int, Matrix], y: Mapping[int, Matrix]) -> dict[int, Matrix]:
    return {a: x.get(a, _STILL) - y.get(a, _STILL) for a in {**x, **y}}


def _spring(found: TreeForces, load: Plain) -> None:
    """Q_a = -(k (l - l0) + c l') dl/dq^a,   V = k (l - l0)^2 / 2."""
    A, B = found.ends(load)
    x, y = (F.p + F.A * found.parameters.vector(load.get(f, NONE)) for F, f in ((A, "from_at"), (B, "to_at")))
    k, c, l0 = (found.numbers.read(load.get(name, 0)) for name in ("stiffness", "damping", "length"))
    length = dot(y - x, y - x).sqrt()
    changes = {a: dot(y - x, u) / length for a, u in _difference(found.moves(B, y), found.moves(A, x)).items()}
    found.add(-k * (length - l0) - c * found.rate(changes), changes)
    if found.is_steady(load.get("stiffness", 0), load.get("length", 0)):
        found.keep(k * (length - l0) * (length - l0) * HALF, -k * (length - l0), changes)


def _bushing(found: TreeForces, load: Plain) -> None:
    """V = k_i d_i^2 / 2 + h_j (1 - a_j . b_j), a_j and b_j the axes, h_j = (k_1 + k_2 + k_3)/2 - k_j; dampers
    -c_i d_i', and -c_i w_i of the angular velocity w_i of B seen from A about a_i.
    """
    A, B = found.ends(load)
    names = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    k, c, ka, ca = (found.numbers.vector(load.get(name, NONE)).entries() for name in names)
    d, d_a = B.p - A.p, _difference(found.moves(B, B.p), found.moves(A, A.p))
    turned = _difference(found.turns(B), found.turns(A))
    for i in range(3):
        axis, other = column(A.A, i), column(B.A, i)
        axis_a, other_a = ({a: cross(w, x) for a, w in found.turns(F).items()} for F, x in ((A, axis), (B, other)))
        along, parallel = found.product(d_a, d, axis_a, axis), found.product(axis_a, axis, other_a, other)
        about = {a: dot(w, axis) for a, w in turned.items()}
        d_i, h = dot(d, axis), (ka[0] + ka[1] + ka[2]) * HALF - ka[i]
        found.add(-k[i] * d_i - c[i] * found.rate(along), along)
        found.add(h, parallel)
        found.add(-ca[i] * found.rate(about), about)
        if found.is_steady(*load.get("stiffness", NONE)):
            found.keep(k[i] * d_i * d_i * HALF, -k[i] * d_i, along)
        if found.is_steady(*load.get("angular_stiffness", NONE)):
            found.keep(h * (1 - dot(axis, other)), h, parallel)


def _in_world(found: TreeForces, load: Plain) -> Matrix:
    given, axes = found.numbers.vector(load["vector"]), load.get("axes", "to")
    if axes == "world":
        return given
    return found.ends(load)[axes == "to"].A * given


def _force(found: TreeForces, load: Plain) -> None:
    """Q_a = F . (u_Ba - u_Aa) of what is of both bodies at the place of the force; V = -F . x."""
    A, B = found.ends(load)
    x, F = B.p + B.A * found.parameters.vector(load.get("at", NONE)), _in_world(found, load)
    changes = {a: dot(F, u) for a, u in _difference(found.moves(B, x), found.moves(A, x)).items()}
    found.add(arb(1), changes)
    names = frozenset().union(*(names_of(steps_of(F_i)) for F_i in load["vector"]))
    is_dead = load.get("from", "world") == "world" and load.get("axes", "to") != "to"
    if is_dead and changes and names <= found.constants:
        found.keep(-dot(F, x), arb(1), changes)


def _torque(found: TreeForces, load: Plain) -> None:
    """Q_a = M . (w_Ba - w_Aa)."""
    A, B = found.ends(load)
    M = _in_world(found, load)
    found.add(arb(1), {a: dot(M, w) for a, w in _difference(found.turns(B), found.turns(A)).items()})


def _joint_load(found: TreeForces, load: Plain) -> None:
    found.add(found.numbers.read(load["force"]), {found.coordinates[load["coordinate"]]: arb(1)})


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
    "bushing": _bushing,
    "force": _force,
    "torque": _torque,
    "joint": _joint_load,
    "potential": _potential,
}
