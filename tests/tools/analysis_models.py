"""Models that the tests of the analysis share."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from made_once import coupled_once
from random_trees import Kind, Plain, model_of, random_definition, with_parameters

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.quantities.numbers.defaults import default_numbers

KINDS = [Kind(3, massive=True), Kind(4, massive=True, joints=("revolute", "prismatic", "fixed"), springs=2)]
FINE: Plain = {"relative_tolerance": 1e-13, "absolute_tolerance": 1e-14}
#: released at rest from the horizontal, m = L = 1, g = 9.81: 4 sqrt(L/g) K(sin 45 deg) (IFToMM A01)
PERIOD = 2.3678419475762373


def catalogue_model(name: str, gravity: tuple[float | str, ...] = (0, 0, -9.81), **parameters: Any) -> Model:
    """A catalogue entry alone at the world, as instance x, with all coordinates of its loops."""
    one = {"name": "x", "substructure": name, "parameters": parameters, "level": "full"}
    return coupled_once({"name": "t", "gravity": list(gravity), "instances": [one]}, {name: catalogue.load(name)})


def oscillator(**joint: Any) -> Plain:
    """A mass of 1 kg on a slide."""
    slide = {"type": "prismatic", "coordinate": "s"} | joint
    return {"name": "mass", "bodies": [{"name": "b", "parent": "base", "joint": slide, "mass": 1}]}


@cache
def shipped(name: str) -> Model:
    """A catalogue entry alone at the world with gravity, exactly -9.81 m/s^2, and its parameters."""
    return catalogue_model(name, (0, 0, "-9.81"))


@cache
def random_model(number: int, **changes: Any) -> Model:
    """A seeded random tree with positive definite metric, a part of its numbers as parameters."""
    rng = np.random.default_rng(900 + number)
    kind = KINDS[number % len(KINDS)]
    kind = Kind(**{**kind.__dict__, **changes})
    definition = random_definition(rng, kind)
    while not any("coordinate" in b["joint"] for b in definition["bodies"]):
        definition = random_definition(rng, kind)
    return model_of(with_parameters(rng, definition, 0.2 * (number % 3)))


def defaults(model: Model) -> dict[str, float]:
    """Default values of all parameters."""
    return default_numbers(model.parameters)


def values_at(model: Model, q: Any, qd: Any, **more: Any) -> dict[str, Any]:
    """Values of all symbols at states (N, n); inputs are 0."""
    values: dict[str, Any] = {s.name: 0.0 for s in model.program.symbols if s.kind == "input"}
    values |= defaults(model) | {"t": 0.0} | more
    values |= {name: q[:, a] for a, name in enumerate(model.coordinates)}
    return values | {f"{name}'": qd[:, a] for a, name in enumerate(model.coordinates)}


def walker(slope: float) -> Model:
    """In the plane x, y, x normal to the slope: stance leg at ``theta`` from x, swing leg at ``phi`` against it."""
    legs = {
        "name": "legs",
        "bodies": [
            {"name": "stance", "parent": "base", "mass": 1, "com": [1, 0, 0],
             "joint": {"type": "revolute", "coordinate": "theta"}},
            {"name": "swing", "parent": "stance", "mass": "1/10^9", "com": [-1, 0, 0],
             "joint": {"type": "revolute", "coordinate": "psi", "d": 1}},
        ],
    }  # fmt: skip
    gravity = [-math.cos(slope), -math.sin(slope), 0]
    spec = TreeSpec.read({"name": "tree", "gravity": gravity, "instances": [{"name": "w", "substructure": "legs"}]})
    return couple(spec, {"w": derive(Definition.read(legs))})
