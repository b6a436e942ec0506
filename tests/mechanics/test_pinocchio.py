"""Random trees against an independent engine: kinematics, mass matrix, gravity, Coriolis matrix, inverse dynamics."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import numpy as np
import pytest
from in_depth import seeds
from independent import by_coordinate
from random_trees import GRAVITY, Kind, model_of, random_definition, random_states, with_parameters

from substructures.quantities.numbers.evaluation import evaluate

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

TOLERANCE = 1e-10
QUANTITIES = ["metric", "gravity", "coriolis", "bias", "inverse_dynamics", "kinematics"]


def deviation(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest deviation relative to the largest entry; NaN, which no maximum shows, is none at all."""
    assert np.isfinite(found).all()
    return float(np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), 1e-2))


def compare_tree(seed: int) -> float:
    """The largest relative deviation of one random tree at two random states."""
    rng = np.random.default_rng(seed)
    kind = Kind(int(rng.integers(1, 7)), bool(rng.integers(2)), loads=0, springs=0, depth=8)
    definition = random_definition(rng, kind)
    while not any(b["joint"]["type"] != "fixed" for b in definition["bodies"]):
        definition = random_definition(rng, kind)
    shown = with_parameters(rng, definition, 0.3) if seed % 4 == 0 else definition
    model = model_of(shown)
    names = [c.removeprefix("x.") for c in model.coordinates]
    states = random_states(rng, 2, model.dof)
    answer = evaluate(model, QUANTITIES, **states)
    engine = engine_of(definition, GRAVITY)
    order = engine.order(names)
    place = np.argsort(order)
    laws = {law: by_coordinate(definition, law, names) for law in ("armature", "damping", "stiffness", "rest")}
    worst = 0.0
    for i in range(2):
        q, v, a = (states[x][i][place] for x in ("q", "qd", "qdd"))
        data = engine.model.createData()
        M = np.triu(pin.crba(engine.model, data, q))
        M = (M + np.triu(M, 1).T)[np.ix_(order, order)] + np.diag(laws["armature"])
        C = pin.computeCoriolisMatrix(engine.model, data, q, v).copy()[np.ix_(order, order)]
        grav = pin.computeGeneralizedGravity(engine.model, data, q).copy()[order]
        tau = pin.rnea(engine.model, data, q, v, a).copy()[order] + laws["armature"] * states["qdd"][i]
        tau += laws["damping"] * states["qd"][i] + laws["stiffness"] * (states["q"][i] - laws["rest"])
        expected = {"metric": M, "gravity": -grav, "coriolis": C, "bias": C @ states["qd"][i], "inverse_dynamics": tau}
        worst = max(worst, *(deviation(answer[name][i], x) for name, x in expected.items()))
        pin.forwardKinematics(engine.model, data, q)
        for f, frame in enumerate(answer.frames or ()):
            joint, where = engine.frames[frame.split(".")[1]]
            pose = data.oMi[joint] * where
            worst = max(worst, deviation(answer["kinematics"]["position"][i, f], pose.translation))
            worst = max(worst, deviation(answer["kinematics"]["rotation"][i, f], pose.rotation))
    return worst


@pytest.mark.parametrize("block", seeds(2, 6))
def test_sixty_random_trees(block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        assert compare_tree(seed) < TOLERANCE, f"seed {seed}"


@pytest.mark.deep
@pytest.mark.parametrize("block", range(50))
def test_a_thousand_random_trees(block: int) -> None:
    worst = 0.0
    for seed in range(1000 + 20 * block, 1020 + 20 * block):
        error = compare_tree(seed)
        assert error < TOLERANCE, f"seed {seed}"
        worst = max(worst, error)
    print(f"largest relative deviation of trees {1000 + 20 * block} ...: {worst:.2g}")
