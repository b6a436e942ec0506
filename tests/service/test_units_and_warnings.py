"""Units and warnings over HTTP, on the pages and on the command line (HTTP contract, sections 1 to 5)."""

from __future__ import annotations

import json
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from service.cli.main import main
from service.content.integrity import digest_of
from service.content.summaries import part_content
from service.content.tree_summaries import TreeSummary
from service.database.tables import trees
from service.messages.references import Reference
from service.messages.viewer import ANYBODY
from service.operations import catalogue, exchange
from service.operations.verification import verify_all
from service.queries.trees import resolve
from service.store.store import Store
from substructures import Definition, Part, derive
from substructures.formats.arrays import as_answer, read_npz
from substructures.formats.arrow import read_tables

from .conftest import HAND, PENDULUM, TREE
from .test_arrow import lists, post, stream

Plain = dict[str, Any]


def _pendulum(**changes: Any) -> Plain:
    rod = PENDULUM["bodies"][0] | changes.pop("rod", {})
    return {**PENDULUM, "name": "other", "bodies": [rod], **changes}


def _codes(answer: Plain) -> list[tuple[str, str]]:
    return [(warning["pointer"], warning["code"]) for warning in answer["warnings"]]


def _posted(client: TestClient, path: str, body: Plain, status: int = 201) -> Plain:
    answer = client.post(f"/v1/{path}", json=body)
    assert answer.status_code == status, answer.text
    found: Plain = answer.json()
    return found


def _tree(client: TestClient, definition: Plain, **changes: Any) -> Plain:
    _posted(client, "substructures", definition)
    tree = {"name": "made", "gravity": [0, 0, -10], "instances": [{"name": "a", "substructure": definition["name"]}]}
    return _posted(client, "trees", tree | changes)


def _evaluated(client: TestClient, ref: str, **given: Any) -> Plain:
    return _posted(client, f"trees/{ref}/evaluations", {"quantities": ["metric"], "q": [0], **given}, 200)


def test_a_parameter_in_millimetres_is_told_and_used_in_metres(filled: TestClient) -> None:
    given = {"value": 1200, "unit": "mm"}
    tree = _tree(filled, _pendulum(parameters=PENDULUM["parameters"] | {"l": given}))
    assert tree["parameters"]["a.l"] == {"value": 1.2, "unit": "m", "description": "", "given": given}
    assert filled.get("/v1/substructures/other").json()["parameters"]["l"] == tree["parameters"]["a.l"]
    metric = _evaluated(filled, "made")["metric"][0][0]
    assert metric == pytest.approx(2 * 1.2**2 * 1.1, rel=1e-12)  # m l^2 + m l^2/10
    bound = filled.get("/v1/trees/made/metric", params={"format": "text", "bind": "defaults"}).text
    assert "3.168" in bound
    page = filled.get("/substructures/other").text
    assert "1200 mm" in page
    assert "1.2" in page


@pytest.mark.parametrize(
    ("definition", "pointer", "code"),
    [
        (_pendulum(rod={"mass": {"value": 3, "unit": "furlong"}}), "/bodies/0/mass", "unit-mismatch"),
        (_pendulum(rod={"mass": "m + l"}), "/bodies/0/mass", "unit-mismatch"),
        (_pendulum(rod={"mass": {"value": 3, "unit": "blub"}}), "/bodies/0/mass", "unknown-unit"),
        (_pendulum(parameters={"l": {"unit": "blub"}, "m": {}}), "/parameters/l/unit", "unknown-unit"),
    ],
)
def test_contradictions_and_unknown_units_are_refused(
    client: TestClient, definition: Plain, pointer: str, code: str
) -> None:
    answer = _posted(client, "substructures", definition, 422)
    assert [(error["pointer"], error["code"]) for error in answer["errors"]] == [(pointer, code)]
    inline = {"name": "t", "instances": [{"name": "a", "definition": definition}]}
    answer = _posted(client, "trees", inline, 422)
    assert answer["errors"][0]["pointer"] == f"/instances/0/definition{pointer}"


