"""What files say beside the equations: nothing is lost in silence, and nothing is refused that needs not be."""

from __future__ import annotations

import json

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.errors import InvalidDocument
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import Imported, import_file
from substructures.tree.publishing.published import Publication, published

from .seeds import DH, MJCF, PAR, SDF, TABLE, URDF

BODY = '<inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
ARM = f"""<robot name="r"><link name="a"/><link name="b">{BODY}</link><link name="c">{BODY}</link>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>
<joint name="k" type="continuous"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>MORE</joint>
</robot>"""
ROLLING = ARM.replace("continuous", "TYPE", 1).replace("</joint>", '<dynamics damping="1" friction="2"/></joint>', 1)
BOUNDED = ROLLING.replace("<dynamics", '<limit lower="-1" upper="1"/><dynamics')
GENERAL = '<actuator><general joint="j"/></actuator>'
POLE = """<mujoco><worldbody><body name="b"><joint name="j" axis="0 1 0"/>
<inertial pos="0 0 0" mass="1" diaginertia=".7 .7 .7"/></body></worldbody>MORE</mujoco>"""
BOX = """<sdf version="VERSION"><model name="m"><link name="a"><pose>0 0 0 0 0 0.5</pose><inertial><mass>1</mass>
<inertia><ixx>.1</ixx><iyy>.2</iyy><izz>.3</izz></inertia></inertial>LINK</link>
<joint name="j" type="revolute"><parent>world</parent><child>a</child><axis><xyz>1 0 0</xyz>AXIS</axis></joint>
</model></sdf>"""


def read(text: str, **more: object) -> Imported:
    return import_file(text.encode(), Options("none"), **more)  # type: ignore[arg-type]


def without_holes(text: str) -> str:
    """The file with nothing where tests put something in."""
    for hole, filling in (("MORE", ""), ("VERSION", "1.9"), ("LINK", ""), ("AXIS", "")):
        text = text.replace(hole, filling)
    return text


def box(version: str = "1.9", link: str = "", axis: str = "") -> Imported:
    return read(BOX.replace("VERSION", version).replace("LINK", link).replace("AXIS", axis))


def model_of(found: Imported) -> Model:
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, -10], "instances": [{"name": "x", "substructure": "robot"}]})
    return couple(spec, {"x": derive(Definition.read(found.definition))})


def metric(found: Imported, q: list[float]) -> np.ndarray:
    return np.asarray(evaluate(model_of(found), ["metric"], q=q)["metric"])


def warnings_of(found: Imported) -> list[str]:
    return [remark["message"] for remark in found.report if remark["level"] == "warning"]


def kept(found: Imported) -> list[str]:
    """What the definition tells of its source."""
    return [each["message"] for each in found.definition.get("left_out", ())]


TURNED = 0.1 * np.cos(0.5) ** 2 + 0.2 * np.sin(0.5) ** 2
DECLARED = '<?xml version="1.0"?>'


@pytest.mark.parametrize("before", ["\n\n", "<!-- made by hand -->\n", " <!-- a --><!-- b -->\n<!-- <?xml?> -->"])
def test_a_declaration_behind_blank_lines_and_comments_is_read_with_the_lines_of_the_file(before: str) -> None:
    assert metric(read(before + DECLARED + ARM), [0, 0]).shape == (2, 2)
    with pytest.raises(InvalidDocument, match=f"line {before.count(chr(10)) + 3}: <child link=.nobody.>"):
        read(before + DECLARED + ARM.replace('child link="c"', 'child link="nobody"'))
    with pytest.raises(InvalidDocument, match="document types, entities and external files are refused"):
        read(before + DECLARED + '<!DOCTYPE r [<!ENTITY a "b">]>' + ARM)


def test_comments_that_are_not_closed_end_at_once() -> None:
    for text in ("<!--" * 100_000, "<!---->" * 100_000, "<!-- -" * 100_000 + DECLARED):
        with pytest.raises(InvalidDocument):
            read(text)


def test_prefixes_hide_no_inclusion_and_no_macro() -> None:
    for text in (
        '<robot xmlns:i="http://www.w3.org/2001/XInclude"><i:include href="/etc/passwd"/></robot>',
        '<robot><xi:include href="/etc/passwd"/></robot>',
    ):
        with pytest.raises(InvalidDocument, match="XInclude is not followed"):
            read(text)
    with pytest.raises(InvalidDocument, match="expand it first"):
        read('<robot xmlns:x="http://www.ros.org/wiki/xacro"><x:arg name="a"/></robot>')


