"""A file that is cut at links is, coupled again, the same robot."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from substructures import Definition, TreeSpec, derive
from substructures.errors import InvalidArgument, InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sides import Side

BODY = '<inertial><origin xyz=".1 .02 -.03" rpy=".1 .2 .3"/><mass value="{m}"/><inertia ixx=".3" iyy=".4" izz=".5" ixy=".01" ixz="0" iyz=".02"/></inertial>'  # noqa: E501


def joint(name: str, parent: str, child: str, kind: str = "revolute", more: str = "") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz=".1 .2 .3" rpy=".3 -.2 .5"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="1 2 3"/>{more}</joint>'


#: a torso with two arms; the left one has a hand on fixed links, whose finger mimics
TORSO = "".join(
    [
        '<robot name="two arms">',
        *(f'<link name="{x}">{BODY.format(m=k + 1)}</link>' for k, x in enumerate(("base", "torso", "left", "right"))),
        *(f'<link name="{x}">{BODY.format(m=k + 5)}</link>' for k, x in enumerate(("hand", "finger", "thumb"))),
        '<link name="flange"/>',
        joint("waist", "base", "torso"),
        joint("left_shoulder", "torso", "left"),
        joint("right_shoulder", "torso", "right", "prismatic", '<limit lower="-1" upper="1" effort="1" velocity="1"/>'),
        joint("screws", "left", "flange", "fixed"),
        joint("adapter", "flange", "hand", "fixed"),
        joint("grip", "hand", "finger", "continuous"),
        joint("counter", "finger", "thumb", "continuous", '<mimic joint="grip" multiplier="-2" offset=".1"/>'),
        "</robot>",
    ]
).encode()
MJCF = b"""<mujoco><option gravity="0 0 -5"/><worldbody>
<body name="a" pos="0 0 1"><joint name="j" axis="0 1 0" pos="0 0 .1"/><geom size=".1 .2" type="capsule"/>
  <body name="b" pos=".2 0 -.5"><joint name="k1" axis="0 1 0"/><joint name="k2" axis="1 0 0" pos=".1 0 0"/>
    <geom type="box" size=".1 .2 .3"/>
    <body name="c" pos=".2 .1 0"><joint name="l" type="slide"/><geom size=".1"/></body></body></body></worldbody>
