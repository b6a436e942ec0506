"""Loads between the frames of a part: as the same loads of a tree, as an independent engine has them, on hosts that
move, in reactions, in modules (the contract, section 1).
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from in_depth import deep
from random_trees import Kind, Plain, random_definition, random_states, vector
from simulated import simulated

from substructures import Definition, InvalidDocument, Model, Part, TreeSpec, couple, derive
from substructures.pictures.tree import picture
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.reactions import reactions
from substructures.quantities.sources import Sources
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

QUANTITIES = ["metric", "forces", "inverse_dynamics", "potential_energy"]
#: loads of the instance ``x``, one of every type and law
LOADS: list[Plain] = [
    {"type": "bushing", "from": "x.b1", "to": "x.tip", "stiffness": [1, 2, "k"], "damping": [1, "k", "0.2*u"],
     "angular_stiffness": ["k", 3, 1], "angular_damping": [0.1, 0.2, "k"]},
    {"type": "bushing", "from": "x.tip", "to": "x.base", "stiffness": [1, "2 + x.q1^2", 3]},
    {"type": "force", "from": "x.b1", "to": "x.tip", "at": [0.1, "k", 0.2], "vector": ["u", 1, "x.q1'"]},
    {"type": "force", "from": "x.tip", "to": "x.b2", "at": [0.1, "k", 0.2], "vector": ["t", 1, 2], "axes": "from"},
    {"type": "force", "from": "x.tip", "to": "x.b2", "at": [0.1, 0, 0.2], "vector": [1, 2, "u"], "axes": "world"},
    {"type": "force", "from": "x.base", "to": "x.b2", "vector": [1, 2, "k"], "axes": "world"},
    {"type": "torque", "from": "x.b1", "to": "x.b2", "vector": [1, "x.q2", 3]},
    {"type": "torque", "from": "x.b1", "to": "x.tip", "vector": [1, "distance'(x.b1, x.tip)", 3], "axes": "from"},
    {"type": "torque", "from": "x.base", "to": "x.tip", "vector": [1, "k", 3], "axes": "world"},
    {"type": "joint", "coordinate": "x.q2", "force": "-k*distance'(x.b1, x.tip) - distance(x.tip, x.base)^2"},
    {"type": "potential", "potential": "k*(distance(x.b1, x.tip) - 0.4)^2*(1 + 0.2*sin(x.q1)) + u*x.q2^2"},
    {"type": "friction", "coordinate": "x.q1", "coulomb": "k", "static": 2, "stribeck": 0.3, "velocity": 0.2},
    {"type": "cable", "along": ["x.b1", {"frame": "x.base", "at": [1.5, "k", 2]}, "x.tip"], "stiffness": "3*k",
     "damping": "0.2*u", "length": 0.4},
]  # fmt: skip
CONSERVATIVE = [LOADS[0], LOADS[10]]


def own(load: Plain) -> Plain:
    """A load of the instance x as one of its definition."""
    return {key: inside(value) for key, value in load.items() if key != "name"}


def inside(value: Any) -> Any:
    if isinstance(value, list):
        return [inside(x) for x in value]
    if isinstance(value, dict):
        return {key: inside(x) for key, x in value.items()}
    return re.sub(r"\bx\.", "", value) if isinstance(value, str) else value


def definition_of(seed: int, loads: list[Plain], name: str = "part") -> Plain:
    """Three bodies that move on each other, and a port."""
    rng = np.random.default_rng(seed)
    while True:
        found = random_definition(rng, Kind(3, chain=True, loads=0, springs=0, laws=False), name)
        if [b["joint"]["type"] for b in found["bodies"]][1:] == ["revolute", "revolute"] and _moves(found, 0):
            break
    port = {"name": "tip", "body": "b3", "position": vector(rng), "rotation": {"rpy": vector(rng, 2)}}
    symbols = {"parameters": {"k": {"value": 0.7}}, "inputs": {"u": {}}}
    return {**found, **symbols, "ports": [port], "loads": [own(load) for load in loads]}


def _moves(definition: Plain, body: int) -> bool:
    """Whether its joint has one coordinate."""
    return isinstance(definition["bodies"][body]["joint"].get("coordinate"), str)


#: what carries the part
HOST: Plain = {
    "name": "host",
    "bodies": [
        {"name": "b", "parent": "base", "mass": 2, "com": [0.1, 0.2, 0], "inertia": {"xx": 1, "yy": 1, "zz": 1},
         "joint": {"type": "free", "coordinate": ["x", "y", "z", "c", "d", "e"]}},
    ],
    "ports": [{"name": "p", "body": "b", "position": [0.2, 0.1, 0.3], "rotation": {"rpy": [0.1, 0.7, 0.3]}}],
}  # fmt: skip


def tree_of(
    definition: Plain, loads: list[Plain] | tuple[()] = (), hosted: bool = False
) -> tuple[TreeSpec, dict[str, Part]]:
    """The definition as x, with loads of the tree; the tree's k and u stand for those of x in them."""
    known = {"k": "x.k", "u": "x.u"}

    def named(value: Any) -> Any:
        if isinstance(value, list):
            return [named(x) for x in value]
        if isinstance(value, dict):
            return {key: named(x) for key, x in value.items()}
        return re.sub(r"(?<![\w.])[ku](?![\w.])", lambda m: known[m[0]], value) if isinstance(value, str) else value

    instances: list[Plain] = [{"name": "x", "substructure": "part"}]
    parts = {"x": derive(Definition.read(definition))}
    if hosted:
        instances = [{"name": "h", "substructure": "host"}, {**instances[0], "at": "h.p"}]
        parts["h"] = derive(Definition.read(HOST))
    given = [{**{key: named(x) for key, x in load.items()}, "name": f"l{i}"} for i, load in enumerate(loads)]
    spec = TreeSpec.read({"name": "t", "gravity": [0.5, -1, -9.81], "instances": instances, "loads": given})
    return spec, parts


