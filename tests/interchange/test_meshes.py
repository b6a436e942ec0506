"""Masses of meshes: bodies whose moments are known, files in three formats, and MuJoCo's four ways of weighing."""

from __future__ import annotations

import io
import struct
import zipfile
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.cli.main import main
from substructures.array import Array
from substructures.errors import InvalidDocument
from substructures.interchange.files.archive import Beside, main_of
from substructures.interchange.files.meshes import MODES, BadMesh, Triangles, changed, read_mesh, weighed
from substructures.interchange.importing import import_file

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])


def box(*sides: float) -> Triangles:
    return Triangles(CUBE * np.array(sides), FACES)


def joined(*meshes: Triangles) -> Triangles:
    starts = np.cumsum([0, *(len(mesh.corners) for mesh in meshes)])[:-1]
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    return Triangles(np.concatenate([mesh.corners for mesh in meshes]), np.concatenate(faces))


def hollow(*at: float) -> Triangles:
    """A box of 3 x 4 x 5 without one of 1 x 2 x 3 from a corner on, about its middle by default."""
    inner = Triangles(CUBE * [1, 2, 3] + np.array(at or (1, 1, 1)), FACES[:, ::-1])
    return joined(box(3, 4, 5), inner)


def of_box(a: float, b: float, c: float) -> Array:
    return np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) / 12


@pytest.mark.parametrize("mode", ["exact", "convex", "legacy"])
def test_a_box(mode: str) -> None:
    found = weighed(box(2, 3, 4), mode)
    assert found.volume == pytest.approx(24)
    assert found.centre == pytest.approx([1, 1.5, 2])
    assert found.theta == pytest.approx(24 * of_box(2, 3, 4))


def test_a_shell_is_its_six_plates() -> None:
    found, m = weighed(box(1, 1, 1), "shell"), 6.0
    assert found.volume == pytest.approx(m)
    assert found.centre == pytest.approx([0.5] * 3)
    assert found.theta == pytest.approx(np.eye(3) * m * 5 / 18)  # of a hollow cube of mass m and side 1


def test_a_tetrahedron() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    found = weighed(Triangles(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])))
    assert found.volume == pytest.approx(1 / 6)
    assert found.centre == pytest.approx([0.25] * 3)
    assert found.theta * 6 == pytest.approx(np.full((3, 3), 1 / 80) + np.eye(3) * (3 / 40 - 1 / 80))


def test_a_hollow_is_not_filled_but_by_its_hull_and_as_it_was_done_first() -> None:
    whole, hole = 60 * of_box(3, 4, 5), 6 * of_box(1, 2, 3)
    d = np.array([1.5, 2, 2.5])
    assert weighed(hollow()).volume == pytest.approx(54)
    centre = (60 * d - 6 * np.array([1.5, 2, 2.5])) / 54
    assert weighed(hollow()).centre == pytest.approx(centre)
    assert weighed(hollow()).theta == pytest.approx(whole - hole)
    assert weighed(hollow(), "convex").volume == pytest.approx(60)
    assert weighed(hollow(), "legacy").volume == pytest.approx(66)


def test_mirrored_and_turned_meshes_weigh_the_same() -> None:
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], dtype=float)
    found = weighed(changed(hollow(), np.array([-1.0, 1, 1]), np.array([0.3, 0.1, 0.2]), turn))
    assert found.volume == pytest.approx(54)
    assert np.linalg.eigvalsh(found.theta) == pytest.approx(np.linalg.eigvalsh(weighed(hollow()).theta))


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (Triangles(CUBE, FACES[1:]), "not closed"),
        (Triangles(CUBE, FACES[:, ::-1]), "seen from inside"),
        (Triangles(CUBE, np.concatenate([FACES[1:], FACES[:1, ::-1]])), "not closed"),
        (Triangles(CUBE * [1, 1, 0], FACES), "not closed"),
        (Triangles(CUBE * 0, FACES), "no area"),
        (Triangles(CUBE[:2], FACES[:0]), "no convex hull"),
    ],
)
def test_what_has_no_mass_says_why(mesh: Triangles, message: str) -> None:
    with pytest.raises(BadMesh, match=message):
        weighed(mesh)


