"""SDF files: the same arm as in URDF, with poses relative to all there is; what is refused."""

from __future__ import annotations

from decimal import Decimal
from time import process_time
from typing import Any

import numpy as np
import pytest
from made_once import derived_once

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.analysis.closed.loops import loop_state
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sides import Side

URDF = """<robot name="arm"><link name="ground"/>
<link name="upper"><inertial><origin xyz="0.1 0 0.3" rpy="0.1 0.2 0.3"/><mass value="4"/>
 <inertia ixx="0.3" iyy="0.4" izz="0.2" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.1 0.2"/><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.05"/>
 </inertial></link>
<joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/><axis xyz="0 1 0"/>
 <origin xyz="0 0 0.4"/><limit lower="-1" upper="2" effort="1" velocity="1"/><dynamics damping="0.5"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/>
 <origin xyz="0 0.1 0.6" rpy="0.3 0 0"/></joint></robot>"""
#: links in the model or relative to each other, the frame of the lower link away from its axis and turned about it
SDF = """<sdf version="1.9"><model name="arm"><pose>0 0 0 0 0 0</pose>
<link name="upper"><pose>0 0 0.4 0 0 0</pose><inertial><pose>0.1 0 0.3 0.1 0.2 0.3</pose><mass>4</mass>
 <inertia><ixx>0.3</ixx><iyy>0.4</iyy><izz>0.2</izz><ixy>0.01</ixy><ixz>0.02</ixz><iyz>0.03</iyz></inertia></inertial></link>
<frame name="pivot" attached_to="upper"><pose degrees="false">0 0.1 0.6 0.3 0 0</pose></frame>
<frame name="grip" attached_to="pivot"/>
<link name="lower"><pose relative_to="pivot" degrees="true">0 0 0.5 0 0 90</pose><inertial>
 <pose>0.1 0 -0.3 0 0 0</pose><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.05</izz></inertia>
 </inertial></link>
<joint name="shoulder" type="revolute"><parent>world</parent><child>upper</child>
 <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper></limit>
 <dynamics><damping>0.5</damping></dynamics></axis>
</joint>
<joint name="elbow" type="revolute"><pose relative_to="pivot">0 0 0 0 0 0.7</pose>
 <parent>upper</parent><child>lower</child>
 <axis><xyz expressed_in="pivot">1 0 0</xyz></axis></joint></model></sdf>"""


def side(text: str) -> Side:
    return Side.of_part(derive(Definition.read(import_file(text.encode()).definition)))


def test_the_same_arm_in_sdf() -> None:
    found = equivalence(side(URDF), side(SDF))
    assert found.equal, (found.first_difference, found.culprits)
    read = import_file(SDF.encode()).definition
    assert [b["joint"].get("limits") for b in read["bodies"]] == [[-1, 2], None]
    assert [p["name"] for p in read["ports"]] == ["lower_frame", "pivot", "grip"]


def test_axes_are_given_in_the_frame_of_the_joint() -> None:
    turned = SDF.replace('<xyz expressed_in="pivot">1 0 0', "<xyz>0.7648421872844885 -0.644217687237691 0")
    assert equivalence(side(URDF), side(turned)).equal
    assert not equivalence(side(URDF), side(SDF.replace(' expressed_in="pivot"', ""))).equal


def test_nested_models_have_names_with_two_colons() -> None:
    start, middle, end = SDF.partition('<link name="upper">')
    inner = (middle + end).replace("</model></sdf>", "")
    nested = f'{start}<model name="in"><pose>0 0 0 0 0 0</pose>{inner}</model></model></sdf>'
    found = import_file(nested.encode())
    assert [b["name"] for b in found.definition["bodies"]] == ["in__upper", "in__lower"]
    names = {"shoulder": "in__shoulder", "elbow": "in__elbow"}
    assert equivalence(side(URDF), side(nested), names).equal


def test_the_model_stands_where_its_pose_says() -> None:
    """In the world, on a frame beside it, or with a frame of its own at its pose; gravity is that of the world."""
    pose = "<pose>1 2 3 1.5707963267948966 0 0</pose>"
    placed = SDF.replace("<pose>0 0 0 0 0 0</pose>", pose, 1)
    table = '<world name="w"><frame name="upper"><pose>0 0 1 0 0 0</pose></frame>'
    on_table = placed.replace("<model", f"{table}<model", 1).replace("</model>", "</model></world>")
    on_table = on_table.replace("<pose>1 2 3", '<pose relative_to="upper">1 2 3', 1)
    held = placed.replace('name="arm"', 'name="arm" placement_frame="upper"')
    for text, at in ((placed, [1, Decimal("1.6"), 3]), (on_table, [1, Decimal("1.6"), 4]), (held, [1, 2, 3])):
        found = import_file(text.encode())
        placement = found.definition["bodies"][0]["joint"]["placement"]
        assert placement == {"position": at, "rpy": ["pi/2", 0, 0]}
        assert found.gravity == (None if text is not on_table else [0, 0, Decimal("-9.8")])


