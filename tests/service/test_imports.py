"""Robot files over HTTP, on the command line and on the first page."""

from __future__ import annotations

from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.cli.main import main
from service.server import background
from service.settings import Limits, Settings
from service.store.store import Store
from tests.interchange.test_meshes import ROBOT as ROBOT_WITH_MESHES
from tests.interchange.test_meshes import zipped

from .conftest import PENDULUM
from .fake_engine import FakeEngine, finished, running

LINK = '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'
ARM = f"""<robot name="My Arm">
<link name="base"/><link name="upper-arm">{LINK}</link><link name="tool"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper-arm"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
<joint name="flange" type="fixed"><parent link="upper-arm"/><child link="tool"/><origin xyz="0 0 1"/></joint>
</robot>"""
LOOP = """<mujoco model="four bar"><worldbody>
<body name="a"><joint name="p" axis="0 1 0"/><geom size=".1" pos="1 0 0"/></body>
<body name="b" pos="2 0 0"><joint name="q" axis="0 1 0"/><geom size=".1" pos="1 0 0"/></body>
</worldbody><equality><connect name="pin" body1="a" body2="b" anchor="1 0 0"/></equality></mujoco>"""
BONE = LINK.replace("<mass", '<origin xyz=".1 .2 .3"/><mass')
LONG = f"""<robot name="long"><link name="ground"/>
{"".join(f'<link name="{name}">{BONE}</link>' for name in ("upperarm", "forearm", "hand"))}
<joint name="shoulder" type="continuous"><parent link="ground"/><child link="upperarm"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upperarm"/><child link="forearm"/><axis xyz="0 1 0"/>
<origin xyz="0 0 .4" rpy="0 .2 .3"/></joint>
<joint name="wrist" type="continuous"><parent link="forearm"/><child link="hand"/><origin xyz="0 0 .3"/></joint>
</robot>"""
XML = {"Content-Type": "application/xml"}
ZIP = {"Content-Type": "application/zip"}


def test_a_file_is_read_and_nothing_is_stored(client: TestClient) -> None:
    before = client.get("/v1/substructures").json()["items"]
    answer = client.post("/v1/imports?file=arm.urdf", content=ARM, headers=XML)
    assert answer.status_code == 200
    found = answer.json()
    assert found["kind"] == "urdf"
    assert found["names"] == {
        "base": "base_2", "upper-arm": "upper_arm", "tool": "tool", "joint shoulder": "shoulder"
    }  # fmt: skip
    assert found["definition"]["source"].startswith("URDF file arm.urdf, sha256:")
    assert found["checks"]["schema"] == {"passed": True, "warnings": 0}
    assert "stored" not in found
    assert client.get("/v1/substructures").json()["items"] == before


def test_what_is_read_can_be_stored_and_coupled(client: TestClient) -> None:
    answer = client.post("/v1/imports?store=true&name=arm&parameters=none", content=ARM, headers=XML)
    assert answer.status_code == 201
    assert answer.json()["stored"] == {
        "name": "arm", "version": 1, "digest": answer.json()["stored"]["digest"], "href": "/v1/substructures/arm@1"
    }  # fmt: skip
    assert client.get(answer.headers["Location"]).json()["ports"] == ["tool"]
    again = client.post("/v1/imports?store=true&name=arm&parameters=none", content=ARM, headers=XML)
    assert again.status_code == 200


def test_a_file_with_loops_is_a_tree(client: TestClient) -> None:
    answer = client.post("/v1/imports?store=true", content=LOOP, headers=XML)
    assert answer.status_code == 201
    found = answer.json()
    assert "definition" not in found
    assert found["tree"]["closures"][0]["type"] == "ball"
    assert client.get("/v1/trees/four-bar").json()["closures"][0]["name"] == "pin"