def answers(model: Model, seed: int = 0) -> dict[str, Any]:
    states = random_states(np.random.default_rng(seed), 3, model.dof)
    found = evaluate(model, QUANTITIES, **states, inputs={"x.u": 0.6}, t=0.8)
    return {name: found[name] for name in QUANTITIES}


def require_same(one: dict[str, Any], two: dict[str, Any]) -> None:
    for name in QUANTITIES:
        scale = max(float(np.abs(two[name]).max()), 1.0)
        assert np.abs(one[name] - two[name]).max() <= 1e-12 * scale, name


@pytest.mark.parametrize("hosted", [True, *deep(False)])
@pytest.mark.parametrize("k", range(len(LOADS)))
def test_a_load_of_a_part_is_that_of_a_tree(k: int, hosted: bool) -> None:
    load = LOADS[k]
    ours = answers(couple(*tree_of(definition_of(k, [load]), hosted=hosted)))
    theirs = answers(couple(*tree_of(definition_of(k, []), [load], hosted)))
    require_same(ours, theirs)
    without = answers(couple(*tree_of(definition_of(k, []), hosted=hosted)))
    assert np.abs(ours["forces"] - without["forces"]).max() > 1e-3


@pytest.mark.parametrize("seed", range(4))
def test_all_loads_together(seed: int) -> None:
    """In stored formulas, and in numbers from the formulas of the parts."""
    ours, theirs = tree_of(definition_of(seed, LOADS), hosted=True), tree_of(definition_of(seed, []), LOADS, True)
    model = couple(*ours)
    require_same(answers(model), answers(couple(*theirs)))
    states = random_states(np.random.default_rng(1), 3, model.dof)
    values: dict[str, Any] = {"x.u": 0.6, "t": 0.8}
    for mark, field in (("", "q"), ("'", "qd"), ("''", "qdd")):
        values |= {f"{c}{mark}": states[field][:, i] for i, c in enumerate(model.coordinates)}
    numbers = NumericTree(*ours)
    require_same({name: numbers.evaluate(values, [name])[name] for name in QUANTITIES}, answers(model, 1))


