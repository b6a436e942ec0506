"""The reduced level beyond floating bases and balls: the equations with multipliers on a chain of joints with angles,
another engine, motions.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tied_combinations
from closed_trees import tree_model, tree_parts
from mechanics.reduced_parts import PARTS, on_a_hull
from scipy.spatial.transform import Rotation

from service.models.formulas import QUANTITIES
from service.models.numbers import ANALYSES
from substructures import Model, couple, equilibria, evaluate, linearise, simulate
from substructures.analysis.closed.reduced import reduced_equations
from substructures.quantities.sources import Sources, of_parts

NAMES = {each["name"]: each for each in PARTS}
ANGLES = ["x", "y", "z", "yaw", "pitch", "roll"]
CHAIN = {"type": "free", "coordinate": ANGLES}
START = {"x.phi": 1.0, "x.psi": -0.6, "x.chi": 1.5}


def rates_of(chain: Model, q: Any, qd: Any, body: str = "hull.hull") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Place and quaternion of a body, and its velocities in its own axes."""
    k = chain.frames.index(body)
    found = evaluate(chain, ["position", "rotation", "U", "Omega"], q)
    turn = Rotation.from_matrix(found["rotation"][k]).as_quat(scalar_first=True)
    v, w = (np.asarray(qd) @ found[name][k] for name in ("U", "Omega"))
    return np.concatenate([found["position"][k], turn]), v, w


@pytest.mark.parametrize("name", NAMES)
def test_on_a_floating_base_they_are_the_equations_with_multipliers(name: str) -> None:
    """Energy and accelerations of the joints are those of the tree on three slides and three turns, with closures; M
    and Gamma~ v v are g v' + Gamma~ v v = Q, and do not depend on where the base is.
    """
    model, chain = on_a_hull(name, {"type": "floating"}), on_a_hull(name, CHAIN, "full")
    assert not model.closures
    assert [x["instance"] for x in model.reduced] == ["x"]
    rng, start = np.random.default_rng(5), {f"x.{q}": float(x) for q, x in NAMES[name]["start"].items()}
    free = [q for q in chain.coordinates if q.startswith("hull.") or q in model.coordinates]
    q = {c: start.get(c, 0) + rng.uniform(-0.2, 0.2) for c in free}
    qd = {c: rng.uniform(-1, 1) for c in free}
    tau = {f"tau.{c}": rng.uniform(-1, 1) for c in free if not c.startswith("hull.")}
    other = reduced_equations(chain, q, qd=qd, inputs=tau, independent=free, start=start)
    assert other.is_right
    state, v, w = rates_of(chain, other.q, other.qd)
    here, rates = [*state, *list(q.values())[6:]], [*v, *w, *list(qd.values())[6:]]
    found = evaluate(model, ["metric", "christoffel", "bias", "forces", "forward_dynamics"], here, rates, inputs=tau)
    second = np.asarray(other.accelerations)
    np.testing.assert_allclose(found["forward_dynamics"][6:], second[6:], rtol=0, atol=1e-11 * np.abs(second).max())
    speeds = np.array(list(qd.values()))
    energy = speeds @ other.metric @ speeds
    assert rates @ found["metric"] @ rates == pytest.approx(energy, rel=1e-12)
    bias = np.einsum("abc,b,c", found["christoffel"], rates, rates)
    np.testing.assert_allclose(found["bias"], bias, rtol=0, atol=1e-12 * np.abs(bias).max())
    balance = found["metric"] @ found["forward_dynamics"] + bias - found["forces"]
    np.testing.assert_allclose(balance, 0, atol=1e-11 * np.abs(bias).max())
    away = evaluate(model, ["metric", "christoffel"], [5, 6, 7, 0, 0.6, 0, 0.8, *here[7:]])
    for each in ("metric", "christoffel"):
        np.testing.assert_array_equal(away[each], found[each])


