"""Reactions in joints: statics by hand, a published formula, joints cut as closures, springs of parts, and faults."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import slider_crank
from random_trees import Kind, random_definition, random_states, tree_of
from simulated import simulated

from substructures import Definition, InvalidArgument, Model, Part, TreeSpec, catalogue, couple, derive
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, Outputs, simulate
from substructures.errors import VerificationFailed
from substructures.quantities import reactions as module
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.part_models import ReactionModel
from substructures.quantities.reactions import reactions
from substructures.quantities.sources import Sources

Plain = dict[str, Any]
DOWN = [0, -9.81, 0]


def made(tree: Plain) -> tuple[Model, ReactionModel]:
    spec = TreeSpec.read({"name": "tree"} | tree)
    parts: dict[str, Part] = {i["name"]: derive(Definition.read(i["definition"])) for i in tree["instances"]}
    return couple(spec, parts), reactions(spec, parts)


def answered(tree: Plain, joints: tuple[str, ...] | None = None, **given: Any) -> Evaluation:
    model, transmitted = made(tree)
    return evaluate(Sources(model, of_parts=lambda _: transmitted, joints=joints), "reactions", **given)


def rod(mass: float, length: float, joint: Plain | None = None, **more: Any) -> Plain:
    """A point mass at the end of a rod along x, on a hinge about z."""
    hinge = {"type": "revolute", "coordinate": "q"} | (joint or {})
    body = {"name": "rod", "parent": "base", "joint": hinge, "mass": mass, "com": [length, 0, 0]}
    return {
        "name": "rod",
        "bodies": [body],
        "ports": [{"name": "tip", "body": "rod", "position": [length, 0, 0]}],
    } | more


def hung(count: int, mass: float = 2, **more: Any) -> Plain:
    """A chain of equal rods."""
    instances: list[Plain] = [{"name": "a0", "definition": rod(mass, 0.5)}]
    instances += [{"name": f"a{i}", "definition": rod(mass, 0.5), "at": f"a{i - 1}.tip"} for i in range(1, count)]
    return {"gravity": DOWN, "instances": instances} | more


def test_each_bearing_of_a_hanging_chain_carries_what_is_below() -> None:
    down = -np.pi / 2
    found = answered(hung(5), q=[down, 0, 0, 0, 0])["reactions"]
    for i in range(5):
        # weight of the bodies from i on, upwards; nothing turns them
        assert np.allclose(found["force_world"][i], [0, 2 * 9.81 * (5 - i), 0], atol=1e-12)
        # along the rods, the first axis of each, which points down
        assert np.allclose(found["force"][i], [-2 * 9.81 * (5 - i), 0, 0], atol=1e-12)
    assert np.allclose(found["moment"], 0, atol=1e-12)


def test_the_force_in_the_rod_of_a_pendulum() -> None:
    """m g cos q + m l q'^2 towards the pivot (any text-book; Landau and Lifshitz, Mechanics, section 5)."""
    m, length, angle, rate = 1.5, 0.8, 0.7, 2.1
    tree = {"gravity": DOWN, "instances": [{"name": "p", "definition": rod(m, length)}]}
    found = answered(tree, q=[angle - np.pi / 2], qd=[rate])["reactions"]
    # q'' is that of the free motion: across the rod the pivot exerts nothing on a point mass
    assert found["force"][0] == pytest.approx([-(m * 9.81 * np.cos(angle) + m * length * rate**2), 0, 0], abs=1e-12)


def test_the_third_component_is_what_acts_in_the_joint() -> None:
    """n . e3 of a hinge, f . e3 of a slide: Q_k - armature q''^k of spring, damper and actuator."""
    law = {"stiffness": 3, "rest": 0.2, "damping": 0.4, "armature": 0.7}
    for kind, field in (("revolute", "moment"), ("prismatic", "force")):
        tree = {
            "gravity": [1, 2, 3], "instances": [{"name": "p", "definition": rod(1.5, 0.8, {"type": kind} | law)}],
        }  # fmt: skip
        model, transmitted = made(tree)
        sources = Sources(model, of_parts=lambda _, given=transmitted: given)
        state = {"q": [0.5], "qd": [1.3], "inputs": {"tau.p.q": 0.9}}
        found = evaluate(sources, ["reactions", "forward_dynamics"], **state)
        law_of_joint = 0.9 - 3 * (0.5 - 0.2) - 0.4 * 1.3
        expected = law_of_joint - 0.7 * found["forward_dynamics"][0]
        assert found["reactions"][field][0, 2] == pytest.approx(expected, abs=1e-12)


