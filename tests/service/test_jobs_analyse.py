"""Jobs of the kinds simulate, optimise and analyse."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import pytest

from service.jobs.engines.engine import Outcome
from service.jobs.kinds import run
from substructures import catalogue
from substructures.documents import read_json, write_json
from substructures.errors import InvalidInput

from .conftest import PENDULUM, TREE
from .jobs_library import MemoryLibrary

SWING = {"q": [0.5], "span": [0, 1], "count": 3}


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return MemoryLibrary([PENDULUM], [TREE])


def outcomes(library: MemoryLibrary, kind: str, request: Mapping[str, Any]) -> list[Outcome]:
    """What comes of a submission, and all shares of progress are shares."""
    shares: list[float] = []  # told by motions at least
    items = [read_json(write_json(item)) for item in library.items(kind, request)]
    found = [run(kind, item, library.blobs, shares.append) for item in items]
    assert shares or kind != "simulate"
    assert all(0 <= share <= 1 for share in shares)
    assert all(outcome.problem is None for outcome in found), [outcome.problem for outcome in found]
    return found


def test_a_list_of_requests(library: MemoryLibrary) -> None:
    requests = [{**SWING, "q": [x]} for x in (0.1, 0.2, 0.3)]
    found = outcomes(library, "simulate", {"items": [{"tree": "cell", "requests": requests}]})
    assert [json.loads(outcome.files["result"])["q"][0][0] for outcome in found] == [0.1, 0.2, 0.3]
    assert all(outcome.summary["status"] == "finished" and outcome.summary["is_right"] for outcome in found)


def test_a_motion_puts_no_numbers_into_formulas(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a tree with a tool somewhere: it moves by the formulas of its shape."""
    robot, hand = (catalogue.load(name) for name in ("ur5", "simple-pendulum"))
    arm = {"name": "arm", "substructure": "ur5"}
    tool = {"name": "tool", "substructure": hand["name"], "at": f"arm.{robot['ports'][0]['name']}"}
    tool["placement"] = {"position": ["0.31", 0, "0.2"]}
    tree = {"name": "placed", "gravity": [0, 0, "-9.81"], "instances": [arm, tool]}
    placed = MemoryLibrary([robot, hand], [tree])

    def put_in(*_: Any) -> None:
        raise AssertionError("numbers are put into the formulas")

    monkeypatch.setattr("substructures.tree.model.with_numbers", put_in)
    (found,) = outcomes(placed, "simulate", {"items": [{"tree": "placed", "request": {**SWING, "q": [0.3] * 7}}]})
    assert found.summary["is_right"]


def test_a_template_with_choices(library: MemoryLibrary) -> None:
    template = {"tree": "cell", "request": SWING, "format": "csv"}
    choices = {"/request/parameters/arm.l": [1, 2]}
    template["request"] = {**SWING, "parameters": {"arm.l": 1}}
    found = outcomes(library, "simulate", {"template": template, "choices": choices})
    assert len(found) == 2
    assert found[0].files["result"] != found[1].files["result"]
    assert found[0].summary["media_type"] == "text/csv"


def test_friction_by_the_load_of_joints() -> None:
    """Which needs the parts of the tree."""
    (rod,) = PENDULUM["bodies"]
    load = {"coefficient": "1/2", "radius": "1/10"}
    joint = {**rod["joint"], "friction": {"coulomb": 0, "velocity": "1/100", "load": load}}
    library = MemoryLibrary([{**PENDULUM, "bodies": [{**rod, "joint": joint}]}], [TREE])
    request = {**SWING, "friction": "loaded"}
    (found,) = outcomes(library, "simulate", {"items": [{"tree": "cell", "request": request}]})
    assert found.summary["is_right"]
    assert "friction-load" in {check["name"] for check in json.loads(found.files["result"])["checks"]}


def test_optimise(library: MemoryLibrary) -> None:
    request = {
        "controls": ["tau.arm.q"], "cost": {"running": "tau.arm.q^2"}, "horizon": 1, "intervals": 8, "q": [0],
        "end": {"qd": [0]},
    }  # fmt: skip
    (found,) = outcomes(library, "optimise", {"items": [{"tree": "cell", "request": request}]})
    assert json.loads(found.files["result"])["status"] == found.summary["status"] == "optimal"
    coarse = {"tree": "cell", "request": {**request, "intervals": 4}}
    (wrong,) = (
        run("optimise", item, library.blobs, lambda _: None) for item in library.items("optimise", {"items": [coarse]})
    )
    assert wrong.problem is not None
    # one voice: what is wrong is not called optimal
    assert wrong.problem["code"] == "analysis-failed"
    assert "'error_limit'" in wrong.problem["detail"]
    result = json.loads(wrong.files["result"])
    assert result["is_right"] is wrong.summary["is_right"] is False
    assert result["status"] == wrong.summary["status"] == "failed"


