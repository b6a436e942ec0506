"""Numbers of evaluations, items of jobs, exports and pictures may have units, too."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from service.schemas.numbers import EvaluationRequest
from service.schemas.state_sets import Grid, Sample
from service.settings import Limits
from substructures import InvalidInput

from .job_outcomes import joined, known_library, outcomes
from .test_arrow import lists, post, stream
from .test_units_of_requests import ARM, DEG, MM, Plain, measured, numbers_of, put, same, with_unit

#: place in an evaluation, with a unit, in SI, a wrong unit
EVALUATIONS: list[tuple[str, Any, Any, str]] = [
    ("/q", measured([[90], [0]], "deg"), [[pi / 2], [0]], "m"),
    ("/q", measured([90], "deg"), [pi / 2], "m"),
    ("/q", [[DEG], [0]], [[pi / 2], [0]], "m"),
    ("/q", {ARM: measured([90, 45], "deg")}, {ARM: [pi / 2, pi / 4]}, "m"),
    ("/qd", [measured(60, "rpm")], [2 * pi], "rad"),
    ("/qdd", [measured(90, "deg/s^2")], [pi / 2], "rad"),
    ("/t", measured(1, "min"), 60.0, "m"),
    ("/t", [measured(1, "min"), 0], [60.0, 0], "m"),
    ("/parameters/arm.m", measured([250, 500], "g"), [0.25, 0.5], "m"),
    ("/parameters/arm.m", [measured(250, "g"), 1], [0.25, 1], "m"),
    ("/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("/along/q", [DEG], [pi / 2], "m"),
    ("/along/qd", [measured(60, "rpm")], [2 * pi], "rad"),
    ("/along/qdd", [measured(90, "deg/s^2")], [pi / 2], "rad"),
    ("/along/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
]


def request_of(place: str, value: Any) -> Plain:
    quantities = ["forces", "inverse_dynamics", "inverse_dynamics_derivative", "kinematics"]
    whole = {"quantities": quantities, "q": [0.1], "qd": [0.2], "qdd": [0.3], "along": {"q": [1]}}
    return put(whole, place, value)


@pytest.mark.parametrize("row", EVALUATIONS, ids=lambda row: row[0])
def test_numbers_of_evaluations_have_units(filled: TestClient, row: tuple[str, Any, Any, str]) -> None:
    place, given, plain, wrong = row
    answers = [filled.post("/v1/trees/cell/evaluations", json=request_of(place, x)) for x in (given, plain)]
    assert [answer.status_code for answer in answers] == [200, 200], answers[0].text
    same(answers[0].json(), answers[1].json())
    changed, below = with_unit(given, wrong)
    answer = filled.post("/v1/trees/cell/evaluations", json=request_of(place, changed))
    assert answer.status_code == 422
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [(place + below, "unit-mismatch")]


def test_evaluations_list_no_further_numbers() -> None:
    listed = {place.replace("/", ".")[1:] for place, *_ in EVALUATIONS}
    found = {path for path, has in numbers_of(EvaluationRequest) if has}
    assert {p for p in found if not any(f"{x}.".startswith(f"{p}.") for x in listed)} == set()
    assert [path for path, has in numbers_of(EvaluationRequest) if not has] == []


#: fields of an item, with units and in SI
ITEMS: list[tuple[Plain, Plain, str, str]] = [
    ({"grid": {ARM: {"from": measured(0, "deg"), "to": DEG, "count": 3}}},
     {"grid": {ARM: {"from": 0, "to": pi / 2, "count": 3}}}, "m", "/grid/arm.q/from"),
    ({"grid": {ARM: measured([0, 90], "deg"), "arm.q'": [measured(60, "rpm")]}},
     {"grid": {ARM: [0, pi / 2], "arm.q'": [2 * pi]}}, "m", "/grid/arm.q"),
    ({"grid": {"arm.m": measured(250, "g"), ARM: [0, 1]}}, {"grid": {"arm.m": 0.25, ARM: [0, 1]}}, "m", "/grid/arm.m"),
    ({"grid": {"tau.arm.q": [measured(25, "N cm"), 1]}}, {"grid": {"tau.arm.q": [0.25, 1]}}, "N", "/grid/tau.arm.q/0"),
    ({"sample": {"count": 4, "ranges": {ARM: measured([0, 90], "deg"), "arm.m": [MM | {"unit": "g"}, 1]}}},
     {"sample": {"count": 4, "ranges": {ARM: [0, pi / 2], "arm.m": [0.25, 1]}}}, "m", "/sample/ranges/arm.q"),
    ({"request": {"quantities": ["forces"], "q": measured([[90], [45], [0]], "deg")}},
     {"request": {"quantities": ["forces"], "q": [[pi / 2], [pi / 4], [0]]}}, "m", "/request/q"),
    ({"request": {"quantities": ["forces"], "q": [0.1], "parameters": {"arm.m": measured([1, 2, 3], "g")}}},
     {"request": {"quantities": ["forces"], "q": [0.1], "parameters": {"arm.m": [0.001, 0.002, 0.003]}}},
     "m", "/request/parameters/arm.m"),
]  # fmt: skip


@pytest.mark.parametrize("row", ITEMS, ids=lambda row: row[3])
def test_items_of_jobs_have_units(row: tuple[Plain, Plain, str, str]) -> None:
    given, plain, wrong, place = row
    library = known_library()
    common: Plain = {"tree": "cell", "request": {"quantities": ["forces"]}}
    made = [
        joined(outcomes(library, "evaluate", {"items": [common | x]}, Limits(job_states=2)), "forces")
        for x in (given, plain)
    ]
    np.testing.assert_allclose(made[0], made[1], rtol=1e-15)
    changed, below = with_unit(given, wrong)
    with pytest.raises(InvalidInput) as caught:
        outcomes(library, "evaluate", {"items": [common | changed]})
    assert below == place
    assert [(f.pointer.removeprefix("/items/0"), f.code) for f in caught.value.faults] == [(place, "unit-mismatch")]


def test_grids_and_samples_have_no_further_numbers() -> None:
    found = {path for schema in (Grid, Sample) for path, _ in numbers_of(schema)}
    assert found == {"", "start", "stop", "ranges"}


def test_bound_numbers_have_units(filled: TestClient) -> None:
    def metric(bind: str) -> Any:
        return filled.get("/v1/trees/cell/metric", params={"format": "text", "bind": bind})

    plain = metric("arm.l:1.2,arm.m:0.25").text
    for text in ("arm.l:1200 mm,arm.m:250 g", "arm.l:6/5 m, arm.m:0.25", "arm.m:1/4 kg,arm.l:12e-1 m"):
        assert metric(text).text == plain
    # an angle stays exact, and expressions keep their names
    assert metric("arm.l:2*arm.m,arm.m:1 kg").status_code == 200
    for text, code in (
        ("arm.l:3 kg", "unit-mismatch"),
        ("arm.l:3 furlog", "unknown-unit"),
        ("arm.l:arm.m", "unit-mismatch"),
        ("arm.l:arm.m mm", "bind"),
    ):
        answer = metric(text)
        assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, code), text
        assert "arm.l" in answer.json()["detail"] or code == "bind"
        assert answer.json()["errors"][0]["pointer"] == "/query/bind"
    part = filled.get("/v1/substructures/pendulum/formulas/metric", params={"format": "text", "bind": "l:1200 mm"})
    assert part.status_code == 200
    item = {"tree": "cell", "quantity": "metric", "format": "text"}
    library = known_library()
    both = [outcomes(library, "export", {"items": [item | {"bind": x}]}) for x in ("arm.l:1200 mm", "arm.l:1.2")]
    assert both[0][0].files["text"] == both[1][0].files["text"]
    for text, code in (("arm.l:3 kg", "unit-mismatch"), ("arm.l:arm.m mm", "bind")):
        with pytest.raises(InvalidInput) as caught:
            outcomes(library, "export", {"items": [item | {"bind": text}]})
        assert [(f.pointer.removeprefix("/items/0"), f.code) for f in caught.value.faults] == [("/bind", code)]


def test_poses_of_pictures_have_units(filled: TestClient) -> None:
    def picture(q: str) -> Any:
        return filled.get("/v1/trees/cell/picture", params={"q": q})

    assert picture("90 deg").text == picture(str(pi / 2)).text
    assert picture("90 mm").json()["errors"][0]["code"] == "unit-mismatch"
    assert picture("9e9 deg").json()["errors"][0]["code"] == "q"


def test_what_is_alike_for_all_states_of_a_stream_has_units(filled: TestClient) -> None:
    batches = [{"q": lists(np.zeros((3, 1)))}, {"q": lists(np.ones((3, 1)))}]
    answers = []
    for mass, t in ((measured(250, "g"), measured(1, "min")), (0.25, 60)):
        body = stream(batches, {"quantities": ["forces"], "parameters": {"arm.m": mass}, "t": t})
        answers.append([post(filled, body), post(filled, body, "application/json")])
    tables = [pa.ipc.open_stream(answer[0].content).read_all() for answer in answers]
    assert tables[0].equals(tables[1])
    assert answers[0][1].json() == answers[1][1].json()
