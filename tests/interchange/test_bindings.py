"""Joints that follow others have no coordinate: the metric is N^T M N of another engine's M."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import Imported, import_file

sys.path.insert(0, str(Path(__file__).parent))
from engines import Reduced, deviation
from related import joints_of, reduction

BODY = '<inertial><origin xyz=".1 .02 -.03" rpy=".1 .2 .3"/><mass value="2"/><inertia ixx=".3" iyy=".4" izz=".5" ixy=".01" ixz="0" iyz="0"/></inertial>'  # noqa: E501
JOINT = '<joint name="{}" type="{}"><parent link="{}"/><child link="{}"/><origin xyz=".1 .2 .3" rpy=".3 -.2 .5"/><axis xyz="0 1 .5"/>{}</joint>'  # noqa: E501
LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
URDF = "".join(
    [
        '<robot name="gripper"><link name="ground"/>',
        *(f'<link name="{name}">{BODY}</link>' for name in "abc"),
        JOINT.format("turn", "revolute", "ground", "a", LIMIT),
        JOINT.format("left", "prismatic", "a", "b", LIMIT),
        JOINT.format("right", "prismatic", "a", "c", LIMIT + '<mimic joint="left" multiplier="-0.75" offset="0.1"/>'),
        "</robot>",
    ]
)
MJCF = """<mujoco><compiler angle="radian"/><worldbody>
<body name="a"><joint name="j" axis="0 1 0" ref="0.2"/><geom type="box" size=".1 .2 .3"/>
<body name="b" pos=".3 0 0"><joint name="k" axis="1 0 0" ref="-0.4"/><geom size=".2" pos=".1 .2 0"/></body></body>
</worldbody><equality><joint joint1="k" joint2="j" polycoef="0.3 -2 0 0 0"/></equality></mujoco>"""
SDF = """<sdf version="1.11"><model name="m"><link name="a"/><link name="b"/>
<joint name="j" type="revolute"><parent>world</parent><child>a</child><axis><xyz>0 1 0</xyz></axis></joint>
<joint name="k" type="prismatic"><parent>a</parent><child>b</child><axis><xyz>0 1 0</xyz>
<mimic joint="j"><multiplier>3</multiplier><offset>0.5</offset><reference>0.1</reference></mimic></axis></joint>
</model></sdf>"""


def read(text: str) -> Imported:
    return import_file(text.encode(), Options("none"))


def model_of(found: Imported) -> Model:
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "robot"}]})
    return couple(spec, {"x": derive(Definition.read(found.definition))})


def test_the_metric_is_that_of_the_reduced_robot(tmp_path: Path) -> None:
    pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
    from with_pinocchio import PinocchioTwin  # noqa: PLC0415 -- beside this file

    found = read(URDF)
    model = model_of(found)
    assert model.coordinates == ("x.turn", "x.left")
    path = tmp_path / "a.urdf"
    path.write_text(URDF)
    twin = PinocchioTwin(path, found.names, ["turn", "left", "right"], np.zeros(3))
    q = np.array([0.3, -0.2, -0.75 * -0.2 + 0.1])
    # dq/d(turn, left)
    slope = np.array([[1, 0], [0, 1], [0, -0.75]])
    free = twin.numbers(q, 0 * q, 0 * q).metric
    ours = evaluate(model, ["metric"], q=q[:2])["metric"]
    np.testing.assert_allclose(ours, slope.T @ free @ slope, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (URDF, {"coordinate": "right", "of": "left", "multiplier": -0.75, "offset": 0.1}),
        # k - ref_k = 0.3 - 2 (j - ref_j)
        (MJCF, {"coordinate": "k", "of": "j", "multiplier": -2, "offset": -0.4 + 0.3 + 2 * 0.2}),
        (SDF, {"coordinate": "k", "of": "j", "multiplier": 3, "offset": 0.5 - 3 * 0.1}),
    ],
)
def test_bindings_of_all_formats(text: str, expected: dict[str, Any]) -> None:
    found = read(text)
    (relation,) = found.definition["relations"]
    told = {key: x if isinstance(x, str) else pytest.approx(float(x)) for key, x in expected.items()}
    assert {key: relation[key] if key in ("coordinate", "of") else float(relation[key]) for key in expected} == told
    assert [r["level"] for r in found.report if "has no coordinate" in r["message"]] == ["merged"]
    assert found.bindings == []
    part = derive(Definition.read(found.definition))
    assert expected["coordinate"] not in part.coordinates
    assert not [w for w in part.certificate["warnings"] if w["code"] == "left-out"]


def test_a_joint_that_follows_twice_leads_the_second() -> None:
    """c of b, and b of a written as a joint that c bounds: one relation is turned round."""
    more = '<body name="c" pos=".3 0 0"><joint name="l" axis="0 0 1"/><geom size=".1"/></body></body></body>'
    twice = '<joint joint1="k" joint2="l" polycoef="0.1 4 0 0 0"/></equality>'
    found = read(MJCF.replace("</body></body>", more, 1).replace("</equality>", twice))
    first, second = found.definition["relations"]
    assert (first["coordinate"], first["of"], second["coordinate"], second["of"]) == ("k", "j", "l", "k")
    model = model_of(found)
    assert model.coordinates == ("x.j",)
    circle = twice.replace("</equality>", '<joint joint1="l" joint2="j" polycoef="0 3 0 0 0"/></equality>')
    over = read(MJCF.replace("</body></body>", more, 1).replace("</equality>", circle))
    assert over.bindings == []
    assert [r["level"] for r in over.report if "this holds joints at numbers" in r["message"]] == ["warning"]
    assert model_of(over).coordinates == ("x.j",)


@pytest.mark.parametrize(
    ("equalities", "free", "said"),
    [
        ("a b 0 1, c d 0.3 1, a c 0.1 2", 1, "moves with"),
        ("a b 0.1 2, a b 0.1 2", 3, "those before it say the same"),
        ("a b 0.2 1, b c 0.1 -1, c a 0.3 -1", 2, "those before it say the same"),
        ("a b 0 3, c d 0 1, a c 0 7", 1, "moves with"),
    ],
)
def test_joints_that_are_bound_several_times_move_as_in_mujoco(
    equalities: str, free: int, said: str, tmp_path: Path
) -> None:
    """Those that both follow others, twice the same, and all round a circle."""
    pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
    from corpus import compared  # noqa: PLC0415 -- beside this file
    from with_mujoco import MujocoTwin  # noqa: PLC0415

    joint = '<body pos=".1 .2 .3" euler="10 20 30"><joint name="{}" axis="0 1 1"/><geom size=".1" pos=".3 .1 0"/>'
    bodies = "".join(map(joint.format, "abcd")) + "</body>" * 4
    rows = [each.split() for each in equalities.split(", ")]
    bound = "".join(f'<joint joint1="{a}" joint2="{b}" polycoef="{c} {k} 0 0 0"/>' for a, b, c, k in rows)
    path = tmp_path / "a.xml"
    path.write_text(f"<mujoco><worldbody>{bodies}</worldbody><equality>{bound}</equality></mujoco>")
    found = compared("bound", path, MujocoTwin)
    assert (found.refused, found.dof) == ("", free)
    assert found.error < 1e-10
    last = read(path.read_text()).report[-1]
    assert said in last["message"]
    assert last["level"] == "merged"


def test_mujoco_holds_its_joint_where_the_binding_says() -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
    model = mujoco.MjModel.from_xml_string(MJCF)
    data = mujoco.MjData(model)
    (binding,) = read(MJCF).definition["relations"]
    data.qpos[:] = 0.7, float(binding["multiplier"]) * 0.7 + float(binding["offset"])
    mujoco.mj_fwdPosition(model, data)
    assert abs(data.efc_pos[: data.ne]).max() < 1e-12
    data.qpos[1] += 0.1
    mujoco.mj_fwdPosition(model, data)
    assert abs(data.efc_pos[: data.ne]).max() == pytest.approx(0.1)


def test_mujoco_has_the_same_numbers_on_its_equality(tmp_path: Path) -> None:
    """Metric, gravity, bias, inverse and forward dynamics at random states that the equality holds."""
    pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
    from with_mujoco import MujocoTwin  # noqa: PLC0415 -- beside this file

    found, path = read(MJCF), tmp_path / "a.xml"
    path.write_text(MJCF)
    definition, gravity = found.definition, np.array([0.3, -0.4, -9.81])
    spec = TreeSpec.read(
        {"name": "t", "gravity": gravity.tolist(), "instances": [{"name": "x", "substructure": "robot"}]}
    )
    model = couple(spec, {"x": derive(Definition.read(definition))})
    order = list(joints_of(definition))
    twin = Reduced(MujocoTwin(path, found.names, order, gravity), *reduction(definition, order, ["j"]))
    states = {key: np.random.default_rng(1).uniform(-1.2, 1.2, (3, 1)) for key in ("q", "qd", "qdd")}
    answer = evaluate(model, ["metric", "gravity", "bias", "inverse_dynamics", "forward_dynamics"], **states)
    for i in range(3):
        assert deviation(answer, twin.numbers(*(x[i] for x in states.values())), i) < 1e-10


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (URDF.replace('mimic joint="left"', 'mimic joint="right"'), "not two joints of one coordinate"),
        (URDF.replace('mimic joint="left"', 'mimic joint="nobody"'), "there is no joint 'nobody'"),
        (URDF.replace('mimic joint="left"', 'mimic joint="letf"'), "no joint 'letf'; did you mean 'left'?"),
        (MJCF.replace("-2 0 0 0", "-2 1 0 0"), "by a polynomial"),
        (MJCF.replace('joint2="j"', ""), "held at a number"),
        (MJCF.replace('joint2="j"', 'joint2="z"'), "there is no joint 'z'"),
        (SDF.replace('mimic joint="j"', 'mimic joint="z"'), "there is no joint 'z'"),
    ],
)
def test_what_cannot_be_bound_is_told(text: str, said: str) -> None:
    found = read(text)
    assert found.bindings == []
    assert "relations" not in found.definition
    assert any(said in r["message"] and r["level"] == "warning" and r["line"] for r in found.report)
