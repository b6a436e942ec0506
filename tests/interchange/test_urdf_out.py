"""URDF files that are written: in Pinocchio they have our metric, gravity and bias; read again they are the same."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Tree

import numpy as np
import pytest
from ball_trees import random_balls, random_position
from catalogue_entries import CHAINS, open_entry, shipped_part
from in_depth import seeds
from related import reduction

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.errors import InvalidDocument, MissingValue
from substructures.export.robots import file_of_part, file_of_tree
from substructures.expr.bind import bind
from substructures.expr.program import Program
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side
from substructures.part.part import Part
from substructures.part.topology import topology
from substructures.quantities.numbers.evaluation import evaluate

sys.path.insert(0, str(Path(__file__).parent))
from engines import Reduced, euler_matrix, euler_rates, quaternion
from package_files import included, mjcf_files, urdf_files

FILES = {**urdf_files(), **mjcf_files()}
GRAVITY = (0.3, -0.4, -9.81)
#: of each kind of joint and placement one
SAMPLE = ("puma560", "scara", "free-body", "ball-pendulum", "drive-train", "slider-crank", "kuka-iiwa-14", "gantry")
#: what has loads, springs or rotors and is said to be left out
WITH_REMARKS = {"puma560": "the armature", "mass-spring-chain": "the spring", "quadrotor": "load 0 of"}


def numbers_of(parameters: Any) -> Any:
    """Puts defaults in place of parameters."""

    def numbers(program: Program) -> Program:
        used = {symbol.name for symbol in program.symbols}
        values = {n: p["value"] for n, p in parameters.items() if p.get("value") is not None and n in used}
        return bind(program, values) if values else program

    return numbers


def urdf_of(part: Part) -> bytes:
    return file_of_part("urdf", part, "robot", f"{part.name}@1", part.definition.digest, numbers_of(part.parameters))


def bare(name: str) -> Part:
    """A shipped part without what URDF cannot say."""
    plain = open_entry(name)
    for body in plain["bodies"]:
        for law in ("stiffness", "rest", "armature", "limits_act"):
            body["joint"].pop(law, None)
    return derive(Definition.read({**plain, "loads": []}))


def at_world(part: Part) -> Model:
    instance = {"name": "x", "substructure": part.name}
    return couple(TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": [instance]}), {"x": part})


def worst_in_pinocchio(data: bytes, model: Model, coordinates: list[str], path: Path) -> float:
    """The largest relative deviation of metric, gravity and bias (there a difference of forces) at random states."""
    pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
    from with_pinocchio import PinocchioTwin  # noqa: PLC0415 -- beside this file

    path.write_bytes(data)
    joints = Tree.fromstring(data).iterfind("joint[mimic]")  # noqa: S314 -- our own
    followers = {joint.get("name"): joint.find("mimic") for joint in joints}
    relations = [
        {"coordinate": name, "of": mimic.get("joint"), **{x: float(mimic.get(x)) for x in ("multiplier", "offset")}}
        for name, mimic in followers.items()
    ]
    order = [*coordinates, *followers]
    engine = PinocchioTwin(path, {f"joint {c}": c for c in order}, order, np.array(GRAVITY))
    assert engine.model.nv == len(order) == model.dof + len(relations)
    # Pinocchio moves followers by themselves
    twin = Reduced(engine, *reduction({"relations": relations}, order, coordinates))
    q, qd, qdd = np.random.default_rng(3).uniform(-1.2, 1.2, (3, 2, model.dof))
    names = ("metric", "gravity", "bias", "inverse_dynamics")
    found, worst = evaluate(model, names, q, qd, qdd), 0.0
    for i in range(2):
        theirs = twin.numbers(q[i], qd[i], qdd[i])
        forces = np.abs(theirs.inverse_dynamics).max(initial=1e-6)
        for name in names:
            expected = getattr(theirs, name)
            scale = np.abs(expected).max(initial=1e-6) if name == "metric" else forces
            worst = max(worst, float(np.abs(found[name][i] - expected).max(initial=0) / scale))
    return worst


@pytest.mark.parametrize("name", SAMPLE)
def test_pinocchio_has_the_same_numbers(name: str, tmp_path: Path) -> None:
    part = bare(name)
    assert worst_in_pinocchio(urdf_of(part), at_world(part), list(part.coordinates), tmp_path / "a.urdf") < 1e-12


def test_tensors_about_the_origin_and_offsets_of_joints(tmp_path: Path) -> None:
    six = {"xx": 0.5, "yy": 0.7, "zz": 0.6, "xy": 0.02, "xz": -0.03, "yz": 0.01, "about": "origin"}
    rows = (
        {"type": "revolute", "psi": 0.3, "theta": 0.7, "d": 0.2, "sigma": 0.1, "phi": 0.4, "tau": -0.3},
        {"type": "prismatic", "psi": -0.5, "theta": 1.1, "d": 0.1, "sigma": 0.2, "phi": 0.6, "tau": 0.25},
        {"type": "revolute", "placement": {"position": [0, 0.1, 0.2], "rpy": [0.1, 0.2, 0.3]}, "axis": [1, -2, 3]},
    )
    bodies = [
        {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": row, "mass": 3, "com": [0.1, -0.2, 0.15],
         "inertia": six} for k, row in enumerate(rows)
    ]  # fmt: skip
    part = derive(Definition.read({"name": "rows", "bodies": bodies}))
    assert worst_in_pinocchio(urdf_of(part), at_world(part), list(part.coordinates), tmp_path / "a.urdf") < 1e-12


def test_relations_are_mimic_joints() -> None:
    """Read again it is the same mechanism: chains are written as followers of the joint that leads."""
    bodies = [
        {"name": name, "parent": parent, "joint": {"type": kind, "coordinate": f"q{name}", "theta": 0.3, "d": 0.2},
         "mass": 2, "com": [0.1, 0.2, 0.3], "inertia": {"xx": 0.1, "yy": 0.12, "zz": 0.15}}
        for name, parent, kind in (("a", "base", "revolute"), ("b", "a", "prismatic"), ("c", "b", "revolute"))
    ]  # fmt: skip
    relations = [
        {"coordinate": "qa", "of": "qc", "multiplier": "r", "offset": 0.5},
        {"coordinate": "qb", "of": "qa", "multiplier": -0.25, "offset": 0.1},
    ]
    parameters = {"r": {"value": 2}}
    part = derive(Definition.read({"name": "x", "bodies": bodies, "relations": relations, "parameters": parameters}))
    data = urdf_of(part)
    assert b'<mimic joint="qc" multiplier="2" offset="0.5" />' in data
    assert b'<mimic joint="qc" multiplier="-0.5" offset="-0.025" />' in data
    again = derive(Definition.read(import_file(data).definition))
    assert again.coordinates == part.coordinates == ("qc",)
    states = {name: [[0.3], [-0.8]] for name in ("q", "qd", "qdd")}
    mine, its = (evaluate(at_world(each), ["metric", "inverse_dynamics"], **states) for each in (part, again))
    for name in ("metric", "inverse_dynamics"):
        assert its[name] == pytest.approx(mine[name], rel=1e-10)


@pytest.mark.parametrize("name", ["positioner", "scara"])
def test_read_again_they_are_the_same(name: str) -> None:
    """The bias of the positioner vanishes, but for rounding in what is read."""
    part = bare(name)
    again = derive(Definition.read(import_file(urdf_of(part)).definition))
    assert equivalence(Side.of_part(part), Side.of_part(again)).equal


@pytest.mark.deep
@pytest.mark.parametrize("name", CHAINS)
def test_pinocchio_has_the_same_numbers_of_all_shipped_parts(name: str, tmp_path: Path) -> None:
    part = bare(name)
    assert worst_in_pinocchio(urdf_of(part), at_world(part), list(part.coordinates), tmp_path / "a.urdf") < 1e-12
    again = derive(Definition.read(import_file(urdf_of(part)).definition))
    assert equivalence(Side.of_part(part), Side.of_part(again)).equal


@pytest.mark.deep
@pytest.mark.parametrize("name", FILES)
def test_files_of_others_come_back(name: str) -> None:
    """Robots of up to 14 coordinates, out and in again, but for what the file says is left out."""
    path = FILES[name]
    try:
        found = import_file(path.read_bytes(), included=included(path))
    except InvalidDocument:
        pytest.skip("it is refused")
    definition = Definition.read(found.definition)
    if len(topology(definition).coordinates) > 14:
        pytest.skip("the comparison takes long")
    part = derive(definition)
    data = urdf_of(part)
    again = derive(Definition.read(import_file(data).definition))
    same = equivalence(Side.of_part(part), Side.of_part(again))
    assert same.equal or b"left out, as URDF cannot say it" in data


def test_what_cannot_be_said_is_told() -> None:
    for name, remark in WITH_REMARKS.items():
        text = urdf_of(shipped_part(name)).decode()
        assert f"<!-- {remark}" in text, name


def two_arms() -> tuple[TreeSpec, dict[str, Part]]:
    parts = {name: bare(name) for name in ("acrobot", "scara")}
    instances = [
        {"name": "b", "substructure": "scara", "at": "a.tip", "parameters": {"m1": "2*a.m1"},
         "placement": {"position": [0.1, 0, "h"], "rpy": [0.3, 0, 1]}},
        {"name": "a", "substructure": "acrobot", "placement": {"position": [0, 0, 1]}, "parameters": {"l1": 0.7}},
    ]  # fmt: skip
    plain = {"name": "two", "gravity": list(GRAVITY), "parameters": {"h": {"value": "0.25"}}, "instances": instances}
    return TreeSpec.read(plain), {"a": parts["acrobot"], "b": parts["scara"]}


def test_a_tree_is_one_file(tmp_path: Path) -> None:
    """Hosts behind what they carry, placements and bindings with parameters of the tree, a number for one of them."""
    spec, parts = two_arms()
    model = couple(spec, parts)
    data = file_of_tree(
        "urdf", spec, parts, "two", "two@1", spec.digest, numbers_of({**model.parameters, "h": {"value": "0.4"}})
    )
    again = bound_tree(spec, parts)
    assert worst_in_pinocchio(data, again, list(model.coordinates), tmp_path / "a.urdf") < 1e-12


def bound_tree(spec: TreeSpec, parts: dict[str, Part]) -> Model:
    plain = spec.model_dump(exclude_defaults=True, by_alias=True)
    return couple(TreeSpec.read({**plain, "parameters": {"h": {"value": "0.4"}}}), parts)


def test_loops_and_loads_of_trees_are_told() -> None:
    spec, parts = two_arms()
    plain = spec.model_dump(exclude_defaults=True, by_alias=True)
    plain["closures"] = [{"name": "rod", "type": "rod", "from": "b.flange", "length": 1}]
    plain["loads"] = [{"name": "cable", "type": "spring", "to": "b.flange", "stiffness": 1}]
    told = couple(TreeSpec.read(plain), parts)
    text = file_of_tree("urdf", TreeSpec.read(plain), parts, "two", "two", "", numbers_of(told.parameters)).decode()
    assert "the closure 'rod' (rod): URDF has no loops" in text
    assert "the load 'cable' (spring)" in text


def test_a_parameter_without_a_number_is_named() -> None:
    plain = catalogue.load("simple-pendulum")
    (name, *_) = plain["parameters"]
    plain["parameters"][name] = {}
    with pytest.raises(MissingValue, match=name):
        urdf_of(derive(Definition.read(plain)))


def test_names_and_titles_cannot_leave_their_places() -> None:
    """A reference with what ends a comment; links that compound joints need avoid names that there are."""
    plain = catalogue.load("free-body")
    body = plain["bodies"][0]["name"]
    plain["ports"] = [{"name": f"{body}_1", "body": body}]
    part = derive(Definition.read(plain))
    data = file_of_part("urdf", part, "robot", "a--><evil/>---@1", "sha256:0", numbers_of(part.parameters))
    root = Tree.fromstring(data)  # noqa: S314 -- our own
    assert {child.tag for child in root} == {"link", "joint"}
    names = [child.attrib["name"] for child in root if child.tag == "link"]
    assert len(names) == len(set(names))
    assert import_file(data).report is not None


@pytest.mark.parametrize("seed", seeds([7], 30))
def test_floating_joints_come_back_as_such_and_balls_as_yaw_pitch_roll(seed: int) -> None:
    """With v = T q' of the angles, the metric read again is T^T g T, and gravity T^T Q."""
    definition, rng = random_balls(seed)
    for body in definition["bodies"]:
        body["joint"].pop("armature", None)
    part = derive(Definition.read(definition))
    data = urdf_of(part)
    floating = {f"{body['name']}_floating" for body in definition["bodies"] if body["joint"]["type"] == "floating"}
    assert {joint.get("name") for joint in Tree.fromstring(data).iterfind("joint[@type='floating']")} == floating  # noqa: S314 -- our own
    found = import_file(data, Options("none", rotations="quaternions"))
    model, again = at_world(part), at_world(derive(Definition.read(found.definition)))
    q, slope, angles = random_position(rng, model), np.eye(model.dof), {}
    for ball in (each for each in model.balls if len(each["positions"]) == 4):
        yaw, pitch, roll = rng.uniform(-1.2, 1.2, 3)
        a, first = model.coordinates.index(ball["velocities"][0]), model.positions.index(ball["positions"][0])
        slope[a : a + 3, a : a + 3] = euler_rates(pitch, roll, 0, 0)[0]
        q[first : first + 4] = quaternion(euler_matrix(yaw, pitch, roll))
        angles |= dict(zip(ball["positions"], ([yaw], [pitch], [roll], []), strict=True))
    there = [x for name, value in zip(model.positions, q, strict=True) for x in angles.get(name, [value])]
    ours, theirs = (evaluate(each, ["metric", "gravity"], at) for each, at in ((model, q), (again, there)))
    np.testing.assert_allclose(
        theirs["metric"], slope.T @ ours["metric"] @ slope, rtol=0, atol=1e-12 * ours["metric"].max()
    )
    np.testing.assert_allclose(theirs["gravity"], slope.T @ ours["gravity"], rtol=0, atol=1e-12 * ours["metric"].max())
    damped = [
        body["name"] for body in definition["bodies"] if "velocities" in body["joint"] and "damping" in body["joint"]
    ]
    assert data.count(b"<!-- the damping of the joint of") == len(damped)