@pytest.mark.parametrize(
    ("content", "query", "status", "said"),
    [
        (ARM.replace("0 1 0", "0 0 0"), "", 422, 'line 3: <axis>: the axis has no direction'),
        (ARM, "?kind=mjcf", 422, "this is URDF, not MJCF"),
        (ARM, "?kind=word", 422, "kind 'word' is none of"),
        (ARM, "?name=%E8%85%95", 422, "/query/name: '\u8155' has nothing of what names here are made of"),
        ("<html></html>", "", 422, "this is a web page"),
        ("", "", 422, "no element found"),
        ("\x00\x01", "", 422, "not well-formed"),
        (" " * 3_000_000, "", 413, "; a zip with the file (application/zip) may have 67,108,864 bytes"),
        (ARM.replace('value="2"', 'value="nan"'), "", 422, "line 2: <mass>: 'value' is no finite number: 'nan'"),
        (ARM.replace('value="2"', 'value="-2"'), "", 422, "the mass -2 kg is negative"),
        (ARM.replace('child link="tool"', 'child link="gone"'), "", 422, "there is no link 'gone'"),
        (ARM.replace("<robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot'), "", 422, "entities and external"),
        (ARM.encode("utf-16")[3:], "", 422, "line 1"),
        ('<mujoco><include file="../../etc/passwd"/></mujoco>', "", 422, "'../../etc/passwd' is not followed"),
        (ARM, "?parameters=some", 422, "parameters"),
    ],
)  # fmt: skip
def test_bad_files_are_refused_with_line_and_element(
    client: TestClient, content: str | bytes, query: str, status: int, said: str
) -> None:
    answer = client.post(f"/v1/imports{query}{'&' if query else '?'}store=true", content=content, headers=XML)
    assert answer.status_code == status
    assert said in answer.text
    assert client.get("/v1/substructures").json()["items"] == client.get("/v1/trees").json()["items"] == []


MIMIC = Path(__file__).parent.parent / "interchange" / "cases" / "11-mimic-offset-chain.urdf"


def test_mimic_joints_are_relations_of_what_is_stored(client: TestClient) -> None:
    """They have no coordinates, in formulas, states and motions; and leave as mimic joints."""
    answer = client.post("/v1/imports?store=true&name=arm", content=MIMIC.read_bytes(), headers=XML).json()
    assert answer["bindings"] == []
    assert [r["coordinate"] for r in answer["definition"]["relations"]] == ["c_joint", "b_joint"]
    version = client.get("/v1/substructures/arm").json()
    assert version["warnings"] == []
    assert version["coordinates"] == ["a_joint"]
    tree = {"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "arm"}]}
    made = client.post("/v1/trees", json=tree).json()
    assert made["warnings"] == []
    motion = client.post("/v1/trees/cell/simulations", json={"q": {"x.a_joint": 0.3}, "span": [0, 1]}).json()
    assert motion["coordinates"] == ["x.a_joint"]
    assert motion["q"][-1] == pytest.approx([2.57323616], abs=1e-5)
    data = client.get("/v1/substructures/arm/export?target=urdf").content
    assert data.count(b"<mimic ") == 2


def test_relations_that_a_definition_leaves_out_are_told_of(client: TestClient) -> None:
    """By the version, by trees, and by a simulation whose start violates one by 0.3 rad."""
    plain = client.post("/v1/imports", content=MIMIC.read_bytes(), headers=XML).json()["definition"]
    plain["left_out"] = [{"message": f"{r['coordinate']} of {r['of']}", "relation": r} for r in plain.pop("relations")]
    assert client.post("/v1/substructures", json={**plain, "name": "arm"}).status_code == 201
    version = client.get("/v1/substructures/arm").json()
    assert [w["code"] for w in version["warnings"]] == ["left-out", "left-out"]
    tree = {"name": "cell", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "arm"}]}
    made = client.post("/v1/trees", json=tree).json()
    assert [w["pointer"] for w in made["warnings"]] == ["/instances/0", "/instances/0"]
    constraints = [
        {"type": "linear", "name": "b_joint", "expression": "x.b_joint' + 1.5*x.a_joint'"},
        {"type": "linear", "name": "c_joint", "expression": "x.c_joint' - 0.5*x.b_joint'"},
    ]
    for b, codes in ((-0.25, []), (0.05, ["relation-left"])):
        q = {"x.a_joint": 0.3, "x.b_joint": b, "x.c_joint": 0.5 * b + 0.05}
        body = {"q": q, "span": [0, 1], "constraints": constraints}
        motion = client.post("/v1/trees/cell/simulations", json=body).json()
        assert [w["code"] for w in motion["warnings"]] == codes
        state = client.post("/v1/trees/cell/evaluations", json={"quantities": ["metric"], "q": q}).json()
        assert [w["code"] for w in state["warnings"]] == codes


def test_a_file_is_cut_into_parts_of_a_tree(client: TestClient) -> None:
    client.post("/v1/imports?store=true&name=arm", content=LONG, headers=XML)
    made = client.post("/v1/imports?store=true&name=two&cut=forearm,%20hand&parameters=none", content=LONG, headers=XML)
    assert made.status_code == 201, made.text
    assert [i["name"] for i in made.json()["tree"]["instances"]] == ["robot", "forearm", "hand"]
    assert [i.get("at") for i in made.json()["tree"]["instances"]][1:] == ["robot.forearm_mount", "forearm.hand_mount"]
    assert made.json()["names"]["joint wrist"] == "hand.wrist"
    names = {
        joint: f"{link}.{joint}" for link, joint in (("robot", "shoulder"), ("forearm", "elbow"), ("hand", "wrist"))
    }
    told = client.post("/v1/equivalences", json={"a": "arm", "b": "two", "coordinates": names}).json()
    assert told["equal"], told
    # the parts are in the catalogue, and the tree is made of them
    tree = client.get("/v1/trees/two").json()
    assert [i["substructure"].partition("@")[0] for i in tree["instances"]] == ["two-robot", "two-forearm", "two-hand"]
    for instance in tree["instances"]:
        part = client.get(f"/v1/substructures/{instance['substructure']}/definition").json()
        assert "sha256:" in part["source"]
        assert client.get(f"/v1/substructures/{part['name']}/uses").json()["items"]
    again = client.post("/v1/imports?store=true&name=two&cut=forearm,hand&parameters=none", content=LONG, headers=XML)
    assert again.status_code == 200
    other = {"name": "other", "instances": [{"name": "h", "substructure": "two-hand"}]}
    assert client.post("/v1/trees", json=other).status_code == 201


def test_parts_of_a_cut_file_are_versions_of_their_names(client: TestClient) -> None:
    taken = {**PENDULUM, "name": "arm-hand"}
    assert client.post("/v1/substructures", json=taken).status_code == 201
    made = client.post("/v1/imports?store=true&name=arm&cut=hand&parameters=none", content=LONG, headers=XML)
    assert made.status_code == 201  # a version more of one's own name
    assert client.get("/v1/substructures/arm-hand").json()["version"] == 2


def test_parts_of_a_cut_file_are_in_the_catalogue_where_it_becomes_a_job(client: TestClient, store: Store) -> None:
    """As where they are stored at once."""
    name, later = "/v1/imports?store=true&cut=hand&visibility=private&name=", {**XML, "Prefer": "respond-async"}
    with running(store, FakeEngine()):
        made = client.post(f"{name}arm", content=LONG, headers=later)
        assert finished(client, made.json()["id"])["state"] == "succeeded"
    assert client.post(f"{name}leg", content=LONG, headers=XML).status_code == 201
    for ref in ("arm", "leg"):
        tree = client.get(f"/v1/trees/{ref}").json()
        for instance, part in zip(tree["instances"], (f"{ref}-robot", f"{ref}-hand"), strict=True):
            version = client.get(f"/v1/substructures/{part}").json()
            assert instance["substructure"] == f"{part}@{version['digest']}"
            assert (version["origin"], version["visibility"]) == ("import", "private")


def test_a_cut_that_cannot_be_stores_nothing(client: TestClient) -> None:
    for cut, said in (("fore arm", "did you mean 'forearm'"), ("ground", "nothing remains")):
        answer = client.post(f"/v1/imports?store=true&cut={cut}", content=LONG, headers=XML)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == "/query/cut"
        assert said in answer.json()["errors"][0]["message"]
    assert client.get("/v1/trees").json()["items"] == []


@pytest.mark.parametrize("sent", ["text/plain", "multipart/form-data", "application/x-www-form-urlencoded", ""])
def test_forms_of_other_sites_are_kept_out(client: TestClient, sent: str) -> None:
    assert client.post("/v1/imports", content=ARM, headers={"Content-Type": sent}).status_code == 415


def test_the_first_page_takes_files(client: TestClient) -> None:
    page = client.get("/")
    assert 'id="file"' in page.text
    assert "connect-src 'self'" in page.headers["Content-Security-Policy"]


@pytest.mark.parametrize("cut", ["", "hand"])
def test_a_robot_that_is_submitted_may_become_a_job(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], cut: str
) -> None:
    """The command waits for it."""
    path = tmp_path / "long.urdf"
    path.write_text(LONG)
    settings = Settings(database=f"sqlite:///{tmp_path / 's.db'}", catalogue=False, limits=Limits(sync_seconds=1e-6))
    with background(settings) as address:
        assert main(["import", str(path), "--cut", cut, "--submit", "--server", address]) == 0
    told = capsys.readouterr()
    assert "became the job" in told.out
    assert f"{'assemble' if cut else 'derive'}: 1 succeeded of 1" in told.err