LIMITS = {
    "<lower>-inf</lower><upper>inf</upper><effort>inf</effort>": (None, ""),
    "<lower>-1e16</lower><upper>1e16</upper>": (None, ""),
    "<lower>-1</lower><upper>+inf</upper>": (None, "one limit alone is left out: give both, lower and upper"),
    "<upper>2</upper>": (None, "one limit alone is left out: give both, lower and upper"),
    "<lower>2</lower><upper>-1</upper>": (None, "the lower limit 2 is above the upper one -1: limits are left out"),
    "<lower>0</lower><upper>0</upper>": (
        [0, 0], "both limits are 0, and limits do not hold a joint here: make it fixed if it is to stand still",
    ),
}  # fmt: skip


@pytest.mark.parametrize("limit", LIMITS)
def test_limits_are_two_or_told(limit: str) -> None:
    wanted, message = LIMITS[limit]
    found = import_file(SDF.replace("<lower>-1</lower><upper>2</upper>", limit).encode())
    assert found.definition["bodies"][0]["joint"].get("limits") == wanted
    assert [remark["message"] for remark in found.report] == [message] * bool(message)


def test_defaults_of_the_format() -> None:
    """Of an <inertia>, told; bools in capitals; frames that are attached to nothing are to the model."""
    inertia = SDF[SDF.index(" <inertia>") : SDF.index("</inertia>") + 10]
    found = import_file(SDF.replace(inertia, "").encode())
    assert [found.definition["parameters"][f"I{e}_upper"]["value"] for e in ("xx", "yy", "zz")] == [1, 1, 1]
    assert [remark["element"] for remark in found.report if "no <inertia>" in remark["message"]] == [
        '<link name="upper">'
    ]
    assert bodies_of(SDF.replace('degrees="true"', 'degrees="True"')) == bodies_of(SDF)
    assert ports('<frame name="f" attached_to=""/>')["f"]["body"] == "a"


def bodies_of(text: str) -> list[dict[str, Any]]:
    bodies: list[dict[str, Any]] = import_file(text.encode()).definition["bodies"]
    return bodies


def test_rounding_displaces_nothing() -> None:
    """0.1 + 0.2 and 0.3 are one place."""
    frames = '<frame name="f"><pose>0 0 0.1 0 0 0</pose></frame>'
    frames += '<frame name="g"><pose relative_to="f">0 0 0.2 0 0 0</pose></frame>'
    links = '<link name="b"><pose relative_to="g"/></link><link name="c"><pose>0 0 0.3 0 0 0</pose></link>'
    joint = '<joint name="j" type="ball"><pose relative_to="c"/><parent>c</parent><child>b</child></joint>'
    bodies = bodies_of(f'<sdf version="1.9"><model name="m">{frames}{links}{joint}</model></sdf>')
    assert "placement" not in bodies[1]["joint"]
    assert "com" not in bodies[1]


def test_numbers_stand_on_lines_of_their_own() -> None:
    lines = SDF.replace("0.1 0 0.3 0.1 0.2 0.3</pose>", "\n0.1 0 0.3\n0.1 0.2\n\n0.3\n</pose>")
    assert bodies_of(lines) == bodies_of(SDF)


def test_joints_are_frames_of_their_children() -> None:
    """What is attached to one, or hangs on one, is on its child link."""
    elbow = "<parent>upper</parent><child>lower"
    assert bodies_of(SDF.replace(elbow, "<parent>shoulder</parent><child>lower")) == bodies_of(SDF)
    on_joint = SDF.replace('"pivot" attached_to="upper"', '"pivot" attached_to="shoulder"')
    assert bodies_of(on_joint.replace(elbow, "<parent>pivot</parent><child>lower")) == bodies_of(SDF)


