"""DH tables and SYMORO files: the same arm written in every form, and what is refused."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import Definition, catalogue, derive
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side

MODIFIED = """# convention: modified
# length: mm
# angle: deg
name,type,a,alpha,d,theta,mass,cx,cy,cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,min,max
q1,R,0,0,300,0,3,10,20,30,0.1,0.2,0.25,0.01,0.02,0.03,-90,90
q2,R,50,-90,0,90,2,100,0,0,0.1,0.1,0.1,0,0,0,,
q3,P,400,30,120,20,1,0,0,50,0.02,0.02,0.01,0,0,0,0,300
"""
SYMORO = """(* Robotname = 'Three joints' *)
NL = 3
NJ = 3
NF = 3
ant = {0,1,2}
sigma = {0,0,1}
b = {0,0,0}
d = {0,0.05,0.4}
r = {0.3,0,q3 + 0.12}
gamma = {0,0,0}
alpha = {0,-pi/2,pi/6}
theta = {q1,q2 + pi/2,pi/9}
XX = {XX1,0.1,0.0225}
XY = {0.0094,0,0}
XZ = {0.0191,0,0}
YY = {0.203,0.12,0.0225}
YZ = {0.0282,0,0}
ZZ = {0.2515,0.12,0.01}
MX = {0.03,0.2,0}
MY = {0.06,0,0}
MZ = {0.09,0,0.05}
M = {3,2,1}
IA = {0,0,0}
FV = {0,0,FV3}
FS = {0,0,1}
"""


def side(text: str) -> Side:
    return Side.of_part(derive(Definition.read(import_file(text.encode()).definition)))


def standard_of(rows: str) -> str:
    """The same axes by standard parameters: a and alpha belong to the row before."""
    lines = [line.split(",") for line in rows.splitlines()[4:]]
    shifted = [[*line[:2], *(lines[k + 1][2:4] if k + 1 < len(lines) else ["0", "0"]), *line[4:6]]
               for k, line in enumerate(lines)]  # fmt: skip
    head = rows.replace("modified", "standard").split(",min,max")[0] + "\n"
    made = (",".join([*s, *_in_the_frame_after(line, s)]) for line, s in zip(lines, shifted, strict=True))
    return head + "\n".join(made)


def _in_the_frame_after(line: list[str], shifted: list[str]) -> list[str]:
    """Mass, mass centre and tensor in the axes behind Tx(a) Rx(alpha)."""
    a, alpha = float(shifted[2]), np.radians(float(shifted[3]))
    R = np.array([[1, 0, 0], [0, np.cos(alpha), -np.sin(alpha)], [0, np.sin(alpha), np.cos(alpha)]])
    com = R.T @ (np.array([float(x) for x in line[7:10]]) - [a, 0, 0])
    xx, yy, zz, xy, xz, yz = (float(x) for x in line[10:16])
    theta = R.T @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R
    six = [theta[i] for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return [line[6], *(f"{x:.16f}" for x in [*com, *six])]


def test_standard_and_modified_tables_are_the_same_arm() -> None:
    found = equivalence(side(MODIFIED), side(standard_of(MODIFIED)))
    assert found.equal, found.culprits


def test_json_is_the_same_table() -> None:
    head, *rows = (line.split(",") for line in MODIFIED.splitlines()[3:])
    table = [{k: (x if k in ("name", "type") else float(x)) for k, x in zip(head, r, strict=True) if x} for r in rows]
    document = {"convention": "modified", "length": "mm", "angle": "deg", "dh": table}
    assert equivalence(side(MODIFIED), side(json.dumps(document))).equal


def test_a_urdf_file_of_the_same_arm() -> None:
    """Rx(alpha) Tx(a) Rz(theta) Tz(d) as origins: (a, 0, 0) with roll alpha, then the offset of the joint."""
    frame = '<joint name="f{0}" type="fixed"><parent link="{1}"/><child link="s{0}"/>'
    frame += '<origin xyz="{2} 0 0" rpy="{3} 0 0"/></joint>'
    moved = '<joint name="{0}" type="{1}"><parent link="s{2}"/><child link="l{2}"/>'
    moved += '<axis xyz="0 0 1"/><origin xyz="0 0 {3}" rpy="0 0 {4}"/></joint>'
    link = '<link name="s{0}"/><link name="l{0}"><inertial><origin xyz="{1}"/>'
    link += '<mass value="{2}"/><inertia {3}/></inertial></link>'
    tensors = ('ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0.02" iyz="0.03"',
               'ixx="0.1" iyy="0.1" izz="0.1"', 'ixx="0.02" iyy="0.02" izz="0.01"')  # fmt: skip
    text = '<robot name="u"><link name="l0"/>'
    rows = ((0, 0, 0.3, 0, "q1", "revolute"), (0.05, -np.pi / 2, 0, np.pi / 2, "q2", "revolute"),
            (0.4, np.pi / 6, 0.12, np.pi / 9, "q3", "prismatic"))  # fmt: skip
    masses = ((3, "0.01 0.02 0.03"), (2, "0.1 0 0"), (1, "0 0 0.05"))
    for k, ((a, alpha, d, theta, name, kind), (m, com)) in enumerate(zip(rows, masses, strict=True), 1):
        text += link.format(k, com, m, tensors[k - 1]) + frame.format(k, f"l{k - 1}", a, alpha)
        text += moved.format(name, kind, k, d, theta)
    assert equivalence(side(MODIFIED), side(text + "</robot>")).equal


def test_symoro_files_keep_their_symbols() -> None:
    found = import_file(SYMORO.encode())
    assert found.definition["parameters"] == {"XX1": {"unit": "kg m^2"}, "FV3": {}}
    assert [r["message"] for r in found.report] == ["dry friction is left out: add a load for it"]
    numbers = SYMORO.replace("XX1", "0.1039").replace("FV3", "0")
    # about the origin: 0.1 + 3 (0.02^2 + 0.03^2), ..., 0.02 - 3 * 0.01 * 0.03, ...
    found_same = equivalence(side(MODIFIED.replace("0.02,0.02,0.01", "0.02,0.02,0.01")), side(numbers))
    assert found_same.equal, (found_same.first_difference, found_same.culprits)


def test_zero_is_zero_with_a_point() -> None:
    """A link of SYMORO without mass, as 0.0: its mass centre is nowhere."""
    light = SYMORO.replace("M = {3,2,1}", "M = {3,0.0,1}").replace("MX = {0.03,0.2,0}", "MX = {0.03,0.0,0.0}")
    assert import_file(light.encode()).definition["bodies"][1]["com"] == ["0", "0", "0"]
    with pytest.raises(InvalidDocument, match="a first moment without a mass"):
        import_file(light.replace("MX = {0.03,0.0", "MX = {0.03,0.1").encode())


def test_one_limit_alone_is_told() -> None:
    found = import_file(MODIFIED.replace("-90,90", ",90").encode())
    assert "limits" not in found.definition["bodies"][0]["joint"]
    assert [remark["message"] for remark in found.report] == ["one limit alone is left out: give both, min and max"]


def test_the_shipped_table_is_the_arm_of_the_catalogue() -> None:
    table = (Path(catalogue.__file__).parent.parent / "interchange" / "examples" / "puma560.csv").read_text()
    known = Side.of_part(shipped_part("puma560"))
    assert equivalence(side(table), known).equal
    assert not equivalence(side(table.replace("0.2275", "0.2276")), known).equal


BAD = {
    "convention": (MODIFIED.replace("convention: modified", "convention: mine"), "line 1: table: say 'convention: st"),
    "column": (MODIFIED.replace("cx,", "x,", 1), "line 4: head: unknown column 'x'"),
    "number": (MODIFIED.replace("300,0,3", "3OO,0,3", 1), "line 5: row, d: 'd' is no finite number: '3OO'"),
    "cells": (MODIFIED.replace("q2,R,", "q2,", 1), "line 6: row: 17 cells, the head has 18"),
    "type": (MODIFIED.replace("q2,R", "q2,X", 1), "line 6: row: type 'x' is none of"),
    "loops": (SYMORO.replace("NF = 3", "NF = 4"), "line 4: NF: 4 frames, 3 joints, 3 links: NF = 2 NJ - NL"),
    "ant": (SYMORO.replace("{0,1,2}", "{0,1,7}"), r"line 5: ant\[3\]: '7' is no number of a link before link 3"),
    "digits": (SYMORO.replace("{0,1,2}", "{0,1,\u00b92}"), r"line 5: ant\[3\]: '.*2' is no number of a link"),
    "sigma": (SYMORO.replace("{0,0,1}", "{0,0,5}"), r"line 6: sigma\[3\]: sigma is 0"),
    "expression": (SYMORO.replace("0.203", "eval(1)"), r"line 16: YY\[1\]: 'eval\(1\)'"),
    "short": (SYMORO.replace("d = {0,0.05,0.4}", "d = {0,0.05}"), r"line 8: d\[3\]: the list 'd' has no entry 3"),
    "no coordinate": (SYMORO.replace("theta = {q1", "theta = {0"), r"line 12: theta\[1\]: '0' is not a coordinate"),
    "cell": (MODIFIED.replace("q2,R", '"' + "q" * 200_000 + '",R', 1), "line 6: row: field larger than field limit"),
    "spaces": (SYMORO.replace("{0,1,2}", "{0,1," + " " * 900_000 + "x}"), r"line 5: ant\[3\]: 'x' is no number"),
    "comments": (SYMORO + "(*" * 400_000, None),
    "size": (SYMORO + " " * 2**20, "the limit is 1,048,576"),
    "sizes": (MODIFIED + "\n" * 2**20, "the limit is 1,048,576"),
    "unit": (MODIFIED.replace("length: mm", "length: kg"), "line 1: table: 'kg' is no unit of a length"),
    "json": ('{"dh": []}', "/dh: a list of 1 to 200 rows"),
    "json cell": ('{"dh": [{"a": [], "alpha": 0, "d": 0, "theta": 0}]}', "/dh/0: numbers and names"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_tables_are_refused_with_their_place(name: str) -> None:
    text, message = BAD[name]
    if message is None:  # only long
        assert import_file(text.encode()).definition["bodies"]
        return
    with pytest.raises(InvalidDocument, match=message):
        import_file(text.encode())
