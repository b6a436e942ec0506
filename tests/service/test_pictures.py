"""Pictures of parts and trees: SVG in any pose, immutable where the reference is."""

from __future__ import annotations

import warnings

import pytest
from fastapi.testclient import TestClient

from .conftest import PENDULUM
from .one_store import filled, store
from .reading import draw, read
from .test_conventions import problem

__all__ = ["filled", "store"]  # fixtures

PICTURES = ("/v1/substructures/pendulum@1/picture", "/v1/trees/cell@1/picture")


@pytest.mark.parametrize("path", PICTURES)
def test_pictures_are_svg_and_immutable(filled: TestClient, path: str) -> None:
    assert len(draw(filled, path)) > 3
    first = filled.get(path)
    assert first.headers["cache-control"].endswith("immutable")
    again = filled.get(path, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    latest = filled.get(path.replace("@1", ""))
    assert (latest.headers["cache-control"], latest.text) == ("no-cache", first.text)


@pytest.mark.parametrize("path", PICTURES)
def test_pictures_in_a_pose(filled: TestClient, path: str) -> None:
    standard, turned = filled.get(path), filled.get(path, params={"q": " -1.5e0 "})
    assert draw(filled, path, q="-1.5") is not None
    assert turned.text != standard.text
    assert turned.headers["etag"] not in (standard.headers["etag"], filled.get(path, params={"q": "1"}).headers["etag"])
    assert filled.get(path).text == standard.text


@pytest.mark.parametrize("path", PICTURES)
@pytest.mark.parametrize(
    "q", ["", "1,2", "1,", "x", "nan", "inf", "1e400", "1e9", "1_0", "0x1", "\u0661", "<script>", "1;2", "--1"]
)
def test_wrong_poses(filled: TestClient, path: str, q: str) -> None:
    document = problem(filled.get(path, params={"q": q}), 422, "q")
    assert document["errors"][0]["pointer"] == "/query/q"


def test_pictures_are_linked(filled: TestClient) -> None:
    for kind in ("substructures/pendulum", "trees/cell"):
        address = filled.get(f"/v1/{kind}").json()["links"]["picture"]
        assert address == f"/v1/{kind}@1/picture"
        draw(filled, address)


def test_numbers_of_any_size_are_drawn(client: TestClient) -> None:
    for value in (1e300, -1e300, 1e-300, 0):
        length = {"l": {"value": value, "unit": "m"}}
        definition = {**PENDULUM, "parameters": {**PENDULUM["parameters"], **length}}
        with warnings.catch_warnings():  # the certificate of such a part is not the subject here
            warnings.simplefilter("ignore", RuntimeWarning)
            answer = client.post("/v1/substructures", json=definition)
        assert answer.status_code == 201, answer.text
        draw(client, answer.headers["location"] + "/picture")
        read(client, "/substructures/pendulum")


@pytest.mark.parametrize("path", ["/v1/substructures/pendulum@1/scene", "/v1/trees/cell@1/scene"])
def test_scenes_are_data_and_immutable(filled: TestClient, path: str) -> None:
    first = filled.get(path)
    assert first.headers["cache-control"].endswith("immutable")
    assert filled.get(path, headers={"If-None-Match": first.headers["etag"]}).status_code == 304
    assert "immutable" not in filled.get(path.replace("@1", "")).headers["cache-control"]
    prefix = "arm." if "cell" in path else ""
    told = first.json()
    assert [frame["name"] for frame in told["frames"]] == [f"{prefix}{name}" for name in ("base", "rod", "tip")]
    assert [frame["parent"] for frame in told["frames"]] == [-1, 0, 1]
    assert told["joints"][0]["coordinate"] == f"{prefix}q"
    assert told["bodies"][0]["name"] == f"{prefix}rod"
    assert list(told["poses"]) == ["home"]
    assert filled.get(f"/v1/{path.split('/')[2]}/nothing/scene").status_code == 404