def test_universal_and_ball_joints() -> None:
    """axis2 is carried by axis: the same as two joints of one body."""
    both = (
        '<sdf version="1.7"><model name="m"><link name="b"><inertial><pose>0 0 1 0 0 0</pose><mass>2</mass><inertia>'
        "<ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial></link>"
        '<joint name="u" type="universal"><parent>world</parent><child>b</child><axis><xyz>1 0 0</xyz></axis>'
        "<axis2><xyz>0 1 0</xyz></axis2></joint></model></sdf>"
    )
    twin = (
        '<mujoco><worldbody><body name="b"><inertial pos="0 0 1" mass="2" diaginertia="1 2 2.5"/>'
        '<joint name="u" axis="1 0 0"/><joint name="u_2" axis="0 1 0"/></body></worldbody></mujoco>'
    )
    assert equivalence(side(both), side(twin)).equal
    ball = import_file(both.replace('type="universal"', 'type="ball"').encode()).definition
    assert ball["bodies"][0]["joint"]["coordinate"] == ["u_yaw", "u_pitch", "u_roll"]
    damped = both.replace("</xyz></axis>", "</xyz><dynamics><damping>3</damping></dynamics></axis>", 1)
    (lost,) = import_file(damped.replace('type="universal"', 'type="ball"').encode()).definition["left_out"]
    assert "damping, springs, friction and limits of a ball joint are not read" in lost["message"]


INERTIA = "<inertia><ixx>0.02</ixx><iyy>0.02</iyy><izz>0.02</izz></inertia>"


def link(name: str, pose: str = "0 0 0 0 0 0", com: str = "0 0 0 0 0 0", mass: float = 3) -> str:
    inertial = f"<inertial><pose>{com}</pose><mass>{mass}</mass>{INERTIA}</inertial>"
    return f'<link name="{name}"><pose>{pose}</pose>{inertial}</link>'


def joint(name: str, kind: str, parent: str, child: str, more: str = "", pose: str = "0 0 0 0 0 0") -> str:
    ends = f"<parent>{parent}</parent><child>{child}</child><pose>{pose}</pose>"
    return f'<joint name="{name}" type="{kind}">{ends}{more}</joint>'


def along(xyz: str, tag: str = "axis", more: str = "") -> str:
    return f"<{tag}><xyz>{xyz}</xyz>{more}</{tag}>"


def model_of(content: str) -> tuple[Imported, Model]:
    text = f'<world name="w"><gravity>0 0 -3.7</gravity><model name="m">{content}</model></world>'
    found = import_file(f'<sdf version="1.11">{text}</sdf>'.encode())
    tree = {"name": "t", "gravity": [0, 0, "-3.7"], "instances": [{"name": "robot", "definition": found.definition}]}
    return found, couple(TreeSpec.read(found.tree or tree), {"robot": derived_once(found.definition)})


PITCHES = {
    "<screw_thread_pitch>0.4</screw_thread_pitch>": 0.4 / (2 * np.pi),
    "<screw_thread_pitch>-4E-10</screw_thread_pitch><thread_pitch>7</thread_pitch>": -4e-10 / (2 * np.pi),
    "<thread_pitch>5</thread_pitch>": -1 / 5,
}


@pytest.mark.parametrize("pitch", PITCHES)
def test_a_screw_by_hand(pitch: str) -> None:
    """J + m mu^2 and -m g mu; a right-handed one, turned by the right hand about its axis, goes along it."""
    mu = PITCHES[pitch]
    laws = "<limit><lower>-9</lower><upper>9</upper></limit><dynamics><damping>0.5</damping></dynamics>"
    found, model = model_of(link("nut") + joint("s", "screw", "world", "nut", along("0 0 2", more=laws) + pitch))
    assert model.coordinates == ("robot.s",)
    numbers = evaluate(model, ["metric", "forces", "kinematics"], q=[0.7], qd=[0.2])
    assert numbers["metric"][0, 0] == pytest.approx(0.02 + 3 * mu**2, rel=1e-12)
    assert numbers["forces"][0] == pytest.approx(-3 * 3.7 * mu - 0.5 * 0.2, rel=1e-12)
    at = list(model.frames).index("robot.nut")
    assert numbers["kinematics"]["position"][at, 2] == pytest.approx(0.7 * mu, rel=1e-12)
    said = [remark["message"] for remark in found.report]
    assert any("its coordinate is its angle" in each for each in said)
    assert any("rad/m, and left-handed" in each for each in said) == pitch.startswith("<thread")


GEARS = {
    "both on it": (("c", "a", "0 1 0"), "0 1 0", -3),
    "against its axis": (("c", "a", "0 -1 0"), "0 1 0", 3),
    "it on the first": (("a", "c", "0 1 0"), "0 2 0", 3),
    "axis of the gearbox": (("c", "a", "0 1 0"), "0 -1 0", 3),
}


