"""Cables over pulleys, in trees and in parts: textbook systems, certificates, faults (notation.md, section 7)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from damaged import damages, errors_of, found_in_tree
from random_trees import Plain

from substructures import Definition, InvalidDocument, Model, Part, TreeSpec, couple, derive
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.simulate import simulate
from substructures.certificate.compare import TOLERANCE
from substructures.pictures.tree import picture
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions
from substructures.quantities.sources import Sources
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

G = 9.81
#: a weight that moves along the third axis of its base
WEIGHT: Plain = {
    "name": "weight",
    "parameters": {"m": {"value": 2, "unit": "kg"}},
    "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}, "mass": "m"}],
}
#: two links whose axes are skew, with a port
ARM: Plain = {
    "name": "arm",
    "parameters": {"k": {"value": 30, "unit": "N/m"}, "s": {"value": 0.2, "unit": "m"}},
    "inputs": {"u": {"unit": "m"}},
    "bodies": [
        {"name": "u", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1", "theta": 0.3}, "mass": 2,
         "com": [0.3, 0.1, 0], "inertia": {"xx": 0.2, "yy": 0.3, "zz": 0.4}},
        {"name": "v", "parent": "u", "joint": {"type": "revolute", "coordinate": "q2", "d": 0.6, "theta": 1.1},
         "mass": 1, "com": [0.2, 0, 0.1], "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}},
    ],
    "ports": [{"name": "tip", "body": "v", "position": [0.5, 0.1, 0.2], "rotation": {"rpy": [0.2, -0.1, 0.4]}}],
}  # fmt: skip
#: over a pulley on u, to the tip; in the names of the part
ALONG: list[Any] = ["base", {"frame": "u", "at": [0.1, "s", 0.5]}, {"frame": "tip", "at": [0, 0.1, 0]}]
LAW: Plain = {"stiffness": "k", "damping": 0.7, "length": "s + u"}


def weights(*loads: Plain, **more: Any) -> Model:
    """Two weights, a at x = 0 and b at x = 1, that move up and down below the world's origin."""
    part = derive(Definition.read(WEIGHT))
    instances = [
        {"name": name, "substructure": "weight", "placement": {"position": [x, 0, 0]}}
        for name, x in (("a", 0), ("b", 1))
    ]
    spec = {"name": "t", "gravity": [0, 0, f"-{G}"], "instances": instances, "loads": list(loads), **more}
    return couple(TreeSpec.read(spec), {"a": part, "b": part})


def over_pulleys(**law: Any) -> Plain:
    """From a up to 3 m, across, and down to b."""
    tops = [{"frame": "world", "at": [x, 0, 3]} for x in (0, 1)]
    return {"name": "rope", "type": "cable", "along": ["a.b", *tops, "b.b"], **law}


def test_atwoods_machine() -> None:
    """Two weights on a rope over pulleys: T = k (L - L0) on both, frequency sqrt(2 k/m) of their sum, momentum apart.

    L = (3 - z_a) + 1 + (3 - z_b); with s = z_a + z_b: m s'' = 2 T - 2 m g, and z_a - z_b moves freely.
    """
    k, m, L0 = 400.0, 2.0, 6.5
    model = weights(over_pulleys(stiffness=k, length=L0))
    z = np.array([0.1, -0.3])
    T = k * (7 - z.sum() - L0)
    assert np.allclose(evaluate(model, ["forces"], q=z)["forces"], T - m * G)
    motion = simulate(model, q=z, qd=[0.2, 0.1], span=(0, 2))
    assert motion.is_right
    w, rest = np.sqrt(2 * k / m), 7 - L0 - m * G / k
    s = rest + (z.sum() - rest) * np.cos(w * motion.t) + 0.3 / w * np.sin(w * motion.t)
    assert np.allclose(motion.q.sum(axis=1), s, atol=1e-8)
    assert np.allclose(motion.q[:, 0] - motion.q[:, 1], 0.4 + 0.1 * motion.t, atol=1e-8)
    assert "energy" in {each.name for each in first_integrals(model).integrals}


