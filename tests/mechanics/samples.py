"""A set of random definitions in numbers and with parameters, and all quantities compared."""

from __future__ import annotations

from typing import Any

import numpy as np
from in_depth import seeds
from random_trees import Kind, Plain, random_definition, random_states, with_parameters

from substructures import Model
from substructures.quantities.numbers.result import Evaluation

QUANTITIES = ["metric", "christoffel", "forces", "gravity", "potential_energy", "kinematics", "momentum"]
COUNT = 8
#: as parameters of tests
SEEDS = seeds(3, COUNT)


def pair(seed: int, share: float) -> tuple[Plain, Plain]:
    """A numeric definition and the same with parameters."""
    rng = np.random.default_rng(7000 + seed)
    definition = random_definition(rng, Kind(int(rng.integers(2, 6)), bool(seed % 2)))
    while not any("coordinate" in b["joint"] for b in definition["bodies"]):
        definition = random_definition(rng, Kind(4))
    return definition, with_parameters(rng, definition, share)


def flat(answer: Evaluation) -> dict[str, Any]:
    """Arrays by name."""
    result = {}
    for name in QUANTITIES:
        some = answer[name] if isinstance(answer[name], dict) else {"": answer[name]}
        result |= {f"{name} {key}": np.asarray(x) for key, x in some.items()}
    return result


def same(one: Plain, two: Plain, tolerance: float) -> None:
    for name, x in one.items():
        scale = max(float(np.abs(x).max(initial=0)), 1.0)
        np.testing.assert_allclose(two[name], x, rtol=0, atol=tolerance * scale, err_msg=name)


def request_for(model: Model, seed: int) -> Plain:
    rng = np.random.default_rng(seed)
    inputs = {s.name: rng.uniform(-1, 1, 3) for s in model.program.symbols if s.kind == "input"}
    return {"quantities": QUANTITIES, **random_states(rng, 3, model.dof), "t": 0.3, "inputs": inputs}
