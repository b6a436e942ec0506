"""USD files with UsdPhysics: loops, files beside them and packages, what is left out, told and refused."""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from made_once import derived_once

from service.cli.main import main
from substructures import Model, TreeSpec, couple, evaluate
from substructures.analysis.closed.loops import loop_state
from substructures.documents import read_json
from substructures.errors import InvalidDocument

pytest.importorskip("pxr", reason="the wheel usd-core is not installed (extra 'usd')")
from .test_usd import DRIVE, ELBOW, USD, generic, read

TOLD = {
    "largest force": (
        DRIVE + "        float drive:angular:physics:maxForce = 9\n",
        "the largest force of the drive, 9, is",
    ),
    "acceleration": (DRIVE + '        uniform token drive:angular:physics:type = "acceleration"\n', "forces grow with"),
    "velocity": (DRIVE + "        float drive:angular:physics:targetVelocity = 9\n", "a drive that follows a velocity"),
    "ref": (
        '    def PhysicsRevoluteJoint "elbow"\n    {\n        custom double mjc:ref = 0.1\n',
        "mjc:ref is not read: what it says of the mechanics is left out",
    ),
    "armature": (
        '    def PhysicsRevoluteJoint "elbow"\n    {\n        float physxJoint:armature = 0.1\n',
        "physxJoint:armature is not read: what it says of the mechanics is left out",
    ),
}


@pytest.mark.parametrize("name", TOLD)
def test_what_is_left_out_is_told(name: str) -> None:
    given, message = TOLD[name]
    text = USD.replace('    def PhysicsRevoluteJoint "elbow"\n    {\n', given)
    (lost,) = read(text).definition["left_out"]
    assert lost["message"].startswith("</arm/elbow>: ")
    assert message in lost["message"]


def test_missing_masses_are_told() -> None:
    text = USD.replace("        float physics:mass = 2\n", "").replace("(0.3, 0.4, 0.2)", "(0, 0, 0)")
    said = [lost["message"] for lost in read(text).definition["left_out"]]
    assert [message.partition(": ")[2] for message in said] == [
        "no diagonalInertia: the body is a point mass",
        "masses of shapes by a density are not computed: give the body physics:mass",
        "centerOfMass and diagonalInertia of a body without mass are left out: give it physics:mass",
        "the link moves and no mass is given for it: it is taken as massless",
    ]


def test_shapes_beside_one_with_a_mass_are_told() -> None:
    """They have the density of the format, but where their mass is that of what they are on."""
    mass, shape = (
        "float physics:mass = 2\n",
        'def Cube "shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])\n        {\n',
    )
    assert USD.count(shape) == 1
    on = f'def Xform "on" (prepend apiSchemas = ["PhysicsMassAPI"])\n{{\n{mass}'
    text = USD.replace(mass, "")
    message = "</arm/lower>: masses of shapes by a density are not computed: give the body physics:mass"
    for made, is_told in ((f"{on}}}\n{shape}", True), (f"{on}{shape}}}\n", False)):
        said = [lost["message"] for lost in read(text.replace(shape, made)).definition["left_out"]]
        assert (message in said) == is_told


OTHERS = {
    "PhysxPhysicsGearJoint": 'def PhysxPhysicsGearJoint "gear"\n{\nrel physics:hinge0 = </arm/shoulder>\n}\n',
    "MjcActuator": 'def MjcActuator "servo"\n{\nrel mjc:target = </arm/shoulder>\n}\n',
    "PointInstancer": 'def PointInstancer "p"\n{\ndef "a" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])\n{\n}\n}\n',
}  # fmt: skip


@pytest.mark.parametrize("kind", OTHERS)
def test_prims_of_other_programs_that_act_are_told(kind: str) -> None:
    (lost,) = read(USD + OTHERS[kind]).definition["left_out"]
    assert f"{kind} is not read: what it says of the mechanics is left out" in lost["message"]


def test_drives_of_axes_that_a_joint_has_not_are_told() -> None:
    spring = "        float drive:rotX:physics:stiffness = 3"
    for head, said in (
        (ELBOW, "the drives other than 'angular' of a joint about one axis are left out"),
        ('PhysicsSphericalJoint "elbow"\n    {', "the drives of a joint that turns about all axes are left out"),
    ):
        driven = head.replace('"elbow"', '"elbow" (prepend apiSchemas = ["PhysicsDriveAPI:rotX"])') + f"\n{spring}"
        (lost,) = read(USD.replace(ELBOW, driven)).definition["left_out"]
        assert said in lost["message"]


