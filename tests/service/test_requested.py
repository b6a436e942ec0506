"""What takes longer than some milliseconds is a work, whoever asks for it: never done by the process that answers."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.jobs.engines.engine import AttemptReport, Work
from service.jobs.kinds import KINDS
from service.jobs.kinds.requested import REQUESTED
from service.store.store import Store

from .conftest import HAND, PENDULUM, SLIDER

ROBOT = (
    '<robot name="rod"><link name="ground"/><link name="rod"><inertial><mass value="2"/>'
    '<inertia ixx="1" iyy="1" izz="1"/></inertial></link>'
    '<joint name="hinge" type="revolute"><parent link="ground"/><child link="rod"/></joint></robot>'
)
XML = {"content": ROBOT, "headers": {"Content-Type": "application/xml"}}
CONSTRAINED = {"constraints": [{"type": "linear", "name": "still", "expression": "arm.q'"}]}
COMPARED = {"a": "pendulum", "b": {"file": ROBOT}, "coordinates": {"q": "hinge"}}
DERIVED = ["regressor", "inertial_parameters", "reactions", "mass_centre", "kinetic_energy"]
MADE = ["derived"] * 5  # one of these and of the motion that reactions are of, each program once
#: method, path, what is sent with it, kinds of its works
ASKED: list[tuple[str, str, dict[str, Any], list[str]]] = [
    ("POST", "/v1/substructures", {"json": {**SLIDER, "name": "other"}}, ["derive"]),
    ("POST", "/v1/substructures", {"json": SLIDER}, []),  # stored already
    ("POST", "/v1/trees", {"json": {"name": "t", "instances": [{"name": "a", "definition": PENDULUM}]}}, ["assemble"]),
    ("POST", "/v1/trees/cell/couplings", {"json": HAND}, ["assemble"]),
    ("POST", "/v1/trees/cell@1/publish", {"json": {"name": "cell-part"}}, ["publish"]),
    ("POST", "/v1/imports", XML, ["import"]),
    ("POST", "/v1/imports?preview=true", XML, ["import", "preview"]),
    ("POST", "/v1/imports?preview=true&cut=rod&name=cut", XML, ["import", "preview"]),
    ("POST", "/v1/imports?store=true", XML, ["import", "derive"]),
    ("POST", "/v1/imports?store=true&cut=rod&name=cut", XML, ["import", "assemble"]),
    ("POST", "/v1/equivalences", {"json": COMPARED}, ["import", "compare"]),
    ("POST", "/v1/jobs", {"json": {"kind": "compare", "items": [{"a": {"file": ROBOT}, "b": "*"}]}}, ["import"]),
    ("POST", "/v1/trees/cell@1/simulations", {"json": {"q": [0.1], "span": [0, 0.1]}}, ["analyse"]),
    ("POST", "/v1/trees/cell@1/linearisations", {"json": {"q": [0]}}, ["analyse"]),
    ("POST", "/v1/trees/cell@1/velocity-equations?format=text", {"json": CONSTRAINED}, ["export"]),
    ("GET", "/v1/trees/cell@1/metric?format=text", {}, ["export"]),
    ("GET", "/v1/trees/cell@1/metric?group=true&format=text", {}, ["export"]),
    ("GET", "/v1/trees/cell@1/first_integrals?format=text", {}, ["export"]),
    ("GET", "/v1/trees/cell@1/export?target=c", {}, ["export"]),
    ("GET", "/v1/substructures/pendulum@1/export?target=python", {}, ["export"]),
    ("GET", "/v1/substructures/pendulum@1/formulas/metric?format=text", {}, ["print-part"]),
    ("GET", "/v1/substructures/pendulum@1/report", {}, ["report"]),
    ("GET", "/v1/trees/cell@1/report?format=text", {}, ["report"]),
    ("GET", "/v1/substructures/pendulum/difference?to=slider", {}, ["difference"]),
    ("GET", "/v1/substructures/pendulum/levels", {}, []),
    ("GET", "/trees/cell/difference?to=cell", {}, ["difference"]),
    ("GET", "/v1/substructures/pendulum@1/picture", {}, ["picture"]),
    ("GET", "/v1/trees/cell@1/picture?q=0.1", {}, ["picture"]),
    ("GET", "/v1/substructures/pendulum@1/scene", {}, ["scene"]),
    ("GET", "/v1/trees/cell/scene", {}, ["scene"]),
    ("POST", "/v1/trees/cell@1/evaluations", {"json": {"quantities": ["metric"], "q": [0]}}, []),
    ("POST", "/v1/trees/cell@1/evaluations", {"json": {"quantities": DERIVED, "q": [0], "qdd": [0]}}, MADE),
    ("POST", "/v1/trees/cell@1/kernels", {"json": {"quantities": ["powers"]}}, ["derived"]),
    ("GET", "/v1/trees/cell@1", {}, []),
]


@pytest.mark.parametrize(
    ("method", "path", "sent", "kinds"), ASKED, ids=[f"{number} {each[1]}" for number, each in enumerate(ASKED)]
)
def test_works_of_requests(
    filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch, method: str, path: str, sent: Any, kinds: Any
) -> None:
    works: list[Work] = []
    compute = store.workers.compute

    def noted(share: str, work: Work, seconds: float) -> AttemptReport:
        works.append(work)
        return compute(share, work, seconds)

    monkeypatch.setattr(store.workers, "compute", noted)
    answer = filled.request(method, path, **sent)
    assert answer.status_code in (200, 201, 202), answer.text
    assert [work.kind for work in works] == kinds
    limits = store.settings.limits
    for work in works:
        assert 0 < work.budget.cpu_seconds <= max(limits.sync_seconds, limits.job_cpu_seconds)
        assert work.budget.memory_bytes == limits.job_memory_bytes


def test_no_submission_names_what_is_for_requests_alone(filled: TestClient) -> None:
    for kind in REQUESTED:
        assert kind not in KINDS
        answer = filled.post("/v1/jobs", json={"kind": kind, "items": [{}]})
        assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "unknown-kind")
