"""Closed loops against an independent engine."""

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import angles, tree_model
from random_trees import GRAVITY, Plain, add_inertia, vector

from substructures.analysis.closed.loops import loop_state
from substructures.quantities.numbers.evaluation import evaluate

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional


@pytest.mark.parametrize("kind", ["spherical", "fixed"])
def test_independent_engine(kind: str) -> None:
    """Accelerations of a chain tied to the world against Pinocchio's constraint dynamics."""
    rng = np.random.default_rng(11)
    bodies: list[Plain] = []
    for k in range(8):
        place = {"position": [0.4, 0.1 * (k % 3), 0.1], "rpy": vector(rng, 2)}
        joint = {"type": "revolute", "coordinate": f"q{k}", "placement": place}
        bodies.append({"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
        add_inertia(rng, bodies[-1], True)
    tip = {"name": "tip", "body": "b7", "position": [0.3, 0, 0.1]}
    definition = {"name": "chain", "bodies": bodies, "ports": [tip]}
    document: Plain = {"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "d"}]}
    start = rng.uniform(-0.5, 0.5, 8)
    chain = tree_model(document, {"d": definition})
    x = evaluate(chain, ["kinematics"], q=start)["kinematics"]
    where, turned = x["position"][-1], x["rotation"][-1]
    seat = {"position": [float(v) for v in where], "rpy": [float(v) for v in reversed(angles(turned))]}
    closure = {"name": "c", "type": kind, "from": "x.tip", "to": "world", "placement": seat}
    model = tree_model(document | {"closures": [closure]}, {"d": definition})
    found = loop_state(model, start, qd=rng.uniform(-1, 1, 8))
    assert found.message == ""
    engine = engine_of(definition, GRAVITY)
    j1, p1 = engine.frames["tip"]
    p2 = pin.SE3(turned, where)
    contact = pin.ContactType.CONTACT_3D if kind == "spherical" else pin.ContactType.CONTACT_6D
    constraint = pin.RigidConstraintModel(contact, engine.model, j1, p1, 0, p2, pin.ReferenceFrame.LOCAL)
    data, settings = engine.model.createData(), pin.ProximalSettings(1e-14, 1e-14, 1000)
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    models.append(constraint)
    datas.append(constraint.createData())
    pin.initConstraintDynamics(engine.model, data, models, datas)
    state = found.consistent.q, found.consistent.qd, np.zeros(8)
    a = pin.constraintDynamics(engine.model, data, *state, models, datas, settings)
    np.testing.assert_allclose(found.qdd, a, rtol=0, atol=1e-7 * np.abs(a).max())