def four_bar(kind: str, at: str) -> str:
    """A parallelogram about x in the plane of y and z: crank and rocker 0.2 long, coupler and ground 0.3."""

    def body(name: str, y: float) -> str:
        return (
            f'def Xform "{name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])\n{{\n'
            f"float physics:mass = 1\npoint3f physics:centerOfMass = (0, {y}, 0)\n"
            "float3 physics:diagonalInertia = (0.01, 0.01, 0.01)\n}\n"
        )

    def joint(name: str, first: str, second: str, p0: str, p1: str, type_: str = "PhysicsRevoluteJoint") -> str:
        one = f"rel physics:body0 = </{first}>\n" if first else ""
        axis = 'uniform token physics:axis = "X"\n' if type_ != "PhysicsSphericalJoint" else ""
        places = f"point3f physics:localPos0 = {p0}\npoint3f physics:localPos1 = {p1}\n"
        cut = "bool physics:excludeFromArticulation = 1\n" if name == "closing" else ""
        return f'def {type_} "{name}"\n{{\n{one}rel physics:body1 = </{second}>\n{axis}{places}{cut}}}\n'

    return (
        '#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = "Z"\n)\n'
        + joint("closing", "coupler", "rocker", at, "(0, 0.2, 0)", kind)
        + body("crank", 0.1) + body("coupler", 0.15) + body("rocker", 0.1)
        + joint("q1", "", "crank", "(0, 0, 0)", "(0, 0, 0)")
        + joint("q2", "crank", "coupler", "(0, 0.2, 0)", "(0, 0, 0)")
        + joint("q3", "", "rocker", "(0, 0.3, 0)", "(0, 0, 0)")
        + 'def PhysicsScene "scene"\n{\nvector3f physics:gravityDirection = (0, 0, -1)\n'
        "float physics:gravityMagnitude = 3.7\n}\n"
    )  # fmt: skip


def closed(text: str) -> Model:
    found = read(text)
    assert found.tree is not None
    assert [float(x) for x in found.tree["gravity"]] == [0, 0, -3.7]
    return couple(TreeSpec.read(found.tree), {"robot": derived_once(found.definition)})


@pytest.mark.parametrize("kind", ["PhysicsRevoluteJoint", "PhysicsSphericalJoint"])
def test_a_loop_is_closed_and_moves_as_a_parallelogram(kind: str) -> None:
    """q2 = -q1, q3 = q1: M q1'' = -dV/dq1 with M = 2 (0.01 + 0.1^2) + 0.2^2, V = 3.7 (0.1 + 0.2 + 0.1) sin q1."""
    model, q = closed(four_bar(kind, "(0, 0.3, 0)")), [0.4, -0.4, 0.4]
    assert model.coordinates == ("robot.q1", "robot.q2", "robot.q3")
    assert np.abs(evaluate(model, ["closure.residual"], q=q)["closure.residual"]).max() < 1e-15
    state = loop_state(model, q)
    assert state.mobility.degrees_of_freedom == 1
    wanted = -3.7 * (0.1 + 0.2 + 0.1) * np.cos(0.4) / (2 * (0.01 + 0.1**2) + 0.2**2)
    np.testing.assert_allclose(state.qdd, wanted * np.array([1, -1, 1]), rtol=1e-12)
    wrong = closed(four_bar(kind, "(0, 0.2, 0)"))
    assert np.abs(evaluate(wrong, ["closure.residual"], q=q)["closure.residual"]).max() > 0.05


REFERS = """#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def "arm" (references = @./parts/arm.usda@</arm>)
{
}
"""


