"""Two models are the same, or the body and the parameter that differ are named."""

from __future__ import annotations

import re
from decimal import Decimal
from typing import Any

import pytest
from catalogue_entries import shipped_part

from substructures import Definition, TreeSpec, derive
from substructures.documents import read_json, write_json
from substructures.errors import InvalidArgument
from substructures.interchange.equivalence import Equivalence, equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side

ARM = """<robot name="arm"><link name="ground"/>
<link name="upper"><inertial><origin xyz="0.1 0 0.3" rpy="0.1 0.2 0.3"/><mass value="4"/>
 <inertia ixx="0.3" iyy="0.4" izz="0.2" ixy="0.01" ixz="0.02" iyz="0.03"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.1 0.2"/><mass value="2"/>
 <inertia ixx="0.1" iyy="0.1" izz="0.05"/></inertial>
</link>
<link name="tool"><inertial><origin xyz="0 0 0.05"/><mass value="0.5"/>
 <inertia ixx="0.01" iyy="0.01" izz="0.01"/></inertial>
</link>
<joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/><axis xyz="0 1 0"/>
 <origin xyz="0 0 0.4"/><dynamics damping="0.5"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/>
 <origin xyz="0 0.1 0.6" rpy="0.3 0 0"/></joint>
<joint name="flange" type="fixed"><parent link="lower"/><child link="tool"/>
 <origin xyz="0 0 0.5" rpy="0 0.7 0"/></joint>
</robot>"""
#: the same arm with the tool counted with the lower link, in MJCF, whose axes are turned there
TWIN = """<mujoco><compiler angle="radian" eulerseq="XYZ"/><worldbody>
<body name="first" pos="0 0 0.4"><joint name="shoulder" axis="0 1 0" damping="0.5"/>
 <inertial pos="0.1 0 0.3" euler="0.1 0.2 0.3" mass="4" fullinertia="0.3 0.4 0.2 0.01 0.02 0.03"/>
 <body name="second" pos="0 0.1 0.6" euler="0.3 0 0"><joint name="elbow" axis="1 0 0"/>
  <geom type="ellipsoid" size="1 1 1" pos="0 0.1 0.2" mass="0"/>
  <inertial pos="0 0.1 0.2" mass="2" diaginertia="0.1 0.1 0.05"/>
  <body name="third" pos="0 0 0.5" euler="0 0.7 0">
   <inertial pos="0 0 0.05" mass="0.5" diaginertia="0.01 0.01 0.01"/></body></body></body>
</worldbody></mujoco>"""


def side(text: str, **options: Any) -> Side:
    definition = import_file(text.encode(), Options(**options)).definition
    return Side.of_part(derive(Definition.read(definition)))


def changed(pattern: str, new: str, text: str = ARM) -> str:
    result, count = re.subn(pattern, new, text, count=1)
    assert count
    return result


def compared(a: str, b: str, **options: Any) -> Equivalence:
    return equivalence(side(a, **options), side(b, **options))


def test_a_file_is_itself_by_formulas() -> None:
    found = compared(ARM, ARM)
    assert (found.equal, found.level) == (True, "formulas")
    assert found.quantities["metric"] == {"formulas": True, "error": 0.0}


def test_values_of_parameters_are_compared_where_formulas_are_the_same() -> None:
    found = compared(ARM, changed('mass value="4"', 'mass value="4.5"'))
    assert not found.equal
    assert found.quantities["metric"]["formulas"]
    assert found.first_difference is not None
    assert found.first_difference["quantity"] == "metric"
    assert [c.plain() for c in found.culprits] == [
        {"body": "upper", "parameter": "mass", "a": pytest.approx(4), "b": pytest.approx(4.5)}
    ]


@pytest.mark.parametrize("ours", ["ports", "bodies"])
def test_files_of_different_kinds_are_the_same(ours: str) -> None:
    found = equivalence(side(ARM, fixed=ours, parameters="none"), side(TWIN, parameters="none"))
    assert (found.equal, found.level) == (True, "values")
    assert max(q["error"] for q in found.quantities.values()) < 1e-12


