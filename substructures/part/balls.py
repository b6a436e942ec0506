"""Ball and floating joints of a definition: the names of their states, and what they do not have."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from fractions import Fraction
from typing import Any, Literal, Protocol

from substructures.errors import Fault
from substructures.expr.graph import Expr, Graph
from substructures.mechanics.balls import quaternion_rates, turned_by
from substructures.mechanics.linear3 import Matrix, apply, transpose

JointType = Literal[
    "revolute", "prismatic", "fixed", "universal", "spherical", "cylindrical", "planar", "free", "ball", "floating"
]
#: joint types without singular angles, by the number of their positions and of their rates
BALLS = {"ball": (4, 3), "floating": (7, 6)}
#: the chain of angles to take in their place
INSTEAD = {"ball": "spherical", "floating": "free"}
#: what needs angles
_OF_ANGLES = ("stiffness", "rest", "armature", "limits", "limits_act", "friction")
#: and what a ball has where it is one number: a |w|^2 / 2 is the same in all axes
_OF_ALL_AXES = ("armature",)
_AXES = ("x", "y", "z")


class Jointed(Protocol):
    """A body of a definition."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def joint(self) -> Any:
        """Its joint."""


class Defined(Protocol):
    """A definition."""

    @property
    def bodies(self) -> Sequence[Jointed]:
        """Bodies with their joints."""

    @property
    def relations(self) -> Sequence[Any]:
        """Joints that move with others."""

    @property
    def closures(self) -> Sequence[Any]:
        """Loops."""


def ball_names(body: Jointed, i: int, faults: list[Fault]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the positions and of the rates of a joint; by default ``r_<body>_x``, ... (place), ``q_<body>_w``, ...
    (quaternion), ``v_<body>_x``, ... (sliding) and ``w_<body>_x``, ... (turning).
    """
    joint, floats = body.joint, body.joint.type == "floating"
    place = [f"r_{body.name}_{axis}" for axis in _AXES if floats]
    sliding = [f"v_{body.name}_{axis}" for axis in _AXES if floats]
    positions = (*place, *(f"q_{body.name}_{axis}" for axis in ("w", *_AXES)))
    rates = (*sliding, *(f"w_{body.name}_{axis}" for axis in _AXES))
    given = (joint.coordinate,) if isinstance(joint.coordinate, str) else joint.coordinate
    counts = BALLS[joint.type]
    what = (
        ("coordinate", given, counts[0], "name(s) of its state"),
        ("velocities", joint.velocities, counts[1], "rates"),
    )
    for field, names, n, words in what:
        if names is not None and len(names) != n:
            message = f"joint type '{joint.type}' has {n} {words}, {len(names)} given: give {n}, or leave it out"
            faults.append(Fault(f"/bodies/{i}/joint/{field}", "wrong-length", message))
            return positions, rates
    return given or positions, joint.velocities or rates


def ball_faults(definition: Defined, rates: Collection[str]) -> list[Fault]:
    """Of ball and floating joints with what needs angles, of other joints with velocities, of relations of ``rates``,
    which have no positions, and of closures, which are not known to go with them.
    """
    faults: list[Fault] = []
    for i, body in enumerate(definition.bodies):
        joint, pointer = body.joint, f"/bodies/{i}/joint"
        if joint.type not in BALLS:
            if joint.velocities is not None:
                message = f"the velocities of a {joint.type} joint are q' of its coordinates: leave 'velocities' out"
                faults.append(Fault(f"{pointer}/velocities", "velocities-of-chain", message))
            continue
        faults += _law_faults(joint, pointer)
    for i, each in enumerate(definition.relations):
        for field, name in (("coordinate", each.coordinate), ("of", each.of)):
            if name in rates:
                message = f"'{name}' is a rate without a position: take the joint type 'spherical' or 'free'"
                faults.append(Fault(f"/relations/{i}/{field}", "has-balls", message))
    if rates and definition.closures:
        message = "closures do not go with ball and floating joints: take the joint types 'spherical' and 'free'"
        faults.append(Fault("/closures", "has-balls", message))
    return faults


def _law_faults(joint: Any, pointer: str) -> Iterator[Fault]:
    """Of laws that need angles, and of rotors that differ by axis."""
    for name in _OF_ANGLES:
        given = getattr(joint, name)
        if joint.type == "ball" and name in _OF_ALL_AXES:
            if isinstance(given, tuple):
                message = f"the {name} of a ball joint is one number, the same about all axes"
                yield Fault(f"{pointer}/{name}", "wrong-length", message)
        elif given not in (0, None):
            message = f"a {joint.type} joint has no angles, and no {name}: take the type '{INSTEAD[joint.type]}'"
            spring = ", or for a spring a load of the type 'bushing' between both bodies"
            message += spring if name == "stiffness" else ""
            yield Fault(f"{pointer}/{name}", "no-angles", message)


def quaternion_turn(graph: Graph, names: Sequence[str]) -> Matrix:
    """E of the quaternion with these names: components in the axes before the joint -> in those of the body."""
    quaternion: list[Expr] = [graph.symbol(name) for name in names]
    square = graph.sum(x * x for x in quaternion)
    # no root of Q . Q: formulas hold for every quaternion but 0, and no domain is lost (section 14)
    return turned_by(quaternion, 2 / square)


def position_rates(graph: Graph, positions: Sequence[str], rates: Sequence[Expr]) -> list[Expr]:
    """p' = R v and Q' = 1/2 Q (0, w) of a floating joint, of a ball joint the second alone; ``rates``: v and w."""
    quaternion = [graph.symbol(name) for name in positions[-4:]]
    turned = quaternion_rates(quaternion, rates[-3:], graph.number(Fraction(1, 2)))
    if len(positions) == len(quaternion):
        return [graph.lift(x) for x in turned]
    # p' = R v: v is in the axes of the body, the place p in those before the joint
    back = transpose(quaternion_turn(graph, positions[-4:]))
    return [graph.lift(x) for x in (*apply(back, (rates[0], rates[1], rates[2])), *turned)]