@pytest.mark.parametrize("name", GEARS)
def test_a_gearbox_by_hand(name: str) -> None:
    """The angles of both wheels against the carrier: theta_2 = -3 theta_1."""
    (parent, child, axis), first, ratio = GEARS[name]
    links = link("a") + link("c", "0 0 1 0 0 0") + link("b", "0 0 2 0 0 0")
    box = along(first) + along("1 0 0", "axis2") + "<gearbox_ratio>3</gearbox_ratio>"
    box = joint("box", "gearbox", "a", "b", f"{box}<gearbox_reference_body>c</gearbox_reference_body>")
    tree = joint("qa", "revolute", parent, child, along(axis)) + joint("qb", "revolute", "c", "b", along("1 0 0"))
    found, model = model_of(links + box + tree)
    assert model.coordinates == ("robot.qa",)
    (relation,) = found.definition["relations"]
    assert relation == {"coordinate": "qb", "of": "qa", "multiplier": ratio, "offset": 0}
    with pytest.raises(InvalidDocument, match="no revolute joints about its axes move its parent and child"):
        model_of(links + box.replace("<xyz>1 0 0", "<xyz>0 1 0") + tree)


def bar(closing: str, more: str = "", flag: str = "") -> str:
    """A parallelogram about x in the plane of y and z: crank and rocker 0.2 long, coupler and ground 0.3."""
    x, still = along("1 0 0", more=more), along("1 0 0")
    cut = joint("closing", closing, "coupler", "rocker", x + flag, "0 0.2 0 0 0 0")
    links = link("crank", com="0 0.1 0 0 0 0", mass=1)
    links += link("coupler", "0 0.2 0 0 0 0", "0 0.15 0 0 0 0", 1)
    links += link("rocker", "0 0.3 0 0 0 0", "0 0 0 0 0 0", 1)
    first = joint("q1", "revolute", "world", "crank", still) + joint("q2", "revolute", "crank", "coupler", still)
    both = [cut, joint("q3", "revolute", "world", "rocker", still)]
    return links + first + "".join(both if flag else both[::-1])


def test_first_joints_that_close_a_circle_leave_it_to_others() -> None:
    """A door on two hinges, of which one has the frame for its child: the order in the file does not matter."""
    one = joint("one", "revolute", "door", "frame", along("0 0 1"))
    two = joint("two", "revolute", "frame", "door", along("0 0 1"))
    root = joint("root", "revolute", "world", "frame", along("1 0 0"))
    found = [
        model_of(link("frame", mass=1) + link("door", mass=1) + all_) for all_ in (one + two + root, root + two + one)
    ]
    for each, model in found:
        assert model.coordinates == ("robot.root", "robot.two")
        said = [remark["message"] for remark in each.report]
        assert "the link 'frame' is the child of 'root' already: this joint closes a loop" in said
    with pytest.raises(InvalidDocument, match="is on or behind a cycle of joints"):
        model_of(link("frame", mass=1) + link("door", mass=1) + one + two)


@pytest.mark.parametrize(
    "flag", ["", "<physics><simbody><must_be_loop_joint>1</must_be_loop_joint></simbody></physics>"]
)
@pytest.mark.parametrize("kind", ["revolute", "ball"])
def test_a_second_parent_closes_a_loop(kind: str, flag: str) -> None:
    """q2 = -q1, q3 = q1: M q1'' = -dV/dq1, M = 2 J + m (0.1^2 + 0.2^2), V = 3.7 (0.1 + 0.2) sin q1."""
    limits = "<limit><lower>-1</lower><upper>1</upper></limit>"
    found, model = model_of(bar(kind, limits if flag else "<dynamics><damping>2</damping></dynamics>", flag))
    q = [0.4, -0.4, 0.4]
    assert model.coordinates == ("robot.q1", "robot.q2", "robot.q3")
    assert np.abs(evaluate(model, ["closure.residual"], q=q)["closure.residual"]).max() < 1e-15
    wanted = -3.7 * (0.1 + 0.2) * np.cos(0.4) / (2 * 0.02 + 0.1**2 + 0.2**2)
    np.testing.assert_allclose(loop_state(model, q).qdd, wanted * np.array([1, -1, 1]), rtol=1e-12)
    said = [remark["message"] for remark in found.report]
    assert "the link 'rocker' is the child of 'q3' already: this joint closes a loop" in said
    assert "limits of a joint that closes a loop are not read" in found.definition["left_out"][0]["message"]


ROWS = {"revolute": 5, "prismatic": 5, "ball": 3, "fixed": 6, "universal": 4, "revolute2": 4}