def test_values_of_evaluations_have_units(filled: TestClient) -> None:
    plain = _evaluated(filled, "cell", parameters={"arm.m": 0.25, "arm.l": [0.5, 2]}, inputs={"tau.arm.q": 3})
    given = {
        "parameters": {"arm.m": {"value": 250, "unit": "g"}, "arm.l": {"value": [500, 2000], "unit": "mm"}},
        "inputs": {"tau.arm.q": {"value": 300, "unit": "N cm"}},
    }
    assert _evaluated(filled, "cell", **given) == plain
    assert np.shape(plain["metric"]) == (2, 1, 1)


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({"parameters": {"arm.m": {"value": 2, "unit": "mm"}}}, "/parameters/arm.m", "unit-mismatch"),
        ({"parameters": {"arm.m": {"value": 2, "unit": "blub"}}}, "/parameters/arm.m", "unknown-unit"),
        ({"parameters": {"arm.m": {"value": 2}}}, "/parameters/arm.m", "number-expected"),
        ({"parameters": {"arm.m": {"value": "2", "unit": "g"}}}, "/parameters/arm.m/value", "number-expected"),
        ({"inputs": {"tau.arm.q": {"value": 2, "unit": "N"}}}, "/inputs/tau.arm.q", "unit-mismatch"),
    ],
)
def test_wrong_units_of_values_are_refused(filled: TestClient, given: Plain, pointer: str, code: str) -> None:
    for path, request in (("evaluations", {"quantities": ["metric"]}), ("simulations", {"span": [0, 0.1]})):
        answer = _posted(filled, f"trees/cell/{path}", {"q": [0], **request, **given}, 422)
        assert [(error["pointer"], error["code"]) for error in answer["errors"]] == [(pointer, code)]


def test_values_of_analyses_have_units(filled: TestClient) -> None:
    start = {"q": [0.3], "span": [0, 0.2], "step": 0.1}
    plain = start | {"parameters": {"arm.l": 0.5}, "inputs": {"tau.arm.q": 0.25}}
    given = {
        "parameters": {"arm.l": {"value": 500, "unit": "mm"}},
        "inputs": {"tau.arm.q": {"value": 25, "unit": "N cm"}},
    }
    first, second = (_posted(filled, "trees/cell/simulations", x, 200) for x in (plain, start | given))
    assert first["q"] == second["q"]


def test_impossible_bodies_are_told_wherever_they_come_from(filled: TestClient) -> None:
    heavy = _tree(filled, _pendulum(parameters={"l": {"value": 1, "unit": "m"}, "m": {"value": -1, "unit": "kg"}}))
    assert _codes(filled.get("/v1/substructures/other").json()) == [
        ("/bodies/0/mass", "negative-mass"),
        ("/bodies/0/inertia", "impossible-inertia"),
    ]
    by_default = [("/instances/0", "negative-mass"), ("/instances/0", "impossible-inertia")]
    assert _codes(heavy) == by_default
    assert _codes(_evaluated(filled, "made")) == by_default
    assert _codes(_evaluated(filled, "made", parameters={"a.m": 1})) == []
    # by what an instance binds, directly and over other parameters
    for name, bound in (("one", -3), ("two", "-g*m0")):
        tree = TREE | {"name": name, "parameters": TREE["parameters"] | {"m0": {"value": 1, "unit": "kg s^2/m"}}}
        tree["instances"] = [TREE["instances"][0] | {"parameters": {"m": bound}}]
        assert ("/instances/0", "negative-mass") in _codes(_posted(filled, "trees", tree))
    # by values of an evaluation
    assert _codes(_evaluated(filled, "cell", parameters={"arm.m": 2})) == []
    found = _evaluated(filled, "cell", q=[[0], [0], [0]], parameters={"arm.m": [1, -1, -2]})
    assert _codes(found) == [("/parameters", "negative-mass"), ("/parameters", "impossible-inertia")]
    assert "state 1 (and in 1 more)" in found["warnings"][0]["message"]
    motion = _posted(filled, "trees/made/simulations", {"q": [0], "span": [0, 0.1]}, 200)
    assert _codes(motion) == by_default


def test_a_tensor_that_only_an_override_makes_impossible(filled: TestClient) -> None:
    free = {"parameters": PENDULUM["parameters"] | {"I": {"value": 1, "unit": "kg m^2"}}}
    body = {"mass": 2, "com": [0.5, 0, 0], "inertia": {"xx": "I", "yy": 1, "zz": 1.5, "about": "origin"}}
    # about the mass centre: I, 0.5, 1, so that I may be from 0.5 to 1.5
    assert ("/instances/0", "impossible-inertia") not in _codes(_tree(filled, _pendulum(rod=body, **free)))
    for value, expected in ((0.51, []), (1.49, []), (0.49, ["impossible-inertia"]), (1.51, ["impossible-inertia"])):
        found = _evaluated(filled, "made", parameters={"a.I": value})
        assert [warning["code"] for warning in found["warnings"]] == expected


