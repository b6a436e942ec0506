"""Definitions with relations between their joints, and the matrix N of q' = N y' computed beside the package."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from independent import value

Plain = dict[str, Any]
Array = Any


def joints_of(definition: Plain) -> dict[str, bool]:
    """The coordinates of all joints in the order of the bodies, and whether each is prismatic."""
    slides = {"prismatic": "P", "revolute": "R", "cylindrical": "RP", "planar": "PPR", "universal": "RR"}
    slides |= {"spherical": "RRR", "free": "PPPRRR", "fixed": ""}
    found: dict[str, bool] = {}
    for body in definition["bodies"]:
        names = body["joint"].get("coordinate", [])
        names = [names] if isinstance(names, str) else names
        found |= {name: kind == "P" for name, kind in zip(names, slides[body["joint"]["type"]], strict=True)}
    return found


def with_relations(rng: np.random.Generator, definition: Plain, count: int) -> Plain:
    """The definition with up to so many relations between joints, chains among them; never a circle."""
    names = list(joints_of(definition))
    order = [names[i] for i in rng.permutation(len(names))]
    relations = []
    for name in order[1 : 1 + count]:
        of = order[int(rng.integers(order.index(name)))]
        multiplier = round(float(rng.uniform(-1.5, 1.5)), 2)
        relations.append(
            {"coordinate": name, "of": of, "multiplier": multiplier, "offset": round(float(rng.normal()), 2)}
        )
    return {**copy.deepcopy(definition), "relations": [relations[i] for i in rng.permutation(len(relations))]}


def reduction(definition: Plain, order: list[str], left: list[str], names: Plain | None = None) -> tuple[Array, Array]:
    """N and q_0 of q = N y + q_0; ``order``: all joints, ``left``: the coordinates that are left."""
    n, given = len(order), {each["coordinate"]: each for each in definition.get("relations", [])}
    # q = A q + B y + c, with a row of A for each relation
    A, B, c = np.zeros((n, n)), np.zeros((n, len(left))), np.zeros(n)
    for i, name in enumerate(order):
        if name in given:
            A[i, order.index(given[name]["of"])] = value(given[name].get("multiplier", 1), names)
            c[i] = value(given[name].get("offset", 0), names)
        else:
            B[i, left.index(name)] = 1
    return np.linalg.solve(np.eye(n) - A, B), np.linalg.solve(np.eye(n) - A, c)