def test_files_beside_and_packages_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    wanted = read(USD).definition["bodies"]
    beside = {"parts/arm.usda": USD.encode()}
    assert read(REFERS, included=beside).definition["bodies"] == wanted
    sdf = __import__("pxr.Sdf").Sdf
    sdf.Layer.OpenAsAnonymous(str(_written(tmp_path / "arm.usda", USD))).Export(str(tmp_path / "arm.usdc"))
    binary = (tmp_path / "arm.usdc").read_bytes()
    assert read(binary).definition["bodies"] == wanted
    with zipfile.ZipFile(tmp_path / "arm.usdz", "w") as archive:
        archive.writestr("arm.usda", REFERS)
        archive.writestr("parts/arm.usda", USD)
    _written(tmp_path / "in" / "robot.usda", REFERS)
    _written(tmp_path / "in" / "parts" / "arm.usda", USD)
    for given in (tmp_path / "arm.usdz", tmp_path / "in" / "robot.usda", tmp_path / "arm.usdc"):
        assert main(["import", str(given)]) == 0
        out = read_json(capsys.readouterr().out.encode())
        assert isinstance(out, dict)
        assert [body["name"] for body in out["bodies"]] == [body["name"] for body in wanted]


def _written(path: Path, text: str) -> Path:
    path.parent.mkdir(exist_ok=True)
    path.write_text(text)
    return path


BAD = {
    "text": (USD.replace("def Xform", "deaf Xform", 1), "@__stage__.usda@: .*"),
    "encoding": (USD.encode().replace(b'"elbow"', b'"elb\xff"'), "@__stage__.usda@: byte [0-9]+ is no UTF-8"),
    "operation": (USD.replace('["xformOp:translate"]', '["xformOp:move"]', 1), "@__stage__@: Invalid xform"),
    "axis": (USD.replace('axis = "X"', 'axis = "W"'), "</arm/elbow>: physics:axis is 'W', and none of X, Y, Z"),
    "type": (
        USD.replace("float physics:lowerLimit = -90", 'token physics:lowerLimit = "x"'),
        "</arm/shoulder>: physics:lowerLimit is x, and has to be of the type float",
    ),
    "up": (USD.replace('upAxis = "Z"', 'upAxis = "X"'), "upAxis: 'X' is none of Y, Z"),
    "binary": (b"PXR-USDC" + bytes(200), "@__stage__.usdc@: Cannot read"),
    "elsewhere": (REFERS.replace("./parts/arm.usda", "/etc/passwd.usda"), "@/etc/passwd.usda@: this is not here"),
    "above": (REFERS.replace("./parts", "../parts"), "@../parts/arm.usda@: this is not here"),
    "not given": (REFERS, "@./parts/arm.usda@: this is not here, or no USD file .*usdcat --flatten"),
    "clips": (
        REFERS.replace("references = @./parts/arm.usda@</arm>", 'clips = {\ndictionary default = {\nint a = 1\n}\n}\n'),
        "</arm>: value clips are not followed",
    ),
    "nothing": ('#usda 1.0\ndef Xform "a"\n{\n}\n', "USD: there is no rigid body"),
    "dangling": (REFERS.replace("@./parts/arm.usda@</arm>", "</nowhere>"), "what it refers to is not there"),
    "two turns": (
        USD.replace(ELBOW, generic("elbow", "transX", "rotX", "rotY")),
        "</arm/elbow>: it slides along X and turns about X Y, and the format does not say which axis carries",
    ),
    "held": (USD.replace(ELBOW, generic("elbow", rotX=(10, 10))), "</arm/elbow>: rotX is held at 10: place the frames"),
    "no body": (USD.replace("body1 = </arm/tool>", "body1 = </arm/tol>"), "</arm/slide>: there is no prim </arm/tol>"),
    "sheared": (
        USD.replace("double3 xformOp:translate = (5, 6, 7)", "double3 xformOp:scale = (1, -1, 1)").replace(
            '["xformOp:translate"]', '["xformOp:scale"]', 1
        ),
        "</arm/upper>: its frame is sheared, mirrored or flat",
    ),
    "number": (USD.replace("(0, 0, 0.3)", "(0, 0, nan)"), "</arm/slide>: nan is no number"),
    "mass": (USD.replace("mass = 4", "mass = -4"), "</arm/upper>: the mass -4 kg is negative"),
    "quaternion": (USD.replace("(0.8, 0, 0, 0.6)", "(0, 0, 0, 0)"), "</arm/elbow>: the quaternion of a frame is zero"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_with_their_place(name: str, capfd: pytest.CaptureFixture[str]) -> None:
    text, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        read(text)
    capfd.readouterr()


def test_without_the_package_the_way_to_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    monkeypatch.delitem(sys.modules, "pxr.Usd", raising=False)
    with pytest.raises(InvalidDocument, match="pip install usd-core"):
        read(USD)
