"""What laws between two frames do at one state: each is the power of its law on changing points and axes.

A point x of a body moves with v_a + w_a x x for q'^a = 1, and an axis e with w_a x e, all in the axes of the world;
lengths, components and angles change as these say.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from flint import arb, fmpq

from substructures.certificate.bodies import NONE, Bodies, Frame
from substructures.certificate.linear import Ball, Matrix, column, cross, dot, zeros
from substructures.certificate.numbers import Numbers, Plain
from substructures.expr.steps import measured

HALF = fmpq(1, 2)
Slopes = dict[int, Ball]
_STILL = zeros(3, 1)


class Between(ABC):
    """The frames of a part or of a tree, between which loads act; ``numbers``: what their laws name, with measures."""

    bodies: Bodies
    numbers: Numbers

    @abstractmethod
    def frame(self, at: str) -> Frame:
        """A frame by its name."""

    @abstractmethod
    def rate(self, changes: Slopes) -> Ball:
        """What changes so changes in time."""

    @abstractmethod
    def add(self, law: Ball, changes: Slopes) -> None:
        """Q_a of a force on what changes."""

    @abstractmethod
    def keep(self, energy: Ball, law: Ball, changes: Slopes) -> None:
        """An energy, whose -dV/dq^a a law is."""

    @abstractmethod
    def is_steady(self, *given: Any) -> bool:
        """Whether numbers name nothing that moves."""

    @abstractmethod
    def ends(self, load: Plain) -> tuple[Frame, Frame]:
        """The frames between which a load acts."""

    @abstractmethod
    def stretch(self, load: Plain, length: Ball, changes: Slopes) -> None:
        """Q_a = -(k (l - l0) + c l') dl/dq^a of a spring and damper along a length l,   V = k (l - l0)^2 / 2."""

    def law(self, load: Plain) -> tuple[Ball, Ball, Ball]:
        """Its stiffness, damping and rest length."""
        k, c, l0 = (self.numbers.read(load.get(name, 0)) for name in ("stiffness", "damping", "length"))
        return k, c, l0

    def turns(self, frame: Frame) -> dict[int, Matrix]:
        """w_a of all joints that carry a frame."""
        return {a: self.bodies.joints[a].w for a in self.bodies.path(frame.carrier)}

    def moves(self, frame: Frame, x: Matrix) -> dict[int, Matrix]:
        """The velocities of a point that is fixed to a frame."""
        return {a: self.bodies.joints[a].v + cross(w, x) for a, w in self.turns(frame).items()}

    def product(self, A: Mapping[int, Matrix], x: Matrix, B: Mapping[int, Matrix], y: Matrix) -> Slopes:
        """The changes of x . y, of which x changes by ``A`` and y by ``B``."""
        return {a: dot(A.get(a, _STILL), y) + dot(x, B.get(a, _STILL)) for a in {**A, **B}}

    def measure(self, name: str) -> tuple[Ball, Slopes]:
        """A measure and its changes, by its name without the mark of a rate."""
        kind, start, end = measured(name) or ("", "", "")
        A, B = self.frame(start), self.frame(end)
        if kind == "distance":
            return distance(self, A, A.p, B, B.p)
        # tan(angle) = y / x of the first axis of B
        axis, turn, other = column(B.A, 0), self.turns(B), self.turns(A)
        x, y = (dot(axis, column(A.A, i)) for i in range(2))
        along = {a: cross(w, axis) for a, w in turn.items()}
        dx, dy = (
            self.product(along, axis, {a: cross(w, column(A.A, i)) for a, w in other.items()}, column(A.A, i))
            for i in range(2)
        )
        return arb.atan2(y, x), {a: (x * dy[a] - y * dx[a]) / (x * x + y * y) for a in dx}


class MeasuredNames(Mapping[str, Ball]):
    """Names, measures of frames among them."""

    def __init__(self, forces: Between, names: Mapping[str, Ball]) -> None:
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


def distance(found: Between, A: Frame, x: Matrix, B: Frame, y: Matrix) -> tuple[Ball, Slopes]:
    """Of two points of frames, with its changes: e . (u_B - u_A)."""
    d = y - x
    length = dot(d, d).sqrt()
    return length, {a: dot(d, u) / length for a, u in difference(found.moves(B, y), found.moves(A, x)).items()}


def difference(x: Mapping[int, Matrix], y: Mapping[int, Matrix]) -> dict[int, Matrix]:
    """What two bodies move against each other."""
    return {a: x.get(a, _STILL) - y.get(a, _STILL) for a in {**x, **y}}


def bushing(found: Between, load: Plain) -> None:
    """V = k_i d_i^2 / 2 + h_j (1 - a_j . b_j), a_j and b_j the axes, h_j = (k_1 + k_2 + k_3)/2 - k_j; dampers
    -c_i d_i', and -c_i w_i of the angular velocity w_i of B seen from A about a_i.
    """
    A, B = found.ends(load)
    names = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    k, c, ka, ca = (found.numbers.vector(load.get(name, NONE)).entries() for name in names)
    d, d_a = B.p - A.p, difference(found.moves(B, B.p), found.moves(A, A.p))
    turned = difference(found.turns(B), found.turns(A))
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


def cable(found: Between, load: Plain) -> None:
    """A spring and damper along the sum of the distances of consecutive points."""
    given = [{"frame": x} if isinstance(x, str) else x for x in load["along"]]
    frames = [found.frame(x["frame"]) for x in given]
    points = [F.p + F.A * found.numbers.vector(x.get("at", NONE)) for F, x in zip(frames, given, strict=True)]
    total, changes = arb(0), dict[int, Ball]()
    for (A, x), (B, y) in pairwise(zip(frames, points, strict=True)):
        length, of_leg = distance(found, A, x, B, y)
        total += length
        changes = {a: changes.get(a, arb(0)) + of_leg.get(a, arb(0)) for a in {**changes, **of_leg}}
    if load.get("slack"):
        total = total.max(found.numbers.read(load.get("length", 0)))
    found.stretch(load, total, changes)


def in_world(found: Between, load: Plain) -> Matrix:
    """The vector of a load."""
    given, axes = found.numbers.vector(load["vector"]), load.get("axes", "to")
    if axes == "world":
        return given
    return found.ends(load)[axes == "to"].A * given


def force_changes(found: Between, load: Plain, F: Matrix, x: Matrix) -> Slopes:
    """F . (u_Ba - u_Aa) of what is of both bodies at the place x of the force."""
    A, B = found.ends(load)
    return {a: dot(F, u) for a, u in difference(found.moves(B, x), found.moves(A, x)).items()}


def torque_changes(found: Between, load: Plain, M: Matrix) -> Slopes:
    """M . (w_Ba - w_Aa)."""
    A, B = found.ends(load)
    return {a: dot(M, w) for a, w in difference(found.turns(B), found.turns(A)).items()}
