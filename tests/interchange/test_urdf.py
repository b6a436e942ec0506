"""URDF files: what becomes of every element, and what is refused with its line."""

from __future__ import annotations

import re
from decimal import Decimal

import numpy as np
import pytest

from substructures import Definition, TreeSpec, couple, derive, evaluate
from substructures.errors import InvalidDocument
from substructures.export.robots.urdf import rpy_of
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.rotations import from_rpy, to_rpy

LINK = '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def urdf(joints: str, links: str = "abc", root: str = "robot") -> bytes:
    made = "\n".join(f'<link name="{name}">{LINK}</link>' for name in links)
    return f'<{root} name="r">\n{made}\n{joints}\n</{root}>'.encode()


def joint(name: str, parent: str, child: str, kind: str = "revolute", more: str = '<axis xyz="0 0 1"/>') -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{more}</joint>'


def numbers(imported: Imported, quantity: str, q: list[float], **states: list[float]) -> np.ndarray:
    instance = {"name": "x", "definition": imported.definition}
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, -10], "instances": [instance]})
    model = couple(spec, {"x": derive(Definition.read(imported.definition))})
    return np.asarray(evaluate(model, [quantity], q=q, **states)[quantity])


def test_names_are_those_of_the_file_and_the_mapping_tells() -> None:
    file = urdf(joint("j-1", "a", "b") + joint("t", "b", "c"))
    found = import_file(file)
    assert [b["joint"].get("coordinate") for b in found.definition["bodies"]] == [None, "j_1", "t_2"]
    assert found.names == {"a": "a", "b": "b", "c": "c", "joint j-1": "j_1", "joint t": "t_2"}


def test_inertias_are_parameters_with_the_values_of_the_file() -> None:
    file = urdf(joint("j", "a", "b"), "ab")
    found = import_file(file).definition
    assert found["parameters"]["m_b"] == {"value": 2, "unit": "kg"}
    assert found["bodies"][1]["mass"] == "m_b"
    folded = import_file(file, Options(parameters="none")).definition
    assert "parameters" not in folded
    assert folded["bodies"][1]["mass"] == 2
    placed = urdf(joint("j", "a", "b", more='<axis xyz="0 0 1"/><origin xyz="0 0 0.5" rpy="0.1 0 0"/>'), "ab")
    free = import_file(placed, Options(parameters="all")).definition
    assert free["bodies"][1]["joint"]["placement"] == {"position": [0, 0, "pz_b"], "rpy": ["rroll_b", 0, 0]}


def test_a_turned_inertial_origin_turns_the_tensor() -> None:
    """R I R^T with R a turn by 90 degrees about x: yy and zz change places, xy becomes xz, xz becomes -xy."""
    inertial = (
        '<inertial><origin rpy="1.5707963267948966 0 0"/><mass value="1"/>'
        '<inertia ixx="5" iyy="6" izz="7" ixy="0.1" ixz="0.2" iyz="0.3"/></inertial>'
    )
    file = urdf(joint("j", "a", "b"), "ab").replace(LINK.encode(), inertial.encode())
    tensor = import_file(file, Options(parameters="none")).definition["bodies"][1]["inertia"]
    expected = {"xx": 5, "yy": 7, "zz": 6, "xy": -0.2, "xz": 0.1, "yz": -0.3}
    assert {k: float(v) for k, v in tensor.items()} == pytest.approx(expected, abs=1e-12)


def test_fixed_links_are_merged_and_their_frames_stay() -> None:
    fixed = joint("f", "b", "c", "fixed", '<origin xyz="1 0 0" rpy="0 0 0"/>')
    file = urdf(joint("j", "a", "b") + fixed)
    merged, kept = import_file(file), import_file(file, Options(fixed="bodies"))
    assert [b["name"] for b in merged.definition["bodies"]] == ["a", "b"]
    assert merged.definition["ports"] == [{"name": "c", "body": "b", "position": [1, 0, 0]}]
    assert [r["element"] for r in merged.report if r["level"] == "merged"] == ['<link name="c">']
    assert len(kept.definition["bodies"]) == 3
    # 1 + (1 + 2 * 1^2) about the axis
    assert numbers(merged, "metric", [0.3]) == pytest.approx(4)
    assert numbers(kept, "metric", [0.3]) == pytest.approx(4)
    assert "ports" not in import_file(file, Options(fixed="dropped")).definition


