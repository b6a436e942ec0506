"""What the numbers of states and of inertias are called, and their units: positions of ball joints are no rates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from substructures.mechanics.balls import BallJoint

#: SI units of revolute and of prismatic coordinates, by the field of states
_UNITS = {"q": ("rad", "m"), "qd": ("rad/s", "m/s"), "qdd": ("rad/s^2", "m/s^2")}
#: SI units of inertial parameters
_INERTIAL = {"m": "kg", "s": "kg m", "J": "kg m^2"}
#: SI units of actuators by the kind of joint
EFFORTS = {"R": "N m", "P": "N"}
#: of a ball joint: ``positions``, place (x, y, z) of a floating one and quaternion (w, x, y, z), and ``velocities``
BallRow = Mapping[str, Sequence[str]]


def effort_units(coordinates: Sequence[str], joints: str) -> dict[str, str]:
    """The SI units of the actuators of coordinates, ``tau.<coordinate>``."""
    return {f"tau.{name}": EFFORTS[kind] for name, kind in zip(coordinates, joints, strict=True)}


def ball_rows(balls: Iterable[BallJoint], joints: Sequence[str]) -> tuple[BallRow, ...]:
    """The names of the balls of a tree; ``joints``: of the coordinates, or rates, of all its joints."""
    return tuple({"positions": list(ball.positions), "velocities": [joints[a] for a in ball.joints]} for ball in balls)


def positions_of(coordinates: Sequence[str], balls: Sequence[BallRow]) -> tuple[str, ...]:
    """The names of the numbers of a state q: the coordinates, and of balls their positions in place of the rates."""
    instead: dict[str, Sequence[str]] = {name: () for ball in balls for name in ball["velocities"]}
    instead |= {ball["velocities"][0]: ball["positions"] for ball in balls}
    return tuple(name for q in coordinates for name in instead.get(q, (q,)))


def resting_state(positions: Sequence[str], balls: Iterable[BallRow]) -> list[float]:
    """A state q in which nothing is turned or shifted: 0, and of quaternions 1, 0, 0, 0."""
    ones = {ball["positions"][-4] for ball in balls}
    return [float(name in ones) for name in positions]


def state_units(coordinates: Sequence[str], joints: str, balls: Sequence[BallRow]) -> dict[str, dict[str, str]]:
    """The SI units of positions, rates and accelerations by name, by the fields q, qd and qdd."""
    kinds = [(name, kind == "P") for name, kind in zip(coordinates, joints, strict=True)]
    found = {field: {name: units[slides] for name, slides in kinds} for field, units in _UNITS.items()}
    known = found["q"]
    for ball in balls:
        known |= dict.fromkeys(ball["positions"], "") | dict.fromkeys(ball["positions"][:-4], "m")
    return found | {"q": {name: known[name] for name in positions_of(coordinates, balls)}}


def inertia_names(body: str) -> list[tuple[str, str]]:
    """(symbol, unit): m, s and J of a body, in the order m, sx, sy, sz, Jxx, Jyy, Jzz, Jxy, Jxz, Jyz."""
    names = ["m", *(f"s{x}" for x in "xyz"), *(f"J{e}" for e in ("xx", "yy", "zz", "xy", "xz", "yz"))]
    return [(f"{body}.{n}", _INERTIAL[n[0]]) for n in names]