def test_the_world_is_there_without_being_written() -> None:
    found = read(ARM.replace('<link name="a"/>', "").replace('parent link="a"', 'parent link="world"'))
    assert metric(found, [0, 0]) == pytest.approx(np.array([[2, 1], [1, 1]]))
    assert [(r["level"], r["line"]) for r in found.report] == [("merged", 2)]
    weld = POLE.replace("MORE", '<equality><connect body1="BODIES" anchor=".1 .2 .3"/></equality>')
    loops = [read(weld.replace("BODIES", both)).tree for both in ('b" body2="world', 'world" body2="b', "b")]
    assert loops[0]["closures"] == loops[1]["closures"] == loops[2]["closures"]  # type: ignore[index]


@pytest.mark.parametrize(
    ("version", "axis", "expected"),
    [
        ("1.4", "", TURNED),
        ("1.5", "", 0.1),
        (
            "1.6",
            "<use_parent_model_frame>true</use_parent_model_frame>",
            0.1 * np.cos(0.5) ** 2 + 0.2 * np.sin(0.5) ** 2,
        ),
        ("1.6", "<use_parent_model_frame>0</use_parent_model_frame>", 0.1),
    ],
)
def test_axes_in_the_frame_of_the_model(version: str, axis: str, expected: float) -> None:
    """n . I n with n = (1, 0, 0) in the model, which is turned by -0.5 in the link."""
    assert metric(box(version, axis=axis), [0.3]) == pytest.approx(np.array([[expected]]))


def test_rotors_behind_gears_are_armatures_in_every_format() -> None:
    axis = "<drake:rotor_inertia>0.001</drake:rotor_inertia><drake:gear_ratio>100</drake:gear_ratio>"
    assert metric(box(axis=axis), [0]) == pytest.approx(np.array([[10.1]]))
    # what MuJoCo has
    motor = '<actuator><motor joint="j" gear="100" armature="0.001"/><motor joint="j" armature=".1"/></actuator>'
    assert metric(read(POLE.replace("MORE", motor)), [0]) == pytest.approx(np.array([[10.8]]))
    damped = read(POLE.replace("MORE", '<actuator><motor joint="j" gear="10" damping="0.5"/></actuator>'))
    assert evaluate(model_of(damped), ["forces"], q=[0], qd=[2])["forces"] == pytest.approx([-100])
    pr2 = "<mechanicalReduction>50</mechanicalReduction>"
    drive = f'<transmission name="t"><joint name="k"/><actuator name="m"><rotor_inertia value="0.002"/></actuator>{pr2}'
    found = read(ARM.replace("MORE", "").replace("</robot>", f"{drive}</transmission></robot>"))
    assert metric(found, [0, 0])[1, 1] == pytest.approx(1 + 50**2 * 0.002)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            ARM.replace("</robot>", '<transmission><joint name="j"/><joint name="k"/><actuator name="m">'
            '<rotor_inertia value="1"/></actuator></transmission></robot>'),
            "the rotor inertia is left out: it moves with 'j', 'k'",
        ),
        (ARM.replace("MORE", '<dynamics friction="1"/>'), "dry friction is not read"),
        (ROLLING.replace("TYPE", "planar"), "damping of a planar joint is not read"),
        (ROLLING.replace("TYPE", "floating"), "damping of a floating joint is not read"),
        (ROLLING.replace("TYPE", "floating"), "dry friction is not read"),
        (BOUNDED.replace("TYPE", "planar"), "limits of a planar joint are not read"),
        (POLE.replace('axis="0 1 0"', 'type="ball" range="0 60"'), "range of a ball joint is not read"),
        (ARM.replace("</robot>", "<gazebo><springStiffness>3</springStiffness></gazebo></robot>"), "<springStiffness>"),
        (ARM.replace("</robot>", '<mujoco><compiler balanceinertia="true"/></mujoco></robot>'), "<compiler>"),
        (ARM.replace("MORE", '<mimic joint="jj"/>'), "no joint 'jj'; did you mean 'j'?"),
        (POLE.replace("MORE", '<actuator><position joint="j" kp="3"/></actuator>'), "actuator <position>"),
        (POLE.replace("MORE", f'<default><position kp="3"/></default>{GENERAL}'), "actuator <general>"),
        (POLE.replace("MORE", '<option><flag spring="disable"/></option>'), "springs and dampers"),
        (POLE.replace("MORE", '<actuator><motor site="s" armature="1"/></actuator>'), "the armature of an actuator"),
        (POLE.replace('axis="0 1 0"', 'axis="0 1 0" springyield="1"'), "springyield"),
        (BOX.replace("LINK", "<gravity>false</gravity>"), "<gravity>"),
        (BOX.replace("LINK", "<velocity_decay><linear>1</linear></velocity_decay>"), "<linear>"),
        (BOX.replace("<link", "<static>true</static><link"), "<static>"),
    ],
)  # fmt: skip
def test_what_is_left_out_is_told_by_the_file_the_part_and_the_tree(text: str, said: str) -> None:
    found = read(without_holes(text))
    assert any(said in message for message in warnings_of(found))
    assert any(said in message for message in kept(found))
    told = [w["message"] for w in model_of(found).certificate["warnings"] if w["code"] == "left-out"]
    assert any(said in message for message in told)


