"""Bodies of the tests that roll or glide on an edge: Chaplygin's sleigh and a thin disc."""

from __future__ import annotations

from closed_trees import tree_model
from random_trees import Plain

from substructures import Model
from substructures.analysis.simulate import KnifeEdge, Rolling


def single(part: Plain, gravity: list[float]) -> Model:
    return tree_model({"gravity": gravity, "instances": [{"name": "s", "substructure": "p"}]}, {"p": part})


def sleigh(gravity: tuple[float, ...] = (0, 0, 0)) -> Model:
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
    return single({"name": "sleigh", "parameters": parameters, "bodies": [body]}, list(gravity))


BLADE = KnifeEdge("blade", "s.b")
FORWARD = {"u": "cos(s.f)*s.x' + sin(s.f)*s.y'", "w": "s.f'"}


#: radius and mass of the disc, its moments of inertia about a diameter and about the axis
R, M, A, C = 0.5, 2.0, 0.125, 0.25
FLOOR = Rolling("floor", "s.disc", "s.r")


def disc() -> Model:
    """Centre (x, y, z), precession psi, nutation th (of the axis from the vertical), spin ph; thin and homogeneous."""
    bodies: list[Plain] = []
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "psi": [0, 0, 1], "th": [1, 0, 0], "ph": [0, 0, 1]}
    for k, (name, axis) in enumerate(axes.items()):
        kind = "prismatic" if k < 3 else "revolute"
        joint = {"type": kind, "coordinate": name, "placement": {"position": [0, 0, 0]}, "axis": axis}
        bodies.append({"name": "disc" if k == 5 else f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
    bodies[-1] |= {"mass": "m", "inertia": {"xx": "m*r^2/4", "yy": "m*r^2/4", "zz": "m*r^2/2"}}
    parameters = {"m": {"value": M}, "r": {"value": R}}
    return single({"name": "disc", "parameters": parameters, "bodies": bodies}, [0, 0, -9.81])