def test_models_are_compared(client: TestClient) -> None:
    client.post("/v1/imports?store=true&name=arm", content=ARM, headers=XML)
    same = client.post("/v1/equivalences", json={"a": "arm", "b": {"file": ARM}})
    assert same.status_code == 200
    assert (same.json()["equal"], same.json()["level"]) == (True, "formulas")
    heavier = ARM.replace('value="2"', 'value="3"').replace('<origin xyz="0 0 1"/>', "")
    other = client.post("/v1/equivalences", json={"a": "arm", "b": {"file": heavier, "kind": "urdf"}})
    assert other.json()["equal"] is True  # the mass is on the axis
    wider = client.post("/v1/equivalences", json={"a": "arm", "b": {"file": ARM.replace('iyy="1"', 'iyy="2"')}})
    assert wider.json()["culprits"] == [{"body": "upper_arm", "parameter": "inertia.yy", "a": 1, "b": 2}]
    tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    tree["instances"] = [{"name": "one", "substructure": "arm"}]
    assert client.post("/v1/trees", json=tree).status_code == 201
    assert client.post("/v1/equivalences", json={"a": "t", "b": "arm"}).json()["equal"] is True


@pytest.mark.parametrize(
    ("a", "said"),
    [
        ("nothing", "there is no substructure or tree 'nothing'"),
        (3, "/a"),
        ({"file": "<html/>"}, "this is a web page"),
        ({"file": ARM, "more": 1}, "a file is its text"),
        ({"bodies": []}, "'name' is needed"),
        ({"file": ARM.replace('"shoulder"', '"other"')}, "coordinates cannot be matched by name"),
    ],
)
def test_bad_comparisons_are_refused(client: TestClient, a: object, said: str) -> None:
    answer = client.post("/v1/equivalences", json={"a": a, "b": {"file": ARM}})
    assert answer.status_code == 422
    assert said in answer.text


