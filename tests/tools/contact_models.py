"""Bodies that touch: a ball, blocks in a plane, a box in space."""

from __future__ import annotations

from typing import Any

from closed_trees import tree_model

from substructures import Definition, Model, TreeSpec, couple, derive

G = 9.81
PLACED: dict[str, Any] = {"placement": {"position": [0, 0, 0]}}
BALL = {
    "name": "ball",
    "bodies": [{"name": "body", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}, "mass": 2}],
}


def of(name: str, definition: Any, gravity: list[Any], **more: Any) -> Model:
    """A part on the ground."""
    document = {"name": "tree", "gravity": gravity, "instances": [{"name": name, "substructure": "x"}], **more}
    return couple(TreeSpec.read(document), {name: derive(Definition.read(definition))})


def plane_body(points: dict[str, list[float]], mass: float, inertia: float) -> dict[str, Any]:
    """A body that moves in the plane x, z and turns about y."""
    slide, turn = {"type": "prismatic", **PLACED}, {"type": "revolute", **PLACED}
    return {
        "name": "block",
        "bodies": [
            {"name": "across", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}},
            {"name": "up", "parent": "across", "joint": {**slide, "coordinate": "z", "axis": [0, 0, 1]}},
            {"name": "body", "parent": "up", "joint": {**turn, "coordinate": "phi", "axis": [0, 1, 0]}, "mass": mass,
             "inertia": {"xx": inertia, "yy": inertia, "zz": inertia}},
        ],
        "ports": [{"name": name, "body": "body", "position": place} for name, place in points.items()],
    }  # fmt: skip


def block(width: float, height: float, mass: float = 2.0) -> dict[str, Any]:
    """A block of these half sizes with the lower corners l and r."""
    points = {"l": [-width, 0.0, -height], "r": [width, 0.0, -height]}
    return plane_body(points, mass, mass * (width**2 + height**2) / 3)


FREE = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}


def box(joint: dict[str, Any] = FREE) -> dict[str, Any]:
    """A box of 0.2 m, 0.1 m and 0.2 m that is free in space, with four corners below."""
    inertia = {"xx": 0.02, "yy": 0.03, "zz": 0.04}
    places = {f"c{i}{j}": [0.2 * i - 0.1, 0.1 * j - 0.05, -0.1] for i in (0, 1) for j in (0, 1)}
    return {
        "name": "box",
        "bodies": [{"name": "body", "parent": "base", "joint": joint, "mass": 2, "inertia": inertia}],
        "ports": [{"name": name, "body": "body", "position": place} for name, place in places.items()],
    }


def disc(
    count: int, mass: float = 2.0, half: float = 0.05, about: tuple[float, float] = (0.02, 0.03)
) -> dict[str, Any]:
    """A disc that is free in space, with so many points alike on its lower rim of 0.1 m, half its height below, and
    its moments of inertia about diameters and its axis.
    """
    joint = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}
    inertia = {"xx": about[0], "yy": about[0], "zz": about[1]}
    angles = [f"{k}*2*pi/{count}" for k in range(count)]
    places = {f"p{k}": [f"cos({angle})/10", f"sin({angle})/10", -half] for k, angle in enumerate(angles)}
    return {
        "name": "disc",
        "bodies": [{"name": "body", "parent": "base", "joint": joint, "mass": mass, "inertia": inertia}],
        "ports": [{"name": name, "body": "body", "position": place} for name, place in places.items()],
    }


def point() -> dict[str, Any]:
    """A mass that moves in space."""
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
    joints = [{"type": "prismatic", "coordinate": name, "axis": axis, **PLACED} for name, axis in axes.items()]
    names = ["base", "across", "along", "body"]
    bodies = [{"name": name, "parent": names[i], "joint": joints[i]} for i, name in enumerate(names[1:])]
    return {"name": "point", "bodies": [*bodies[:2], {**bodies[2], "mass": 2}]}


def walker(foot: str) -> dict[str, Any]:
    """The simplest walking machine: a hip of 1 kg on two legs of 1 m with feet of this mass."""
    slide, turn = {"type": "prismatic", **PLACED}, {"type": "revolute", **PLACED, "axis": [0, 1, 0]}
    legs = [
        {"name": leg, "parent": "hip", "joint": {**turn, "coordinate": leg}, "mass": foot, "com": [0, 0, -1]}
        for leg in ("a", "b")
    ]
    return {
        "name": "walker",
        "bodies": [
            {"name": "across", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}},
            {"name": "hip", "parent": "across", "joint": {**slide, "coordinate": "z", "axis": [0, 0, 1]}, "mass": 1},
            *legs,
        ],
        "ports": [{"name": f"f{leg}", "body": leg, "position": [0, 0, -1]} for leg in ("a", "b")],
    }


def on_moving_plate(x: str, y: str) -> Model:
    """A mass on a plate that moves along x and y as formulas of t say."""
    slide = {"type": "prismatic", **PLACED}
    bodies = [
        {"name": "frame", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}},
        {"name": "plate", "parent": "frame", "joint": {**slide, "coordinate": "y", "axis": [0, 1, 0]}, "mass": 1},
    ]
    contact = {"name": "plate", "point": "b.body", "plane": "f.plate", "friction": "0.3"}
    instances = [{"name": "f", "substructure": "floor"}, {"name": "b", "substructure": "point"}]
    tree = {"gravity": [0, 0, -G], "instances": instances, "driven": {"f.x": x, "f.y": y}, "contacts": [contact]}
    return tree_model(tree, {"floor": {"name": "floor", "bodies": bodies}, "point": point()})
