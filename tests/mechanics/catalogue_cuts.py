"""Mechanisms of the catalogue in pieces: cut at any set of bodies, each piece mounted on the body that carried it."""

from __future__ import annotations

import copy
import json
import re
from functools import cache

from random_cuts import owners
from random_trees import Plain

from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive

#: acceleration of the world in any direction
GRAVITY = ["gx", "gy", "gz"]


def bare(name: str) -> Plain:
    """An entry of the catalogue without what acts on it."""
    definition = catalogue.load(name) | {"loads": [], "inputs": {}, "ports": []}
    definition.setdefault("parameters", {})
    for body in definition["bodies"]:
        for law in ("stiffness", "damping", "rest", "limits", "limits_act"):
            body["joint"].pop(law, None)
    return definition


def in_pieces(definition: Plain, cut: tuple[str, ...]) -> Model:
    """The mechanism with the bodies of a cut as roots of parts, each mounted on the body that carried it."""
    owner = owners(definition, cut)
    host = {owner[b["name"]]: f"{owner[b['parent']]}.{b['parent']}" for b in definition["bodies"] if b["name"] in cut}
    instances, parts = [], {}
    for name in dict.fromkeys(owner.values()):
        bodies = [copy.deepcopy(b) for b in definition["bodies"] if owner[b["name"]] == name]
        for body in bodies:
            body["parent"] = "base" if body["name"] in cut else body["parent"]
        used = set(re.findall(r"[A-Za-z_]\w*", json.dumps(bodies, default=str))) & definition["parameters"].keys()
        text = {"name": name.replace("_", "-").lower(), "bodies": bodies}
        text["parameters"] = {p: definition["parameters"][p] for p in sorted(used)}
        parts[name] = _stored(json.dumps(text, default=str))
        instance = {"name": name, "substructure": parts[name].name, "at": host.get(name, "world")}
        instances.append(instance | {"parameters": {p: p for p in used}})
    parameters = definition["parameters"] | {g: {} for g in GRAVITY}
    tree = {"name": "tree", "parameters": parameters, "gravity": GRAVITY, "instances": instances}
    return couple(TreeSpec.read(tree), parts)


@cache
def _stored(text: str) -> Part:
    return derive(Definition.read(json.loads(text)))
