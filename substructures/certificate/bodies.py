"""Definitions read into frames and masses in one world at one state: from the documents alone.

Everything is where it is at that state, in the axes of the world and about its origin (of a part standing alone: of its
interface frame). The documents are those of the contract: joint rows (notation.md, section 2) or placements, in the
order of the bodies with parents first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat, fmpq

from substructures.certificate.linear import (
    Ball,
    Matrix,
    cross,
    identity,
    onto_third_axis,
    outer,
    roll_pitch_yaw,
    turn,
    unit,
    vector,
    with_third_axis,
    zeros,
)
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.relations import POSITIONS, Related, is_ball, mover, place_of, rates_of, slope_of
from substructures.expr.steps import Step

GROUND = -1
#: (prismatic, axis of the frame before it) of every one degree of freedom joint in a joint type
CHAINS: dict[str, tuple[tuple[bool, int], ...]] = {
    "revolute": ((False, 2),),
    "prismatic": ((True, 2),),
    "fixed": (),
    "universal": ((False, 2), (False, 1)),
    "spherical": ((False, 2), (False, 1), (False, 0)),
    "cylindrical": ((False, 2), (True, 2)),
    "planar": ((True, 0), (True, 1), (False, 2)),
    "free": ((True, 0), (True, 1), (True, 2), (False, 2), (False, 1), (False, 0)),
    "ball": ((False, 0), (False, 1), (False, 2)),
    "floating": ((True, 0), (True, 1), (True, 2), (False, 0), (False, 1), (False, 2)),
}
NONE, MASSES = (0, 0, 0), frozenset(("mass", "com", "inertia"))


@dataclass(frozen=True)
class Frame:
    """A frame fixed in what a joint carries (GROUND: in the world): its axes as columns of A, its origin p."""

    carrier: int
    A: Matrix
    p: Matrix

    def placed(self, A: Matrix, p: Matrix) -> Frame:
        """A frame placed in this one."""
        return Frame(self.carrier, self.A * A, self.p + self.A * p)


@dataclass(frozen=True)
class Moments:
    """Mass, first moment, and second moment (integral of x x^T dm) of a distribution of mass."""

    m: Ball
    s: Matrix
    J: Matrix

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.m + other.m, self.s + other.s, self.J + other.J)

    def outwards(self, A: Matrix, p: Matrix) -> Moments:
        """Given in a frame: about the origin of the world. x -> A x + p under the integrals."""
        s = A * self.s
        return Moments(
            self.m,
            s + p * self.m,
            A * self.J * A.transpose() + outer(s, p) + outer(p, s) + outer(p, p) * self.m,
        )

    def inwards(self, A: Matrix, p: Matrix) -> Moments:
        """Given about the origin of the world: about that of a frame, in its axes."""
        back = A.transpose()
        return self.outwards(identity(), -p).turned(back)

    def turned(self, A: Matrix) -> Moments:
        """In other axes."""
        return self.outwards(A, zeros(3, 1))


def massless() -> Moments:
    """Nothing."""
    return Moments(arb(0), zeros(3, 1), zeros(3, 3))


@dataclass(frozen=True)
class Joint:
    """A joint of one degree of freedom at the state.

    ``parent``: the joint that carries it. ``A``, ``O``: joint frame k and its origin O_k; ``tau``: shift of the body
    frame along the axis. ``w``, ``v``: angular velocity, and velocity of what is at the world's origin, for q' = 1.
    ``mover``: the coordinate that moves it, its own or that of a relation, and ``slope`` dq / d mover. ``group``: the
    joints of a ball or floating one.
    """

    coordinate: str
    parent: int
    prismatic: bool
    A: Matrix
    O: Matrix  # noqa: E741 -- symbol of the notation
    tau: Ball
    w: Matrix
    v: Matrix
    armature: Ball
    mover: str
    slope: Ball
    group: range = range(0)

    @property
    def body(self) -> Matrix:
        """Origin of the body frame: O + tau e3."""
        return self.O + self.A * unit(2) * self.tau


class Bodies:
    """Joints, frames and masses; definitions are added with :meth:`add`, hosts first.

    ``frames``: bodies and ports by name with the prefix of their definition; ``own``: what the definitions put on every
    carrier; ``named``: the first body on a carrier, after which its inertia symbols are called.
    """

    def __init__(self) -> None:
        self.joints: list[Joint] = []
        self.frames: dict[str, Frame] = {}
        self.own: dict[int, Moments] = {GROUND: massless()}
        self.named: dict[int, str] = {}

    def carrier(self, k: int) -> tuple[Matrix, Matrix]:
        """Axes and origin of the body frame of a carrier."""
        return (identity(), zeros(3, 1)) if k == GROUND else (self.joints[k].A, self.joints[k].body)

    def path(self, k: int) -> list[int]:
        """The joints that move a carrier, from the world outwards."""
        found = []
        while k != GROUND:
            found.append(k)
            k = self.joints[k].parent
        return found[::-1]

    def add(self, definition: Plain, numbers: Numbers, seat: Frame, prefix: str = "") -> None:
        """The bodies and ports of a definition whose interface frame is ``seat``."""
        self.frames[f"{prefix}base"] = seat
        numbers = Numbers(Related(definition, numbers.names))
        for body in in_order(definition):
            movers = [(mover(definition, q), slope_of(definition, q, numbers)) for q in coordinates_of(body)]
            self._body(body, numbers, prefix, movers)
        for port in definition.get("ports", ()):
            angles = numbers.vector(port.get("rotation", {}).get("rpy", NONE))
            place = roll_pitch_yaw(angles), numbers.vector(port.get("position", NONE))
            self.frames[f"{prefix}{port['name']}"] = self.frames[f"{prefix}{port['body']}"].placed(*place)

    def _body(self, body: Plain, numbers: Numbers, prefix: str, movers: list[tuple[str, Ball]]) -> None:
        joint = body["joint"]
        frame = _before_joint(self.frames[f"{prefix}{body['parent']}"], joint, numbers)
        phi, tau = numbers.read(joint.get("phi", 0)), numbers.read(joint.get("tau", 0))
        if joint["type"] == "fixed":
            frame = frame.placed(turn(2, phi), vector(arb(0), arb(0), tau))
        if is_ball(body):
            frame = frame.placed(*place_of(body, numbers.names))
        for step, (coordinate, (prismatic, axis)) in enumerate(_steps(body)):
            names = f"{prefix}{coordinate}", f"{prefix}{movers[step][0]}", movers[step][1]
            frame = self._moved(frame, joint, step, names, prismatic, axis, (phi, tau), numbers)
        self.frames[f"{prefix}{body['name']}"] = frame
        self.named.setdefault(frame.carrier, f"{prefix}{body['name']}")
        if not MASSES.isdisjoint(body):
            self.own[frame.carrier] += mass_of(body, numbers).outwards(frame.A, frame.p)

    def _moved(
        self,
        frame: Frame,
        joint: Plain,
        step: int,
        names: tuple[str, str, Ball],
        prismatic: bool,
        axis: int,
        offsets: tuple[Ball, Ball],
        numbers: Numbers,
    ) -> Frame:
        """Over a joint of one degree of freedom: the frame in which the axis of the next one is given.

        ``names``: of its coordinate and of the one that moves it, with its slope.
        """
        coordinate, by, rate = names
        turned = onto_third_axis(axis)
        if "axis" in joint:
            turned = with_third_axis(numbers.vector(joint["axis"])) * turned
        q = arb(0) if joint["type"] in POSITIONS else numbers.names[coordinate.rpartition(".")[2]]
        # revolute: phi = q + phi0, tau constant;   prismatic: tau = q + tau0, phi constant
        phi, tau = (offsets[0], q + offsets[1]) if prismatic else (q + offsets[0], offsets[1])
        A = frame.A * turned * turn(2, phi)
        z = A * unit(2)
        # of a turn about the axis z through O: w = z, and O x z at the world's origin
        w, v = (zeros(3, 1), z) if prismatic else (z, cross(frame.p, z))
        armature = numbers.read(of_step(joint.get("armature", 0), step))
        k, in_one = len(self.joints), joint["type"] in POSITIONS
        group = range(k - step, k - step + len(CHAINS[joint["type"]])) if in_one else range(0)
        row = Joint(coordinate, frame.carrier, prismatic, A, frame.p, tau, w, v, armature, by, rate, group)
        self.joints.append(row)
        self.own[k] = massless()
        return Frame(k, A * turned.transpose(), self.joints[k].body)


def of_step(given: Any, step: int) -> Any:
    """Of a joint with several coordinates: what is given for one of them, or for all."""
    return given[step] if isinstance(given, (list, tuple)) and not isinstance(given[0], Step) else given


def laws_of(definition: Plain) -> list[tuple[Plain, int]]:
    """The joint of every coordinate, and the number of the coordinate in it."""
    return [(body["joint"], step) for body in in_order(definition) for step in range(len(coordinates_of(body)))]


def limits_of(joint: Plain, step: int) -> Any:
    """Lowest and highest value of a coordinate of a joint; None without limits."""
    given = joint.get("limits")
    return given[step] if given and isinstance(given[0], (list, tuple)) else given or None


def _before_joint(parent: Frame, joint: Plain, numbers: Numbers) -> Frame:
    """Rz(psi) Tz(sigma) Rx(theta) Tx(d), or the placement."""
    placement = joint.get("placement")
    if placement is not None:
        A = roll_pitch_yaw(numbers.vector(placement.get("rpy", NONE)))
        return parent.placed(A, numbers.vector(placement.get("position", NONE)))
    psi, sigma, theta, d = (numbers.read(joint.get(name, 0)) for name in ("psi", "sigma", "theta", "d"))
    turned = parent.placed(turn(2, psi), vector(arb(0), arb(0), sigma))
    return turned.placed(turn(0, theta), vector(d, arb(0), arb(0)))


def mass_of(body: Plain, numbers: Numbers) -> Moments:
    """(m, s, J) about the origin of the body's frame; J = tr(Theta)/2 1 - Theta."""
    m, c = numbers.read(body.get("mass", 0)), numbers.vector(body.get("com", NONE))
    tensor = body.get("inertia", {})
    xx, yy, zz, xy, xz, yz = (numbers.read(tensor.get(e, 0)) for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
    half = (xx + yy + zz) * arb(fmpq(1, 2))
    J = arb_mat(3, 3, [half - xx, -xy, -xz, -xy, half - yy, -yz, -xz, -yz, half - zz])
    if tensor.get("about", "com") == "com":
        J = J + outer(c, c) * m
    return Moments(m, c * m, J)


def _steps(body: Plain) -> list[tuple[str, tuple[bool, int]]]:
    return list(zip(coordinates_of(body), CHAINS[body["joint"]["type"]], strict=True))


def coordinates_of(body: Plain) -> list[str]:
    """Names of the coordinates, or rates, of a body's joint; ``q_<body>``, with a number where there are several."""
    if is_ball(body):
        return rates_of(body)
    given, n = body["joint"].get("coordinate"), len(CHAINS[body["joint"]["type"]])
    if given is not None:
        return [given] if isinstance(given, str) else list(given)
    return [f"q_{body['name']}"] if n == 1 else [f"q_{body['name']}_{j + 1}" for j in range(n)]


def in_order(definition: Plain) -> list[Plain]:
    """The bodies as given where parents stand first, otherwise level by level from the base."""
    bodies = list(definition.get("bodies", ()))
    known = {"base"}
    for body in bodies:
        if body["parent"] not in known:
            break
        known.add(body["name"])
    else:
        return bodies
    order = [body for body in bodies if body["parent"] == "base"]
    for parent in order:
        order += [body for body in bodies if body["parent"] == parent["name"]]
    return order


def inertia_of_symbols(name: str, values: Mapping[str, Ball]) -> Moments:
    """The ten inertia symbols of a body, about the origin of its carrier's body frame, in its axes."""
    m, sx, sy, sz, xx, yy, zz, xy, xz, yz = (values[symbol] for symbol in inertia_names(name))
    J = arb_mat(3, 3, [xx, xy, xz, xy, yy, yz, xz, yz, zz])
    return Moments(m, vector(sx, sy, sz), J)


def inertia_names(body: str) -> list[str]:
    """The names of the ten symbols."""
    tensor = ("xx", "yy", "zz", "xy", "xz", "yz")
    return [f"{body}.m", *(f"{body}.s{i}" for i in "xyz"), *(f"{body}.J{e}" for e in tensor)]


def theta_of(J: Matrix) -> Matrix:
    """The inertia tensor tr(J) 1 - J."""
    return identity() * J.trace() - J
