"""USD files with UsdPhysics: the same arm as in URDF, in other units and axes; loops; what is told and refused."""

from __future__ import annotations

from cProfile import Profile
from pstats import Stats
from typing import Any

import numpy as np
import pytest
from independent import value
from made_once import derived_once

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.interchange.equivalence import equivalence
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sides import Side
from substructures.interchange.usd.reader import read_usd

pytest.importorskip("pxr", reason="the wheel usd-core is not installed (extra 'usd')")

URDF = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.1 0 0.3"/><mass value="4"/>
 <inertia ixx="0.3" iyy="0.4" izz="0.2"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.1 0.2" rpy="1.5707963267948966 0 0"/><mass value="2"/>
 <inertia ixx="0.1" iyy="0.12" izz="0.05"/></inertial></link>
<link name="tool"><inertial><origin xyz="0 0 0.05"/><mass value="0.7"/>
 <inertia ixx="0.01" iyy="0.01" izz="0.002"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
 <origin xyz="0.2 0 0.4"/>
 <limit lower="-1.5707963267948966" upper="2.0943951023931953" effort="1" velocity="1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/>
 <origin xyz="0 0.1 0.6" rpy="0 0 1.2870022175866"/></joint>
<joint name="slide" type="prismatic"><parent link="lower"/><child link="tool"/><axis xyz="0 0 1"/>
 <origin xyz="0 0 0.3"/><limit lower="0" upper="0.25" effort="1" velocity="1"/></joint></robot>"""
#: joints away from the frames of their bodies, and bodies anywhere
USD = """#usda 1.0
(
    defaultPrim = "arm"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "arm" (prepend apiSchemas = ["PhysicsArticulationRootAPI"])
{
    def Xform "upper" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 4
        point3f physics:centerOfMass = (0.1, 0, 0.3)
        float3 physics:diagonalInertia = (0.3, 0.4, 0.2)
        double3 xformOp:translate = (5, 6, 7)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Xform "lower" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 2
        point3f physics:centerOfMass = (0, 0.1, 0.2)
        float3 physics:diagonalInertia = (0.1, 0.12, 0.05)
        quatf physics:principalAxes = (0.70710677, 0.70710677, 0, 0)
        def Cube "shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
        }
    }
    def Xform "tool" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
        def Xform "inner" (prepend apiSchemas = ["PhysicsMassAPI"])
        {
            float physics:mass = 0.7
            point3f physics:centerOfMass = (0, 0, 0.01)
            float3 physics:diagonalInertia = (0.01, 0.01, 0.002)
            double3 xformOp:translate = (0, 0, 0.04)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
    }
    def PhysicsRevoluteJoint "shoulder"
    {
        uniform token physics:axis = "Y"
        rel physics:body1 = </arm/upper>
        point3f physics:localPos0 = (0.2, 0.3, 0.4)
        point3f physics:localPos1 = (0, 0.3, 0)
        float physics:lowerLimit = -90
        float physics:upperLimit = 120
    }
    def PhysicsRevoluteJoint "elbow"
    {
        uniform token physics:axis = "X"
        rel physics:body0 = </arm/upper>
        rel physics:body1 = </arm/lower>
        point3f physics:localPos0 = (0, 0.1, 0.6)
        quatf physics:localRot0 = (0.8, 0, 0, 0.6)
    }
    def PhysicsPrismaticJoint "slide"
    {
        uniform token physics:axis = "Z"
        rel physics:body0 = </arm/lower>
        rel physics:body1 = </arm/tool>
        point3f physics:localPos0 = (0, 0, 0.3)
        float physics:lowerLimit = 0
        float physics:upperLimit = 0.25
    }
}
"""


def read(text: str | bytes, **more: Any) -> Imported:
    return import_file(text if isinstance(text, bytes) else text.encode(), **more)


def side(text: str) -> Side:
    return Side.of_part(derive(Definition.read(read(text).definition)))


def model_of(text: str) -> Model:
    instance = {"name": "x", "definition": read(text).definition}
    tree = {"name": "t", "gravity": [0.1, 0.2, -9.81], "instances": [instance]}
    return couple(TreeSpec.read(tree), {"x": derived_once(instance["definition"])})


def test_the_arm_is_that_of_its_urdf_file() -> None:
    """To 1e-12 of the largest number: half of an angle is atan(3/4) exactly in USD, and to 13 digits in URDF."""
    ours, theirs = model_of(USD), model_of(URDF)
    assert ours.coordinates == theirs.coordinates == ("x.shoulder", "x.elbow", "x.slide")
    q, qd = np.random.default_rng(3).uniform(-1, 1, (2, 20, 3))
    names = ["metric", "bias", "gravity", "forward_dynamics"]
    found, wanted = (evaluate(model, names, q=q, qd=qd) for model in (ours, theirs))
    for name in names:
        np.testing.assert_allclose(found[name], wanted[name], rtol=0, atol=1e-12 * np.abs(wanted[name]).max())
    at = [[value(x) for x in body["joint"].get("limits", ())] for body in read(USD).definition["bodies"]]
    assert at == [[-np.pi / 2, pytest.approx(2 * np.pi / 3)], [], [0, 0.25]]


def test_rounding_displaces_nothing() -> None:
    """Two frames at one place, turned alike: 0.1 stays 0.1."""
    text = USD.replace("(0, 0.1, 0.6)", "(0.1, 0.2, 0.3)").replace("(0.8, 0, 0, 0.6)", "(0.3, 0.4, 0.5, 0.6)")
    more = "point3f physics:localPos1 = (0.1, 0.2, 0.3)\n        quatf physics:localRot1 = (0.3, 0.4, 0.5, 0.6)\n"
    text = text.replace("        quatf physics:localRot0", f"        {more}        quatf physics:localRot0")
    placement = read(text).definition["bodies"][1]["joint"]["placement"]
    assert [str(x) for x in placement["position"]] == ["0.1", "-0.1", "0.3"]


def test_limits_are_two_in_order_or_told() -> None:
    for low, high, message in (
        ("-inf", "0.25", "one limit alone"),
        ("0.5", "0.25", "the lower limit 0.5 is above"),
        ("0.25", "0.25", "both limits are 0.25"),
    ):
        text = USD.replace("Limit = 0\n", f"Limit = {low}\n").replace("Limit = 0.25", f"Limit = {high}")
        (said,) = (remark["message"] for remark in read(text).report)
        assert said.startswith(message)


WRONG = [
    ("(0, 0, 0.3)", "(0, 0.3, 0)"), ("(0, 0.3, 0)", "(0, 0, 0.3)"), ("(0.8, 0, 0, 0.6)", "(0.8, 0, 0.6, 0)"),
    ('physics:axis = "X"', 'physics:axis = "Z"'), ("(0.70710677, 0.70710677, 0, 0)", "(1, 0, 0, 0)"),
    ("translate = (0, 0, 0.04)", "translate = (0, 0.04, 0)"),
]  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
def test_another_arm_is_another_one(wrong: tuple[str, str]) -> None:
    assert USD.count(wrong[0]) == 1
    assert not equivalence(side(USD), side(USD.replace(*wrong))).equal


def in_other_units() -> str:
    """In centimetres, grams and with y up: all vectors in the world are (x, z, -y); the arm hangs on a scaled prim."""
    text = USD.replace("metersPerUnit = 1", "metersPerUnit = 0.01\n    kilogramsPerUnit = 0.001").replace(
        '"Z"\n)', '"Y"\n)'
    )
    for old, new in (("mass = 4", "mass = 4000"), ("mass = 2", "mass = 2000"), ("mass = 0.7", "mass = 700"),
                     ("(0.3, 0.4, 0.2)", "(3e6, 4e6, 2e6)"), ("(0.1, 0.12, 0.05)", "(1e6, 1.2e6, 5e5)"),
                     ("(0.01, 0.01, 0.002)", "(1e5, 1e5, 2e4)"), ("(0.1, 0, 0.3)", "(10, 0, 30)"),
                     ("(0, 0.1, 0.2)", "(0, 10, 20)"), ("(0, 0, 0.01)", "(0, 0, 1)"), ("(0, 0, 0.04)", "(0, 0, 4)"),
                     ("(0, 0.1, 0.6)", "(0, 10, 60)"), ("(0, 0, 0.3)", "(0, 0, 30)"), ("= 0.25", "= 25"),
                     # the base frame of the joint stands upright in the world
                     ("(0.2, 0.3, 0.4)", "(20, 40, -30)\n        quatf physics:localRot0 = (1, -1, 0, 0)"),
                     ("(0, 0.3, 0)", "(0, 30, 0)")):  # fmt: skip
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def test_units_and_axes_of_the_file_are_those_of_the_part() -> None:
    found = equivalence(side(in_other_units()), side(USD))
    assert found.equal, (found.first_difference, found.culprits)
    told = [remark["message"] for remark in read(in_other_units()).report]
    assert "y is up in the file, and z in the part: all is turned about x" in told
    said = [remark["message"] for remark in read(USD.replace("    metersPerUnit = 1\n", "")).report]
    assert "a length of 1 is 0.01 m, as the format has it where nothing is said" in said


def test_scaled_bodies_have_scaled_places() -> None:
    """Half the numbers in a prim that is twice as large; only the places in it, not its mass or moments."""
    scaled = USD.replace(
        "        double3 xformOp:translate = (5, 6, 7)\n", "        double3 xformOp:scale = (2, 2, 2)\n"
    )
    scaled = scaled.replace('["xformOp:translate"]', '["xformOp:scale"]', 1)
    for old, new in (
        ("(0.1, 0, 0.3)", "(0.05, 0, 0.15)"),
        ("(0, 0.3, 0)", "(0, 0.15, 0)"),
        ("(0, 0.1, 0.6)", "(0, 0.05, 0.3)"),
    ):
        scaled = scaled.replace(old, new)
    assert equivalence(side(scaled), side(USD)).equal


def test_joints_go_either_way() -> None:
    """With its ends exchanged the coordinate of a joint has the opposite sign."""
    turned = USD.replace("body0 = </arm/upper>", "body1 = </arm/upper>").replace(
        "body1 = </arm/lower>", "body0 = </arm/lower>", 1
    )
    turned = turned.replace("physics:localPos0 = (0, 0.1, 0.6)", "physics:localPos1 = (0, 0.1, 0.6)")
    turned = turned.replace("physics:localRot0 = (0.8", "physics:localRot1 = (0.8")
    ours, theirs, sign = model_of(USD), model_of(turned), np.array([1, -1, 1])
    q = np.random.default_rng(1).uniform(-1, 1, (5, 3))
    found = evaluate(theirs, ["metric"], q=q * sign)["metric"]
    np.testing.assert_allclose(found * np.outer(sign, sign), evaluate(ours, ["metric"], q=q)["metric"], atol=1e-13)


DRIVE = """    def PhysicsRevoluteJoint "elbow" (prepend apiSchemas = ["PhysicsDriveAPI:angular"])
    {
        float drive:angular:physics:stiffness = 0.5
        float drive:angular:physics:damping = 0.25
        float drive:angular:physics:targetPosition = 30
"""


ELBOW = 'PhysicsRevoluteJoint "elbow"\n    {\n        uniform token physics:axis = "X"'
SLIDE = 'PhysicsPrismaticJoint "slide"\n    {\n        uniform token physics:axis = "Z"'
SIX = ("transX", "transY", "transZ", "rotX", "rotY", "rotZ")
LOCKED = (1.0, -1.0)


def generic(name: str, *free: str, more: str = "", apis: str = "", **limits: tuple[float, float]) -> str:
    """The head of a PhysicsJoint that leaves these axes free, or within limits."""
    ranges = dict.fromkeys((axis for axis in SIX if axis not in free), LOCKED) | limits
    lines = [
        f"        float limit:{axis}:physics:{end} = {x}"
        for axis, both in ranges.items()
        for end, x in zip(("low", "high"), both, strict=True)
    ]
    schemas = ", ".join([f'"PhysicsLimitAPI:{axis}"' for axis in ranges] + [apis] * bool(apis))
    applied = f" (prepend apiSchemas = [{schemas}])" if schemas else ""
    head = f'PhysicsJoint "{name}"{applied}\n    {{\n'
    return head + "\n".join(lines) + more


def test_a_joint_of_six_axes_is_what_it_leaves_free() -> None:
    """One axis: a hinge or a slide with its limits; none: fixed; three rotations: a ball."""
    hinge = USD.replace(ELBOW, generic("elbow", "rotX"))
    assert read(hinge).definition["bodies"] == read(USD).definition["bodies"]
    own = "        float physics:lowerLimit = 0\n        float physics:upperLimit = 0.25\n"
    slide = USD.replace(SLIDE, generic("slide", transZ=(0, 0.25))).replace(own, "")
    assert read(slide).definition["bodies"] == read(USD).definition["bodies"]
    fixed = USD.replace(ELBOW, generic("elbow", rotX=(0, 0)))
    plain = USD.replace(ELBOW, 'PhysicsFixedJoint "elbow"\n    {')
    assert read(fixed).definition["bodies"] == read(plain).definition["bodies"]
    ball = read(USD.replace(ELBOW, generic("elbow", "rotX", "rotY", rotZ=(-20, 20))))
    plain = USD.replace(ELBOW, 'PhysicsSphericalJoint "elbow"\n    {')
    assert ball.definition["bodies"] == read(plain).definition["bodies"]
    assert "the ranges of a joint that turns about all axes are left out" in ball.definition["left_out"][0]["message"]
    bodies = read(USD.replace(ELBOW, generic("elbow", *SIX))).definition["bodies"]
    assert [body["joint"]["type"] for body in bodies] == ["revolute", "free", "prismatic"]


def test_its_drives_act_along_its_axes() -> None:
    more = """
        float drive:rotX:physics:stiffness = 0.5
        float drive:rotX:physics:damping = 0.25
        float drive:rotX:physics:targetPosition = 30"""
    six = USD.replace(ELBOW, generic("elbow", "rotX", more=more, apis='"PhysicsDriveAPI:rotX"'))
    one = USD.replace('    def PhysicsRevoluteJoint "elbow"\n    {\n', DRIVE)
    assert read(six).definition["bodies"] == read(one).definition["bodies"]


def test_slides_come_before_the_turn_in_the_frame_of_body0() -> None:
    """x, y and an angle in a plane: T = m |v|^2 / 2 + I w^2 / 2 of the mass centre, either way round."""
    text = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "disc" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{
    float physics:mass = 2
    point3f physics:centerOfMass = (0.3, 0, 0)
    float3 physics:diagonalInertia = (0.1, 0.1, 0.5)
}
def JOINT
        rel physics:body1 = </disc>
    }
"""
    joint = generic("plane", "transX", "transY", "rotZ")
    there = model_of(text.replace("JOINT", joint))
    assert there.coordinates == ("x.plane_transX", "x.plane_transY", "x.plane_rotZ")
    q, (s, c) = [0.2, -0.1, 0.7], (np.sin(0.7), np.cos(0.7))
    velocity = np.array([[1, 0, -0.3 * s], [0, 1, 0.3 * c]])
    wanted = 2 * velocity.T @ velocity + np.diag([0, 0, 0.5])
    np.testing.assert_allclose(evaluate(there, ["metric"], q=q)["metric"], wanted, atol=1e-14)
    # turned round its mass centre is at R(-angle) (0.3 - x, -y)
    back = model_of(text.replace("JOINT", joint).replace("body1", "body0"))
    assert back.coordinates == ("x.plane_rotZ", "x.plane_transY", "x.plane_transX")
    along = np.array([[-s, c], [-c, -s]]) @ (0.3 - 0.2, 0.1)
    velocity = np.column_stack([along, (-s, -c), (-c, s)])
    wanted = 2 * velocity.T @ velocity + np.diag([0.5, 0, 0])
    np.testing.assert_allclose(evaluate(back, ["metric"], q=q[::-1])["metric"], wanted, atol=1e-14)


def test_drives_are_springs_and_dampers() -> None:
    text = USD.replace('    def PhysicsRevoluteJoint "elbow"\n    {\n', DRIVE)
    joint = {body["name"]: body["joint"] for body in read(text).definition["bodies"]}["lower"]
    assert float(joint["stiffness"]) == pytest.approx(0.5 * 180 / np.pi, rel=1e-15)
    assert float(joint["damping"]) == pytest.approx(0.25 * 180 / np.pi, rel=1e-15)
    assert joint["rest"] == "pi/6"
    moment = evaluate(model_of(text), ["forces"], q=[0, 1.2, 0], qd=[0, 0.3, 0])["forces"]
    free = evaluate(model_of(USD), ["forces"], q=[0, 1.2, 0], qd=[0, 0.3, 0])["forces"]
    wanted = 0.5 * (30 - np.degrees(1.2)) - 0.25 * np.degrees(0.3)
    assert moment[1] - free[1] == pytest.approx(wanted, rel=1e-12)


def heap(bodies: int, kind: str) -> str:
    """A chain of bodies with its joints from the last to the first, bodies that lie apart, or that are nested."""
    api = '(prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])'
    begun = [f'def Xform "b{k}" {api}\n{{\n float physics:mass = 1\n' for k in range(bodies)]
    if kind == "nested":
        return "#usda 1.0\n" + "".join(begun) + "}\n" * bodies
    joints = [
        f'def PhysicsFixedJoint "j{k}"\n{{\n rel physics:body0 = </b{k - 1}>\n rel physics:body1 = </b{k}>\n}}\n'
        for k in range(bodies - 1, 0, -1)
    ]
    return "#usda 1.0\n" + "".join(each + "}\n" for each in begun) + "".join(joints if kind == "chain" else [])


@pytest.mark.parametrize("kind", ["chain", "apart", "nested"])
def test_work_grows_with_the_number_of_prims(kind: str) -> None:
    def calls(bodies: int) -> int:
        profile = Profile()
        robot = profile.runcall(read_usd, heap(bodies, kind).encode())
        assert len(robot.links) == bodies
        return int(Stats(profile).total_calls)  # type: ignore[attr-defined]

    calls(2)  # what is imported and kept by the way
    assert calls(80) < 2.02 * calls(40)


def test_balls_turn_by_yaw_pitch_and_roll_and_their_cones_are_told() -> None:
    ball = USD.replace(
        'PhysicsRevoluteJoint "elbow"\n    {\n        uniform token physics:axis = "X"',
        'PhysicsSphericalJoint "elbow"\n    {',
    )
    names = {body["name"]: body["joint"] for body in read(ball).definition["bodies"]}
    assert names["lower"]["coordinate"] == ["elbow_yaw", "elbow_pitch", "elbow_roll"]
    cone = ball.replace(
        "        quatf physics:localRot0", "        float physics:coneAngle0Limit = 30\n        quatf physics:localRot0"
    )
    (lost,) = read(cone).definition["left_out"]
    assert "</arm/elbow>: the cone in which a ball moves is left out" in lost["message"]