@pytest.mark.parametrize(
    ("pattern", "new", "body", "parameters"),
    [
        ('mass value="2"', 'mass value="2.1"', "lower", {"mass", "com.x", "com.y", "com.z", "inertia.xx"}),
        ('ixy="0.01"', 'ixy="-0.01"', "upper", {"inertia.xy"}),
        ('xyz="0.1 0 0.3"', 'xyz="0.1 0 0.31"', "upper", {"com.z"}),
        ('rpy="0.1 0.2 0.3"', 'rpy="0.3 0.2 0.1"', "upper", {"inertia.xx", "inertia.yy", "inertia.xy"}),
        ('xyz="0 0.1 0.6"', 'xyz="0 0.1 0.65"', "lower", {"position"}),
        ('<axis xyz="1 0 0"/>', '<axis xyz="1 0.1 0"/>', "lower", {"axis"}),
        ('damping="0.5"', 'damping="0.6"', "shoulder", {"damping"}),
    ],
)
def test_the_culprit_is_named(pattern: str, new: str, body: str, parameters: set[str]) -> None:
    found = compared(ARM, changed(pattern, new), parameters="none")
    assert not found.equal
    assert {c.body for c in found.culprits} == {body}
    assert {c.parameter for c in found.culprits} & parameters


def swinging(mass: float) -> Side:
    joint = {"type": "revolute", "coordinate": "q", "theta": "pi/2"}
    body = {"name": "b", "parent": "base", "mass": mass, "com": [0.3, 0, 0], "joint": joint}
    body["inertia"] = {"xx": 0.01, "yy": 0.01, "zz": 0.01}
    return Side.of_part(derive(Definition.read({"name": "a", "bodies": [body]})))


@pytest.mark.parametrize("mass", [2, 1.000001])
def test_what_differs_is_told_as_json(mass: float) -> None:
    told = read_json(write_json(equivalence(swinging(1), swinging(mass)).plain()))
    assert told["equal"] is False
    assert told["culprits"] == [{"body": "b", "parameter": "mass", "a": 1, "b": pytest.approx(Decimal(str(mass)))}]


def test_armature_is_named() -> None:
    armed = changed('axis="1 0 0"', 'axis="1 0 0" armature="0.2"', TWIN)
    assert {(c.body, c.parameter) for c in compared(TWIN, armed).culprits} == {("elbow", "armature")}


def test_base_parameters_count_not_the_split() -> None:
    """A mass on the elbow's axis may be counted with either link: no difference, and no culprit beside another one."""
    point = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="0" iyy="0" izz="0"/></inertial></link>'
    fixed = '<joint name="{0}" type="fixed"><parent link="{1}"/><child link="{0}"/><origin xyz="{2}"/></joint>'
    before = ARM.replace("</robot>", point.format("w") + fixed.format("w", "upper", "0 0.1 0.6") + "</robot>")
    after = ARM.replace("</robot>", point.format("w") + fixed.format("w", "lower", "0 0 0") + "</robot>")
    assert compared(before, after, parameters="none").equal
    other = changed('damping="0.5"', 'damping="0.6"', after)
    assert {c.body for c in compared(before, other, parameters="none").culprits} == {"shoulder"}


def test_coordinates_may_have_other_names() -> None:
    renamed = ARM.replace('"elbow"', '"q2"')
    with pytest.raises(InvalidArgument, match=r"coordinates cannot be matched by name \(elbow\)"):
        compared(ARM, renamed)
    assert equivalence(side(ARM), side(renamed), {"elbow": "q2"}).equal
    assert not compared(ARM, changed('type="fixed"', 'type="revolute"')).equal