def test_any_analysis(library: MemoryLibrary) -> None:
    items = [
        {"tree": "cell", "analysis": "equilibria", "request": {"count": 4}},
        {"tree": "cell", "analysis": "linearisations", "request": {"q": [0]}, "format": "npz"},
    ]
    found = outcomes(library, "analyse", {"items": items})
    assert {len(e["q"]) for e in json.loads(found[0].files["result"])["found"]} == {1}
    assert found[1].summary["media_type"] == "application/x-npz"


def test_export_what_follows_from_a_model(library: MemoryLibrary) -> None:
    common = {"tree": "cell", "format": "text", "bind": "defaults"}
    options = {"options": {"outputs": ["sin(arm.q)"]}}
    items = [{**common, "quantity": "first_integrals"}, {**common, "quantity": "state_space", **options}]
    first, second = (o.files["text"].decode() for o in outcomes(library, "export", {"items": items}))
    assert "energy in J, constant" in first
    assert "output" in second


@pytest.mark.parametrize(
    ("kind", "item", "pointer"),
    [
        ("simulate", {"tree": "nothing", "request": SWING}, "/items/0/tree"),
        ("simulate", {"tree": "cell", "request": {"q": [0]}}, "/items/0/request/span"),
        ("simulate", {"tree": "cell", "requests": []}, "/items/0/requests"),
        ("simulate", {"tree": "cell", "requests": [SWING, []]}, "/items/0/requests/1"),
        ("simulate", {"tree": "cell", "request": SWING, "format": "pdf"}, "/items/0/format"),
        ("simulate", {"tree": "cell", "request": {**SWING, "q": [0, 0]}}, "/items/0/request/q"),
        ("simulate", {"tree": "cell", "requests": [SWING, {**SWING, "qd": [0, 0]}]}, "/items/0/requests/1/qd"),
        ("simulate", {"tree": "cell", "request": {"span": [0, 1]}}, "/items/0/request/q"),
        ("simulate", {"tree": "cell", "request": {**SWING, "parameters": {"x": 1}}}, "/items/0/request/parameters/x"),
        (
            "analyse",
            {"tree": "cell", "analysis": "linearisations", "request": {"q": [[0, 0]]}},
            "/items/0/request/q",
        ),
        (
            "analyse",
            {
                "tree": "cell",
                "analysis": "linearisations",
                "request": {"q": [[0], [1]], "parameters": {"g": [1, 2, 3]}},
            },
            "/items/0/request/parameters/g",
        ),
        ("optimise", {"tree": "cell", "request": {"horizon": -1}}, "/items/0/request/horizon"),
        ("analyse", {"tree": "cell", "analysis": "magic", "request": {}}, "/items/0/analysis"),
        ("analyse", {"tree": "cell", "analysis": "equilibria", "request": {}, "format": "svg"}, "/items/0/format"),
        ("analyse", {"tree": "cell", "request": {}}, "/items/0/analysis"),
        ("export", {"tree": "cell", "quantity": "x", "format": "text", "options": {"a": 1}}, "/items/0/options/a"),
        ("export", {"tree": "cell", "quantity": "metric", "format": "text", "request": {}}, "/items/0/request"),
        ("export", {"tree": "cell", "quantity": "velocity-equations", "format": "text"}, "/items/0/request"),
        (
            "export",
            {"tree": "cell", "quantity": "velocity-equations", "format": "text", "request": {"constraints": 1}},
            "/items/0/request/constraints",
        ),
        ("analyse", {"tree": "cell", "analysis": "excitations", "request": {"q": [[0]]}}, "/items/0/request/qdd"),
    ],
)
def test_wrong_items(library: MemoryLibrary, kind: str, item: dict[str, Any], pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        library.items(kind, {"items": [item]})
    assert pointer in {fault.pointer for fault in caught.value.faults}


def test_faults_that_need_the_model_are_outcomes(library: MemoryLibrary) -> None:
    request = {**SWING, "series": {"x": "nose"}}
    (item,) = library.items("simulate", {"items": [{"tree": "cell", "request": request}]})
    outcome = run("simulate", item, library.blobs, lambda _: None)
    assert outcome.problem is not None
    assert outcome.problem["errors"][0]["pointer"] == "/series/x"


@pytest.mark.parametrize("name", ["format", "analysis"])
def test_a_list_in_place_of_a_text_is_not_shown_as_in_python(library: MemoryLibrary, name: str) -> None:
    item = {"tree": "cell", "analysis": "equilibria", "request": {}, name: ["npz"]}
    with pytest.raises(InvalidInput, match=f"/{name}: a text is needed, found " + re.escape('["npz"]')):
        library.items("analyse", {"items": [item]})
