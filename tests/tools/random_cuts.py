"""The same mechanism in pieces: any set of joints of a definition is cut, the pieces are mounted on each other.

A cut names bodies; each becomes the root of a part of its own. How it is mounted is drawn: on the parent's body frame,
on the interface frame of its host, by a placement, on a port, or half by a port and half by a placement.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Iterator
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
from random_trees import GRAVITY, Plain, coordinates_of

from substructures import Definition, Model, Part, TreeSpec, couple, derive

ROOT = "rest"


def all_cuts(definition: Plain) -> Iterator[tuple[str, ...]]:
    """Every set of bodies, the empty one included."""
    names = [body["name"] for body in definition["bodies"]]
    for size in range(len(names) + 1):
        yield from combinations(names, size)


def owners(definition: Plain, cut: tuple[str, ...]) -> dict[str, str]:
    """The part (named after its root body, or ROOT) of every body."""
    parent = {body["name"]: body["parent"] for body in definition["bodies"]}
    result = {"base": ROOT}
    for name in parent:
        body = name
        while body not in cut and body != "base":
            body = parent[body]
        result[name] = ROOT if body == "base" else f"part_{body}"
    return result


def seat(joint: Plain) -> tuple[list[Any], list[Any]]:
    """The placement before the joint moves: position and rpy. Rz(psi) Rx(theta) has rpy (theta, 0, psi)."""
    if "placement" in joint:
        return joint["placement"]["position"], joint["placement"]["rpy"]
    psi, theta, d, sigma = (joint.get(x, 0) for x in ("psi", "theta", "d", "sigma"))
    return [f"({d})*cos({psi})", f"({d})*sin({psi})", sigma], [theta, 0, psi]


def unseated(joint: Plain) -> Plain:
    """The joint without its seat."""
    rest = {key: x for key, x in joint.items() if key not in ("psi", "theta", "d", "sigma", "placement")}
    return rest | ({"placement": {"position": [0, 0, 0], "rpy": [0, 0, 0]}} if "axis" in joint else {})


def cut_tree(rng: np.random.Generator, definition: Plain, cut: tuple[str, ...]) -> Plain:
    """The tree document of the mechanism in pieces; parameters are those of the tree."""
    owner = owners(definition, cut)
    parts = {name: _part(definition, owner, name) for name in dict.fromkeys(owner.values())}
    mounts: dict[str, Plain] = {name: {} for name in parts}
    sprung = {load["to"]["body"] for load in definition["loads"] if load["type"] == "spring"}
    for body in definition["bodies"]:
        if body["name"] in cut:
            part = parts[owner[body["name"]]]
            host = owner[body["parent"]]
            mounts[owner[body["name"]]] = _mount(rng, part, body, host, parts, body["name"] in sprung)
    instances = []
    for name, part in parts.items():
        used = _used(part, definition)
        part["parameters"] = {p: definition["parameters"][p] for p in used}
        instances.append({"name": name, "definition": part, "parameters": {p: p for p in used}} | mounts[name])
    # hosts may come in any order
    instances = [instances[i] for i in rng.permutation(len(instances))]
    return {
        "name": "tree",
        "gravity": list(GRAVITY),
        "parameters": definition.get("parameters", {}),
        "instances": instances,
    }


def _used(part: Plain, definition: Plain) -> list[str]:
    words = set(re.findall(r"\bp\d+\b", json.dumps(part, default=str)))
    return [p for p in definition.get("parameters", {}) if p in words]


def _part(definition: Plain, owner: dict[str, str], name: str) -> Plain:
    """Bodies, ports and loads of one part; the parent of its root is its interface frame."""
    mine = [copy.deepcopy(body) for body in definition["bodies"] if owner[body["name"]] == name]
    names = {body["name"] for body in mine} | ({"base"} if name == ROOT else set())
    for body in mine:
        body["parent"] = body["parent"] if body["parent"] in names else "base"
    coordinates = {c for body in mine for c in coordinates_of(body)}
    loads = []
    for load in copy.deepcopy(definition["loads"]):
        if load["type"] == "spring" and load["to"]["body"] in names:
            if load["from"]["body"] not in names:
                load["from"]["body"] = "base"
            loads.append(load)
        elif load.get("body") in names or load.get("coordinate") in coordinates:
            loads.append(load)
    ports = [copy.deepcopy(port) for port in definition["ports"] if port["body"] in names]
    library_name = name.replace("_", "-")
    return {"name": library_name, "bodies": mine, "ports": ports, "inputs": definition["inputs"], "loads": loads}


def _mount(
    rng: np.random.Generator, part: Plain, body: Plain, host: str, parts: dict[str, Plain], sprung: bool
) -> Plain:
    root = next(b for b in part["bodies"] if b["name"] == body["name"])
    at = f"{host}.{body['parent']}"
    styles = ["body"] if sprung else ["body", "placement", "port", "split"]
    style = str(rng.choice(styles))
    if at == f"{ROOT}.base" and rng.random() < 0.5:
        at = "world"
    if style == "body":
        return {"at": at}
    position, rpy = seat(body["joint"])
    root["joint"] = unseated(root["joint"])
    if style == "placement" or at == "world":
        return {"at": at, "placement": {"position": position, "rpy": rpy}}
    port: Plain = {"name": f"seat_{body['name']}", "body": body["parent"], "position": position}
    parts[host]["ports"].append(port)
    if style == "split":
        return {"at": f"{host}.{port['name']}", "placement": {"position": [0, 0, 0], "rpy": rpy}}
    port["rotation"] = {"rpy": rpy}
    return {"at": f"{host}.{port['name']}"}


@cache
def _derived(canonical: bytes) -> Part:
    return derive(Definition.read(json.loads(canonical)))


def coupled(tree: Plain) -> Model:
    """Couple a tree of definitions; equal parts are derived once."""
    spec = TreeSpec.read(tree)
    parts = {}
    for instance in spec.instances:
        assert instance.definition is not None
        derived = _derived(instance.definition.canonical())
        parts[instance.name] = Part(instance.definition, derived.program, derived.certificate)
    return couple(spec, parts)
