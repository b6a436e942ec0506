"""New versions of parts with the inertia that was identified: what a library stores."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.analysis.identification.findings import ConsistentInertia, pseudo_inertia
from substructures.array import Array
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.tree.document import TreeSpec

OF_INERTIA = ("mass", "com", "inertia")
TENSOR = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def new_versions(spec: TreeSpec, parts: Mapping[str, Part], found: ConsistentInertia) -> dict[str, dict[str, Any]]:
    """By instance the definition of its part with the identified inertia as numbers, and ``derived_from``: what the
    instance names. What is fixed to a link is part of it; what is fixed to the interface stays, and so do parts of
    which nothing was identified.
    """
    rows = dict(zip(found.links, found.values.reshape(-1, 10), strict=True))
    result = {}
    for instance in spec.instances:
        definition = parts[instance.name].definition
        own = {
            body.name: rows[name]
            for body in definition.bodies
            if (name := f"{instance.name}.{body.name}") in rows and name not in found.held
        }
        if own:
            origin = {} if instance.substructure is None else {"derived_from": str(instance.substructure)}
            result[instance.name] = {**with_inertia(definition, own), **origin}
    return result


def with_inertia(definition: Definition, ten: Mapping[str, Array]) -> dict[str, Any]:
    """The document of a definition with m [kg], s [kg m], J [kg m^2] (10,) of some links as numbers."""
    document: dict[str, Any] = json.loads(definition.canonical())
    parents = {body.name: body.parent for body in definition.bodies if body.joint.type == "fixed"}
    for body in document["bodies"]:
        carrier = body["name"]
        while carrier in parents:
            carrier = parents[carrier]
        if carrier not in ten:
            continue
        for name in OF_INERTIA:
            body.pop(name, None)
        if body["name"] == carrier:
            body.update(_inertia(ten[carrier]))
    return document


def _inertia(ten: Array) -> dict[str, Any]:
    """Theta = tr(J_c) 1 - J_c about the mass centre c = s/m, J_c = J - s s^T/m."""
    m, s, J = float(ten[0]), ten[1:4], pseudo_inertia(ten)[:3, :3]
    J_c = J - np.outer(s, s) / m
    Theta = np.trace(J_c) * np.eye(3) - J_c
    return {"mass": m, "com": (s / m).tolist(), "inertia": {name: float(Theta[at]) for name, at in TENSOR.items()}}