def test_a_linkage_that_floats_is_one_on_a_body_without_mass() -> None:
    """`floating_metric` and `floating_christoffel` of a tree, and the metric of this tree on a floating base."""
    name, names = "rod", ["floating_metric", "floating_christoffel"]
    document = {"instances": [{"name": "x", "substructure": name}]}
    light = {"name": "light", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "floating"}}]}
    carried = [{"name": "h", "substructure": "light"}, {**document["instances"][0], "at": "h.b"}]
    spec, parts = tree_parts(document, {name: NAMES[name]})
    found = evaluate(Sources(couple(spec, parts), of_parts=of_parts(spec, parts)), names, [0.6])
    assert list(found.labels["rates"]) == ["vx", "vy", "vz", "wx", "wy", "wz", "x.phi'"]
    model = tree_model({"instances": carried}, {name: NAMES[name], "light": light})
    other = evaluate(model, ["metric", "christoffel"], [1, 2, 3, 0.5, 0.5, -0.5, 0.5, 0.6])
    for ours, theirs in zip(names, ("metric", "christoffel"), strict=True):
        np.testing.assert_allclose(found[ours], other[theirs], rtol=0, atol=1e-14)


def test_motions_on_a_floating_base_are_those_of_angles() -> None:
    """Place and linkage after half a second; the verdict knows energy and the norm of the quaternion."""
    model, chain = (on_a_hull("crank-rocker", joint, is_handed=False) for joint in ({"type": "floating"}, CHAIN))
    q, qd = [0, 0, 0, 0.2, 0.1, -0.3, 1.0], [0.1, 0, 0.2, 0.5, -1, 0.7, 3]
    state, v, w = rates_of(chain, q, qd)
    ours = simulate(model, [*state, 1.0], (0, 0.5), qd=[*v, *w, 3.0])
    theirs = simulate(chain, q, (0, 0.5), qd=qd)
    assert ours.is_right
    assert theirs.is_right
    end, *_ = rates_of(chain, theirs.q[-1], theirs.qd[-1])
    np.testing.assert_allclose(ours.q[-1][:3], end[:3], rtol=0, atol=1e-6)
    assert abs(ours.q[-1][3:7] @ end[3:]) == pytest.approx(1, abs=1e-9)
    assert ours.q[-1][7] == pytest.approx(theirs.q[-1][6], abs=1e-6)


