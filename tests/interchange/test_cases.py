"""Robot files from public reports of users of other tools, with the values that are right."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate, simulate
from substructures.analysis.equations.nonholonomic.velocity_constraints import Linear
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import ConstrainedMotion, Integrator
from substructures.errors import InvalidDocument
from substructures.export import render
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sides import Side

CASES = Path(__file__).parent / "cases"
G = 9.81


def read(name: str) -> Imported:
    return import_file((CASES / name).read_bytes(), file=name)


def model_of(found: Imported, gravity: tuple[float, ...] = (0, 0, -G)) -> Model:
    spec = TreeSpec.read({"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": "robot"}]})
    return couple(spec, {"x": derive(Definition.read(found.definition))})


def numbers(name: str, quantity: str, q: list[float], **state: Any) -> np.ndarray:
    return np.asarray(evaluate(model_of(read(name)), [quantity], q=q, **state)[quantity])


def warnings_of(found: Imported) -> list[str]:
    return [remark["message"] for remark in found.report if remark["level"] == "warning"]


METRICS: dict[str, tuple[list[float], Any]] = {
    "01-inertial-origin-turned.urdf": ([0.4], [[2]]),
    "02-fullinertia-order.xml": ([0, 0, 0], [[0.11, 0.01, -0.02], [0.01, 0.12, 0.03], [-0.02, 0.03, 0.13]]),
    "06-model-frame-axis.sdf": ([0], [[0.212254864]]),
    "07-universal-axes.sdf": ([0.5, -0.7], [[0.148975, 0.006442], [0.006442, 0.32]]),
    "08-ref-springref.xml": ([0.9], [[0.6]]),
    "10-guards.xml": ([0.9, 0.3], [[1.5, 0], [0, 0.04]]),
    "13-armature-once.xml": ([0, 0, 0], [[2.94, 0.91, 0.21], [0.91, 0.56, 0.15], [0.21, 0.15, 0.11]]),
    "16-axis-length-and-sign.urdf": ([0, 0], [[0.38, 0], [0, 1]]),
    "17-prefix-without-namespace.urdf": ([0.3], [[0.7]]),
    "22-numbers.urdf": ([0.3], [[0.7]]),
    "27-prismatic-mesh-only.urdf": ([0.3], [[0]]),
    "32-reflected-inertia.urdf": ([0.3], [[10.7]]),
    "35-mesh-on-fixed-body.xml": ([0.3], [[0.7]]),
}


@pytest.mark.parametrize("name", METRICS)
def test_the_metric(name: str) -> None:
    q, expected = METRICS[name]
    assert numbers(name, "metric", q) == pytest.approx(np.array(expected), abs=1e-6)


def test_forces_of_gravity_and_springs() -> None:
    assert numbers("06-model-frame-axis.sdf", "gravity", [0]) == pytest.approx([0.602001320])
    assert numbers("07-universal-axes.sdf", "gravity", [0.5, -0.7]) == pytest.approx([0, -2.291245], abs=1e-6)
    # what MuJoCo has for gravity, and for the spring, at its q = 0 and 0.9
    for q, gravity, spring in (
        (0.0, 8.53421537000772, -1.3089969389957472),
        (0.9, 6.901873949799604, -4.008996938995748),
    ):
        assert numbers("08-ref-springref.xml", "gravity", [q]) == pytest.approx([gravity])
        assert numbers("08-ref-springref.xml", "forces", [q]) == pytest.approx([gravity + spring])
    assert numbers("12-pendulum-continuous.urdf", "forward_dynamics", [np.pi / 2], qd=[0]) == pytest.approx([-4.905])


def test_a_symbolic_table_has_its_symbols_as_parameters() -> None:
    found = read("03-two-links-modified.csv")
    units = {"m1": {"unit": "kg"}, "L1": {"unit": "m"}, "m2": {"unit": "kg"}, "L2": {"unit": "m"}}
    assert found.definition["parameters"] == units
    values = {"x.L1": 0.7, "x.L2": 0.4, "x.m1": 1.3, "x.m2": 0.9}
    state = {"q": [0.3, -0.8], "qd": [0.5, 1.1], "qdd": [-0.4, 0.9]}
    answer = evaluate(model_of(found, (0, -G, 0)), ["inverse_dynamics"], parameters=values, **state)
    assert answer["inverse_dynamics"] == pytest.approx([17.607865388, 3.055849106], abs=1e-9)


def test_mimic_joints_are_relations() -> None:
    """The motion of the reduced mechanism is that of the free one with velocity constraints."""
    found = read("11-mimic-offset-chain.urdf")
    relations = found.definition["relations"]
    assert [(r["coordinate"], r["of"]) for r in relations] == [("c_joint", "b_joint"), ("b_joint", "a_joint")]
    part = derive(Definition.read(found.definition))
    assert part.coordinates == ("a_joint",)
    assert not part.certificate["warnings"]
    motion = simulate(
        model_of(found),
        {"x.a_joint": 0.3},
        span=(0, 1),
        integrator=Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-12),
    )
    a = 2.57323616
    assert motion.q[-1] == pytest.approx([a], abs=1e-6)
    # what velocity constraints gave for b and c
    assert (-1.5 * a + 0.2, 0.5 * (-1.5 * a + 0.2) + 0.05) == pytest.approx((-3.65985424, -1.77992712), abs=1e-7)


def test_relations_that_a_definition_leaves_out_are_told_of_wherever_they_are() -> None:
    """By the part and its trees; with the constraints the motion is that of the robot."""
    plain = read("11-mimic-offset-chain.urdf").definition
    plain["left_out"] = [
        {"message": f"'{r['coordinate']}' = {r['multiplier']} * '{r['of']}' + {r['offset']}", "relation": r}
        for r in plain.pop("relations")
    ]
    part = derive(Definition.read(plain))
    spec = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "robot"}]}
    model = couple(spec, {"x": part})
    for certificate, pointers in (
        (part.certificate, ["/left_out/0", "/left_out/1"]),
        (model.certificate, ["/instances/0"] * 2),
    ):
        told = [w for w in certificate["warnings"] if w["code"] == "left-out"]
        assert [w["pointer"] for w in told] == pointers
        assert "'b_joint' = -1.5 * 'a_joint' + 0.2" in told[1]["message"]
    constraints = [Linear("c", "x.c_joint' - 0.5*x.b_joint'"), Linear("b", "x.b_joint' + 1.5*x.a_joint'")]
    motion = followed(model, constraints, q_b=-0.25)
    assert motion.q[-1] == pytest.approx([2.57323616, -3.65985424, -1.77992712], abs=1e-6)
    assert not motion.warnings
    off = followed(model, constraints, q_b=0.05)
    assert [w["code"] for w in off.warnings] == ["relation-left"]
    assert "'x.b_joint' is 0.05 in state 0" in off.warnings[0]["message"]
    assert "-1.5*'x.a_joint' + 0.2 = -0.25" in off.warnings[0]["message"]
    state = evaluate(model, ["metric"], q=[0.3, 0.05, 0.075])
    assert [w["code"] for w in state.warnings] == ["relation-left"]


def followed(model: Model, constraints: list[Linear], q_b: float) -> Trajectory:
    """A motion of a second with the constraints of the file, from a start in which c follows b."""
    q = {"x.a_joint": 0.3, "x.b_joint": q_b, "x.c_joint": 0.5 * q_b + 0.05}
    return simulate(
        model,
        q,
        span=(0, 1),
        kind=ConstrainedMotion(constraints=constraints),
        integrator=Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-12),
    )


def test_impossible_inertias_are_read_and_told_with_their_moments() -> None:
    (message,) = warnings_of(read("18-impossible-inertia.urdf"))
    assert "principal moments 2e-07, 8.31e-07, 1.486e-06 kg m^2" in message


def test_tensors_are_judged_as_the_compiler_makes_them() -> None:
    assert set(warnings_of(read("10-guards.xml"))) == {"moments of inertia changed as <compiler> asks for"}


def test_two_descriptions_of_one_robot() -> None:
    a, b = (
        Side.of_part(derive(Definition.read(read(f"19{x}.urdf").definition)))
        for x in ("a-axis-as-given", "b-axis-made-z")
    )
    assert equivalence(a, b).equal


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("20-xacro-left.urdf", "line 2: .*xacro file.xacro > file.urdf"),
        ("25-two-parents.urdf", "line 7: <joint name=\"j4\">: the link 'c' is the child of 'j3' already"),
    ],
)
def test_what_is_refused(name: str, message: str) -> None:
    with pytest.raises(InvalidDocument, match=message):
        read(name)


def test_planar_joints_have_their_name_and_exact_axes() -> None:
    """metric[1, 3] = -m (cy cos q3 - cz sin q3), forces[1] = tau + 9.81 m, and no number of rounding."""
    assert read("23-planar-tilted.urdf").names["joint slide"] == "slide_1, slide_2, slide_3"
    found = read("23b-planar-x.urdf")
    assert found.names["joint slide"] == "slide_1, slide_2, slide_3"
    axes = [body["joint"].get("axis", [0, 0, 1]) for body in found.definition["bodies"][1:]]
    assert axes == [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    q = [0.1, 0.2, 0.3]
    expected = -2 * (0.2 * np.cos(0.3) - 0.3 * np.sin(0.3))
    assert numbers("23b-planar-x.urdf", "metric", q)[0, 2] == pytest.approx(expected)
    assert numbers("23b-planar-x.urdf", "forces", q)[0] == pytest.approx(2 * G)
    text = render(model_of(found).program.select(["metric", "forces"]), "text")
    assert not re.search(r"\d{5}", text)


def test_moving_links_without_mass_are_told_everywhere() -> None:
    found = read("27-prismatic-mesh-only.urdf")
    assert warnings_of(found) == ["the link moves and no mass is given for it: it is taken as massless"]
    assert not found.checks["physics"]["passed"]
    part = derive(Definition.read(found.definition))
    assert any("massless" in w["message"] for w in part.certificate["warnings"])
    codes = {w["code"] for w in model_of(found).certificate["warnings"]}
    assert {"left-out", "weightless"} <= codes


def test_rotor_inertia_is_an_armature_and_told_as_that() -> None:
    found = read("32-reflected-inertia.urdf")
    assert found.definition["bodies"][1]["joint"]["armature"] == 10
    assert [(r["level"], r["line"]) for r in found.report] == [("merged", 6)]


def test_misspelt_attributes_are_told_with_what_was_meant() -> None:
    (message,) = warnings_of(read("33-misspelt-attribute.urdf"))
    assert "'dampnig' is not known here and ignored; did you mean 'damping'?" in message


def test_a_mesh_on_a_body_that_stands_still_has_a_mass_or_is_told_and_kept_from_moving() -> None:
    data = (CASES / "35-mesh-on-fixed-body.xml").read_bytes()
    assert warnings_of(import_file(data)) == []
    free = import_file(data, Options(base="floating")).definition
    assert float(free["parameters"]["m_base_2"]["value"]) == pytest.approx(1000 / 6)  # a corner of a cube
    elsewhere = data.replace(b'vertex="0 0 0  1 0 0  0 1 0  0 0 1"', b'file="plinth.stl"')
    assert elsewhere != data
    assert any("the mass of a mesh needs its file" in message for message in warnings_of(import_file(elsewhere)))
    with pytest.raises(InvalidDocument, match="line 4: <geom>: the mass of a mesh needs its file"):
        import_file(elsewhere, Options(base="floating"))
    scaled = elsewhere.replace(b"<asset>", b'<compiler settotalmass="3"/><asset>')
    with pytest.raises(InvalidDocument, match="scaled by settotalmass"):
        import_file(scaled)