def test_the_potential_is_that_of_the_forces() -> None:
    """dV/dq by differences of fourth order."""
    model = couple(*tree_of(definition_of(3, CONSERVATIVE)))
    q, h = np.array([0.3, -0.4, 0.6]), 1e-3

    def energy(x: np.ndarray) -> float:
        return float(evaluate(model, "potential_energy", q=x, inputs={"x.u": 0.4})["potential_energy"])

    Q = evaluate(model, "forces", q=q, inputs={"x.u": 0.4})["forces"]
    for a, e in enumerate(h * np.eye(3)):
        slope = (8 * (energy(q + e) - energy(q - e)) - energy(q + 2 * e) + energy(q - 2 * e)) / (12 * h)
        assert slope == pytest.approx(-Q[a], abs=1e-8)


def test_reactions_are_those_of_the_same_loads_of_a_tree() -> None:
    found = []
    for spec, parts in (tree_of(definition_of(5, LOADS), hosted=True), tree_of(definition_of(5, []), LOADS, True)):
        model, transmitted = couple(spec, parts), reactions(spec, parts)
        sources = Sources(model, of_parts=lambda _, given=transmitted: given)
        state = {name: x[0] for name, x in random_states(np.random.default_rng(2), 1, model.dof).items()}
        found.append(evaluate(sources, ["reactions"], inputs={"x.u": 0.6}, t=0.8, **state)["reactions"])
    for field in ("force", "moment", "force_world", "moment_world"):
        assert np.allclose(found[0][field], found[1][field], rtol=0, atol=1e-10), field


def test_a_module_has_the_loads_of_its_tree() -> None:
    """Loads of the parts and of the tree, between parts, become loads of one part."""
    other = {"type": "bushing", "name": "o", "from": "x.tip", "to": "y.tip", "angular_stiffness": ["x.k", 1, 2]}
    measured = {"type": "potential", "name": "m", "potential": "y.k*distance(x.tip, y.b2)^3*cos(y.q1)"}
    spec, parts = tree_of(definition_of(6, LOADS), hosted=True)
    plain = spec.model_dump(exclude_defaults=True, by_alias=True)
    seat = {"name": "y", "substructure": "part", "at": "x.tip", "placement": {"position": [0.1, 0.2, 0]}}
    tree = TreeSpec.read({**plain, "instances": [*plain["instances"], seat], "loads": [other, measured]})
    parts["y"] = parts["x"]
    model, module = couple(tree, parts), published(tree, parts, Publication({"name": "module"}))
    part = published_part(module, parts)
    alone = couple(
        TreeSpec.read(
            {"name": "s", "gravity": plain["gravity"], "instances": [{"name": "m", "substructure": "module"}]}
        ),
        {"m": part},
    )
    assert [f"m.{module.names[name]}" for name in model.coordinates] == list(alone.coordinates)
    states = random_states(np.random.default_rng(7), 3, model.dof)
    inputs = {"x.u": 0.3, "y.u": -0.4}
    ours = evaluate(model, QUANTITIES, **states, inputs=inputs, t=0.2)
    moved = {f"m.{module.names[name]}": x for name, x in inputs.items()}
    require_same(
        {x: evaluate(alone, x, **states, inputs=moved, t=0.2)[x] for x in QUANTITIES}, {x: ours[x] for x in QUANTITIES}
    )


def test_angles_of_a_common_axis() -> None:
    """Two parallel hinges: q1 + q2 and its rate, turned by a port."""
    hinge = {"type": "revolute"}
    bodies = [
        {"name": "a", "parent": "base", "joint": {**hinge, "coordinate": "q1"}, "mass": 1, "com": [0.3, 0, 0]},
        {"name": "b", "parent": "a", "joint": {**hinge, "coordinate": "q2", "d": 1}, "mass": 1, "com": [0.3, 0, 0]},
    ]
    port = {"name": "p", "body": "b", "rotation": {"rpy": [0, 0, 0.5]}}
    loads = [
        {"type": "joint", "coordinate": "q1", "force": "angle(base, p) + 10*angle'(a, base)"},
        {"type": "potential", "potential": "angle(p, base)^2/2"},
    ]
    definition = {"name": "part", "bodies": bodies, "ports": [port], "loads": loads}
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "part"}]})
    found = evaluate(couple(spec, {"x": derive(Definition.read(definition))}), "forces", q=[0.3, 0.4], qd=[0.6, 0.7])
    # V = (q1 + q2 + 0.5)^2/2
    assert found["forces"] == pytest.approx([1.2 - 6 - 1.2, -1.2], abs=1e-14)


