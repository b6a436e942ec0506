"""MJCF files: every way of saying something, beside MuJoCo; what is refused, and loops."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from substructures import Definition, TreeSpec, couple, derive, evaluate, linearise
from substructures.errors import InvalidDocument
from substructures.expr.interpret import interpret
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file
from substructures.interchange.mjcf.reader import read_mjcf
from substructures.interchange.xml import read_xml

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
sys.path.insert(0, str(Path(__file__).parent))
from corpus import compared  # noqa: E402 -- the engine is optional
from with_mujoco import MujocoTwin  # noqa: E402 -- the engine is optional

TURNED = '<geom type="box" size=".1 .2 .3" pos=".1 .2 .3" {}/>'
FEATURES = {
    "quat": ("", TURNED.format('quat="1 2 3 4"')),
    "axisangle": ("", TURNED.format('axisangle="1 2 3 40"')),
    "xyaxes": ("", TURNED.format('xyaxes="1 2 0 0 1 3"')),
    "zaxis": ("", TURNED.format('zaxis="1 -2 1"')),
    "zaxis down": ("", TURNED.format('zaxis="0 0 -1"')),
    "euler": ("", TURNED.format('euler="10 20 30"')),
    "euler in radian": ('<compiler angle="radian"/>', TURNED.format('euler=".1 .2 .3"')),
    "euler sequence": ('<compiler eulerseq="zyx"/>', TURNED.format('euler="10 20 30"')),
    "euler about fixed axes": ('<compiler eulerseq="XZY"/>', TURNED.format('euler="10 20 30"')),
    "mixed euler sequence": ('<compiler eulerseq="xYz"/>', TURNED.format('euler="10 20 30"')),
    "sphere": ("", '<geom size=".2" pos="1 0 0"/>'),
    "capsule": ("", '<geom type="capsule" size=".2 .5" density="300" pos="1 0 0"/>'),
    "capsule from to": ("", '<geom type="capsule" size=".2" fromto="0 0 1 1 2 3"/>'),
    "cylinder from to": ("", '<geom type="cylinder" size=".2" mass="3" fromto="0 0 1 1 2 3"/>'),
    "box from to": ("", '<geom type="box" size=".2" fromto="0 0 1 1 2 3"/>'),
    "ellipsoid": ("", '<geom type="ellipsoid" size=".2 .3 .4" quat="1 1 0 0"/>'),
    "ellipsoid from to": ("", '<geom type="ellipsoid" size=".2" fromto="0 0 1 1 2 3"/>'),
    "shells": ('<default><geom shellinertia="true" density="7"/></default>', '<geom size=".2" pos="1 0 0" density="9"/>'
               '<geom type="capsule" size=".2 .5" quat="1 1 0 0"/><geom type="box" size=".1 .2 .4" mass="3"/>'
               '<geom type="cylinder" size=".2" fromto="0 0 1 1 2 3"/><geom size=".3" shellinertia="false"/>'),
    "shell of an ellipsoid": ("", '<geom type="ellipsoid" size=".2 .3 .4" quat="1 1 0 1" shellinertia="true" '
                              'density="7"/><geom type="ellipsoid" size=".3" fromto="0 0 1 1 2 3" mass="2" '
                              'shellinertia="true"/>'),
    "two geoms": ("", '<geom size=".2" pos="1 0 0"/><geom type="box" size=".1 .1 .4" pos="0 1 0"/>'),
    "groups": ('<compiler inertiagrouprange="0 1"/>', '<geom size=".2"/><geom size=".5" group="2"/>'),
    "inertial": ("", '<inertial pos="1 2 3" mass="2" quat="1 2 0 0" diaginertia="1 2 2.5"/><geom size="1"/>'),
    "full inertia": ("", '<inertial pos="1 2 3" mass="2" fullinertia="3 4 5 .1 .2 .3"/>'),
    "inertia from geoms": ('<compiler inertiafromgeom="true"/>', '<inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/>'
                           '<geom size="1"/>'),
    "bounds": ('<compiler boundmass="3" boundinertia=".5"/>', '<geom size=".1" pos="1 0 0"/>'),
    "bounds of nothing": ('<compiler boundmass="3" boundinertia=".5"/>', '<geom size=".1" mass="0"/>'
                          '<body pos="1 0 0"><joint name="b"/></body><body pos="0 1 0"/>'),
    "inertial where no geom counts": ('<compiler inertiafromgeom="true" inertiagrouprange="1 2"/>', '<geom size="1"/>'
                                      '<inertial pos="1 0 0" mass="2" diaginertia="1 1 1"/>'),
    "sizes of classes": ('<default><geom type="box" size=".1 .2 .3"/><default class="x"><geom size=".4"/></default>'
                         '</default>', '<geom class="x" size=".5 .6" pos="1 0 0"/><geom class="x" pos="0 1 0"/>'
                         '<geom type="sphere" size=".7"/>'),
    "orientations of classes": ('<default><geom euler="10 20 30"/><default class="x"><geom zaxis="1 2 3"/></default>'
                                '</default>', '<geom class="x" type="box" size=".1 .2 .3" pos="1 0 0"/>'
                                '<geom type="box" size=".1 .2 .3"/>'),
    "balanced": ('<compiler balanceinertia="true"/>', '<inertial pos="1 0 0" mass="2" diaginertia="1 1 9"/>'),
    "bounds, then balanced": ('<compiler balanceinertia="true" boundinertia=".5"/>',
                              '<inertial pos="1 0 0" mass="2" diaginertia=".1 .1 1"/>'),
    "bounds and balanced": ('<compiler balanceinertia="true" boundinertia=".5"/>',
                            '<inertial pos="1 0 0" mass="2" diaginertia=".1 .1 9"/>'),
    "total mass": ('<compiler settotalmass="7"/>', '<geom size=".1" pos="1 0 0"/>'),
    "hinges": ("", '<geom size=".1"/><joint name="a" pos="1 2 3" axis="1 1 0"/><joint name="b" pos="-1 0 2"/>'),
    "ref": ("", '<geom size=".1" pos="1 2 0"/><joint name="a" pos="1 0 0" ref="30" springref="40" stiffness="3"/>'),
    "slide with ref": ("", '<geom size=".1"/><joint name="a" type="slide" axis="1 2 3" ref=".3" springref=".1" '
                       'stiffness="3" damping="2" armature=".5"/>'),
    "slide, then hinge": ("", '<geom size=".1" pos="1 0 0"/><joint name="a" type="slide" axis="1 0 0"/>'
                          '<joint name="b" pos="0 1 0"/>'),
    "ball": ("", '<geom size=".1" pos="1 0 0"/><joint name="a" type="ball" pos="0 0 .3" damping="2"/>'),
    "sprung ball": ("", '<geom size=".1" pos="1 0 0"/><joint name="a" type="ball" pos="0 0 .3" stiffness="3"/>'),
    "default classes": ('<default><joint damping="1"/><default class="x"><joint armature="2" axis="0 1 0"/>'
                        '<default class="y"><joint damping="4"/></default></default></default>',
                        '<geom size=".1" pos="1 0 0"/><joint name="a" class="y"/>'),
    "child classes": ('<default><default class="x"><geom size=".3"/></default></default>',
                      '<geom class="x"/><body childclass="x"><joint name="c"/><geom pos="0 1 0"/><body pos="1 0 0">'
                      '<joint name="d"/><geom/></body></body>'),
    "springdamper": ('<compiler settotalmass="7"/><default><joint springdamper=".1 .5" damping="9"/></default>'
                     '<actuator><general joint="a" armature=".2" damping=".4" gear="3"/></actuator>',
                     '<geom size=".1" pos="1 0 0"/><joint name="a" axis="0 1 0" ref="30" springref="50"/><body name="c"'
                     ' pos="1 0 .5"><joint name="b" type="slide" axis="1 1 0" ref=".4" springdamper=".2 3"/><joint '
                     'name="d" axis="1 0 1" springdamper="0 0" damping="2"/><geom size=".2" pos="0 1 0"/></body>'),
    "frames": ("", '<frame pos="1 2 3" euler="20 30 40"><geom type="box" size=".1 .2 .3"/><joint name="a" '
               'axis="1 0 0" pos=".1 .2 .3"/><body pos="1 0 0"><joint name="b"/><geom size=".1"/></body></frame>'),
    "copies": ("", '<replicate count="3" offset=".1 .2 .3" euler="20 30 40" sep="-"><geom type="box" size=".1 .2 .3"/>'
               '</replicate><replicate count="11" euler="10 0 40"><body name="x" pos="1 0 0">'
               '<joint name="j" axis="1 1 0"/><geom size=".1" pos="0 .3 0"/></body></replicate>'),
    "copies of copies": ('<compiler angle="radian" eulerseq="XYZ"/>', '<geom size=".1"/><replicate count="2" sep="_" '
                         'offset="1 0 0" euler=".1 .2 .3"><replicate count="2" offset="0 1 0"><body name="x"><joint '
                         'name="j"/><geom size=".1" pos="1 0 0"/></body></replicate></replicate>'),
}  # fmt: skip


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("base", ["", "<freejoint/>"])
@pytest.mark.parametrize("name", FEATURES)
def test_features_are_what_mujoco_makes_of_them(name: str, base: str, tmp_path: Path) -> None:
    head, body = FEATURES[name]
    root = f'<body name="root" pos=".1 .2 .3" euler="30 0 0">{base}<geom size=".3"/><body name="body">{body}'
    joint = "" if "<joint" in body else '<joint name="j"/>'
    path = tmp_path / "model.xml"
    path.write_text(f"<mujoco>{head}<worldbody>{root}{joint}</body></body></worldbody></mujoco>")
    row = compared(name, path, MujocoTwin)
    assert not row.refused
    assert row.error < 1e-10


@pytest.mark.filterwarnings("ignore")
def test_free_joints_have_armature_and_damping(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    body = '<body euler="10 20 30" pos="1 2 3"><joint type="free" armature="2" damping="3" stiffness="4"/>'
    path.write_text(f'<mujoco><worldbody>{body}<geom size=".3" pos="1 0 0"/></body></worldbody></mujoco>')
    assert compared("free", path, MujocoTwin).error < 1e-10


@pytest.mark.filterwarnings("ignore")
def test_the_armature_of_a_ball_on_what_stands_still_is_a_moment_of_inertia(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    head = '<mujoco><worldbody><body euler="10 20 30"><body pos="1 2 3"><joint type="ball" armature="2" pos="0 .1 0"/>'
    path.write_text(f'{head}<geom size=".3" pos="1 0 0"/></body></body></worldbody></mujoco>')
    assert compared("ball", path, MujocoTwin).error < 1e-10


@pytest.mark.parametrize("given", [".1 2", "1e-9 .5"])
def test_springdamper_gives_what_mujoco_makes_of_it_with_joints_that_others_move(given: str, tmp_path: Path) -> None:
    """The inertia is that of free joints, whatever equations bind them; numbers are told."""
    path = tmp_path / "model.xml"
    arm = f'<joint name="a" axis="0 1 0" springdamper="{given}"/><geom size=".1" pos="1 0 0"/><body pos="1 0 0">'
    path.write_text(
        f'<mujoco><worldbody><body name="x">{arm}<joint name="b" axis="0 1 1" springdamper=".3 .5" armature=".01"/>'
        '<geom size=".2" pos="1 0 1"/></body></body></worldbody>'
        '<equality><joint joint1="b" joint2="a" polycoef="0 2 0 0 0"/></equality></mujoco>'
    )
    found, engine = import_file(path.read_bytes()), mujoco.MjModel.from_xml_path(str(path))
    joints = [body["joint"] for body in found.definition["bodies"]]
    stiffness = [float(joint["stiffness"]) for joint in joints]
    assert stiffness == pytest.approx(np.ravel(engine.jnt_stiffness)[:2], rel=1e-12)
    assert [float(joint["damping"]) for joint in joints] == pytest.approx(np.ravel(engine.dof_damping)[:2], rel=1e-12)
    told = [remark["message"] for remark in found.report if "springdamper" in remark["message"]]
    assert [f"stiffness {k:.6g} and damping" in said for k, said in zip(stiffness, told, strict=True)] == [True, True]


@pytest.mark.parametrize("kind", ["ball", "free"])
def test_the_spring_of_a_ball_is_a_spring_at_rest_and_changes_its_sign_at_half_a_turn(kind: str) -> None:
    """Where its law is 0/0: M = 1, K = 3 about all axes; and -k theta about one axis, |theta| <= pi."""
    joint, inertia = f'<joint name="a" type="{kind}" stiffness="3"/>', 'pos="0 0 0" mass="1" diaginertia="1 1 1"'
    definition = import_file(one(f"{joint}<inertial {inertia}/>")).definition
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "definition": definition}]}
    model = couple(TreeSpec.read(tree), {"x": derive(Definition.read(definition))})
    n = len(model.coordinates)
    np.testing.assert_array_equal(linearise(model, np.zeros(n)).K, 3 * np.eye(n))
    turned = np.zeros((4, n))
    turned[:, -3] = [0, 1e-12, 3.1, 3.2]
    forces = evaluate(model, ["forces"], q=turned, qd=np.zeros((4, n)))["forces"][:, -3]
    np.testing.assert_allclose(forces, [0, -3e-12, -9.3, -3 * (3.2 - 2 * np.pi)], rtol=1e-14)


MESH = '<asset><mesh name="m" file="m.stl"/></asset>'


def one(inside: str, head: str = "") -> bytes:
    return f"<mujoco>\n{head}<worldbody>\n<body name='b'>\n{inside}\n</body></worldbody></mujoco>".encode()


BAD = {
    "mesh": (one('<joint/><geom name="g" type="mesh" mesh="m"/>', MESH),
             'line 4: <geom name="g">: the mass of a mesh needs its file: \'m.stl\' is not given'),
    "no mesh": (one('<joint/><geom type="mesh" mesh="../etc/passwd"/>', MESH), "there is no mesh '../etc/passwd'; .*m"),
    "fitted": (one('<joint/><geom type="box" mesh="m"/>', MESH), "a box fitted to a mesh is not read: give its size"),
    "shell of a mesh": (one('<joint/><geom type="mesh" mesh="m" shellinertia="true"/>', MESH), "inertia='shell'"),
    "inertia": (one('<joint/><geom type="mesh" mesh="m"/>', MESH.replace("/>", ' inertia="all"/>', 1)),
                "inertia='all' is none of legacy, exact, convex, shell"),
    "flat": (one('<joint/><geom type="mesh" mesh="m"/>', MESH.replace('file="m.stl"', 'vertex="0 0 0 1 0 0 0 1 0"')),
             "this mesh has no mass: its points have no convex hull"),
    "include": (b'<mujoco>\n<include file="/etc/passwd"/></mujoco>', "line 2: <include>: the file '/etc/passwd'"),
    "include in a body": (one('<include file="x.xml"/>'), "line 4: <include>: the file 'x.xml' is not followed"),
    "global": (one("<geom size='1'/>", '<compiler coordinate="global"/>'), "no longer in MJCF"),
    "rotor of a ball": (one('<joint/><geom size="1"/><body><joint type="ball" armature="1"/><geom size="1"/></body>'),
                        "needs quaternions: take rotations=quaternions"),
    "class": (one('<geom class="c" size="1"/>'), "no default class 'c'"),
    "zero axis": (one('<joint axis="0 0 0"/>'), "line 4: <joint>: the axis has no direction"),
    "zero quaternion": (one('<geom size="1" quat="0 0 0 0"/>'), "quat has no direction"),
    "two orientations": (one('<geom size="1" quat="1 0 0 0" euler="1 2 3"/>'), "give one of quat and euler"),
    "type": (one('<joint type="screw"/>'), "type='screw' is none of hinge"),
    "springdamper": (one('<joint springdamper="1 0"/>'), "line 4: <joint>: springdamper needs two positive numbers"),
    "springdamper of a ball": (one('<joint type="ball" springdamper="1 1"/>'), "springdamper of a ball or free joint"),
    "springdamper of nothing": (one('<joint springdamper="1 1"/>'), "line 4: <joint>: springdamper needs an inertia"),
    "springdamper of joints too many": (one('<joint springdamper="1 1"/><joint/><geom size="1"/>'), "is singular"),
    "polynomial": (one('<joint stiffness="1 2"/>'), "stiffness has to be one number"),
    "free below": (one('<body><freejoint/></body>'), "only a body of the world"),
    "free and hinge": (one('<freejoint/><joint/>'), "the only one of its body"),
    "replicate": (one('<replicate count="1.5"><geom size="1"/></replicate>'), "line 4: <replicate>: count is a whole"),
    "copies": (one('<replicate count="1000">' * 3 + "<geom/>" + "</replicate>" * 3), "when copies are written out"),
    "range reversed": (one('<joint limited="true" range="1 -1"/>'), "line 4: <joint>: the range 1 -1 needs a first"),
    "no size": (one("<geom/>"), "size needs 1 positive"),
    "negative mass": (one('<geom size="1" mass="-1"/>'), "the mass -1 kg is negative"),
    "two moments": (one('<inertial pos="0 0 0" mass="1" diaginertia="1 1 1" fullinertia="1 1 1 0 0 0"/>'),
                    "either 'diaginertia' or 'fullinertia' is needed"),
    "no moment": (one('<inertial pos="0 0 0" mass="1"/>'), "'diaginertia' or 'fullinertia' is needed"),
    "no mass to scale": (one("<joint/>", '<compiler settotalmass="5"/>'), "line 3: .*settotalmass has nothing"),
    "no body": (b"<mujoco/>", "the file has no <body>"),
    "two joints": (one('<joint name="j"/>\n<joint name="j" axis="1 0 0"/>'), "line 5: .* a second joint 'j'"),
    "two bodies": (one("<body name='b'/>"), "a second link 'b'"),
    "eulerseq": (one("", '<compiler eulerseq="abc"/>'), "three letters"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_with_their_place(name: str) -> None:
    data, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        import_file(data)


def test_files_are_included_where_they_are_given_along() -> None:
    file = b'<mujoco><include file="a.xml"/></mujoco>'
    found = import_file(file, included={"a.xml": one('<geom size="1"/>')})
    assert [b["name"] for b in found.definition["bodies"]] == ["b"]
    with pytest.raises(InvalidDocument, match=r"'a\.xml' is not followed"):
        import_file(file, included={"a.xml": file})


def test_what_has_no_name_gets_one_that_nothing_has() -> None:
    inside = (
        '<joint/><joint name="joint1" axis="1 0 0"/><geom size="1"/><body><geom size="1"/><body name="body2"/></body>'
    )
    found = import_file(one(inside))
    assert [b["joint"].get("coordinate") for b in found.definition["bodies"]][:2] == ["joint1_", "joint1"]
    assert len(found.definition["bodies"]) == 2


def test_closures_and_tendons_without_a_name_get_one_that_nothing_has() -> None:
    ends = 'body1="b" body2="c" anchor="1 0 0"'
    tendon = '<fixed {} stiffness="1"><joint joint="p" coef="1"/></fixed>'
    tendons = tendon.format('name="tendon2"') + tendon.format("")
    text = LOOP.format(f'<connect name="loop2" {ends}/><connect {ends}/>')
    text = text.replace("</mujoco>", f"<tendon>{tendons}</tendon></mujoco>")
    engine = mujoco.MjModel.from_xml_string(text)
    assert [engine.neq, engine.ntendon] == [2, 2]
    found = import_file(text.encode())
    assert found.tree is not None
    assert len(TreeSpec.read(found.tree).closures) == 2
    assert [tendon.name for tendon in read_mjcf(read_xml(text.encode())).tendons] == ["tendon2", "tendon2_"]


@pytest.mark.parametrize(
    ("head", "actuator"),
    [
        ('<general armature="2" gear="3"/>', "<motor {}/>"),
        ('<motor gear="3"/>', '<general {} armature="2"/>'),
        ('<position armature="2" damping="1"/><motor gear="3"/>', "<velocity {}/>"),
        ('<motor gear="3"/><default class="x"><position gear="5" armature="2"/></default>', '<velocity class="x" {}/>'),
    ],
)
def test_defaults_of_one_kind_of_actuator_are_those_of_all(head: str, actuator: str) -> None:
    on, inside = 'joint="j"', '<joint name="j"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    tail = f"<actuator>{actuator.format(on)}</actuator></mujoco>"
    data = one(inside, f"<default>{head}</default>").replace(b"</mujoco>", tail.encode())
    engine = mujoco.MjModel.from_xml_string(data.decode())
    state = mujoco.MjData(engine)
    state.qvel[:] = 1
    mujoco.mj_forward(engine, state)
    mass = np.zeros(1)
    mujoco.mj_mulM(engine, state, mass, np.ones(1))
    joint = import_file(data).definition["bodies"][0]["joint"]
    ours = [1 + float(joint["armature"]), -float(joint.get("damping", 0))]
    assert ours == pytest.approx([mass[0], state.qfrc_passive[0]])


@pytest.mark.parametrize("given", ["0 0", "1 -1", "-1 2"])
def test_a_range_without_limited_is_one_where_mujoco_has_it(given: str) -> None:
    data = one(f'<joint range="{given}"/><geom size="1"/>', '<compiler angle="radian"/>')
    engine = mujoco.MjModel.from_xml_string(data.decode())
    limits = import_file(data).definition["bodies"][0]["joint"].get("limits")
    expected = engine.jnt_range[0].tolist() if engine.jnt_limited[0] else None
    assert (limits and [float(x) for x in limits]) == expected


@pytest.mark.parametrize(
    "options",
    [
        '<option><flag gravity="disable"/></option><option><flag gravity="enable"/></option>',
        '<option><flag gravity="enable"/></option><option><flag gravity="disable"/></option>',
        '<option><flag gravity="disable"/></option><option gravity="0 0 -3"><flag contact="disable"/></option>',
        '<option gravity="0 0 -3"><flag spring="disable"/></option><option><flag spring="enable"/></option>',
    ],
)
def test_of_flags_the_last_counts_as_in_mujoco(options: str) -> None:
    text = LOOP.format('<connect body1="b" body2="c" anchor="1 0 0"/>').replace("<worldbody>", f"{options}<worldbody>")
    engine, found = mujoco.MjModel.from_xml_string(text), import_file(text.encode())
    assert found.tree is not None
    is_off = bool(engine.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY)
    assert TreeSpec.read(found.tree).gravity == ((0, 0, 0) if is_off else tuple(engine.opt.gravity))
    assert not any("springs and dampers" in remark["message"] for remark in found.report)


def test_what_is_left_out_is_told() -> None:
    tail = '<tendon><fixed name="t" armature="2"><joint joint="j" coef="1"/></fixed></tendon>'
    data = one('<joint name="j" frictionloss="1"/><geom size="1"/>').replace(b"</mujoco>", f"{tail}</mujoco>".encode())
    report = import_file(data.replace(b"<worldbody>", b'<option density="1.2"/><worldbody>')).report
    said = [r["message"] for r in report if r["level"] == "warning"]
    assert [any(word in text for text in said) for word in ("dry friction", "tendon", "fluid")] == [True] * 3


LOOP = """<mujoco><option gravity="0 0 -5"/><worldbody>
<body name="a" pos="0 0 1"><joint name="p" axis="0 1 0"/><geom type="capsule" size=".05" fromto="0 0 0 1 0 0"/>
<body name="b" pos="1 0 0" euler="0 30 0"><joint name="q" axis="0 1 0"/><geom type="capsule" size=".05"
 fromto="0 0 0 1 0 0"/></body></body>
