"""Reactions in the joints of random trees, with loads of all types, against an independent engine."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from random_trees import Plain, random_states  # noqa: E402 -- the engine is optional

from substructures import Definition, TreeSpec, couple, derive  # noqa: E402
from substructures.quantities.numbers.evaluation import evaluate  # noqa: E402
from substructures.quantities.reactions import reactions  # noqa: E402
from substructures.quantities.sources import Sources  # noqa: E402

from .tree_loads import ByHand, random_tree, two_definitions  # noqa: E402

TOLERANCE = 1e-10


class Released(ByHand):
    """Six more columns for every joint, of what it carries moved as one body: its share of loads is their wrench."""

    def __init__(self, tree: Plain, coordinates: list[str], q: Any, qd: Any, names: Plain) -> None:
        super().__init__(tree, coordinates, q, qd, names)
        self.real, joints = self.n, self.engine.model.njoints - 1
        self.n += 6 * joints
        self.qd = np.concatenate([qd, np.zeros(6 * joints)])

    def frame(self, at: str) -> Any:
        if at == "world":
            return np.eye(3), np.zeros(3), np.zeros((6, self.n))
        joint, where = self.engine.frames[at.replace(".", "_")]
        pose = self.data.oMi[joint] * where
        J = np.zeros((6, self.n))
        J[:, : self.real] = pin.getJointJacobian(self.engine.model, self.data, joint, pin.ReferenceFrame.WORLD)[
            :, self.order
        ]
        while joint:
            first = self.real + 6 * (joint - 1)
            J[:, first : first + 6] = np.eye(6)
            joint = self.engine.model.parents[joint]
        return pose.rotation, pose.translation, J

    def reactions(self, loads: list[Plain], qdd: Any) -> dict[str, Any]:
        """By coordinate: force, and moment about the origin of the moved frame, in the axes of the world."""
        model, data = self.engine.model, self.data
        a = np.zeros(self.real)
        a[self.order] = qdd
        Q = np.sum([self.force(load) for load in loads], axis=0)
        pin.rnea(model, data, self.q, self.v, a)
        found = {}
        for c, name in enumerate(self.coordinates):
            joint = next(j for j in range(1, model.njoints) if model.joints[j].idx_v == self.order[c])
            R, p = data.oMi[joint].rotation, data.oMi[joint].translation
            F, M = np.split(Q[self.real + 6 * (joint - 1) :][:6], 2)
            # the load on what the joint carries, from the world's origin to that of the frame
            found[name] = R @ data.f[joint].linear - F, R @ data.f[joint].angular - (M - np.cross(p, F))
        return found


def compare_tree(seed: int) -> float:
    rng = np.random.default_rng(seed)
    definitions = two_definitions(rng)
    tree = random_tree(rng, definitions)
    spec, parts = TreeSpec.read(tree), {name: derive(Definition.read(x)) for name, x in definitions.items()}
    model = couple(spec, parts)
    transmitted = reactions(spec, parts)
    states = random_states(rng, 2, model.dof)
    sources = Sources(model, of_parts=lambda _: transmitted)
    answer = evaluate(sources, "reactions", **states, inputs={"u": 0.6}, t=0.8)
    worst = 0.0
    for i in range(2):
        hand = Released(tree, list(model.coordinates), states["q"][i], states["qd"][i], {"k": 1.7, "u": 0.6, "t": 0.8})
        for name, (force, moment) in hand.reactions(tree["loads"], states["qdd"][i]).items():
            k = answer.joints.index(name)
            for field, expected in (("force_world", force), ("moment_world", moment)):
                scale = max(float(np.abs(expected).max()), 1e-2)
                worst = max(worst, float(np.abs(answer["reactions"][field][i, k] - expected).max()) / scale)
    return worst


@pytest.mark.parametrize("block", seeds(1, 2))
def test_random_trees_with_loads(block: int) -> None:
    for seed in range(6 * block, 6 * block + 6):
        assert compare_tree(seed) < TOLERANCE, f"seed {seed}"


@pytest.mark.deep
@pytest.mark.parametrize("block", range(10))
def test_hundred_random_trees_with_loads(block: int) -> None:
    for seed in range(100 + 10 * block, 110 + 10 * block):
        assert compare_tree(seed) < TOLERANCE, f"seed {seed}"