SLIDE: Plain = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}
LAW: Plain = {"coulomb": "F", "static": 3, "stribeck": 0.1, "velocity": {"value": 1, "unit": "mm/s"}}


def block(where: str) -> tuple[TreeSpec, dict[str, Part]]:
    """A block on an incline, with its friction in the joint, as a load of the part, or of the tree."""
    joint = SLIDE["joint"] | ({"friction": LAW} if where == "joint" else {})
    definition = {
        "name": "block",
        "parameters": {"F": {"value": 2.5, "unit": "N"}},
        "bodies": [{**SLIDE, "joint": joint}],
    }
    tree: Plain = {"name": "t", "gravity": [0, 0, -2], "instances": [{"name": "a", "substructure": "block"}]}
    if where == "part":
        definition["loads"] = [{"type": "friction", "coordinate": "x", **LAW}]
    if where == "tree":
        tree["loads"] = [{"name": "f", "type": "friction", "coordinate": "a.x", **LAW, "coulomb": "a.F"}]
    return TreeSpec.read(tree), {"a": derive(Definition.read(definition))}


def test_friction_is_the_same_wherever_it_is_given() -> None:
    """Forces, and exact sticking: 1 m/s against 2 N and friction, which then holds with 2 N."""
    found = []
    for where in ("joint", "part", "tree"):
        model = couple(*block(where))
        assert "friction" in model.program.outputs
        forces = evaluate(model, "forces", q=[[0.0]] * 3, qd=[[-0.2], [1e-4], [0.3]])["forces"]
        motion = simulated(model, q=[0], qd=[1], span=(0, 1), friction="exact")
        assert motion.is_right, motion.checks
        assert motion.series["friction"][-1] == pytest.approx([2.0], abs=1e-12)
        found.append((forces, motion.q))
    for forces, q in found[1:]:
        assert np.array_equal(forces, found[0][0])
        assert np.allclose(q, found[0][1], rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("change", "code", "place", "said"),
    [
        ({"coordinate": "a.y"}, "unknown-coordinate", "/loads/0/coordinate", "there are a.x"),
        ({"coulomb": -1}, "bad-friction", "/loads/0/coulomb", "not negative"),
        ({"velocity": 0}, "bad-friction", "/loads/0/velocity", "positive"),
        ({"coulomb": "2*a.x"}, "unknown-name", "/loads/0/coulomb", "a.x"),
        ({"velocity": {"value": 1, "unit": "rad/s"}}, "unit-mismatch", "/loads/0/velocity", "rad/s"),
    ],
)
def test_friction_of_a_tree_that_is_wrong(change: Plain, code: str, place: str, said: str) -> None:
    spec, parts = block("tree")
    plain = spec.model_dump(exclude_defaults=True, by_alias=True)
    wrong = TreeSpec.read({**plain, "loads": [{**plain["loads"][0], **change}]})
    with pytest.raises(InvalidDocument) as raised:
        couple(wrong, parts)
    assert [(f.code, f.pointer, said in f.message) for f in raised.value.faults] == [(code, place, True)]


@pytest.mark.parametrize("where", ["joint", "part", "tree"])
def test_a_coordinate_has_one_friction(where: str) -> None:
    spec, parts = block(where)
    plain = spec.model_dump(exclude_defaults=True, by_alias=True)
    more = {"name": "g", "type": "friction", "coordinate": "a.x", "coulomb": 1, "velocity": 1}
    with pytest.raises(InvalidDocument) as raised:
        couple(TreeSpec.read({**plain, "loads": [*plain.get("loads", ()), more]}), parts)
    (fault,) = raised.value.faults
    assert (fault.code, fault.pointer) == ("several-frictions", f"/loads/{int(where == 'tree')}/coordinate")


def test_springs_and_bushings_of_a_part_are_drawn() -> None:
    bushing = {"type": "bushing", "from": "x.b1", "to": "x.tip", "stiffness": [1, 1, 1]}
    spec, parts = tree_of(definition_of(0, [bushing]))
    without, bare = tree_of(definition_of(0, []))
    drawn, empty = picture(spec, parts, couple(spec, parts)), picture(without, bare, couple(without, bare))
    assert drawn.count("<polyline") == empty.count("<polyline") + 1