def test_what_is_left_out_at_several_places_is_kept_once() -> None:
    friction = '<dynamics friction="1"/></joint>'
    (message,) = kept(read(ARM.replace("MORE", "").replace("</joint>", friction)))
    assert message.startswith("line 2: <dynamics> and 1 more: dry friction")


def test_messages_are_not_longer_than_a_definition_may_keep() -> None:
    long = ARM.replace('name="k"', f'name="{"k" * 9000}"').replace("MORE", '<mimic joint="j"/>')
    (told,) = (each for each in (read(long, cut=["c"]).tree or {})["instances"] if "left_out" in each["definition"])
    assert [len(each["message"]) for each in told["definition"]["left_out"]] == [2000]
    Definition.read(told["definition"])


def test_relations_name_coordinates_of_the_part() -> None:
    found = read(ARM.replace("MORE", '<mimic joint="j" multiplier="2"/>')).definition
    (relation,) = found.pop("relations")
    assert relation == {"coordinate": "k", "of": "j", "multiplier": 2, "offset": 0}
    found["left_out"] = [{"message": "of old", "relation": relation | {"of": "i", "offset": "m"}}]
    with pytest.raises(InvalidDocument) as raised:
        derive(Definition.read(found))
    assert [fault.pointer for fault in raised.value.faults] == [
        "/left_out/0/relation/of",
        "/left_out/0/relation/offset",
    ]


def test_a_relation_between_parts_is_told_in_words_by_the_one_that_follows() -> None:
    found = read(ARM.replace("MORE", '<mimic joint="j"/>'), cut=["c"])
    assert found.tree is not None
    first, second = (each["definition"] for each in found.tree["instances"])
    assert "left_out" not in first
    (told,) = second["left_out"]
    assert "relation" not in told
    assert "'k' = 1 * 'j'" in told["message"]
    assert found.bindings[0]["coordinate"] == "c.k"
    assert found.bindings[0]["of"] == "robot.j"


def test_a_tree_that_becomes_a_part_keeps_what_is_left_out() -> None:
    found = read(ARM.replace("MORE", '<mimic joint="j" multiplier="2"/>')).definition
    found["left_out"] = [{"message": "of old", "relation": found.pop("relations")[0]}]
    part = derive(Definition.read(found))
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "r"}]})
    made = published(spec, {"x": part}, Publication({"name": "whole"})).definition
    (told,) = made.left_out
    assert told.relation is not None
    assert (told.relation.coordinate, told.relation.of, told.relation.multiplier) == ("x_k", "x_j", 2)
    assert [w["code"] for w in derive(made).certificate["warnings"]] == ["left-out"]


@pytest.mark.parametrize("text", [URDF, MJCF, SDF, DH, TABLE, PAR])
def test_known_names_are_not_told(text: str | bytes) -> None:
    data = text.encode() if isinstance(text, str) else text
    assert not any("not known" in remark["message"] for remark in import_file(data).report)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (ARM.replace("MORE", "<dynamcs/>"), "<dynamcs> is not known in <joint> and ignored; did you mean 'dynamics'?"),
        (ARM.replace("<mass", '<axis xyz="0 0 1"/><mass'), "in <inertial> and ignored; it belongs in <joint>"),
        (ARM.replace("<link name=\"a\"/>", f'<link name="a"><visual>{BODY}</visual></link>'), "it belongs in <link>"),
        (ARM.replace("<mass", '<mass xyz="1 0 0"'), "'xyz' is not known here and ignored; it belongs in"),
        (POLE.replace("mass=", 'friction="1" mass='), "'friction' is not known here and ignored; it belongs"),
        (POLE.replace("axis=", 'armatur="1" axis='), "did you mean 'armature'?"),
        (POLE.replace("MORE", '<default><joint dampin="1"/></default>'), "did you mean 'damping'?"),
        (BOX.replace("AXIS", "<dynamics><dampin>1</dampin></dynamics>"), "<dampin> is not known in <dynamics>"),
        (BOX.replace("LINK", "<mass>1</mass>"), "<mass> is not known in <link> and ignored; it belongs in <inertial>"),
    ],
)  # fmt: skip
def test_names_that_are_not_known_are_told_with_what_was_meant(text: str, said: str) -> None:
    found = read(without_holes(text))
    assert any(said in message for message in warnings_of(found)), warnings_of(found)


