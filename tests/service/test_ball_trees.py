"""Trees with joints without singular angles over HTTP: stored, shown, printed, evaluated, moved, exported."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.messages.negotiation import MEDIA_TYPES
from service.schemas.resources import TreeView, VersionView

#: a satellite on a wheel
TREE: dict[str, Any] = {
    "name": "satellite",
    "gravity": [0, 0, -9.81],
    "instances": [
        {
            "name": "s",
            "definition": {
                "name": "on-a-wheel",
                "parameters": {"J": {"value": 0.2, "unit": "kg*m^2"}},
                "bodies": [
                    {"name": "hull", "parent": "base", "mass": 5, "inertia": {"xx": 2, "yy": 3, "zz": 4},
                     "joint": {"type": "floating", "velocities": ["vx", "vy", "vz", "wx", "wy", "wz"]}},
                    {"name": "wheel", "parent": "hull", "inertia": {"zz": "J"},
                     "joint": {"type": "revolute", "coordinate": "spin"}},
                ],
            },
        }
    ],
}  # fmt: skip
POSITIONS = [*(f"s.r_hull_{axis}" for axis in "xyz"), *(f"s.q_hull_{axis}" for axis in "wxyz"), "s.spin"]


@pytest.fixture
def satellite(client: TestClient) -> TestClient:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    rates = [f"s.{name}" for name in ("vx", "vy", "vz", "wx", "wy", "wz")]
    assert made.json()["coordinates"] == [*rates, "s.spin"]
    assert made.json()["balls"] == [{"positions": POSITIONS[:-1], "velocities": rates}]
    TreeView.model_validate(made.json())
    return client


def test_a_part_of_it_has_the_view_of_any(client: TestClient) -> None:
    made = client.post("/v1/substructures", json=TREE["instances"][0]["definition"])
    assert made.status_code == 201, made.text
    VersionView.model_validate(made.json())


def test_reports_of_it_are_refused(satellite: TestClient) -> None:
    """Of the part, too."""
    made = satellite.post("/v1/substructures", json=TREE["instances"][0]["definition"])
    assert made.status_code in (200, 201), made.text
    for path in ("trees/satellite", f"substructures/{made.json()['name']}"):
        answer = satellite.get(f"/v1/{path}/report")
        assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "has-balls"), answer.text


def test_it_is_shown_and_printed(satellite: TestClient) -> None:
    assert satellite.get("/trees/satellite").status_code == 200
    for name in ("metric", "christoffel", "forces", "potential_energy", "bias", "position_rates"):
        for kind in MEDIA_TYPES:
            answer = satellite.get(f"/v1/trees/satellite/{name}?format={kind}")
            assert answer.status_code == 200, (name, kind, answer.text[:300])
    text = satellite.get("/v1/trees/satellite/bias?format=text").text
    assert "wx'*wy'" in text
    assert "q_hull" not in text


def test_it_is_evaluated(satellite: TestClient) -> None:
    body = {
        "quantities": ["metric", "bias", "gravity"],
        "q": [1, 2, 3, 0.6, 0.8, 0, 0, 0.5],
        "qd": [0] * 3 + [1, 2, 3, 4],
    }
    found = satellite.post("/v1/trees/satellite/evaluations", json=body)
    assert found.status_code == 200, found.text
    assert np.array(found.json()["metric"]).shape == (7, 7)
    # weight in the axes of the hull, which is turned about x
    np.testing.assert_allclose(found.json()["gravity"][:3], [0, -5 * 9.81 * 0.96, -5 * 9.81 * -0.28], rtol=1e-12)
    named = {**body, "q": dict(zip(POSITIONS, body["q"], strict=True))}  # type: ignore[call-overload]
    assert satellite.post("/v1/trees/satellite/evaluations", json=named).json()["bias"] == found.json()["bias"]
    wrong = satellite.post("/v1/trees/satellite/evaluations", json={**body, "q": [0, 0, 0, 1, 1, 0, 0, 0]})
    assert (wrong.status_code, wrong.json()["errors"][0]["code"]) == (422, "not-a-unit-quaternion")
    short = satellite.post("/v1/trees/satellite/evaluations", json={**body, "q": [0] * 7})
    assert short.json()["errors"][0]["code"] == "wrong-length"


def test_it_moves(satellite: TestClient) -> None:
    start = {"q": [0, 0, 0, 1, 0, 0, 0, 0], "qd": [0, 0, 0, 0.1, 1, 0.2, 5], "span": [0, 3], "count": 4}
    found = satellite.post("/v1/trees/satellite/simulations", json=start)
    assert found.status_code == 200, found.text
    told = found.json()
    assert told["is_right"] is True
    assert told["positions"] == POSITIONS
    assert np.array(told["q"]).shape == (4, 8)
    # free fall
    np.testing.assert_allclose(np.array(told["q"])[:, 2], -9.81 / 2 * np.arange(4) ** 2, atol=1e-7)
    for kind in ("text/csv", "image/svg+xml", "application/x-npz"):
        answer = satellite.post("/v1/trees/satellite/simulations", json=start, headers={"Accept": kind})
        assert answer.status_code == 200, (kind, answer.text[:300])


def test_a_wheel_of_it_sticks(client: TestClient) -> None:
    """Told with the hull's quaternion; without friction there is none to be exact."""
    definition = TREE["instances"][0]["definition"]
    hull, wheel = definition["bodies"]
    rubbing = {**wheel["joint"], "friction": {"coulomb": "1/2", "velocity": "1/1000"}}
    instance = {"name": "s", "definition": {**definition, "bodies": [hull, {**wheel, "joint": rubbing}]}}
    for tree in (TREE, {**TREE, "name": "rubbing", "instances": [instance]}):
        assert client.post("/v1/trees", json=tree).status_code == 201
    start = {"q": [0, 0, 0, 1, 0, 0, 0, 0], "qd": [0] * 6 + [1], "span": [0, 1], "friction": "exact"}
    motion = client.post("/v1/trees/rubbing/simulations", json=start).json()
    assert motion["is_right"], motion["checks"]
    (event,) = motion["events"]
    # 0.5 N m on 0.2 kg m^2 and on the hull's 4
    assert (event["name"], event["kind"], event["t"]) == ("s.spin", "stick", pytest.approx(1 / (0.5 / 0.2 + 0.5 / 4)))
    assert np.linalg.norm(event["q"][3:7]) == pytest.approx(1, abs=1e-14)
    wrong = client.post("/v1/trees/satellite/simulations", json=start)
    assert wrong.json()["errors"][0]["code"] == "no-friction", wrong.text