<body name="c" pos="2 0 0" euler="0 0 20"><joint name="r" axis="0 1 0"/><geom size=".1" pos=".3 0 0"/></body>
</worldbody><equality>{}</equality></mujoco>"""


@pytest.mark.parametrize(("kind", "rows"), [("connect", 3), ("weld", 6)])
def test_connect_and_weld_are_closures(kind: str, rows: int) -> None:
    text = LOOP.format(f'<{kind} name="z" body1="b" body2="c" {"anchor" * (kind == "connect")}'.replace(
        "anchor", 'anchor="1 0 0"') + "/>")  # fmt: skip
    found = import_file(text.encode(), Options(parameters="none"))
    assert found.tree is not None
    spec = TreeSpec.read(found.tree)
    model = couple(spec, {"robot": derive(Definition.read(found.definition))})
    assert [float(x) for x in spec.gravity] == [0, 0, -5]
    engine = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(engine)
    for q in (np.zeros(3), np.array([0.3, -0.5, 0.7])):
        values = dict(zip(model.coordinates, q, strict=True))
        ours = interpret(model.program, values, ["closure.residual"])["closure.residual"]
        data.qpos[:] = q
        mujoco.mj_forward(engine, data)
        assert len(ours) == rows
        # the gap of the anchors, in whatever axes
        assert np.linalg.norm(ours[:3]) == pytest.approx(np.linalg.norm(data.efc_pos[:3]), abs=1e-12)
        if not q.any():
            assert np.abs(ours).max() < 1e-12


@pytest.mark.parametrize("given", ["", 'active="true"', 'class="on"'])
def test_constraints_that_a_class_takes_back_are_not_there(given: str) -> None:
    head = '<default><equality active="false"/><default class="on"><equality active="true"/></default></default>'
    bound = f'<connect body1="b" body2="c" anchor="1 0 0" {given}/><joint joint1="p" joint2="r" {given}/>'
    text = LOOP.format(bound).replace("<worldbody>", f"{head}<worldbody>")
    engine = mujoco.MjModel.from_xml_string(text)
    found = import_file(text.encode())
    closures = [] if found.tree is None else found.tree.get("closures", [])
    assert [len(closures), len(found.definition.get("relations", []))] == engine.eq_active0.tolist()


@pytest.mark.parametrize(
    ("site", "message"),
    [("tipp", "there is no site 'tipp'; did you mean 'tip'"), ("tip", "both bodies are 'c': name two")],
)
def test_closures_between_sites_need_two_that_are_there(site: str, message: str) -> None:
    """Those that are written by us are read in test_mjcf_out."""
    text = LOOP.format(f'<connect site1="tip" site2="{site}"/>').replace(
        "</body>\n</w", '<site name="tip"/></body>\n</w'
    )
    with pytest.raises(InvalidDocument, match=message):
        import_file(text.encode())