def test_a_damper_takes_the_power_of_the_whole_length() -> None:
    """P = T L' with L' = -(z_a' + z_b'); a weight that falls as the other rises loses nothing."""
    model = weights(over_pulleys(damping=5))
    power = [evaluate(model, ["power"], q=[0, 0], qd=qd)["power"].sum() for qd in ([1, -1], [0.2, 0.1])]
    gravity = [0, -2 * G * 0.3]
    assert np.allclose(power, [gravity[0], gravity[1] - 5 * 0.3**2])


@pytest.mark.parametrize("z", [0.2, 0.6])
def test_a_slack_cable_pulls_only(z: float) -> None:
    """V = k p^2/2 of p = max(0, L - L0): nothing where both weights are high."""
    model = weights(over_pulleys(stiffness=400, length=6, slack=True))
    p = max(0.0, 7 - 2 * z - 6)
    found = evaluate(model, ["forces", "potential_energy"], q=[z, z])
    assert np.allclose(found["forces"], 400 * p - 2 * G)
    assert found["potential_energy"] == pytest.approx(200 * p**2 + 2 * 2 * G * z)


def test_a_weight_falls_into_a_slack_cable() -> None:
    """Free fall, then a spring: the lowest place is where m g (fall) = k p^2/2."""
    model = weights(over_pulleys(stiffness=900, length=7, slack=True))
    motion = simulate(model, q=[0.5, 0.5], span=(0, 1.2))
    assert motion.is_right, motion.checks
    # L - L0 = -2 z =: p,   V = 2 m g z + k p^2 / 2 of both weights = 2 m g 0.5
    p = np.roots([450, -2 * G, -2 * G]).max()
    assert motion.q.min() == pytest.approx(-p / 2, abs=2e-3)


def arm(*loads: Plain) -> Part:
    return derive(Definition.read({**ARM, "loads": list(loads)}))


def tree_of(part: Part, *loads: Plain) -> tuple[TreeSpec, dict[str, Part]]:
    given = [{"name": f"l{i}", **load} for i, load in enumerate(loads)]
    spec = {"name": "t", "gravity": [0.5, -1, -9], "instances": [{"name": "x", "substructure": "arm"}], "loads": given}
    return TreeSpec.read(spec), {"x": part}


def in_tree(given: Any) -> Any:
    """What is said of the part, in the names of the tree."""
    if isinstance(given, list):
        return [in_tree(x) for x in given]
    if isinstance(given, dict):
        return {key: in_tree(x) if key in ("frame", "at") else x for key, x in given.items()}
    return f"x.{given}" if isinstance(given, str) else given


OF_PART: Plain = {"type": "cable", "along": ALONG, **LAW}
OF_TREE: Plain = {**OF_PART, "along": in_tree(ALONG), "stiffness": "x.k", "length": "x.s + x.u"}
QUANTITIES = ["forces", "inverse_dynamics", "potential_energy"]
STATE: dict[str, Any] = {"q": [0.3, -0.8], "qd": [0.5, 1.1], "qdd": [0.2, -0.7], "inputs": {"x.u": 0.1}}


def same(one: Any, two: Any, names: list[str]) -> None:
    for name in names:
        assert np.allclose(one[name], two[name], rtol=1e-12, atol=1e-12), name


def test_a_cable_of_a_part_is_that_of_a_tree() -> None:
    """Also in reactions, powers, and as a module; two points are a spring."""
    ours, theirs = tree_of(arm(OF_PART)), tree_of(arm(), OF_TREE)
    answers = [evaluate(couple(*each), QUANTITIES, **STATE) for each in (ours, theirs)]
    same(*answers, QUANTITIES)
    without = evaluate(couple(*tree_of(arm())), ["forces"], **STATE)
    assert np.abs(answers[0]["forces"] - without["forces"]).max() > 1
    assert powers(*ours).rows[-1] == "cable x.loads/0"
    assert powers(*theirs).rows[-1] == "cable l0"
    assert reactions(*ours).rows == reactions(*theirs).rows
    assert "<polyline" in picture(*ours, couple(*ours))
    for spec, parts in (ours, theirs):
        found = published(spec, parts, Publication({"name": "arm"}))
        model = couple(*tree_of(published_part(found, parts)))
        state = {**STATE, "inputs": {"x.x_u": 0.1}}
        same(evaluate(model, QUANTITIES, **state), answers[0], QUANTITIES)


