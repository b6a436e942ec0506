"""Joints that move with others: against the unreduced model, another engine and closed forms; faults that are found."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from damaged import found_in_part, require_all_found
from in_depth import seeds
from independent import by_coordinate
from random_trees import GRAVITY, Kind, model_of, random_definition, random_states, tree_of, with_parameters
from related import joints_of, reduction, with_relations

from substructures import Definition, EvaluationOptions, InvalidDocument, TreeSpec, couple, derive, evaluate
from substructures.expr.interpret import interpret
from substructures.formats.packing import unpack
from substructures.quantities.centroidal import centroidal
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions
from substructures.quantities.regressor import regressor
from substructures.tree.plausibility import Plausibility
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

Plain = dict[str, Any]
TOLERANCE = 1e-10
GEARS: Plain = {
    "name": "gears",
    "parameters": {"J": {"value": 0.3, "unit": "kg m^2"}, "k": {"value": -2}},
    "bodies": [
        {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "a", "damping": 0.5},
         "inertia": {"xx": "J", "yy": "J", "zz": "J"}},
        {"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "b", "armature": 0.1,
         "damping": 1.5, "stiffness": 4, "rest": 0.25, "limits": [-1, 3]}, "inertia": {"xx": 2, "yy": 2, "zz": 2}},
    ],
    "relations": [{"coordinate": "b", "of": "a", "multiplier": "k", "offset": 0.5}],
    "loads": [{"type": "joint", "coordinate": "b", "force": "3*b'"}],
}  # fmt: skip


def deviation(found: Any, expected: Any) -> float:
    assert np.isfinite(found).all()
    return float(np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), 1e-2))


def random_related(seed: int, loads: int) -> tuple[Plain, np.random.Generator]:
    rng = np.random.default_rng(seed)
    kind = Kind(int(rng.integers(2, 6)), bool(rng.integers(2)), loads=loads, springs=loads // 2, depth=7)
    definition = random_definition(rng, kind)
    while len(joints_of(definition)) < 2:
        definition = random_definition(rng, kind)
    return with_relations(rng, definition, int(rng.integers(1, len(joints_of(definition))))), rng


@pytest.mark.parametrize("seed", seeds(8, 60))
def test_reduced_is_the_unreduced_model_on_the_relations(seed: int) -> None:
    """M* = N^T M N, Gamma* = N N N Gamma, Q* = N^T Q."""
    definition, rng = random_related(seed, 4)
    model = model_of(with_parameters(rng, definition, 0.3) if seed % 3 == 0 else definition)
    whole = model_of({**definition, "relations": []})
    left, order = ([c.removeprefix("x.") for c in m.coordinates] for m in (model, whole))
    N, q0 = reduction(definition, order, left)
    states = random_states(rng, 2, model.dof)
    names = ["metric", "christoffel", "gravity", "forces", "bias", "inverse_dynamics", "potential_energy", "kinematics"]
    inputs = {"x.u1": 0.3, "x.u2": -0.7}
    found = evaluate(model, names, **states, t=0.2, inputs=inputs)
    full = {"q": states["q"] @ N.T + q0, "qd": states["qd"] @ N.T, "qdd": states["qdd"] @ N.T}
    other = evaluate(whole, names, **full, t=0.2, inputs=inputs)
    for i in range(2):
        expected = {
            "metric": N.T @ other["metric"][i] @ N,
            "christoffel": np.einsum("abc,ai,bj,ck->ijk", other["christoffel"][i], N, N, N),
            **{name: N.T @ other[name][i] for name in ("gravity", "forces", "bias", "inverse_dynamics")},
        }
        for name, x in expected.items():
            assert deviation(found[name][i], x) < TOLERANCE, name
        assert deviation(found["kinematics"]["position"][i], other["kinematics"]["position"][i]) < TOLERANCE


@pytest.mark.parametrize("seed", seeds(8, 100))
def test_random_mechanisms_against_pinocchio(seed: int) -> None:
    definition, rng = random_related(1000 + seed, 0)
    model = model_of(definition)
    engine, order = engine_of(definition, GRAVITY), list(joints_of(definition))
    place = engine.order(order)
    N, q0 = reduction(definition, order, [c.removeprefix("x.") for c in model.coordinates])
    states = random_states(rng, 1, model.dof)
    found = evaluate(model, ["metric", "bias", "gravity"], **states)
    q, v = np.zeros(len(order)), np.zeros(len(order))
    q[place], v[place] = N @ states["q"][0] + q0, N @ states["qd"][0]
    data = engine.model.createData()
    M = np.triu(pin.crba(engine.model, data, q))
    M = (M + np.triu(M, 1).T)[np.ix_(place, place)] + np.diag(by_coordinate(definition, "armature", order))
    C = pin.computeCoriolisMatrix(engine.model, data, q, v).copy()[np.ix_(place, place)]
    grav = pin.computeGeneralizedGravity(engine.model, data, q).copy()[place]
    assert deviation(found["metric"][0], N.T @ M @ N) < TOLERANCE
    assert deviation(found["bias"][0], N.T @ C @ v[place]) < TOLERANCE
    assert deviation(found["gravity"][0], -N.T @ grav) < TOLERANCE


def test_a_pair_of_gears_by_hand() -> None:
    """(J + k^2 (J_b + armature)) a'' = tau - (d_a + k^2 d_b) a' - k c (k a + delta - rest) + 3 k^2 a'."""
    part = derive(GEARS)
    assert (part.coordinates, part.joints, part.dof) == (("a",), "R", 1)
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}]}
    model = couple(tree, {"x": part})
    assert model.coordinates == ("x.a",)
    found = evaluate(model, ["metric", "forces", "bias", "potential_energy", "limits"], q=[0.3], qd=[0.7])
    k = -2
    assert found["metric"][0, 0] == pytest.approx(0.3 + k**2 * 2.1)
    b, rate = k * 0.3 + 0.5, k * 0.7
    assert found["forces"][0] == pytest.approx(-0.5 * 0.7 + k * (-1.5 * rate - 4 * (b - 0.25) + 3 * rate))
    assert found["bias"][0] == 0
    assert found["potential_energy"] == pytest.approx(0.5 * 4 * (b - 0.25) ** 2)
    # -1 <= -2 a + 0.5 <= 3
    assert found["limits"][0] == pytest.approx([-1.25, 0.75])


def test_a_screw_by_hand() -> None:
    """A nut of mass m on a screw of lead h: J + m mu^2 with mu = h / 2 pi, and m g mu of torque."""
    screw = {
        "name": "screw",
        "bodies": [
            {"name": "s", "parent": "base", "joint": {"type": "revolute", "coordinate": "turn"},
             "inertia": {"xx": 0.02, "yy": 0.02, "zz": 0.02}},
            {"name": "nut", "parent": "base", "joint": {"type": "prismatic", "coordinate": "rise"}, "mass": 3},
        ],
        "relations": [{"coordinate": "rise", "of": "turn", "multiplier": {"value": "5/(2*pi)", "unit": "mm/rad"},
                       "offset": {"value": 10, "unit": "cm"}}],
    }  # fmt: skip
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "screw"}]}
    model = couple(tree, {"x": derive(screw)})
    found = evaluate(model, ["metric", "gravity", "kinematics"], q=[2.0])
    mu = 5e-3 / (2 * np.pi)
    assert found["metric"][0, 0] == pytest.approx(0.02 + 3 * mu**2, rel=1e-12)
    assert found["gravity"][0] == pytest.approx(-3 * 9.81 * mu, rel=1e-12)
    assert found["kinematics"]["position"][list(model.frames).index("x.nut"), 2] == pytest.approx(0.1 + 2 * mu)


def chain(seed: int) -> tuple[Plain, dict[str, Any]]:
    """Two parts with relations and one without, mounted on each other."""
    first, _ = random_related(seed, 2)
    second, _ = random_related(seed + 1, 0)
    parts = {"a": {**first, "name": "first"}, "b": {**second, "name": "second"}, "c": {**second, "name": "second"}}
    derived = {name: derive(Definition.read(each)) for name, each in parts.items()}
    at = {"b": f"a.{derived['a'].bodies[-1]}", "c": f"b.{derived['b'].bodies[-1]}"}
    instances = [
        {"name": name, "substructure": part.name, "at": at.get(name, "world"), "placement": {"rpy": [0.1, 0.2, 0.3]}}
        for name, part in derived.items()
    ]
    return {"name": "chain", "gravity": ["0.3", 0, "-9.81"], "instances": instances}, derived


@pytest.mark.parametrize("seed", seeds(2, 12))
def test_a_tree_of_parts_gives_what_its_quantities_and_numbers_do(seed: int) -> None:
    """Powers, momentum, regressor and reactions are certified from the documents."""
    tree, parts = chain(20 * seed)
    spec, model = TreeSpec.read(tree), couple(tree, parts)
    for quantity in (powers, centroidal, regressor, reactions):
        assert len(quantity(spec, parts).program)
    rng = np.random.default_rng(seed)
    values = {s.name: rng.uniform(-1, 1) for s in model.program.symbols}
    names = ["metric", "christoffel", "gravity", "forces", "bias", "inverse_dynamics"]
    found = NumericTree(spec, parts).evaluate(values, names)
    expected = interpret(model.program, values, names)
    for name in names:
        assert deviation(found[name], expected[name]) < 1e-12, name
    Y = regressor(spec, parts)
    rows = Y.evaluate(*(rng.uniform(-1, 1, model.dof) for _ in range(3)))
    assert rows["regressor"].shape[0] == model.dof


def test_planted_faults_are_found() -> None:
    definition, _ = random_related(5, 2)
    part, spec = derive(Definition.read(definition)), tree_of(definition)
    require_all_found(part, spec, couple(spec, {"x": part}))


def test_a_wrong_ratio_in_the_definition_is_found() -> None:
    right = derive(GEARS)
    other = {**GEARS, "relations": [{"coordinate": "b", "of": "a", "multiplier": "k", "offset": 0.6}]}
    assert found_in_part(replace(right, definition=Definition.read(other)), right.program)


@pytest.mark.parametrize(
    ("name", "force"),
    [
        ("e3", "2e3*e3 + e3'"),
        ("table", "table*table(table; 0: 1, 1: 2)"),
        ("smooth", "table(smooth; 0: 1, 1: 2, 2: 5; smooth)"),
        ("a", "a*distance (base, a)"),
    ],
)
def test_laws_name_related_joints_as_numbers_and_functions_are_written(name: str, force: str) -> None:
    joint = {"type": "prismatic", "coordinate": "q"}
    bodies = [{"name": "a", "parent": "base", "mass": 1, "joint": joint}]
    bodies.append({"name": "b", "parent": "a", "mass": 1, "joint": {**joint, "coordinate": name, "theta": 0.3}})
    loads = [{"type": "joint", "coordinate": "q", "force": force}]
    relations = [{"coordinate": name, "of": "q", "multiplier": 2, "offset": 0.1}]
    assert derive({"name": "x", "bodies": bodies, "relations": relations, "loads": loads}).coordinates == ("q",)


def test_a_long_chain_of_relations_has_laws() -> None:
    joint = {"type": "prismatic", "theta": 0.1}
    bodies: list[Plain] = [
        {"name": f"b{k}", "parent": "base", "mass": 1, "joint": {**joint, "coordinate": f"q{k}"}} for k in range(66)
    ]
    bodies[-1]["joint"]["stiffness"] = "1 + q65^2"
    relations = [{"coordinate": f"q{k}", "of": f"q{k - 1}", "multiplier": -1.5, "offset": 1} for k in range(1, 66)]
    loads = [{"type": "joint", "coordinate": "q65", "force": "-q65 - q65'"}]
    assert derive({"name": "x", "bodies": bodies, "relations": relations, "loads": loads}).coordinates == ("q0",)


@pytest.mark.parametrize("multiplier", [0, "0*k", "sin(pi)"])
def test_limits_and_friction_of_a_joint_that_is_held_bind_nothing(multiplier: Any) -> None:
    bodies = [{**body, "joint": {**body["joint"], "friction": None}} for body in GEARS["bodies"]]
    bodies[1]["joint"]["friction"] = {"coulomb": 0.4, "velocity": 0.02}
    held = {**GEARS, "bodies": bodies, "relations": [{"coordinate": "b", "of": "a", "multiplier": multiplier}]}
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}]}
    model = couple(tree, {"x": derive(held)})
    assert model.limited == ()
    assert not {"limits", "friction"} & model.program.outputs.keys()


@pytest.mark.parametrize(
    ("relations", "pointer", "code"),
    [
        ([{"coordinate": "c", "of": "a"}], "/relations/0/coordinate", "unknown-coordinate"),
        ([{"coordinate": "b", "of": "A"}], "/relations/0/of", "unknown-coordinate"),
        ([{"coordinate": "b", "of": "b"}], "/relations/0/of", "cycle"),
        ([{"coordinate": "b", "of": "a"}, {"coordinate": "a", "of": "b"}], "/relations/1/of", "cycle"),
        ([{"coordinate": "b", "of": "a"}] * 2, "/relations/1/coordinate", "several-relations"),
        ([{"coordinate": "b", "of": "a", "multiplier": "a"}], "/relations/0/multiplier", "unknown-name"),
        (
            [{"coordinate": "b", "of": "a", "multiplier": {"value": 1, "unit": "m/rad"}}],
            "/relations/0/multiplier",
            "unit",
        ),
        ([{"coordinate": "b", "of": "a", "offset": {"value": 1, "unit": "m"}}], "/relations/0/offset", "unit"),
    ],
)
def test_what_is_no_relation(relations: list[Plain], pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        derive({**GEARS, "relations": relations})
    (fault, *_) = caught.value.faults
    assert fault.pointer == pointer
    assert code in fault.code


def test_friction_of_related_joints_is_one_law_of_the_coordinate() -> None:
    law = {"coulomb": 0.4, "velocity": 0.02}
    bodies = [{**body, "joint": {**body["joint"], "friction": law}} for body in GEARS["bodies"]]
    bodies[1]["joint"]["friction"] = {"coulomb": 0.3, "velocity": 0.04}
    gears = {**GEARS, "relations": [{"coordinate": "b", "of": "a", "multiplier": -2}]}
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}]}
    model = couple(tree, {"x": derive({**gears, "bodies": bodies})})
    found = evaluate(model, ["friction"], q=[0.3])["friction"][0]
    # of b: 0.3 |k| at rates of 0.04 / |k|
    assert found == pytest.approx([0.4 + 0.6, 0.4 + 0.6, 0, 0.02])
    bodies[1]["joint"]["friction"] = {"coulomb": 0.3, "velocity": 0.05}
    with pytest.raises(InvalidDocument, match="no law of one velocity"):
        couple(tree, {"x": derive({**gears, "bodies": bodies})})


def test_packed_christoffel_symbols_of_relations() -> None:
    definition, rng = random_related(3, 0)
    model = model_of(definition)
    q = rng.uniform(-1, 1, (2, model.dof))
    dense, packed = (
        evaluate(model, ["christoffel"], q=q, options=EvaluationOptions(packed=x))["christoffel"] for x in (False, True)
    )
    assert packed.shape == (2, model.dof**2 * (model.dof + 1) // 2)
    assert np.array_equal(unpack("christoffel", packed, model.dof), dense)


def test_stored_formulas_are_called_after_bodies_and_coordinates() -> None:
    """f is of the coordinate, E of the joint: b moves with a, and c has a coordinate of its own."""
    joint = {"type": "revolute", "theta": 0.5, "d": 0.2}
    bodies = [
        {"name": name, "parent": parent, "joint": {**joint, "coordinate": f"q{name}"}, "mass": 1, "com": [0.1, 0, 0.2]}
        for name, parent in (("a", "base"), ("b", "a"), ("c", "b"))
    ]
    part = derive({"name": "x", "bodies": bodies, "relations": [{"coordinate": "qa", "of": "qb"}]})
    found = {(f.output, f.index): (f.body, f.coordinate) for f in part.formulas()}
    assert part.coordinates == ("qb", "qc")
    assert found["E", (2,)] == ("c", None)
    assert found["f", (0,)] == ("b", None)
    assert found["f", (1,)] == ("c", None)
    assert found["U", (2, 0)] == ("c", "qb")
    assert found["N", (0, 1)] == ("c", "qb")


def test_published_trees_keep_their_relations() -> None:
    """The part that a tree becomes is what the tree is, and has its coordinates."""
    tree, parts = chain(60)
    spec, model = TreeSpec.read(tree), couple(tree, parts)
    found = published(spec, parts, Publication({"name": "whole"}))
    whole = published_part(found, parts)
    assert whole.dof == model.dof
    alone = {"name": "t", "gravity": ["0.3", 0, "-9.81"], "instances": [{"name": "x", "substructure": "whole"}]}
    other = couple(alone, {"x": whole})
    states = random_states(np.random.default_rng(1), 2, model.dof)
    mine, its = (evaluate(each, ["metric", "bias", "gravity"], **states) for each in (model, other))
    for name in ("metric", "bias", "gravity"):
        assert deviation(its[name], mine[name]) < TOLERANCE, name


def test_limits_of_what_moves_are_limits_of_the_coordinate() -> None:
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}]}
    spec, part = TreeSpec.read(tree), derive(GEARS)
    model = couple(spec, {"x": part})
    assert model.limited == ("x.a",)
    low, high, unit = Plausibility(spec, {"x": part.definition}).limits({"x.k": np.array([-2.0, 0.5, 0.0])})["x.a"]
    assert np.allclose(low, [-1.25, -3, -np.inf])
    assert np.allclose(high, [0.75, 5, np.inf])
    assert unit == "rad"
    assert evaluate(model, ["metric"], q=[[0.9]]).warnings


def test_a_torque_that_follows_a_moved_joint_has_a_potential() -> None:
    """About a fixed axis, 2 b with b = -2 a + 0.5: V = -int 2 b da, which is zero where a is."""
    load = {"type": "torque", "body": "a", "vector": [0, 0, "2*b"], "frame": "world"}
    gears = {**GEARS, "loads": [load], "relations": [{"coordinate": "b", "of": "a", "multiplier": -2, "offset": 0.5}]}
    for body in (bodies := [{**body, "joint": {**body["joint"], "stiffness": 0}} for body in GEARS["bodies"]]):
        body["joint"].pop("rest", None)
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}]}
    model = couple(tree, {"x": derive({**gears, "bodies": bodies})})
    found = evaluate(model, ["forces", "potential_energy"], q=[0.3])
    assert found["forces"] == pytest.approx([2 * (-2 * 0.3 + 0.5)])
    assert found["potential_energy"] == pytest.approx(2 * 0.3**2 - 0.3)
    assert "potential_left_out" not in model.certificate["direct_form"]


def test_a_joint_that_moves_has_no_name_in_trees() -> None:
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "gears"}],
            "loads": [{"name": "f", "type": "joint", "coordinate": "x.b", "force": 1}]}  # fmt: skip
    with pytest.raises(InvalidDocument, match=r"unknown coordinate 'x\.b'"):
        couple(tree, {"x": derive(GEARS)})
