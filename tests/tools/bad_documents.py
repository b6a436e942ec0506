"""A definition, a tree and a request in which everything is right, and a way to put faults in."""

from __future__ import annotations

import copy
from functools import cache, reduce
from typing import Any

from substructures import Definition, Model, Part, TreeSpec, couple, derive

Plain = dict[str, Any]
Path = tuple[str | int, ...]

GOOD: Plain = {
    "name": "good",
    "parameters": {"l": {"value": 1.5, "unit": "m"}, "free": {"unit": "kg"}},
    "inputs": {"u": {"unit": "N"}},
    "bodies": [
        {
            "name": "b1",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q1", "theta": "pi/2", "d": "l", "limits": [-1, 1]},
            "mass": "free",
            "com": ["l/2", 0, 0],
            "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2},
        },
        {"name": "b2", "parent": "b1", "joint": {"type": "planar", "coordinate": ["x", "y", "q2"]}, "mass": 2},
        {
            "name": "b3",
            "parent": "b2",
            "joint": {"type": "prismatic", "coordinate": "s", "placement": {"position": [0, 0, 1]}, "axis": [1, 0, 0]},
            "mass": 1,
        },
    ],
    "ports": [{"name": "tip", "body": "b3", "position": ["l", 0, 0], "rotation": {"rpy": [0, 0, 0]}}],
    "loads": [
        {"type": "force", "body": "b3", "at": [0, 0, 0], "vector": ["u", "q1'", 0], "frame": "world"},
        {"type": "torque", "body": "b1", "vector": [0, 0, "t"]},
        {
            "type": "spring",
            "from": {"body": "base"},
            "to": {"body": "b2", "at": [1, 0, 0]},
            "stiffness": 3,
            "length": "l",
        },
        {"type": "joint", "coordinate": "s", "force": "-s"},
    ],
}
TREE: Plain = {
    "name": "cell",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81}},
    "instances": [
        {"name": "one", "substructure": "good", "at": "world"},
        {"name": "two", "substructure": "good", "at": "one.tip", "parameters": {"free": 2, "l": "2*one.l"}},
    ],
}


def changed(document: Plain, *changes: tuple[Path, Any]) -> Plain:
    """A copy with values put in at paths; the value ... takes the key away."""
    result = copy.deepcopy(document)
    for path, value in changes:
        parent = reduce(lambda here, key: here[key], path[:-1], result)
        if value is ...:
            del parent[path[-1]]
        elif isinstance(parent, list) and path[-1] == len(parent):
            parent.append(value)
        else:
            parent[path[-1]] = value
    return result


def pointer_of(path: Path) -> str:
    return "".join(f"/{step}" for step in path)


@cache
def good() -> Part:
    return derive(Definition.read(GOOD))


def coupled(tree: Plain) -> Model:
    spec = TreeSpec.read(tree)
    return couple(spec, {instance.name: good() for instance in spec.instances})


@cache
def cell() -> Model:
    return coupled(TREE)


def request(**changes: Any) -> Plain:
    parameters = {"one.free": 1}
    return {"quantities": ["metric", "forces"], "q": [0.1] * 10, "qd": [0.2] * 10, "parameters": parameters} | changes