@pytest.mark.parametrize("pitch", ["1.5707963", "1.57079633", "1.570796325", "1.5707963267949"])
def test_frames_turned_by_nearly_a_right_angle_are_exact(pitch: str) -> None:
    """Roll and yaw alone are known to 1e-16 / cos(pitch)."""
    first = from_rpy((Decimal("0.7"), Decimal("0.2"), Decimal("-1.1")))
    turned = first.T @ (first @ from_rpy((Decimal("0.3"), Decimal(pitch), Decimal("2.9"))))
    for roll, about, yaw in (to_rpy(turned), map(Decimal, rpy_of(turned).tolist())):
        np.testing.assert_allclose(from_rpy((roll, about, yaw)), turned, rtol=0, atol=1e-14)


@pytest.mark.parametrize(("axis", "weights"), [("0 0 1", [2, 2, 1]), ("1 0 0", [2, 2, 1]), ("1 2 -2", [2, 2, 1])])
def test_planar_joints_move_across_their_axis(axis: str, weights: list[float]) -> None:
    found = import_file(urdf(joint("p", "a", "b", "planar", f'<axis xyz="{axis}"/>'), "ab"))
    assert numbers(found, "metric", [0.1, 0.2, 0.3]) == pytest.approx(np.diag(weights))


def test_floating_joints_and_bases_have_six_coordinates() -> None:
    steps = ["x", "y", "z", "yaw", "pitch", "roll"]
    found = import_file(urdf(joint("f", "a", "b", "floating"), "ab"))
    assert found.definition["bodies"][1]["joint"]["coordinate"] == [f"f_{s}" for s in steps]
    free = import_file(urdf(joint("j", "a", "b"), "ab"), Options(base="floating")).definition
    assert free["bodies"][0]["joint"]["coordinate"] == [f"a_free_{s}" for s in steps]


def test_floating_roots_that_are_seen_and_have_no_mass_are_told() -> None:
    shape = '<visual><geometry><sphere radius="1"/></geometry></visual>'
    for root, options, is_told in (
        (f'<link name="a">{shape}</link>', Options(base="floating"), True),
        (f'<link name="a">{shape}</link>', Options(), False),
        ('<link name="a"/>', Options(base="floating"), False),
    ):
        found = import_file(urdf(root + joint("j", "a", "b"), "b"), options)
        assert any("no mass is given" in remark["message"] for remark in found.report) == is_told


def test_limits_damping_and_remarks() -> None:
    more = (
        '<axis xyz="0 0 1"/><limit lower="-1" upper="2" effort="1" velocity="1"/>'
        '<dynamics damping="0.5" friction="0.1"/>'
    )
    found = import_file(urdf(joint("j", "a", "b", more=more) + joint("k", "b", "c", more='<mimic joint="j"/>')))
    assert found.definition["bodies"][1]["joint"]["limits"] == [-1, 2]
    assert numbers(found, "forces", [0], qd=[2])[0] == pytest.approx(-1)
    assert found.definition["relations"] == [{"coordinate": "k", "of": "j", "multiplier": 1, "offset": 0}]
    assert found.bindings == []
    assert [(r["line"], r["level"]) for r in found.report] == [(5, "warning"), (5, "merged")]
    assert found.checks["topology"] == {"passed": True, "warnings": 0}


@pytest.mark.parametrize("limits", [[0, 0], [1, 1], [None, None]])
def test_limits_that_leave_a_joint_one_place_are_told(limits: list[int | None]) -> None:
    """0, 0 is what is written where none are meant; nothing is none."""
    given = "".join(f' {end}="{x}"' for end, x in zip(("lower", "upper"), limits, strict=True) if x is not None)
    found = import_file(urdf(joint("j", "a", "b", more=f'<limit{given} effort="1" velocity="1"/>'), "ab"))
    assert found.definition["bodies"][1]["joint"].get("limits") == (limits if limits[0] else None)
    told = [f"both limits are {limits[0]}, and limits do not hold a joint"] if limits[0] is not None else []
    assert [remark["message"].partition(" here")[0] for remark in found.report] == told


def test_provenance() -> None:
    found = import_file(urdf(joint("j", "a", "b"), "ab"), file="arm.urdf", license_of_file="BSD-3-Clause")
    assert re.fullmatch(r"URDF file arm\.urdf, sha256:[0-9a-f]{64}", found.definition["source"])
    assert found.definition["license"] == "BSD-3-Clause"


