"""Kernels of random trees beside Pinocchio."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import numpy as np
import pytest
from random_trees import GRAVITY, Kind, model_of, random_definition

from substructures.compile import compile_program

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from independent import by_coordinate  # noqa: E402
from pinocchio_trees import engine_of  # noqa: E402

pytest.importorskip("llvmlite")


def compare(seed: int, count: int) -> float:
    """Largest relative deviation of metric, gravity forces and Coriolis matrix of a random tree."""
    rng = np.random.default_rng(seed)
    definition = random_definition(
        rng, Kind(int(rng.integers(2, 7)), bool(rng.integers(2)), loads=0, springs=0, depth=8)
    )
    model = model_of(definition)
    if not model.dof:
        return 0.0
    q, qd = rng.uniform(-3, 3, (2, count, model.dof))
    rest = {s.name: 0.0 for s in model.program.symbols} | {n: p["value"] for n, p in model.parameters.items()}
    kernel = compile_program(model.program, ["metric", "gravity", "christoffel"])
    found = kernel.evaluate({n: float(v) for n, v in rest.items()}, columns=[(model.coordinates, q)])
    engine, names = engine_of(definition, GRAVITY), [c.removeprefix("x.") for c in model.coordinates]
    order = engine.order(names)
    place, rotors = np.argsort(order), np.diag(by_coordinate(definition, "armature", names))
    data, worst = engine.model.createData(), 0.0
    for i in range(count):
        M = np.triu(pin.crba(engine.model, data, q[i][place]))
        M = (M + np.triu(M, 1).T)[np.ix_(order, order)] + rotors
        C = pin.computeCoriolisMatrix(engine.model, data, q[i][place], qd[i][place])[np.ix_(order, order)]
        forces = -pin.computeGeneralizedGravity(engine.model, data, q[i][place])[order]
        pairs = ((found["metric"][i], M), (found["gravity"][i], forces), (found["christoffel"][i] @ qd[i], C))
        worst = max(worst, *(float(np.abs(a - b).max() / max(np.abs(b).max(), 1e-2)) for a, b in pairs))
    return worst


def test_random_trees() -> None:
    assert max(compare(seed, 20) for seed in range(8)) < 1e-10


@pytest.mark.deep
@pytest.mark.parametrize("block", range(10))
def test_many_random_trees(block: int) -> None:
    assert max(compare(seed, 1000) for seed in range(100 + 10 * block, 110 + 10 * block)) < 1e-10
