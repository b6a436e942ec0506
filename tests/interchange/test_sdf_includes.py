"""<include> of SDF files: the same robot as with its models written out, and what is refused."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from service.cli.main import main
from substructures import Definition, derive
from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.archive import main_of
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sdf import includes
from substructures.interchange.sides import Side


def link(name: str, pose: str, mass: float) -> str:
    inertia = f"<inertia><ixx>{mass}</ixx><iyy>{mass}</iyy><izz>{mass / 2}</izz></inertia>"
    return f'<link name="{name}"><pose>{pose}</pose><inertial><mass>{mass}</mass>{inertia}</inertial></link>'


FINGER = f"""<model name="finger"><pose>0 0 0.1 0 0 0</pose>{link("tip", "0 0 0.2 0.3 0 0", 0.1)}
<frame name="nail" attached_to="tip"><pose>0 0 0.1 0 0 0</pose></frame></model>"""
#: its palm moves against its mount about an axis in the frame of the model, as version 1.4 has it
HAND = f"""<model name="hand"><pose>0 0 9 0 0 0</pose>{link("mount", "0 0 0 0 0.2 0", 1)}
{link("palm", "0 0 0.1 0.4 0.2 0", 0.5)}
<joint name="wrist" type="revolute"><parent>mount</parent><child>palm</child><axis><xyz>0 1 0</xyz>FLAG</axis></joint>
FINGERS</model>"""
ARM = f"""<sdf version="1.9"><model name="arm">{link("upper", "0 0 0.4 0 0 0", 4)}
<joint name="shoulder" type="revolute"><parent>world</parent><child>upper</child><axis><xyz>0 1 0</xyz></axis></joint>
<frame name="flange" attached_to="upper"><pose>0 0 0.5 0 0 0.7</pose></frame>
HAND<joint name="hold" type="fixed"><parent>upper</parent><child>right::mount</child></joint>
</model></sdf>"""
INCLUDE = '<include><uri>model://hand</uri><name>right</name><pose relative_to="flange">0 0 0.1 0 0 0</pose></include>'
FINGERS = '<include><uri>FINGER</uri></include><joint name="glue" type="fixed"><parent>palm</parent><child>finger::tip</child></joint>'  # noqa: E501
WORLD = '<sdf version="1.9"><world name="w"><include><uri>model://arm</uri></include></world></sdf>'
CONFIG = b'<model><name>hand</name><sdf version="1.3">old.sdf</sdf><sdf version="1.4">hand-1_4.sdf</sdf></model>'


def files(finger: str = "model://finger/finger.sdf") -> dict[str, bytes]:
    """The arm at the top, the hand as Gazebo keeps models, the finger beside it."""
    hand = HAND.replace("FLAG", "").replace("FINGERS", FINGERS.replace("FINGER", finger))
    return {
        "arm.sdf": ARM.replace("HAND", INCLUDE).encode(),
        "models/hand/model.config": CONFIG,
        "models/hand/hand-1_4.sdf": f'<sdf version="1.4">{hand}</sdf>'.encode(),
        "models/finger/finger.sdf": f'<sdf version="1.7">{FINGER}</sdf>'.encode(),
    }


def written_out() -> str:
    """The same in one file."""
    hand = HAND.replace('"hand"', '"right"', 1).replace(
        "<pose>0 0 9 0 0 0", '<pose relative_to="flange">0 0 0.1 0 0 0', 1
    )
    hand = hand.replace("FLAG", "<use_parent_model_frame>true</use_parent_model_frame>")
    inner = FINGERS.replace("<include><uri>FINGER</uri></include>", FINGER)
    return ARM.replace("HAND", hand.replace("FINGERS", inner))


def read(given: dict[str, bytes]) -> Imported:
    return import_file(given["arm.sdf"], included=given)


def side(found: Imported) -> Side:
    return Side.of_part(derive(Definition.read(found.definition)))


@pytest.mark.parametrize("finger", ["model://finger/finger.sdf", "../finger/finger.sdf", "file://../finger/finger.sdf"])
def test_models_that_are_included_are_as_written_out(finger: str) -> None:
    found, whole = read(files(finger)), import_file(written_out().encode())
    assert found.definition["bodies"] == whole.definition["bodies"]
    assert found.definition["ports"] == whole.definition["ports"]
    assert found.names == whole.names


@pytest.mark.parametrize("wrong", [('relative_to="flange"', ""), ("0 0 0.1 0 0 0</pose></include>", "0 0 0 0 0 0</pose></include>")])  # fmt: skip  # noqa: E501
def test_another_place_of_what_is_included_is_seen(wrong: tuple[str, str]) -> None:
    moved = files()
    moved["arm.sdf"] = moved["arm.sdf"].decode().replace(*wrong).encode()
    assert not equivalence(side(read(moved)), side(read(files()))).equal


def test_axes_of_a_file_are_given_as_its_version_has_them() -> None:
    newer = files()
    newer["models/hand/hand-1_4.sdf"] = newer["models/hand/hand-1_4.sdf"].replace(b'"1.4"', b'"1.9"')
    assert not equivalence(side(read(newer)), side(read(files()))).equal


def merged_hand(version: str = "1.4", **changes: str) -> dict[str, bytes]:
    """The hand's links, joints and frames in the arm, and the finger's in the hand."""
    found = files() | {"arm.sdf": ARM.replace("HAND", INCLUDE).replace("right::mount", "mount").encode()}
    found = {k: x.replace(b"<include>", b'<include merge="true">') for k, x in found.items()}
    hand = found["models/hand/hand-1_4.sdf"].decode().replace("finger::tip", "tip").replace('"1.4"', f'"{version}"')
    for old, new in changes.items():
        hand = hand.replace(old, new)
    return found | {"models/hand/hand-1_4.sdf": hand.encode()}


def test_what_is_merged_is_the_same_robot_with_shorter_names() -> None:
    """Poses and axes that are given in the frame of a model are so in the frame that stands for it."""
    nested, merged = read(files()), read(merged_hand())
    assert [x["name"] for x in merged.definition["bodies"]] == ["upper", "palm"]
    assert [x["joint"]["coordinate"] for x in merged.definition["bodies"]] == ["shoulder", "wrist"]
    names = {"shoulder": "shoulder", "wrist": "right__wrist"}
    assert equivalence(side(merged), side(nested), names).equal
    frames = {port["name"]: port for port in merged.definition["ports"]}
    assert {"flange", "mount", "tip", "nail"} < set(frames)
    assert {f"frame _merged__{name}__model__" for name in ("right", "finger")} < set(merged.names)
    theirs = {port["name"]: port for port in nested.definition["ports"]}
    for one, other in (("nail", "right__finger__nail"), ("tip", "right__finger__tip"), ("mount", "right__mount")):
        assert {**frames[one], "name": "", "body": ""} == {**theirs[other], "name": "", "body": ""}


def test_a_merged_model_is_named_by_its_frame() -> None:
    """``__model__`` of the hand, in axes, frames and as the end of a joint, is not that of the arm."""
    hand = merged_hand("1.9", **{"<xyz>": '<xyz expressed_in="__model__">'})
    assert equivalence(side(read(hand)), side(read(merged_hand()))).equal
    hand = merged_hand("1.9", **{"<xyz>": '<xyz expressed_in="__model__">', "<parent>mount": "<parent>__model__"})
    assert equivalence(side(read(hand)), side(read(merged_hand()))).equal
    assert not equivalence(side(read(merged_hand("1.9"))), side(read(merged_hand()))).equal


@pytest.mark.parametrize("is_merged", [False, True])
def test_a_placement_frame_stands_where_the_model_is_put(is_merged: bool) -> None:
    """The mount is at (0, 0, 0), turned by 0.2, in the hand: the pose of the mount is that of the hand by this turn."""
    given = merged_hand() if is_merged else files()
    placed = given | {"arm.sdf": given["arm.sdf"].replace(b"0 0 0.1 0 0 0</pose>", b"0 0 0.1 0 0.2 0</pose>")}
    placed["arm.sdf"] = placed["arm.sdf"].replace(b"</include>", b"<placement_frame>mount</placement_frame></include>")
    assert equivalence(side(read(placed)), side(read(given))).equal


def test_a_joint_may_name_a_model_for_its_canonical_link() -> None:
    found = read(changed("arm.sdf", "right::mount", "right"))
    assert equivalence(side(found), side(read(files()))).equal


def test_a_folder_and_a_zip_bring_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main_of(files(), files().__getitem__) == "arm.sdf"
    with zipfile.ZipFile(tmp_path / "arm.zip", "w") as archive:
        for name, data in files().items():
            archive.writestr(f"robot/{name}", data)
    with zipfile.ZipFile(tmp_path / "arm.zip") as archive:
        archive.extractall(tmp_path / "in")
    wanted = read(files()).definition["bodies"]
    for given in (tmp_path / "arm.zip", tmp_path / "in", tmp_path / "in" / "robot" / "arm.sdf"):
        assert main(["import", str(given)]) == 0
        out = read_json(capsys.readouterr().out.encode())
        assert isinstance(out, dict)
        assert [body["name"] for body in out["bodies"]] == [body["name"] for body in wanted] == ["upper", "right__palm"]


def changed(file: str, old: str, new: str) -> dict[str, bytes]:
    found = files()
    found[file] = found[file].decode().replace(old, new).encode()
    return found


BAD = {
    "merge of one name": (
        changed("arm.sdf", "<include>", "<frame name='palm'/><include merge='true'>"),
        "line 2: <link name=\"palm\"> of models/hand/hand-1_4.sdf: a second frame 'palm'",
    ),
    "merge in a world": (
        {"arm.sdf": WORLD.replace("<include>", "<include merge='1'>").encode()},
        "<include>: merge in a <world> is not read: leave it out",
    ),
    "missing": (
        {k: x for k, x in files().items() if "finger" not in k},
        "line 4: <include> of models/hand/hand-1_4.sdf: 'model://finger/finger.sdf' is not here: send its folder along",
    ),
    "from the net": (changed("arm.sdf", "model://hand", "https://fuel.example/hand"), "'https://fuel.example/hand' is"),
    "circle": (changed("models/hand/hand-1_4.sdf", "model://finger/finger.sdf", "hand-1_4.sdf"), "includes itself"),
    "no uri": (changed("arm.sdf", "<uri>model://hand</uri>", ""), "line 4: <include>: <uri> is needed"),
    "no model": (changed("models/finger/finger.sdf", "model", "modal"), "there is no link 'right::finger::tip'"),
    "place": (
        changed("models/finger/finger.sdf", "0 0 0.2 0.3", "0 0.2 0.3"),
        "line 1: <pose> of models/finger/finger.sdf: 'pose' needs 6 numbers",
    ),
    "form": (changed("models/finger/finger.sdf", "</link>", ""), "line 2: XML of models/finger/finger.sdf: mismatched"),
    "frame": (
        changed("arm.sdf", "</include>", "<placement_frame>plam</placement_frame></include>"),
        "there is no frame 'right::plam'",
    ),
    "frame in itself": (
        changed("arm.sdf", '"flange" attached_to="upper"', '"flange" attached_to="right::palm"'),
        "the frame '[a-z:_]*' is placed relative to itself",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_included_is_refused_with_its_place(name: str) -> None:
    given, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        read(given)


def test_long_and_broad_chains_of_files_end(monkeypatch: pytest.MonkeyPatch) -> None:
    """A file that includes the next one, of which there are 1000, or twice, of which there are 20."""

    def chain(length: int, times: int) -> dict[str, bytes]:
        def text(k: int) -> str:
            included = "".join(
                f"<include><uri>{k + 1}.sdf</uri><name>m{i}</name></include>"
                for i in range(times if k + 1 < length else 0)
            )
            return f'<sdf version="1.9"><model name="m">{link("a", "0 0 0 0 0 0", 1)}{included}</model></sdf>'

        return {f"{k or 'arm'}.sdf": text(k).encode() for k in range(length)}

    with pytest.raises(InvalidDocument, match="nested deeper than 200 levels"):
        read(chain(1000, 1))
    monkeypatch.setattr(includes, "MAX_ELEMENTS", 2000)
    with pytest.raises(InvalidDocument, match="more than 2,000 elements in what is included"):
        read(chain(20, 2))


def test_what_stands_beside_the_model_in_a_world_may_be_missing() -> None:
    model = ARM.replace('<sdf version="1.9">', "").replace("HAND", "").replace("</sdf>", "")
    model = model.replace(
        '<joint name="hold" type="fixed"><parent>upper</parent><child>right::mount</child></joint>', ""
    )
    world = f'<sdf version="1.9"><world name="w"><include><uri>model://sun</uri></include>{model}</world></sdf>'
    assert "the file is not here" in import_file(world.encode()).definition["left_out"][0]["message"]
    with pytest.raises(InvalidDocument, match="'model://arm' is not here"):
        import_file(WORLD.encode())
    given = {"arm/model.sdf": written_out().encode()}
    assert import_file(WORLD.encode(), included=given).definition["name"] == "arm"