def test_springs_between_bodies_are_no_load_of_the_joints_that_carry_both() -> None:
    """Inner forces add up to nothing: the world carries the weight, and what the whole needs to be accelerated."""
    rng = np.random.default_rng(4)
    definition = random_definition(rng, Kind(5, loads=0, springs=4))
    tree = {"gravity": [0, 0, -9.81], "instances": [{"name": "x", "definition": definition}]}
    resting = {"q": random_states(rng, 1, made(tree)[0].dof)["q"][0]}
    resting |= {"qd": np.zeros_like(resting["q"]), "qdd": np.zeros_like(resting["q"])}
    found = answered(tree, **resting)
    mass = sum(float(body.get("mass", 0)) for body in definition["bodies"])
    carried = found["reactions"]["force_world"][found.joints.index("x.base")]
    assert np.allclose(carried, [0, 0, 9.81 * mass], atol=1e-9)


def two_links(closed: bool) -> Plain:
    """A double pendulum, its second link with a skew mass; or the same with this link free, and the hinge a closure."""
    skew = {"mass": 1.2, "com": [0.3, 0.1, 0.2], "inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.25, "xz": 0.05, "yz": -0.03}}
    joint: Plain = {"type": "revolute", "coordinate": "q", "damping": 0.3}
    if closed:
        joint = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}
    second = {"name": "two", "bodies": [{"name": "link", "parent": "base", "joint": joint, **skew}]}
    first = {"name": "one", "definition": rod(2, 0.5)}
    seat = {"name": "two", "definition": second, "at": "world" if closed else "one.tip"}
    # in the loop the damper of the hinge is a law of the rates of the two bodies
    load = {"name": "d", "type": "bushing", "from": "one.tip", "to": "two.link", "angular_damping": [0, 0, 0.3]}
    hinge = {"name": "hinge", "type": "pin", "from": "one.tip", "to": "two.link"}
    tree = {"gravity": [0.3, -9.81, 0], "instances": [first, seat]}
    return tree | ({"closures": [hinge], "loads": [load]} if closed else {})


def test_a_joint_cut_as_a_closure_has_the_same_reactions() -> None:
    q1, q2, w1, w2 = 0.4, 0.9, 1.5, -0.7
    open_ = answered(two_links(False), q=[q1, q2], qd=[w1, w2])
    model, transmitted = made(two_links(True))
    c, s = 0.5 * np.cos(q1), 0.5 * np.sin(q1)
    q, qd = [q1, c, s, 0, q1 + q2, 0, 0], [w1, -s * w1, c * w1, 0, w1 + w2, 0, 0]
    found = evaluate(Sources(model, of_parts=lambda _: transmitted), "reactions", q, qd)
    row = {name: k for k, name in enumerate(found.joints)}
    for field in ("force", "moment", "force_world", "moment_world"):
        # the hinge of the first link, which carries both
        assert np.allclose(found["reactions"][field][0], open_["reactions"][field][0], atol=1e-9), field
    # the hinge between them transmits the multipliers, in the axes of the first link; the free link has no bearing
    state = loop_state(model, q, qd=qd)
    hinge = state.reactions[0]
    assert np.allclose(found["reactions"]["force"][row["two.roll"]], 0, atol=1e-9)
    turned = np.array([[np.cos(q1), np.sin(q1), 0], [-np.sin(q1), np.cos(q1), 0], [0, 0, 1]])
    second = {field: open_["reactions"][f"{field}_world"][1] for field in ("force", "moment")}
    assert np.allclose(hinge.force, turned @ second["force"], atol=1e-9)
    assert np.allclose(hinge.moment[:2], (turned @ second["moment"])[:2], atol=1e-9)


