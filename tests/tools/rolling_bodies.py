"""Bodies of the tests that roll or glide on an edge: Chaplygin's sleigh, a thin disc, a bicycle."""

from __future__ import annotations

from math import cos, pi, sin

from closed_trees import tree_model
from random_trees import Plain

from substructures import Model
from substructures.analysis.simulate import KnifeEdge, Rolling


def single(part: Plain, gravity: list[float]) -> Model:
    return tree_model({"gravity": gravity, "instances": [{"name": "s", "substructure": "p"}]}, {"p": part})


def sleigh_part() -> Plain:
    """A body in the plane with its blade at the origin of its frame and the mass centre at a on the blade's line."""
    joint = {"type": "planar", "coordinate": ["x", "y", "f"]}
    body = {
        "name": "b",
        "parent": "base",
        "joint": joint,
        "mass": "m",
        "com": ["a", 0, 0],
        "inertia": {"xx": "I", "zz": "I"},
    }
    parameters = {"m": {"value": 2, "unit": "kg"}, "a": {"value": 0.25, "unit": "m"}}
    parameters["I"] = {"value": 0.3, "unit": "kg*m^2"}
    return {"name": "sleigh", "parameters": parameters, "bodies": [body]}


def sleigh(gravity: tuple[float, ...] = (0, 0, 0)) -> Model:
    return single(sleigh_part(), list(gravity))


BLADE = KnifeEdge("blade", "s.b")
FORWARD = {"u": "cos(s.f)*s.x' + sin(s.f)*s.y'", "w": "s.f'"}


#: radius and mass of the disc, its moments of inertia about a diameter and about the axis
R, M, A, C = 0.5, 2.0, 0.125, 0.25
FLOOR = Rolling("floor", "s.disc", "s.r")


def disc() -> Model:
    """Under gravity."""
    return single(disc_part(), [0, 0, -9.81])


def disc_part() -> Plain:
    """Centre (x, y, z), precession psi, nutation th (of the axis from the vertical), spin ph; thin and homogeneous."""
    bodies: list[Plain] = []
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "psi": [0, 0, 1], "th": [1, 0, 0], "ph": [0, 0, 1]}
    for k, (name, axis) in enumerate(axes.items()):
        kind = "prismatic" if k < 3 else "revolute"
        joint = {"type": kind, "coordinate": name, "placement": {"position": [0, 0, 0]}, "axis": axis}
        bodies.append({"name": "disc" if k == 5 else f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
    bodies[-1] |= {"mass": "m", "inertia": {"xx": "m*r^2/4", "yy": "m*r^2/4", "zz": "m*r^2/2"}}
    parameters = {"m": {"value": M}, "r": {"value": R}}
    return {"name": "disc", "parameters": parameters, "bodies": bodies}


#: of the benchmark: wheel base, trail, tilt of the steering axis, radii of the wheels
BASE, TRAIL, TILT, REAR, FRONT = 1.02, 0.08, pi / 10, 0.3, 0.35


def bicycle_part() -> Plain:
    """J. P. Meijaard, J. M. Papadopoulos, A. Ruina, A. L. Schwab, Linearized dynamics equations for the balance and
    steer of a bicycle, Proc. R. Soc. A 463, 2007, table 1, with the third axis upwards.
    """
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "yaw": [0, 0, 1], "lean": [1, 0, 0], "pitch": [0, 1, 0]}
    bodies: list[Plain] = []
    for k, (name, axis) in enumerate(axes.items()):
        kind = "prismatic" if k < 3 else "revolute"
        joint = {"type": kind, "coordinate": name, "axis": axis, "placement": {"position": [0, 0, 0]}}
        bodies.append({"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
    inertia = {"xx": 9.2, "yy": 11, "zz": 2.8, "xz": -2.4}
    bodies[-1] |= {"mass": 85, "com": [0.3, 0, 0.9 - REAR], "inertia": inertia}

    def turning(name: str, parent: str, axis: list[float], place: list[float], **more: object) -> None:
        joint = {"type": "revolute", "coordinate": name, "axis": axis, "placement": {"position": place}}
        bodies.append({"name": name, "parent": parent, "joint": joint, **more})

    head = BASE + TRAIL
    wheel = {"xx": 0.0603, "yy": 0.12, "zz": 0.0603}
    turning("rear", "b5", [0, 1, 0], [0, 0, 0], mass=2, inertia=wheel)
    inertia = {"xx": 0.05892, "yy": 0.06, "zz": 0.00708, "xz": 0.00756}
    fork = {"mass": 4, "com": [0.9 - head, 0, 0.7], "inertia": inertia}
    turning("steer", "b5", [-sin(TILT), 0, cos(TILT)], [head, 0, -REAR], **fork)
    wheel = {"xx": 0.1405, "yy": 0.28, "zz": 0.1405}
    turning("front", "steer", [0, 1, 0], [BASE - head, 0, FRONT], mass=3, inertia=wheel)
    axles = [{"name": f"{x}_axle", "body": x, "rotation": {"rpy": ["-pi/2", 0, 0]}} for x in ("rear", "front")]
    return {"name": "bicycle", "bodies": bodies, "ports": axles}