def stl(mesh: Triangles) -> bytes:
    rows = [struct.pack("<12fH", 0, 0, 0, *mesh.corners[list(face)].ravel(), 0) for face in mesh.faces]
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def stl_of_text(mesh: Triangles) -> bytes:
    facet = "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n"
    lines = [facet.format("".join(f"vertex {x} {y} {z}\n" for x, y, z in mesh.corners[face])) for face in mesh.faces]
    return f"solid cube\n{''.join(lines)}endsolid cube\n".encode()


def obj(mesh: Triangles) -> bytes:
    """Faces of four corners, counted from the end."""
    lines = [*(f"v {x} {y} {z}" for x, y, z in mesh.corners), "vt 0 0", "vn 0 0 1"]
    return "\n".join([*lines, *("f " + " ".join(f"{k - 8}/1/1" for k in quad) for quad in QUADS)]).encode()


def msh(mesh: Triangles) -> bytes:
    head = struct.pack("<4i", len(mesh.corners), len(mesh.corners), 0, len(mesh.faces))
    normals = np.zeros(mesh.corners.shape, "<f4").tobytes()
    return head + mesh.corners.astype("<f4").tobytes() + normals + mesh.faces.astype("<i4").tobytes()


FORMATS = {"stl": stl, "obj": obj, "msh": msh}


@pytest.mark.parametrize(("ending", "written"), [*FORMATS.items(), ("STL", stl_of_text)])
def test_files_have_the_triangles_that_were_written(ending: str, written: Any) -> None:
    found = weighed(read_mesh(f"part.{ending}", written(box(2, 3, 4))))
    assert found.volume == pytest.approx(24)
    assert found.theta == pytest.approx(24 * of_box(2, 3, 4))


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.dae", b"<COLLADA/>"),
        ("a.stl", b""),
        ("a.stl", stl(box(1, 1, 1))[:-1]),
        ("a.stl", b"solid x\nvertex 1 2\n"),
        ("a.obj", b"v 1 2\nf 1 2 3"),
        ("a.obj", b"v 0 0 0\nf 1 2 9"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3"),
        ("a.msh", b"\1\0\0\0" * 4),
        ("a.msh", struct.pack("<4i", -1, 0, 0, 0)),
        ("a.msh", msh(Triangles(CUBE, FACES + 1))),
    ],
)
def test_bad_files_are_refused(name: str, data: bytes) -> None:
    with pytest.raises(BadMesh):
        read_mesh(name, data)


def model(mesh: Triangles, mode: str, file: str = "") -> str:
    written = " ".join(map(repr, chain(*mesh.corners.tolist())))
    faces = " ".join(map(str, chain(*mesh.faces.tolist())))
    shape = f'file="{file}"' if file else f'vertex="{written}" face="{faces}"'
    placed = 'refpos=".1 .2 .3" refquat=".9 .1 .2 .3" scale=".5 -.4 .3"'
    return (
        f'<mujoco><compiler meshdir="meshes"/><asset><mesh name="m" inertia="{mode}" {shape} {placed}/></asset>'
        '<worldbody><body name="b"><joint axis="1 2 3"/><geom type="mesh" mesh="m" pos=".3 .2 .1" '
        'quat=".5 .1 .7 .1"/><geom type="mesh" mesh="m" mass="2"/></body></worldbody></mujoco>'
    )


def inertial(definition: Any) -> tuple[float, Array, Array]:
    """Mass, mass centre and tensor about it, of the only body."""
    (body,) = (each for each in definition["bodies"] if each.get("mass") is not None)

    def value(name: str) -> float:
        return float(definition["parameters"].get(name, {"value": 0})["value"])

    six = {name: value(f"I{name}_b") for name in ("xx", "yy", "zz", "xy", "xz", "yz")}
    rows = [[six["".join(sorted(a + b))] for b in "xyz"] for a in "xyz"]
    assert body["mass"] == "m_b"
    return value("m_b"), np.array([value(f"c{axis}_b") for axis in "xyz"]), np.array(rows)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("mesh", [box(2, 3, 4), hollow(), hollow(0.25, 1.75, 0.5)], ids=["box", "hollow", "lopsided"])