@pytest.mark.parametrize("cut", ["", "&cut=upper-arm"])
def test_what_is_stored_may_be_private(client: TestClient, cut: str) -> None:
    answer = client.post(f"/v1/imports?store=true&name=arm&visibility=private{cut}", content=ARM, headers=XML)
    assert answer.status_code == 201, answer.text
    for kind in ("trees", "substructures") if cut else ("substructures",):
        for found in client.get(f"/v1/{kind}").json()["items"]:
            told = client.get(f"/v1/{kind}/{found['name']}/visibility").json()
            assert told["visibility"] == "private", told


def test_a_visibility_that_is_none_is_refused(client: TestClient) -> None:
    answer = client.post("/v1/imports?store=true&visibility=hidden", content=ARM, headers=XML)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/query/visibility")


def test_a_zip_brings_the_meshes_along(client: TestClient) -> None:
    answer = client.post("/v1/imports?preview=true&file=bot.zip", content=zipped(ROBOT_WITH_MESHES), headers=ZIP)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert found["definition"]["source"].startswith("MJCF file bot/robot.xml, sha256:")
    assert found["preview"]["mass"] == pytest.approx(1000 * 24 * 0.5 * 0.4 * 0.3 + 2)
    stored = client.post("/v1/imports?store=true&name=bot", content=zipped(ROBOT_WITH_MESHES), headers=ZIP)
    assert stored.status_code == 201
    assert client.get("/v1/substructures/bot@1").json()["dof"] == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"PK\3\4 no zip", "not a zip that can be read"),
        (zipped({"x.stl": b""}), "there is no robot file"),
        (zipped({"a.xml": b"<a/>", "b.xml": b"<b/>"}), "several robot files: say which by 'file': a.xml, b.xml"),
        (zipped({"../a.xml": b"<a/>"}), "leads out of the bundle"),
        (zipped({"bot/robot.xml": ROBOT_WITH_MESHES["bot/robot.xml"]}), "'part.stl' is not given"),
        (zipped({**ROBOT_WITH_MESHES, "bot/meshes/part.stl": b"?"}), "neither a binary STL file"),
        (zipped({"a.xml": b" " * (65 * 2**20)}), "the limit is 67,108,864"),
    ],
)
def test_bad_zips_are_refused(client: TestClient, content: bytes, message: str) -> None:
    answer = client.post("/v1/imports", content=content, headers=ZIP)
    assert answer.status_code == 422
    assert message in answer.text


USD = b"""#usda 1.0
(
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "rod" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
{
    float physics:mass = 2
    point3f physics:centerOfMass = (0, 0, -0.5)
    float3 physics:diagonalInertia = (0.2, 0.2, 0.01)
}
def PhysicsRevoluteJoint "hinge"
{
    uniform token physics:axis = "Y"
    rel physics:body1 = </rod>
}
"""


def test_usd_files_and_packages_are_read_where_requests_are_computed(client: TestClient) -> None:
    pytest.importorskip("pxr", reason="the wheel usd-core is not installed (extra 'usd')")
    package = zipped({"rod.usda": USD, "other.usda": b"#usda 1.0\n"})
    binary = {"Content-Type": "application/octet-stream"}
    for content, file in ((USD, "rod.usda"), (package, "rod.usdz")):
        answer = client.post(f"/v1/imports?preview=true&file={file}", content=content, headers=binary)
        assert answer.status_code == 200, answer.text
        assert answer.json()["kind"] == "usd"
        assert answer.json()["preview"]["mass"] == 2
    refused = client.post("/v1/imports", content=USD.replace(b"</rod>", b"</rot>"), headers=binary)
    assert refused.status_code == 422
    assert "</hinge>: there is no prim </rot>; did you mean '/rod'?" in refused.text