def test_the_gravity_of_a_file_is_told_where_a_part_is_made_of_it() -> None:
    found = read(POLE.replace("MORE", '<option gravity="0 0 -1.62"/>'))
    assert list(map(str, found.gravity or ())) == ["0", "0", "-1.62"]
    assert 'gravity is that of a tree: give it "gravity": [0, 0, -1.62]' in warnings_of(found)
    plain = read(POLE.replace("MORE", ""))
    assert list(map(str, plain.gravity or ())) == ["0", "0", "-9.81"]
    assert not warnings_of(plain)
    assert read(ARM.replace("MORE", "")).gravity is None


def test_headless_tables_are_told_that_they_have_no_head() -> None:
    with pytest.raises(InvalidDocument, match="the first line of a table names its columns, a, alpha, d, theta"):
        import_file(b"0,0,0.3,0,2\n0.4,0,0,0,1\n")


def test_expressions_and_coordinates_in_tables() -> None:
    rows = [
        {"a": 0, "alpha": 0, "d": "h", "theta": "th1 - pi/4", "mass": "m", "cx": "L/2"},
        {"a": "L", "alpha": "-pi/2", "d": "s", "theta": "pi/6", "type": "P", "mass": 1},
    ]
    found = import_file(json.dumps({"convention": "modified", "dh": rows}).encode())
    joints = [body["joint"] for body in found.definition["bodies"]]
    assert [joint["coordinate"] for joint in joints] == ["th1", "s"]
    assert (joints[0]["phi"], joints[1]["phi"], joints[1]["theta"]) == ("- pi/4", "pi/6", "-pi/2")
    assert {name: p.get("unit") for name, p in found.definition["parameters"].items()} == {
        "h": "m", "m": "kg", "L": "m", "m_link2": "kg"
    }  # fmt: skip
    names = ["name", "type", "a", "alpha", "d", "theta", "mass", "cx"]
    lines = [
        ",".join(str({"name": "", "type": "R"}.get(n, "") if n not in row else row[n]) for n in names) for row in rows
    ]
    table = "# convention: modified\n" + ",".join(names) + "\n" + "\n".join(lines)
    same = import_file(table.encode())
    assert same.definition["bodies"] == found.definition["bodies"]
    assert derive(Definition.read(found.definition)).dof == 2


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ("0,0,0,pi/2,1", "'pi/2' beside numbers in deg: write the table in SI units"),
        ("0,0,h+20,0,1", "'h\\+20' beside numbers in mm"),
        ("0,nan,0,0,1", "'alpha' is no finite number: 'nan'"),
        ("0,0,0,3OO,1", "'theta' is no finite number: '3OO'"),
        ("0,0,q1,0,1", "q1 stands for a coordinate"),
    ],
)
def test_expressions_that_mean_two_things_are_refused(row: str, said: str) -> None:
    table = "# convention: modified\n# length: mm\n# angle: deg\na,alpha,d,theta,mass\n" + row
    with pytest.raises(InvalidDocument, match=said):
        import_file(table.encode())


def test_computed_vectors_and_those_of_programs_are_cleaned() -> None:
    origin = (
        '<origin xyz="0.3 2.2204460492503132e-17 0"/><axis xyz="-0.70710678118654746 1.1e-16 0.70710678118654757"/>'
    )
    found = read(ARM.replace('<axis xyz="0 1 0"/></joint>\n<joint', f"{origin}</joint>\n<joint").replace("MORE", ""))
    joint = found.definition["bodies"][1]["joint"]
    assert joint["placement"]["position"][1] == 0
    assert joint["axis"] == [-1, 0, 1]
    frame = POLE.replace("<joint", '<frame euler="0 90 45"><joint').replace("/>\n<inertial", "/></frame>\n<inertial")
    body = read(frame.replace("MORE", "").replace('"0 1 0"', '"0 0 1"')).definition["bodies"][0]
    assert body["joint"]["axis"] == [1, 0, 0]