def test_reactions_are_those_of_a_spring() -> None:
    """A cable between two points is a spring in all that is transmitted."""
    point = {"frame": "x.tip", "at": [0.1, 0, 0]}
    cable = {"type": "cable", "along": ["world", point], "stiffness": 3, "damping": 2, "length": 0.4}
    spring = {"type": "spring", "to": point, "stiffness": 3, "damping": 2, "length": 0.4}
    found = []
    for load in (cable, spring):
        spec, parts = tree_of(arm(), load)
        model, transmitted = couple(spec, parts), reactions(spec, parts)
        sources = Sources(model, of_parts=lambda _, given=transmitted: given)
        found.append(evaluate(sources, [*QUANTITIES, "reactions"], **STATE))
    same(*found, QUANTITIES)
    same(*(each["reactions"] for each in found), ["force", "moment"])


def test_damage_is_found() -> None:
    spec, parts = tree_of(
        arm(OF_PART), OF_TREE, {**OF_TREE, "stiffness": "x.k*(1 + x.q1^2)", "slack": True, "damping": 0}
    )
    model = couple(spec, parts)
    errors = errors_of(model.certificate)
    assert all(error is not None and error <= TOLERANCE for error in errors.values())
    rng = np.random.default_rng(3)
    for kind, place, wrong in damages(model.program, rng, elements=2):
        if place.partition("[")[0] in ("forces", "inverse_dynamics", "potential_energy"):
            assert found_in_tree(spec, parts, model, wrong) is not None, (kind, place)


def test_a_stiffness_that_moves_has_its_potential_in_a_part() -> None:
    """As of a spring: where the force is a gradient it is found, and told where it is not."""
    part = arm({**OF_PART, "stiffness": "k*(1 + q1^2)", "damping": 0})
    assert [each["code"] for each in part.certificate["warnings"]] == ["no-potential"]


BAD: list[tuple[Plain, str, str, str]] = [
    ({"along": ["base"]}, "/loads/0/along", "too-short", "2"),
    ({"along": ["base", "hand"]}, "/loads/0/along/1", "unknown-frame", "tip"),
    ({"along": ["base", {"frame": "hand"}]}, "/loads/0/along/1/frame", "unknown-frame", "tip"),
    ({"along": ["base", {"frame": "tip", "at": ["q1", 0, 0]}]}, "/loads/0/along/1/at/0", "unknown-name", "constant"),
    ({"along": ["base", {"frame": "tip", "at": [0, 0]}]}, "/loads/0/along/1/at/2", "missing", ""),
    ({"along": ["base", {"at": [0, 0, 0]}]}, "/loads/0/along/1/frame", "missing", "frame"),
    ({"along": ["base", "tip", "tip"]}, "/loads/0/along/2", "coincident-ends", "points 2 and 3"),
    ({"along": ["base", {"frame": "tip", "at": [{"value": 1, "unit": "kg"}, 0, 0]}]}, "/loads/0/along/1/at/0",
     "unit-mismatch", "kg"),
    ({"stiffness": {"value": 1, "unit": "N"}}, "/loads/0/stiffness", "unit-mismatch", "N/m"),
    ({"slack": True, "damping": 1}, "/loads/0/damping", "damping-of-slack", "slack"),
    ({"stifness": 1}, "/loads/0/stifness", "extra-forbidden", "stiffness"),
]  # fmt: skip


@pytest.mark.parametrize(("bad", "pointer", "code", "word"), BAD)
@pytest.mark.parametrize("within", [True, False])
def test_bad_cables(bad: Plain, pointer: str, code: str, word: str, within: bool) -> None:
    given: Plain = {"type": "cable", "along": ["base", "tip"], **bad}
    of_tree = given | {"along": in_tree(given["along"])}
    with pytest.raises(InvalidDocument) as raised:
        couple(*(tree_of(arm(given)) if within else tree_of(arm(), of_tree)))
    (fault,) = raised.value.faults
    expected = code if within else code.replace("unknown-frame", "unknown-port")
    assert (fault.pointer, fault.code) == (pointer, expected), fault
    assert word in fault.message