def test_along_a_motion_with_a_closure() -> None:
    """A driven slider crank, cut at its wrist: the guide carries no force along the way of the piston, the bearing of
    the crank transmits the torque, and the base the weight.
    """
    model = slider_crank((0, -9.81, 0))
    definition = Definition.read(catalogue.load("slider-crank"))
    closure = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    one = {"name": "x", "substructure": "slider-crank"}
    spec = TreeSpec.read({"name": "l", "gravity": DOWN, "instances": [one], "closures": [closure]})
    transmitted = reactions(spec, {"x": derive(definition)})
    given: Plain = {"qd": [40, 0, 0], "inputs": {"tau.x.crank": "2*sin(20*t)"}, "fixed": ["x.crank"]}
    motion = simulated(model, [0.3, -0.1, 0.17], (0, 0.1), **given, count=11, reactions=transmitted)
    row = {name: k for k, name in enumerate(motion.joints)}
    torque = motion.series["reaction_moment"][:, row["x.crank"], 2]
    assert np.allclose(torque, 2 * np.sin(20 * motion.t), atol=1e-7)
    assert np.allclose(motion.series["reaction_force"][:, row["x.piston"], 2], 0, atol=1e-7)
    assert np.abs(motion.series["reaction_force"]).max() > 10
    # what the world exerts on the whole is its weight, upwards, and its rate of momentum
    h, momenta = 1e-5, []
    for sign in (1, -1):
        q, qd = motion.q + sign * h * motion.qd, motion.qd + sign * h * motion.series["qdd"]
        momenta.append(evaluate(model, "momentum", q, qd)["momentum"]["linear"])
    rate = (momenta[0] - momenta[1]) / (2 * h)
    weight = motion.series["reaction_force_world"][:, row["x.base"]] - rate
    assert np.allclose(weight, weight[0], atol=1e-4 * np.abs(rate).max())
    assert weight[0, 1] > 0


def test_a_motion_that_does_not_begin_has_none() -> None:
    """The loop cannot be closed with the piston far away."""
    closure = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    one = {"name": "x", "substructure": "slider-crank"}
    spec = TreeSpec.read({"name": "l", "gravity": DOWN, "instances": [one], "closures": [closure]})
    transmitted = reactions(spec, {"x": shipped_part("slider-crank")})
    far = {"x.crank": "0.3", "x.piston": "9"}
    motion = simulate(
        slider_crank((0, -9.81, 0)),
        [0, 0, 0],
        (0, 1),
        kind=ClosedMotion(prescribed=far),
        outputs=Outputs(reactions=transmitted),
    )
    assert motion.status == "failed"
    assert "reaction_force" not in motion.series


def test_chosen_joints_alone() -> None:
    given = {"q": [[0.1, 0.2, 0.3]] * 2, "qd": [[1.0, 0, 2]] * 2}
    whole, some = answered(hung(3), **given), answered(hung(3), ("a2.q", "a0.base"), **given)
    assert some.joints == ("a2.q", "a0.base")
    for field, numbers in some["reactions"].items():
        assert numbers.shape == (2, 2, 3)
        assert np.allclose(numbers, whole["reactions"][field][:, [2, 3]], rtol=0, atol=1e-12)
    model, transmitted = made(hung(3))
    assert len(transmitted.of(["a2.q"]).program) < 0.7 * len(transmitted.program)
    with pytest.raises(InvalidArgument, match=r"there is no joint 'a2.p'.*a2.q"):
        transmitted.of(["a0.q", "a2.p"])
    with pytest.raises(InvalidArgument, match=r"'reactions' needs the parts .*: give Sources\("):
        evaluate(model, "reactions", [0, 0, 0])


def test_states_without_accelerations_have_none() -> None:
    """A state that does not meet the closure."""
    off = answered(two_links(True), q=[0.4, 5, 0, 0, 0, 0, 0])
    assert "forward_dynamics" in off.failures[0].message
    with pytest.raises(InvalidArgument, match="leave 'qdd' out"):
        answered(two_links(True), q=[0.4, 5, 0, 0, 0, 0, 0], qdd=[0] * 7)


@pytest.mark.parametrize("fault", ["pass_back", "applied_wrenches"])
def test_wrong_formulas_are_not_served(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate sees a recursion that forgets to go on, and a load that is forgotten."""
    definition = random_definition(np.random.default_rng(3), Kind(4, loads=3, springs=2))
    monkeypatch.setattr(module, fault, lambda *_: [])
    with pytest.raises(VerificationFailed, match="reactions: reaction_"):
        reactions(tree_of(definition), {"x": derive(Definition.read(definition))})