def test_masses_are_what_mujoco_makes_of_them(mesh: Triangles, mode: str) -> None:
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
    text = model(mesh, mode)
    theirs = mujoco.MjModel.from_xml_string(text)
    m, centre, theta = inertial(import_file(text.encode()).definition)
    nine = np.zeros(9)
    mujoco.mju_quat2Mat(nine, theirs.body_iquat[1])
    turn = nine.reshape(3, 3)
    expected = turn @ np.diag(theirs.body_inertia[1]) @ turn.T
    assert m == pytest.approx(theirs.body_mass[1], rel=1e-12)
    assert centre == pytest.approx(theirs.body_ipos[1], abs=1e-12)
    assert theta == pytest.approx(expected, rel=1e-7, abs=1e-7 * expected.max())  # there in single precision


@pytest.mark.parametrize("mode", MODES)
def test_of_an_obj_file_of_several_objects_the_first_is_weighed(mode: str) -> None:
    """As MuJoCo does, and told."""
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
    small = "\n".join(f"v {3 + x / 2} {y / 2} {z / 2}" for x, y, z in CUBE)
    faces = "\n".join("f " + " ".join(str(k + 9) for k in face) for face in FACES)
    data = b"o first\n" + obj(box(1, 1, 1)) + f"\no second\n{small}\n{faces}\n".encode()
    mesh = f'<asset><mesh name="m" file="m.obj" inertia="{mode}"/></asset>'
    body = '<body name="b"><joint/><geom type="mesh" mesh="m"/></body>'
    text = f"<mujoco>{mesh}<worldbody>{body}</worldbody></mujoco>"
    theirs = mujoco.MjModel.from_xml_string(text, {"m.obj": data})
    found = import_file(text.encode(), included={"m.obj": data})
    m, centre, _ = inertial(found.definition)
    assert m == pytest.approx(theirs.body_mass[1], rel=1e-6)
    assert centre == pytest.approx(theirs.body_ipos[1], abs=1e-6)
    assert any("only the first object of 'm.obj' is weighed" in each["message"] for each in found.report)


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("where", ["meshes/part.{}", "part.{}"])
def test_files_beside_are_found(ending: str, where: str) -> None:
    mesh = box(2, 3, 4)
    beside = {where.format(ending): FORMATS[ending](mesh)}
    found = import_file(model(mesh, "exact", f"part.{ending}").encode(), included=beside)
    plain = import_file(model(mesh, "exact").encode())
    for a, b in zip(inertial(found.definition), inertial(plain.definition), strict=True):
        assert a == pytest.approx(b)


def zipped(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


ROBOT = {"bot/robot.xml": model(box(2, 3, 4), "exact", "part.stl").encode(), "bot/meshes/part.stl": stl(box(2, 3, 4))}


def test_a_folder_and_a_zip_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, data in ROBOT.items():
        (tmp_path / "in" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "in" / name).write_bytes(data)
    (tmp_path / "robot.zip").write_bytes(zipped({**ROBOT, "__MACOSX/bot/robot.xml": b"?"}))
    said = []
    for given in (tmp_path / "in", tmp_path / "robot.zip", tmp_path / "in" / "bot" / "robot.xml"):
        assert main(["import", str(given)]) == 0
        said.append(capsys.readouterr().out.replace("bot/robot.xml", "robot.xml"))
    assert said[0] == said[1] == said[2]
    (tmp_path / "robot.zip").write_bytes(b"PK\3\4 no zip")
    assert main(["import", str(tmp_path / "robot.zip")]) == 1
    assert "not a zip" in capsys.readouterr().err


def test_which_file_is_the_robot() -> None:
    files = {"a/main.xml": b'<mujoco><include file="parts/arm.xml"/></mujoco>', "a/parts/arm.xml": b"", "a/x.stl": b""}
    assert main_of(files, files.__getitem__) == "a/main.xml"
    assert main_of(files, files.__getitem__, "arm.xml") == "a/parts/arm.xml"
    assert main_of(files, files.__getitem__, "a/parts/arm.xml") == "a/parts/arm.xml"
    beside = Beside("a/main.xml", files, files.__getitem__)
    assert "parts/arm.xml" in beside
    assert "../a/x.stl" in beside
    assert "../../etc/passwd" not in beside
    assert sorted(beside) == ["main.xml", "parts/arm.xml", "x.stl"]
    with pytest.raises(InvalidDocument, match="no robot file"):
        main_of(["x.stl"], files.__getitem__)
    several = {"a.urdf": b"", "b.urdf": b""}
    with pytest.raises(InvalidDocument, match=r"several robot files: say which by 'file': a\.urdf, b\.urdf"):
        main_of(several, several.__getitem__)