@pytest.mark.parametrize("kind", ROWS)
def test_a_loop_leaves_what_its_joint_leaves(kind: str) -> None:
    """Beside a joint like it it holds nothing anywhere; beside a ball elsewhere it does."""
    links = link("a", "0.1 0.2 0.3 0.4 0.5 0.6") + link("b", "-0.3 0 0.5 1 -0.7 0.2")
    axes = along("1 2 2") + along("2 1 -2", "axis2")
    cut = joint("cut", kind, "a", "b", axes, "0.2 0.1 -0.3 0.3 0.2 0.1")
    start = links + joint("w", "revolute", "world", "a", along("1 2 3"))
    for tree, holds in ((cut.replace("cut", "tree"), False), (joint("x", "ball", "a", "b", "", "0.3 0 0 0 0 0"), True)):
        _, model = model_of(start + tree + cut)
        assert [len(closure.rows) for closure in model.closures] == [ROWS[kind]]
        q = np.random.default_rng(3).uniform(-1, 1, model.dof)
        found = np.abs(evaluate(model, ["closure.residual"], q=q)["closure.residual"]).max()
        assert found > 0.01 if holds else found < 1e-14


SKEW = along("0 0 1") + along("0 1 1", "axis2")
BAD = {
    "version": (SDF.replace("1.9", "1.2"), "line 1: <sdf>: version '1.2' is none of"),
    "include": (SDF.replace("<frame", "<include><uri>m</uri></include><frame", 1), "line 4: <include>: 'm' is not"),
    "frame": (SDF.replace('relative_to="pivot"', 'relative_to="nowhere"', 1), "there is no frame 'nowhere'"),
    "circle": (SDF.replace('attached_to="upper"><pose', 'attached_to="upper"><pose relative_to="lower"'), "to itself"),
    "link": (SDF.replace("<parent>upper", "<parent>arm"), 'line 13: <joint name="elbow">: there is no link .arm'),
    "axis": (SDF.replace("<xyz>0 1 0", "<xyz>0 0 0"), "line 10: <xyz>: the axis has no direction"),
    "type": (SDF.replace('"elbow" type="revolute"', '"elbow" type="hinge"'), "type 'hinge' is none of"),
    "screw": (SDF.replace('"elbow" type="revolute"', '"elbow" type="screw"'), "<screw_thread_pitch> is needed"),
    "two screws": (
        SDF.replace("</model>", f"{joint('s', 'screw', 'world', 'lower')}</model>"),
        "the link 'lower' is the child of 'elbow' already, and a joint 'screw' on 'None' closes no loop",
    ),
    "skew": (
        SDF.replace("</model>", f"{joint('u', 'universal', 'upper', 'lower', SKEW)}</model>"),
        "it closes a loop, and its axes are not at a right angle",
    ),
    "pose": (SDF.replace("0.1 0.2 0.3</pose>", "0.1 0.2</pose>"), "line 2: <pose>: 'pose' needs 6 numbers"),
    "mass": (SDF.replace("<mass>4", "<mass>-4"), "line 2: <inertial>: the mass -4 kg is negative"),
    "models": ('<sdf version="1.9"/>', "0 models: one is needed"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_with_their_place(name: str) -> None:
    text, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        import_file(text.encode())


def ports(content: str) -> dict[str, Any]:
    """The ports by name of a model of one link and more."""
    text = f'<sdf version="1.9"><model name="m"><link name="a"/>{content}</model></sdf>'
    found = import_file(text.encode()).definition.get("ports", [])
    return {port["name"]: port for port in found}


def test_chains_of_frames_are_read_once() -> None:
    """20,000 frames, each attached to the one before it or behind it: what one takes does not grow with all."""
    count = 20_000
    frames = [
        f'<frame name="f{k}" attached_to="{f"f{k - 1}" if k else "a"}"><pose>0 0 0.001 0 0 0</pose></frame>'
        for k in range(count)
    ]
    for given in (frames, frames[::-1]):
        start = process_time()
        found = ports("".join(given))
        assert process_time() - start < 30
        assert {port["body"] for port in found.values()} == {"a"}
        for name, port in found.items():
            assert float(port["position"][2]) == pytest.approx((int(name[1:]) + 1) / 1000)


def test_frames_in_a_circle_are_on_no_link() -> None:
    circle = "".join(f'<frame name="f{k}" attached_to="f{(k + 1) % 3}"/>' for k in range(3))
    assert not ports(circle).keys() & {"f0", "f1", "f2"}
    assert "g" not in ports(f'{circle}<frame name="g" attached_to="f0"/>')
