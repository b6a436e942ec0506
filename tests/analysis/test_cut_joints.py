"""Any joint of a tree may be cut and closed again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import angles, tree_model
from random_trees import GRAVITY, Plain, add_inertia, number, vector

from substructures.analysis.closed.loops import loop_state
from substructures.part.topology import CHAINS
from substructures.quantities.numbers.evaluation import evaluate

KINDS = ("revolute", "prismatic", "spherical", "fixed", "cylindrical", "universal", "planar")


def cut(rng: np.random.Generator, kind: str) -> tuple[Plain, Plain]:
    """A chain of three bodies whose second joint is of this kind; and the same with that joint cut: a free body."""
    bodies: list[Plain] = []
    for name, parent, joint in (("b1", "base", "revolute"), ("b2", "b1", kind), ("b3", "b2", "prismatic")):
        place = {"position": vector(rng), "rpy": [number(rng) for _ in range(3)]}
        bodies.append({"name": name, "parent": parent, "joint": {"type": joint, "placement": place}})
        add_inertia(rng, bodies[-1], True)
    seat = bodies[1]["joint"]["placement"]
    port = {"name": "seat", "body": "b1", "position": seat["position"], "rotation": {"rpy": seat["rpy"]}}
    free = {**bodies[1], "parent": "base", "joint": {"type": "free"}}
    load = {"type": "force", "body": "b3", "vector": [1, 2, 3], "frame": "world"}
    whole = {"name": "whole", "bodies": bodies, "ports": [port], "loads": [load]}
    return whole, whole | {"bodies": [bodies[0], free, bodies[2]]}


@pytest.mark.parametrize("kind", KINDS)
def test_any_joint_may_be_cut(kind: str) -> None:
    """A free body that a closure ties to its old place moves like the chain it was cut from."""
    rng = np.random.default_rng(KINDS.index(kind))
    whole, parted = cut(rng, kind)
    chain = tree_model({"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "w"}]}, {"w": whole})
    closure = {"name": "c", "type": kind, "from": "x.seat", "to": "x.b2"}
    document = {"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "w"}], "closures": [closure]}
    closed = tree_model(document, {"w": parted})
    n = len(CHAINS[kind])
    q, qd = rng.uniform(-0.6, 0.6, chain.dof), rng.uniform(-1, 1, chain.dof)
    answer = evaluate(chain, ["kinematics", "forward_dynamics"], q=q, qd=qd)
    b2 = chain.frames.index("x.b2")
    pose = answer["kinematics"]["position"][b2], answer["kinematics"]["rotation"][b2]
    start = np.concatenate((q[:1], pose[0], angles(pose[1]), q[1 + n :]))
    speeds = np.concatenate((qd[:1], np.zeros(6), qd[1 + n :]))
    rates = slopes(chain, q, qd, b2)
    speeds[1:7] = rates
    found = loop_state(closed, start, qd=speeds)
    assert found.message == ""
    assert found.mobility.degrees_of_freedom == chain.dof
    assert not found.mobility.redundant
    np.testing.assert_allclose(found.consistent.q, start, atol=1e-11)
    np.testing.assert_allclose(found.consistent.qd, speeds, atol=1e-6)
    again = loop_state(closed, found.consistent.q, qd=speeds)
    expected = answer["forward_dynamics"]
    np.testing.assert_allclose(again.qdd[[0, -1]], expected[[0, -1]], rtol=1e-6, atol=1e-6 * np.abs(expected).max())


def slopes(chain: Any, q: np.ndarray, qd: np.ndarray, frame: int, h: float = 1e-4) -> np.ndarray:
    """Rates of position and angles of a frame, by differences of fourth order."""
    result = np.zeros(6)
    for k, c in ((1, 8), (-1, -8), (2, -1), (-2, 1)):
        x = evaluate(chain, ["kinematics"], q=q + k * h * qd)["kinematics"]
        result += c / (12 * h) * np.concatenate((x["position"][frame], angles(x["rotation"][frame])))
    return result