def test_the_satellite_leaves_as_an_fmu(satellite: TestClient) -> None:
    answer = satellite.get("/v1/trees/satellite/export?target=fmu&quantities=kinetic_energy")
    assert answer.status_code == 200, answer.text
    told = zipfile.ZipFile(io.BytesIO(answer.content)).read("modelDescription.xml").decode()
    assert f'name="der({POSITIONS[3]})"' in told
    block = satellite.get("/v1/trees/satellite/export?target=simulink")
    assert block.status_code == 200, block.text
    source = zipfile.ZipFile(io.BytesIO(block.content)).read("satellite_sfun.c").decode()
    assert "NQ = 8, NV = 7" in source


def test_the_linearised_satellite(satellite: TestClient) -> None:
    """Displacements in the axes of the hull: gravity turns with it, -m g along x by the turn about y."""
    found = satellite.post("/v1/trees/satellite/linearisations", json={"q": [0, 0, 0, 1, 0, 0, 0, 0]}).json()
    assert found["K"][0][4] == pytest.approx(-5 * 9.81)
    assert np.array(found["R"]).shape == (7, 7)
    assert not np.any(found["R"])
    space = satellite.get("/v1/trees/satellite/state_space").json()
    assert space["positions"] == POSITIONS
    assert len(space["state"]) == 14