BAD = {
    "unknown-link": (urdf(joint("j", "a", "nowhere")), "line 5: <child link=\"nowhere\">: there is no link"),
    "cycle": (urdf(joint("j", "a", "b") + joint("k", "b", "a"), "ab"), "line 4: .*cycle"),
    "cycle behind": (urdf(joint("j", "b", "c") + joint("k", "c", "b")), "on or behind a cycle"),
    "two-parents": (urdf(joint("j", "a", "c") + "\n" + joint("k", "b", "c")), "line 6: .*child of 'j' already"),
    "several-roots": (urdf(joint("j", "a", "b")), "line 4: <link name=\"c\">: there are several roots"),
    "zero-axis": (urdf(joint("j", "a", "b", more='<axis xyz="0 0 0"/>'), "ab"), "line 4: <axis>: the axis has no"),
    "NaN": (urdf(joint("j", "a", "b", more='<axis xyz="0 nan 1"/>'), "ab"), "'xyz' is no finite number: 'nan'"),
    "huge": (urdf(joint("j", "a", "b", more='<axis xyz="0 1e999 1"/>'), "ab"), "beyond 1e-100 to 1e100"),
    "comma": (urdf(joint("j", "a", "b", more='<axis xyz="0 0,5 1"/>'), "ab"), "written with a point"),
    "two numbers": (urdf(joint("j", "a", "b", more='<axis xyz="0 1"/>'), "ab"), "needs 3 numbers"),
    "negative-mass": (urdf("", "a").replace(b'value="2"', b'value="-2"'), "line 2: <inertial>: the mass -2 kg"),
    "no mass": (urdf("", "a").replace(b'<mass value="2"/>', b""), "<mass value='...'/> is needed"),
    "no moment": (urdf("", "a").replace(b'ixx="1"', b""), "line 2: <inertia>: the attribute 'ixx' is needed"),
    "duplicate-name": (urdf("", "aa"), "line 3: .*a second link 'a'"),
    "unknown-type": (urdf(joint("j", "a", "b", "ball"), "ab"), "type 'ball' is none of revolute"),
    "no-links": (b'<robot name="r"/>', "no <link>"),
    "entity bomb": (b'<!DOCTYPE r [<!ENTITY a "b">]><robot>&a;</robot>', "line 1: <!DOCTYPE>: document types"),
    "external": (b'<!DOCTYPE r SYSTEM "file:///etc/passwd"><robot/>', "document types, entities and external"),
    "XInclude": (
        b'<robot xmlns:xi="http://www.w3.org/2001/XInclude"><xi:include href="/etc/passwd"/></robot>',
        "XInclude is not followed",
    ),
    "xacro": (b'<robot xmlns:xacro="http://wiki.ros.org/xacro"><xacro:arg name="a"/></robot>', "expand it first"),
    "html": (b"<!DOCTYPE html><html><body>404</body></html>", "this is a web page"),
    "white space": (b" " * 17_000_000, "the limit is 16,777,216"),
    "only white space": (b" " * 10_000, "not-well-formed|no element found"),
    "encoding": (b'<?xml version="1.0" encoding="klingon"?><robot/>', "line 1: .*encoding"),
    "broken": (b"<robot><link></robot>", "line 1: XML: mismatched tag"),
    "not utf-8": (b'<robot name="\xff"/>', "line 1: XML: not well-formed"),
    "deep": (b"<robot>" + b"<a>" * 300 + b"</a>" * 300 + b"</robot>", "nested deeper than 200"),
    "other": (b"<svg/>", "not one of"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files_are_refused_with_their_place(name: str) -> None:
    data, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        import_file(data)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_other_encodings_are_read(encoding: str) -> None:
    text = urdf(joint("j", "a", "b"), "ab").decode()
    assert import_file(text.encode(encoding)).definition["bodies"][0]["name"] == "a"


def test_meshes_and_paths_are_never_followed() -> None:
    mesh = '<visual><geometry><mesh filename="../../../etc/passwd"/></geometry></visual>'
    found = import_file(urdf("", "a").replace(b"<inertial>", mesh.encode() + b"<inertial>"))
    assert [(r["level"], r["element"]) for r in found.report] == [("ignored", "<visual>")]


def test_what_no_body_can_be_is_told() -> None:
    found = import_file(urdf("", "a").replace(b'izz="1"', b'izz="9"'))
    assert found.checks["physics"] == {"passed": False, "warnings": 1}
    assert "triangle inequality" in found.report[0]["message"]


def test_imports_have_the_same_digest_again() -> None:
    file = urdf(joint("j", "a", "b"), "ab")
    assert Definition.read(import_file(file).definition).digest == Definition.read(import_file(file).definition).digest