def test_gravity_that_nobody_gave_is_told(filled: TestClient) -> None:
    tree = {name: value for name, value in TREE.items() if name not in ("gravity", "parameters")} | {"name": "loose"}
    assert _codes(_posted(filled, "trees", tree)) == [("/gravity", "gravity-not-given")]
    assert _codes(_evaluated(filled, "loose")) == [("/gravity", "gravity-not-given")]
    assert "gravity is not given" in filled.get("/trees/loose").text
    assert _codes(_posted(filled, "trees", tree | {"name": "zero", "gravity": [0, 0, 0]})) == []
    # zero that was given stays given when the tree grows
    assert _codes(_posted(filled, "trees/zero/couplings", HAND)) == []
    assert _codes(_posted(filled, "trees/loose/couplings", HAND)) == [("/gravity", "gravity-not-given")]
    # it is stored as given, so that what is derived of the stored document is the same
    store: Store = filled.app.state.store  # type: ignore[attr-defined]
    assert [finding for finding in verify_all(store.database) if finding.fault] == []


def test_joint_limits_left_are_told(filled: TestClient) -> None:
    joint = {"type": "revolute", "coordinate": "q", "limits": ["-reach", {"value": 90, "unit": "deg"}]}
    reach = {"reach": {"value": 60, "unit": "deg"}}
    tree = _tree(filled, _pendulum(rod={"joint": joint}, parameters=PENDULUM["parameters"] | reach))
    assert _codes(tree) == []
    for q, expected in (([1.5], []), ([1.6], ["limits-left"]), ([-1.0], []), ([-1.1], ["limits-left"])):
        assert [code for _, code in _codes(_evaluated(filled, "made", q=q))] == expected
    assert _codes(_evaluated(filled, "made", q=[-1.1], parameters={"a.reach": 1.2})) == []
    motion = _posted(filled, "trees/made/simulations", {"q": [0], "qd": [9], "span": [0, 1]}, 200)
    assert _codes(motion) == [("/q/a.q", "limits-left")]
    assert "it goes up to" in motion["warnings"][0]["message"]
    linear = _posted(filled, "trees/made/linearisations", {"q": [2]}, 200)
    assert _codes(linear) == [("/q", "limits-left")]


def test_parameters_without_effect_are_told_and_accepted(filled: TestClient) -> None:
    idle = {"parameters": PENDULUM["parameters"] | {"idle": {"value": 1}}, "inputs": {"wind": {"unit": "N"}}}
    tree = _tree(filled, _pendulum(**idle), parameters={"spare": {"value": 1}})
    assert _codes(filled.get("/v1/substructures/other").json()) == [
        ("/parameters/idle", "no-effect"),
        ("/inputs/wind", "no-effect"),
    ]
    assert _codes(tree) == [("/parameters/spare", "no-effect")]
    assert {"a.idle", "spare"} < tree["parameters"].keys()
    assert tree["inputs"] == {"a.wind": {"unit": "N", "description": ""}}
    given = {"parameters": {"a.idle": 3}, "inputs": {"a.wind": 2}}
    found = _evaluated(filled, "made", **given)
    assert _codes(found) == [("/parameters/a.idle", "no-effect"), ("/inputs/a.wind", "no-effect")]
    for path, request in (
        ("simulations", {"q": [0], "span": [0, 0.1]}),
        ("linearisations", {"q": [0], "of_inputs": ["a.wind"]}),
        ("equilibria", {}),
    ):
        assert _posted(filled, f"trees/made/{path}", request | given, 200)
    assert filled.get("/v1/trees/made/metric", params={"bind": "a.idle:3,spare:1"}).status_code == 200
    items = [{"tree": "made", "request": {"quantities": ["metric"], "q": [0], **given}}]
    _posted(filled, "jobs", {"kind": "evaluate", "items": items}, 202)
    refused = _posted(
        filled, "trees/made/evaluations", {"quantities": ["metric"], "q": [0], "inputs": {"a.win": 1}}, 422
    )
    assert "a.wind" in refused["detail"]


def test_warnings_are_in_npz_too(filled: TestClient) -> None:
    body = {"quantities": ["metric"], "q": [0], "parameters": {"arm.m": -1}}
    answer = filled.post("/v1/trees/cell/evaluations", json=body, headers={"Accept": "application/x-npz"})
    found = as_answer(read_npz(BytesIO(answer.content), 10**6))
    assert [warning["code"] for warning in found["warnings"]] == ["negative-mass", "impossible-inertia"]