<equality><connect body1="c" body2="a" anchor=".3 0 0"/><connect body1="b" anchor=".3 0 0"/></equality></mujoco>"""


def side(found: Imported) -> Side:
    if found.tree is None:
        return Side.of_part(derive(Definition.read(found.definition)))
    plain = {**found.tree, "gravity": ["gx", "gy", "gz"]}
    plain["parameters"] = {name: {"value": value} for name, value in (("gx", "0.7"), ("gy", "-1.3"), ("gz", "-9.5"))}
    spec = TreeSpec.read(plain)
    return Side.of_tree(spec, {i.name: derive(i.definition) for i in spec.instances if i.definition})


def coordinates(a: Imported, b: Imported) -> dict[str, str]:
    """Names of joints in a to those in b."""
    pairs: dict[str, str] = {}
    for there, ours in a.names.items():
        if there.startswith("joint ") and ours:  # a fixed joint has no coordinate
            prefix = "" if a.tree is None or len(a.tree["instances"]) > 1 else "robot."
            names = [x.removeprefix(prefix) for x in ours.split(", ")]
            pairs |= dict(zip(names, b.names[there].split(", "), strict=True))
    return {name: other for name, other in pairs.items() if name not in moved(a)}


def moved(found: Imported) -> set[str]:
    """The joints that relations of the whole move."""
    return {each["coordinate"] for each in found.definition.get("relations", ())}


@pytest.mark.parametrize("parameters", ["none", "inertia", "all"])
@pytest.mark.parametrize("links", [["left", "right"], ["hand"], ["flange", "finger"], ["torso", "left", "thumb"]])
def test_coupled_again_it_is_the_whole(links: list[str], parameters: Any) -> None:
    """A joint that follows one of another part is free there, and told of."""
    options, between = Options(parameters), "thumb" in links
    text = re.sub(rb"<mimic[^>]*>", b"", TORSO) if between else TORSO
    whole, cut = import_file(text, options), import_file(TORSO, options, cut=links)
    assert cut.tree is not None
    assert [i["name"] for i in cut.tree["instances"]] == ["robot", *links]
    a, b = side(whole), side(cut)
    assert len(a.names) == 4 + between
    found = equivalence(a, b)  # coordinates are known by their last names
    assert found.equal, found
    assert equivalence(a, b, coordinates(whole, cut)) == found
    if not between:
        assert cut.bindings == []
        return
    (binding,) = cut.bindings
    names = {"counter": cut.names["joint counter"], "grip": cut.names["joint grip"]}
    assert (binding["coordinate"], binding["of"]) == tuple(names.values())
    assert binding["constraint"]["expression"] == f"{names['counter']}' - (-2)*{names['grip']}'"


@pytest.mark.parametrize("links", [["b"], ["c"], ["b", "c"]])
def test_loops_go_from_part_to_part(links: list[str]) -> None:
    whole, cut = import_file(MJCF), import_file(MJCF, cut=links)
    assert cut.tree is not None
    a, b = side(whole), side(cut)
    assert equivalence(a, b, coordinates(whole, cut)).equal
    assert {rows.start.partition(".")[0] for rows in b.model.closures} <= {"robot", *links}
    assert [rows.type for rows in b.model.closures] == ["ball", "ball"]


def test_a_floating_base_is_that_of_the_main_part() -> None:
    options = Options("none", base="floating")
    whole, cut = import_file(TORSO, options), import_file(TORSO, options, cut=["hand"])
    a, b = side(whole), side(cut)
    assert equivalence(a, b, coordinates(whole, cut)).equal
    assert len(b.names) == 6 + 4


@pytest.mark.parametrize(
    ("links", "said"),
    [
        (["lefft"], "there is no link 'lefft' to be cut at; did you mean 'left'"),
        (["base"], "nothing remains before 'base'"),
    ],
)
def test_links_that_are_not_there_are_named(links: list[str], said: str) -> None:
    with pytest.raises(InvalidArgument, match=said):
        import_file(TORSO, cut=links)


TABLES = Path(__file__).parents[2] / "substructures/interchange/examples"
#: a mast with two arms, one of which carries a hand; the mass centre and moments of all are symbols
FORKED = b"""(* Robotname = 'forked' *)
NL = 5
NJ = 5
NF = 5
ant = {0,1,2,1,4}
sigma = {0,0,1,0,2}
gamma = {0,0.3,0,g4,0}
b = {0,0.1,0,b4,0}
alpha = {0,pi/2,0,-pi/2,a5}
d = {0,d2,0.2,d4,0}
theta = {t1,t2+pi/3,0,t4,0.2}
r = {0,r2,p3,0,0}
XX = {XX1,XX2,XX3,XX4,XX5}
YY = {YY1,YY2,YY3,YY4,YY5}
ZZ = {ZZ1,ZZ2,ZZ3,ZZ4,ZZ5}
XY = {0,XY2,0,0,0}
MX = {MX1,MX2,MX3,0,MX5}
MY = {0,MY2,0,MY4,0}
MZ = {0,0,MZ3,0,0}
M = {M1,M2,M3,M4,M5}
IA = {IA1,0,0,0,0}
"""


@pytest.mark.parametrize("links", [["link2", "link4"], ["link3"], ["link5", "link4"], ["link2", "link3", "link5"]])
def test_a_symoro_file_is_cut(links: list[str]) -> None:
    whole, cut = import_file(FORKED), import_file(FORKED, cut=links)
    assert cut.tree is not None
    parts = [i["definition"] for i in cut.tree["instances"]]
    assert [i["name"] for i in cut.tree["instances"]] == ["robot", *sorted(links)]
    assert [p["name"] for p in parts] == ["forked-robot", *(f"forked-{link}" for link in sorted(links))]
    assert sum(len(p["bodies"]) for p in parts) == 5
    assert set().union(*(p["parameters"] for p in parts)) == set(whole.definition["parameters"])
    for piece in parts[1:]:  # what the others have alone is not here
        assert "IA1" not in piece["parameters"]
    numbers = re.sub(rb"(?<=[{,])([A-Z]+|[a-z])\d(?=[,}])", _number, FORKED)
    found = equivalence(side(import_file(numbers)), side(import_file(numbers, cut=links)))
    assert found.equal, found


def _number(found: re.Match[bytes]) -> bytes:
    """For a constant; coordinates stay."""
    text = found[0]
    small = text[:2] in (b"MX", b"MY", b"MZ", b"XY")
    return text if text[:1] in b"tp" else f"{(0.1 if small else 2) + sum(text) % 7 / 50}".encode()


@pytest.mark.parametrize("convention", ["modified", "standard"])
@pytest.mark.parametrize("links", [["q3"], ["q2", "q5"]])
def test_a_table_is_cut(links: list[str], convention: str) -> None:
    table = (TABLES / "puma560.csv").read_bytes().replace(b": standard", f": {convention}".encode())
    whole, cut = import_file(table), import_file(table, cut=links)
    assert cut.tree is not None
    found = equivalence(side(whole), side(cut))
    assert found.equal, found
    for instance in cut.tree["instances"][1:]:  # the joint comes along
        assert instance["definition"]["bodies"][0]["joint"]["type"] == "revolute"


@pytest.mark.parametrize(
    ("links", "said"),
    [
        (["lnik3"], "there is no body 'lnik3' to be cut at; did you mean 'link"),
        (["link1"], "nothing remains before"),
    ],
)
def test_bodies_that_are_not_there_are_named(links: list[str], said: str) -> None:
    with pytest.raises(InvalidArgument, match=said):
        import_file(FORKED, cut=links)


def test_a_mount_beyond_the_most_ports_is_refused() -> None:
    extra = "".join(f'<link name="f{k}"/>' + joint(f"g{k}", "torso", f"f{k}", "fixed") for k in range(501))
    many = TORSO.replace(b"</robot>", extra.encode() + b"</robot>")
    with pytest.raises(InvalidDocument, match="fixed=dropped"):
        import_file(many, cut=["left"])
    assert import_file(many, Options(fixed="dropped"), cut=["left"]).tree is not None