def test_the_order_of_coordinates_does_not_matter() -> None:
    two = '<robot name="r"><link name="g"/>{}</robot>'
    one = (
        '<link name="{0}"><inertial><origin xyz="0.1 0 0"/><mass value="{1}"/><inertia ixx="1" iyy="1" izz="1"/>'
        '</inertial></link><joint name="j{0}" type="revolute"><parent link="g"/><child link="{0}"/></joint>'
    )
    first, second = one.format("a", 1), one.format("b", 2)
    found = compared(two.format(first + second), two.format(second + first))
    assert (found.equal, found.level) == (True, "formulas")


def test_trees_are_compared_with_parts() -> None:
    definition = import_file(ARM.encode()).definition
    part = derive(Definition.read(definition))
    document = {"name": "t", "gravity": [1, 2, 3], "instances": [{"name": "arm", "definition": definition}]}
    tree = Side.of_tree(TreeSpec.read(document), {"arm": part})
    assert equivalence(tree, Side.of_part(part, tree.spec)).equal
    found = equivalence(tree, Side.of_part(part))
    assert not found.equal
    assert found.first_difference is not None
    assert found.first_difference["quantity"] == "gravity"


ROD = {"name": "rod", "type": "rod", "from": "x.tip", "to": "world", "length": 0.7}


@pytest.mark.parametrize(
    ("closures", "quantity"),
    [
        ([ROD], None),
        ([], "closures"),
        ([{**ROD, "length": 0.8}], "closure.residual"),
        ([{**ROD, "placement": {"position": [1, 0, 0]}}], "closure.residual"),
    ],
)
def test_closures_are_compared(closures: list[dict[str, Any]], quantity: str | None) -> None:
    part = shipped_part("acrobot")
    plain = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "acrobot"}]}
    a, b = (Side.of_tree(TreeSpec.read({**plain, "closures": c}), {"x": part}) for c in ([ROD], closures))
    found = equivalence(a, b)
    assert found.equal == (quantity is None)
    assert quantity is None or (found.first_difference or {})["quantity"] == quantity


def test_last_names_are_taken_only_where_they_are_clear() -> None:
    part = shipped_part("acrobot")
    plain: dict[str, Any] = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": []}
    plain["instances"] = [{"name": name, "substructure": "acrobot"} for name in ("one", "two")]
    two = Side.of_tree(TreeSpec.read(plain), {"one": part, "two": part})
    plain["instances"] = [{"name": name, "substructure": "acrobot"} for name in ("three", "two")]
    other = Side.of_tree(TreeSpec.read(plain), {"three": part, "two": part})
    with pytest.raises(InvalidArgument, match="cannot be matched by name"):
        equivalence(two, other)
    assert equivalence(two, other, {"one.q1": "three.q1", "one.q2": "three.q2"}).equal


DECK = {"name": "deck", "bodies": [
    {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "z"}},
    {"name": "r", "parent": "b", "mass": 2, "com": [0, 1, 0],
     "joint": {"type": "revolute", "coordinate": "q", "theta": "-pi/2"}},
]}  # fmt: skip


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("sin(t)", "cos(t - pi/2)", True),
        ("t^4", "2*t^4", False),  # alike at t = 0
        ("t^4", {"input": True}, False),
        ({"input": True}, {"input": True}, True),
    ],
)
def test_given_motions_are_compared_at_other_times(one: Any, other: Any, same: bool) -> None:
    def driven(motion: Any) -> Side:
        tree = {"name": "t", "instances": [{"name": "a", "substructure": "deck"}], "driven": {"a.z": motion}}
        return Side.of_tree(TreeSpec.read(tree), {"a": derive(DECK)})

    found = equivalence(driven(one), driven(other))
    assert found.equal is same
    assert same or found.first_difference is not None


def test_loads_that_vary_are_compared_at_other_times() -> None:
    def pushed(force: str) -> Side:
        load = {"type": "joint", "coordinate": "q", "force": force}
        return Side.of_part(derive({**DECK, "loads": [load]}))

    assert not equivalence(pushed("t"), pushed("t^2 + t - t^2*3")).equal
    assert equivalence(pushed("(t + 1)^2"), pushed("t^2 + 2*t + 1")).equal