def test_it_accelerates_as_in_mujoco() -> None:
    """M, h and J of that engine, whose loop is closed by <connect>; J' by differences along the motion."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the test extra")
    turn = Rotation.from_euler("xyz", [0.3, 0, 0.1]).as_quat(scalar_first=True)
    own = '<inertial mass="1" pos="0.1 0.05 0.02" diaginertia="0.01 0.02 0.02"/><joint axis="0 0 1" type="hinge"'
    coupler = f'<body name="coupler" pos="0.3 0 0">{own}/></body>'
    crank = f"<body>{own}/>{coupler}</body>"
    laws = 'stiffness="3" springref="0.7" damping="0.2" armature="0.1"'
    rocker = f'<body name="rocker" pos="1 0 0">{own} {laws}/></body>'
    linkage = f'<body pos="0.1 0 0.2" quat="{" ".join(map(repr, turn.tolist()))}">{crank}{rocker}</body>'
    mass = '<inertial mass="3" pos="0.1 0.2 0" fullinertia="1 2 1.5 0.1 0 0"/>'
    text = (
        f'<mujoco><compiler angle="radian"/><option gravity="1 -9.81 2" jacobian="dense"/><worldbody><body><freejoint/>'
        f"{mass}{linkage}</body></worldbody><equality>"
        '<connect site1="end" site2="tip"/></equality></mujoco>'
    )
    text = text.replace("</body></body><body", '<site name="end" pos="0.9 0 0"/></body></body><body')
    text = text.replace(f"{laws}/>", f'{laws}/><site name="tip" pos="0.7 0 0"/>')
    m = mujoco.MjModel.from_xml_string(text)
    data, M = mujoco.MjData(m), np.zeros((9, 9))
    model = on_a_hull("crank-rocker", {"type": "floating"}, is_handed=False)
    full = tree_model(
        {"instances": [{"name": "x", "substructure": "crank-rocker", "level": "full"}]},
        {"crank-rocker": NAMES["crank-rocker"]},
    )
    rng = np.random.default_rng(2)
    for crank_angle in (0.8, 2.5):
        loop = reduced_equations(full, {"x.phi": crank_angle}, qd={"x.phi": 1.7}, start=START)
        quaternion = rng.normal(size=4)
        quaternion /= np.linalg.norm(quaternion)
        v, w, place = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
        R = Rotation.from_quat(quaternion, scalar_first=True)

        def rows(step: float, loop: Any = loop, at: Any = (place, R, v, w)) -> np.ndarray:
            """J a moment later."""
            place, R, v, w = at
            turned = (R * Rotation.from_rotvec(step * w)).as_quat(scalar_first=True)
            # velocities of the frame are constant in its own axes, to first order
            there = place + step * R.apply(v)
            data.qpos[:] = [*there, *turned, *(np.asarray(loop.q) + step * np.asarray(loop.qd))]
            data.qvel[:] = [*R.apply(v), *w, *loop.qd]
            mujoco.mj_forward(m, data)
            return np.array(data.efc_J).reshape(-1, m.nv)

        rate = (rows(1e-6) - rows(-1e-6)) / 2e-6
        J = rows(0)
        assert np.abs(data.efc_pos).max() < 1e-12
        mujoco.mj_fullM(m, data, M)
        K = np.block([[M, -J.T], [J, np.zeros((len(J), len(J)))]])
        right = np.concatenate([data.qfrc_passive - data.qfrc_bias, -rate @ data.qvel])
        wanted = np.linalg.lstsq(K, right, rcond=1e-12)[0][: m.nv]
        found = evaluate(model, "forward_dynamics", [*place, *quaternion, crank_angle], [*v, *w, 1.7])
        second = found["forward_dynamics"]
        # of a point: R (v' + w x v)
        ours = [*R.apply(second[:3] + np.cross(w, v)), *second[3:]]
        np.testing.assert_allclose(ours, wanted[:7], rtol=0, atol=1e-7 * np.abs(wanted).max())


def test_a_linkage_on_a_ball_swings_as_on_angles() -> None:
    """Eigenvalues about a position of rest, found with angles, by the polynomial whose roots they are: two are zero."""
    joints = {"type": "ball"}, {"type": "spherical", "coordinate": ANGLES[3:]}
    ball, chain = (on_a_hull("rod", joint, is_handed=False) for joint in joints)
    still = min(equilibria(chain, count=8).found, key=lambda each: np.linalg.cond(each.at.M)).q
    state, *_ = rates_of(chain, still, [0] * 4)
    ours, theirs = linearise(ball, [*state[3:], still[3]]), linearise(chain, still)
    wanted = np.poly(theirs.A)
    np.testing.assert_allclose(np.poly(ours.A), wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize("name", [*ANALYSES, *QUANTITIES])
def test_what_takes_balls_takes_linkages_on_them(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Each analysis, and each formula of analyses, of the tree of the table of what goes together."""
    hull = tied_combinations.TREES["balls"]["instances"][0]
    linkage = {"name": "x", "definition": tied_combinations.LINKAGE, "at": "hull.deck"}
    both = {"gravity": [0, 0, 0], "instances": [hull, linkage]}
    monkeypatch.setitem(tied_combinations.TREES, "both", both)
    wanted = {"": "", "has-balls": "has-balls"}
    if name != "reduced-equations":
        assert tied_combinations.refusal(name, "both") == wanted[tied_combinations.refusal(name, "balls")]