def test_warnings_of_all_batches_are_in_streams(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Impossible bodies and limits that only the last batch has, with their places in the whole."""
    limited = {"type": "revolute", "coordinate": "q", "limits": [-1, 1]}
    _posted(filled, "substructures", _pendulum(rod={"joint": limited}))
    _posted(filled, "trees", {"name": "cell", "instances": [{"name": "arm", "substructure": "other"}]})
    columns = (([0, 0.5], [1, 1]), ([0.1, 0.2], [1, 1]), ([0, 2], [1, -1]))
    parts = [{"q": lists(np.array(q, float)[:, None]), "parameters.arm.m": np.array(m, float)} for q, m in columns]
    body = stream(parts, {"quantities": ["metric"]})
    whole = post(filled, body, "application/json").json()["warnings"]
    codes = ["gravity-not-given", "negative-mass", "impossible-inertia", "limits-left"]
    assert [each["code"] for each in whole] == codes
    for size in (10**9, 1):
        monkeypatch.setattr(exchange, "PART", size)
        monkeypatch.setattr(exchange, "WHOLE", 1)
        tables = list(read_tables(BytesIO(post(filled, body).content)))
        told = [each for table in tables for each in table["warnings"]]
        assert told[0] == whole[0]  # said once
        assert [each["code"] for each in told] == codes
        assert [each["pointer"] for each in told] == [each["pointer"] for each in whole]
        assert tables[0]["warnings"] == told[:1]
        # a part of one state has no number, and stands in its row
        assert size == 1 or told == whole


def test_what_was_stored_when_units_were_texts_keeps_its_meaning(client: TestClient, store: Store) -> None:
    """As an older version left it: the same program, the unit mm beside 1.2, which was metres, and no word of units."""
    given = Definition.stored(_pendulum(parameters=PENDULUM["parameters"] | {"l": {"value": 1.2, "unit": "mm"}}))
    derived = derive(Definition.read(_pendulum()))
    certificate = {name: x for name, x in derived.certificate.items() if name != "converted"}
    old = Part(given, derived.program, certificate)
    with store.database.write() as connection:
        catalogue.submit(connection, ANYBODY, catalogue.PartSubmission("other", given.digest, part_content(old)))
    found = client.get("/v1/substructures/other").json()
    assert _codes(found) == [("/parameters/l/unit", "unit-not-counted")]
    tree = {"name": "old", "gravity": [0, 0, -10], "instances": [{"name": "a", "substructure": "other"}]}
    assert _posted(client, "trees", tree)["parameters"]["a.l"]["value"] == 1.2
    assert _evaluated(client, "old")["metric"][0][0] == pytest.approx(2 * 1.2**2 * 1.1)
    # the same text today is something else: a new version in millimetres
    today = _pendulum(parameters=PENDULUM["parameters"] | {"l": {"value": 1.2, "unit": "mm"}})
    again = _posted(client, "substructures", today)
    assert again["version"] == 2
    assert again["parameters"]["l"]["value"] == 0.0012


def test_trees_of_old_accept_what_is_declared(filled: TestClient, store: Store) -> None:
    """As an older version left it: only what occurs in formulas is noted."""
    _tree(filled, _pendulum(parameters=PENDULUM["parameters"] | {"idle": {}}, inputs={"wind": {}}))
    with store.database.write() as connection:
        tree = resolve(connection, ANYBODY, Reference("made"))
        assert tree is not None
        summary = json.loads(tree.summary)
        del summary["inputs"], summary["parameters"]["a.idle"]
        text = json.dumps(summary)
        older = TreeSummary(text, digest_of(text.encode())).columns()
        del older["form"]
        connection.execute(update(trees).where(trees.c.name == "made").values(**older))
    store.caches.models._entries.clear()
    found = _evaluated(filled, "made", parameters={"a.idle": 1}, inputs={"a.wind": 1})
    assert _codes(found) == [("/parameters/a.idle", "no-effect"), ("/inputs/a.wind", "no-effect")]


@pytest.fixture
def written(tmp_path: Path) -> Callable[[str, Plain], str]:
    def write(name: str, document: Plain) -> str:
        path = tmp_path / name
        path.write_text(json.dumps(document))
        return str(path)

    return write


def test_the_command_line_tells_warnings(
    written: Callable[[str, Plain], str], capsys: pytest.CaptureFixture[str]
) -> None:
    definition = _pendulum(parameters=PENDULUM["parameters"] | {"m": {"value": -2, "unit": "kg"}, "idle": {}})
    assert main(["derive", written("other.json", definition)]) == 0
    told = capsys.readouterr().err
    assert "warning: /bodies/0/mass: body 'rod': the mass -2 kg is negative" in told
    assert "warning: /parameters/idle: no formula depends on the parameter 'idle'" in told
    limited = _pendulum(rod={"joint": {"type": "revolute", "coordinate": "q", "limits": [-1, 1]}})
    tree = {"name": "t", "parameters": {"spare": {}}, "instances": [{"name": "a", "definition": limited}]}
    request = written("request.json", {"q": [0], "qd": [9], "span": [0, 1]})
    assert main(["simulate", written("tree.json", tree), request]) == 0
    told = capsys.readouterr().err
    assert "warning: /gravity: gravity is not given" in told
    assert "warning: /parameters/spare: no formula" in told
    assert "warning: /q/a.q: 'a.q' leaves its limits [-1, 1] rad: it goes up to 9 rad" in told