def test_it_is_drawn_at_rest_and_at_any_state(satellite: TestClient) -> None:
    scene = satellite.get("/v1/trees/satellite/scene").json()
    assert scene["positions"] == POSITIONS
    assert scene["poses"] == {"home": [0, 0, 0, 1, 0, 0, 0, 0]}
    assert len({shape.text for shape in (drawn(satellite, q) for q in (None, "0,0,0,1,0,0,0,0"))}) == 1
    assert drawn(satellite, "1 m,2,3,0.6,0.8,0,0,30 deg").text != drawn(satellite, None).text
    part = satellite.get("/v1/trees/satellite").json()["instances"][0]
    assert part["name"] == "s"
    for q, told in (("0,0,0,0,0,0,0", "expected 8"), ("0,0,0,1 m,0,0,0,0", "'1 m'"), ("0,0,0,1,1,0,0,0", "norm")):
        answer = satellite.get(f"/v1/trees/satellite/picture?q={q}")
        assert (answer.status_code, told in answer.text) == (422, True), answer.text


def drawn(client: TestClient, q: str | None) -> Any:
    answer = client.get("/v1/trees/satellite/picture", params={} if q is None else {"q": q})
    assert answer.status_code == 200, answer.text
    return answer


def test_its_part_is_drawn_too_and_imports_are_previewed(client: TestClient) -> None:
    made = client.post("/v1/substructures", json=TREE["instances"][0]["definition"])
    assert made.status_code == 201, made.text
    scene = client.get("/v1/substructures/on-a-wheel@1/scene").json()
    assert scene["positions"][3:5] == ["q_hull_w", "q_hull_x"]
    assert client.get("/v1/substructures/on-a-wheel@1/picture?q=0,0,0,0,1,0,0,0.5").status_code == 200
    file = '<mujoco><worldbody><body><freejoint name="f"/><geom size=".1"/></body></worldbody></mujoco>'
    told = client.post(
        "/v1/imports?rotations=quaternions&preview=true", content=file, headers={"Content-Type": "text/xml"}
    )
    assert told.json()["preview"]["dof"] == 6, told.text


def test_it_is_published_and_mounted_again(satellite: TestClient) -> None:
    made = satellite.post("/v1/trees/satellite/publish", json={"name": "as-a-part"})
    assert made.status_code == 201, made.text
    tree = {**TREE, "name": "again", "instances": [{"name": "x", "substructure": "as-a-part"}]}
    again = satellite.post("/v1/trees", json=tree)
    assert again.json()["balls"][0]["positions"] == [f"x.{name.replace('.', '_')}" for name in POSITIONS[:-1]], (
        again.text
    )
    body = {"quantities": ["bias"], "q": [1, 2, 3, 0.6, 0.8, 0, 0, 0.5], "qd": [1, 2, 3, 1, 2, 3, 4]}
    ours, theirs = (
        satellite.post(f"/v1/trees/{name}/evaluations", json=body).json() for name in ("satellite", "again")
    )
    np.testing.assert_allclose(theirs["bias"], ours["bias"], rtol=1e-12)


def test_it_leaves_as_urdf_and_comes_back(satellite: TestClient) -> None:
    file = satellite.get("/v1/trees/satellite/export?target=urdf&bind=s.J:0")
    assert file.status_code == 200, file.text
    assert '<joint name="s.hull_floating" type="floating">' in file.text
    query = "name=again&parameters=none&rotations=quaternions&store=true"
    made = satellite.post(f"/v1/imports?{query}", content=file.content, headers={"Content-Type": "application/xml"})
    assert made.status_code == 201, made.text
    rates = made.json()["names"]["velocities s.hull_floating"].split(", ")
    assert rates == [f"s_hull_floating_{name}" for name in ("vx", "vy", "vz", "wx", "wy", "wz")]
    same = satellite.post("/v1/equivalences", json={"a": "again@1", "b": made.json()["definition"]})
    assert same.json().get("level") == "formulas", same.text
    whole = {"name": "whole", "instances": [{"name": "x", "substructure": "again"}]}
    assert satellite.post("/v1/trees", json=whole).json()["balls"][0]["positions"][3] == "x.s_hull_floating_qw"


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("curvatures", {"q": [0, 0, 0, 1, 0, 0, 0, 0]}),
        ("evaluations", {"quantities": ["floating_metric"], "q": [0, 0, 0, 1, 0, 0, 0, 0]}),
    ],
)
def test_what_refuses_it_says_why(satellite: TestClient, path: str, body: dict[str, Any]) -> None:
    answer = satellite.post(f"/v1/trees/satellite/{path}", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["code"] == "has-balls", answer.text
