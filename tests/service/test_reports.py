"""``GET .../report`` over HTTP."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.operations.reports import FORMATS
from service.schemas.reports import ReportView

from .conftest import make_client
from .one_store import copied, filled, store

__all__ = ["filled", "store"]  # fixtures


@pytest.mark.parametrize("path", ["substructures/pendulum", "substructures/slider", "trees/cell"])
@pytest.mark.parametrize("name", FORMATS)
def test_every_format(filled: TestClient, path: str, name: str) -> None:
    answer = filled.get(f"/v1/{path}/report", params={"format": name})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == FORMATS[name]
    by_accept = filled.get(f"/v1/{path}/report", headers={"Accept": FORMATS[name].partition(";")[0]})
    assert by_accept.content == answer.content
    again = filled.get(f"/v1/{path}/report?format={name}", headers={"If-None-Match": answer.headers["etag"]})
    assert again.status_code == 304
    if name == "json":
        ReportView.model_validate(answer.json())


def test_what_a_tree_says(filled: TestClient) -> None:
    found = filled.get("/v1/trees/cell/report").json()
    assert (found["name"], found["title"], found["dof"]) == ("cell@1", "Tree cell", 1)
    assert "g[1,1] does not change." in {each["text"] for each in found["statements"]}
    assert found["notes"] == ["Instances: arm (pendulum)."]
    values = {each["name"]: each["value"] for each in found["symbols"]}
    assert values["arm.m"] == 2
    assert found["sources"][0]["title"] == "Pendulum"
    requests = {each["request"] for each in found["statements"] if each["about"] == "rest"}
    assert requests == {"POST /v1/trees/cell@1/equilibria"}
    (told,) = [each["figures"][1] for each in found["statements"] if each["code"] == "searched"]
    shown = filled.post("/v1/trees/cell@1/equilibria", json={}).json()
    assert told == {"name": "found", "value": len(shown["found"]), "unit": "1"}


def test_a_part_says_what_was_assumed(filled: TestClient) -> None:
    found = filled.get("/v1/substructures/pendulum@1/report").json()
    assert "gravity" in found["notes"][0]
    assert found["digest"] == filled.get("/v1/substructures/pendulum").json()["digest"]


def test_the_document_and_its_body(filled: TestClient) -> None:
    whole = filled.get("/v1/trees/cell/report?format=latex&document=true").text
    body = filled.get("/v1/trees/cell/report?format=latex&document=false").text
    assert whole.startswith(r"\documentclass")
    assert body in whole
    assert r"\begin{picture}" in body


def test_the_page_may_have_its_style_and_nothing_else(filled: TestClient) -> None:
    answer = filled.get("/v1/trees/cell/report", headers={"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"})
    assert answer.headers["content-type"].startswith("application/xhtml+xml")
    assert answer.headers["content-security-policy"].startswith("default-src 'none'; style-src 'unsafe-inline'")
    ElementTree.fromstring(answer.content)  # noqa: S314 -- our own


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("trees/cell/report?format=c", 422),
        ("trees/cell/report?form=textbook", 422),
        ("trees/nobody/report", 404),
        ("substructures/nobody/report", 404),
    ],
)
def test_what_is_refused(filled: TestClient, path: str, status: int) -> None:
    assert filled.get(f"/v1/{path}").status_code == status
    assert filled.get("/v1/trees/cell/report", headers={"Accept": "image/png"}).status_code == 406


def test_too_much_is_refused_with_its_size(template: Path, tmp_path: Path) -> None:
    """Of a store that has made no report yet."""
    with copied(template, tmp_path) as store, make_client(store) as client:
        limits = store.settings.limits.model_copy(update={"program_nodes": 2})
        store.settings = store.settings.model_copy(update={"limits": limits})
        answer = client.get("/v1/trees/cell/report?format=latex")
    assert (answer.status_code, answer.json()["code"]) == (422, "too-large")
    assert "limit is 2" in answer.json()["detail"]


def test_parts_and_trees_lead_to_their_reports(filled: TestClient) -> None:
    for path, page in (
        ("/v1/substructures/pendulum@1", "/substructures/pendulum@1"),
        ("/v1/trees/cell@1", "/trees/cell@1"),
    ):
        report = filled.get(path).json()["links"]["report"]
        assert filled.get(report).status_code == 200
        shown = filled.get(page)
        assert shown.status_code == 200
        assert f'href="{report}?format=mathml"' in shown.text
