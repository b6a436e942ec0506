"""Trees with velocity constraints over HTTP: stored, shown, moved, and what refuses them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from rolling_bodies import sleigh_part

from service.models.formulas import QUANTITIES, made
from service.models.numbers import ANALYSES, analysis_of
from service.models.source import Source
from service.settings import Limits
from substructures import Definition, TreeSpec, couple, derive
from substructures.errors import InvalidInput
from substructures.quantities.sources import Sources
from substructures.tree.given.ties import TAKES_CONSTRAINTS

from .job_outcomes import outcomes
from .jobs_library import MemoryLibrary

EDGE: dict[str, Any] = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
TREE: dict[str, Any] = {
    "name": "sleigh",
    "gravity": [0, 0, 0],
    "instances": [{"name": "s", "definition": sleigh_part()}],
    "velocity_constraints": [EDGE],
}
START: dict[str, Any] = {"q": [0, 0, 0.4], "v": {"u": 2, "w": 1}}
VELOCITIES = {"velocities": {"u": "cos(s.f)*s.x' + sin(s.f)*s.y'", "w": "s.f'"}}


@pytest.fixture
def tied(client: TestClient) -> TestClient:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    assert made.json()["velocity_constraints"] == [EDGE]
    free = {name: x for name, x in TREE.items() if name != "velocity_constraints"} | {"name": "free"}
    assert "velocity_constraints" not in client.post("/v1/trees", json=free).json()
    return client


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("simulations", {**START, **VELOCITIES, "span": [0, 1], "count": 3}),
        ("linearisations", {**START, **VELOCITIES}),
        ("velocity-equations", VELOCITIES),
    ],
)
def test_it_moves_as_with_the_same_beside_it(tied: TestClient, path: str, body: dict[str, Any]) -> None:
    own = tied.post(f"/v1/trees/sleigh/{path}", json=body)
    beside = tied.post(f"/v1/trees/free/{path}", json={**body, "constraints": [EDGE]})
    assert own.status_code == beside.status_code == 200, own.text
    left = ("digest", "tree", "seconds")
    assert {k: x for k, x in own.json().items() if k not in left} == {
        k: x for k, x in beside.json().items() if k not in left
    }
    twice = tied.post(f"/v1/trees/sleigh/{path}", json={**body, "constraints": [EDGE | {"name": "other"}]})
    (fault,) = twice.json()["errors"]
    assert (twice.status_code, fault["pointer"], fault["code"]) == (422, "/constraints", "has-velocity-constraints")


def test_velocities_are_given_either_way(tied: TestClient) -> None:
    """Linearised about the same motion by quasi-velocities, and by velocities in a list, by name and in other units."""
    path = "/v1/trees/sleigh/linearisations"
    expected = tied.post(path, json={"q": [0, 0, 0.0], "v": {"u": 2.5, "w": 1.25}, **VELOCITIES})
    for qd in (
        [2.5, 0.0, 1.25],
        {"s.x": 2.5, "s.y": 0, "s.f": 1.25},
        {"s.x": {"value": 2500, "unit": "mm/s"}, "s.y": 0, "s.f": 1.25},
    ):
        found = tied.post(path, json={"q": [0, 0, 0.0], "qd": qd, **VELOCITIES})
        assert found.status_code == 200, found.text
        assert found.json()["v"] == pytest.approx([2.5, 1.25], abs=1e-12)
        assert np.allclose(found.json()["A"], expected.json()["A"], atol=1e-12)
    wrong = tied.post(path, json={"q": [0, 0, 0], "qd": [0.5, 0.5, 1], **VELOCITIES})
    assert (wrong.status_code, wrong.json()["errors"][0]["code"]) == (422, "violated")


def test_reactions_along_a_motion(tied: TestClient) -> None:
    asked = {**START, **VELOCITIES, "span": [0, 1], "count": 3, "reactions": ["s.f"]}
    own = tied.post("/v1/trees/sleigh/simulations", json=asked)
    assert own.status_code == 200, own.text
    # the blade alone turns the sleigh: its joints transmit nothing
    assert max(abs(x) for row in own.json()["series"]["reaction_force"] for x in row[0]) < 1e-12
    beside = tied.post("/v1/trees/free/simulations", json={**asked, "constraints": [EDGE]})
    (fault,) = beside.json()["errors"]
    assert (fault["pointer"], fault["code"]) == ("/reactions", "not-supported")
    assert "part of the tree" in fault["message"]


def test_steady_motions_and_integrals(tied: TestClient) -> None:
    asked = {"rates": {"u": 2, "s.f": 0}, **VELOCITIES, "count": 0}
    steady = tied.post("/v1/trees/sleigh/steady-motions", json=asked)
    assert steady.status_code == 200, steady.text
    assert [each["stability"]["verdict"] for each in steady.json()["found"]] == ["stable"]
    assert tied.post("/v1/trees/sleigh/equilibria", json={"count": 0}).status_code == 200
    integrals = tied.get("/v1/trees/sleigh/first_integrals").json()["integrals"]
    assert [each["name"] for each in integrals] == ["energy"]


def test_ensembles_and_derivatives(tied: TestClient) -> None:
    """In the velocities of the sleigh, drawn by name, also with units."""
    speeds = {"uniform": [100, 200], "unit": "cm/s"}
    samples = {"method": "sobol", "count": 4, "of": {"s.x'": speeds, "s.f": {"uniform": [0, 1]}}}
    drawn = {"samples": samples, "span": [0, 1], "count": 2, "independent": ["s.x", "s.f"]}
    many = tied.post("/v1/trees/sleigh/ensembles", json=drawn)
    assert many.status_code == 200, many.text
    found = many.json()
    assert (found["right"], len(found["q"])) == (4, 4)
    slopes = [(qd[0][1] / qd[0][0], q[0][2]) for q, qd in zip(found["q"], found["qd"], strict=True)]
    np.testing.assert_allclose([a for a, _ in slopes], [np.tan(f) for _, f in slopes], rtol=1e-9)
    assert all(1 <= qd[0][0] <= 2 for qd in found["qd"])
    some = {**VELOCITIES, "q": [0, 0, 0.4], "v": {"u": [1, 2], "w": 1}, "span": [0, 1], "count": 2}
    assert tied.post("/v1/trees/sleigh/ensembles", json=some).json()["count"] == 2
    asked = {**START, **VELOCITIES, "span": [0, 1], "count": 3, "by": ["s.a"], "of_start": True}
    own = tied.post("/v1/trees/sleigh/sensitivities", json=asked)
    assert own.status_code == 200, own.text
    assert own.json()["is_right"] is True
    beside = tied.post("/v1/trees/free/sensitivities", json={**asked, "constraints": [EDGE]})
    assert own.json()["series"] == beside.json()["series"]
    assert np.shape(own.json()["series"]["d.start"]) == (3, 6, 5)
    # what is of constraints means nothing without
    refused = tied.post("/v1/trees/free/sensitivities", json={**START, "span": [0, 1], "by": ["s.a"]})
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/v", "not-supported")]


def test_formulas_of_what_perturbs_a_motion(tied: TestClient) -> None:
    """In quasi-velocities, which are named."""
    found = tied.get("/v1/trees/sleigh/perturbation").json()
    assert found["constraints"] == ["blade"]
    assert len(found["velocities"]) == 2
    assert {"metric", "damping", "stiffness", "rates_by_position"} <= {*found["outputs"]}
    assert tied.get("/v1/trees/sleigh/parameter_sensitivity?parameters=s.a").status_code == 200


def test_a_state_space_in_independent_velocities(tied: TestClient) -> None:
    """x = (q, v); without constraints no velocities are chosen."""
    found = tied.get("/v1/trees/sleigh/state_space?independent=s.x,s.f&outputs=s.y'").json()
    assert found["state"] == ["s.x", "s.y", "s.f", "s.x'", "s.f'"]
    assert [found["outputs"][name]["shape"] for name in "ABC"] == [[5, 5], [5, 3], [1, 5]]
    refused = tied.get("/v1/trees/free/state_space?independent=s.x")
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/query/independent", "not-supported")]


def test_a_regulator_keeps_the_line(tied: TestClient) -> None:
    """Of a sleigh that glides along x; at rest it cannot be moved aside."""
    asked = {"q": [0, 0, 0], "qd": [1, 0, 0], "weights": {"s.y": 1}, "of_inputs": ["tau.s.f"]}
    found = tied.post("/v1/trees/sleigh/regulators", json=asked).json()
    assert (found["states"], found["is_right"]) == (["s.y", "s.f", "s.f'"], True)
    still = tied.post("/v1/trees/sleigh/regulators", json={**asked, "qd": [0, 0, 0]}).json()
    assert (still["status"], still["controllable"], still["reached"][0]["parts"]) == ("failed", False, ["s.y"])
    sliding = tied.post("/v1/trees/sleigh/regulators", json={**asked, "qd": [1, 0, 1]})
    assert [(e["pointer"], e["code"]) for e in sliding.json()["errors"]] == [("/q", "not-steady")]


def test_dynamics_in_independent_velocities(tied: TestClient) -> None:
    """As formulas, in code, and as an FMU; where they are singular is said."""
    found = tied.get("/v1/trees/sleigh/velocity_dynamics?independent=s.f,s.x")
    assert found.status_code == 200, found.text
    assert found.json()["velocities"] == ["s.x'", "s.f'"]
    assert {*found.json()["outputs"]} == {"rates", "acceleration", "second", "power"}
    (warning,) = found.json()["warnings"]
    assert (warning["code"], "cos(f) is zero" in warning["message"]) == ("singular-velocities", True)
    text = tied.get("/v1/trees/sleigh/velocity_dynamics?format=text&independent=s.x,s.f").text
    assert "*v_x" in text
    code = tied.get("/v1/trees/sleigh/export?target=c&quantities=velocity_dynamics&independent=s.x,s.f")
    assert code.status_code == 200, code.text
    assert tied.get("/v1/trees/sleigh/export?target=fmu").status_code == 200
    refused = tied.get("/v1/trees/free/export?target=fmu&independent=s.x")
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/query/independent", "not-of-quantity")]


def test_best_parameters(tied: TestClient) -> None:
    """The place of the mass centre at which the sleigh turns least in a second; what ignores the blade says so."""
    motion = {"analysis": "simulation", "at": {"q": [0, 0, 0], "qd": [1, 0, 0.5]}, "span": [0, 1], "expression": "s.f"}
    asked = {"vary": {"s.a": [0.1, 0.3]}, "columns": {"turn": motion}, "minimise": "turn", "starts": 1}
    found = tied.post("/v1/trees/sleigh/optimal-parameters", json=asked)
    assert found.status_code == 200, found.text
    assert found.json()["parameters"]["s.a"] == pytest.approx(0.3)
    rest = {"analysis": "equilibrium", "at": {"q": [0, 0, 0]}, "of": "s.f"}
    held = {"analysis": "linearisation", "at": {"q": [0, 0, 0]}, "held": True, "take": "lowest_frequency"}
    for column in (rest, held):
        refused = tied.post("/v1/trees/sleigh/optimal-parameters", json={**asked, "columns": {"turn": column}})
        assert refused.status_code == 422, refused.text
        assert refused.json()["errors"][0]["code"] == "has-velocity-constraints"


REFUSED: list[tuple[str, dict[str, Any]]] = [
    ("curvatures", {"q": [0, 0, 0]}),
    ("loop-states", {"q": [0, 0, 0]}),
    ("evaluations", {"quantities": ["forward_dynamics"], "q": [0, 0, 0]}),
    ("evaluations", {"quantities": ["reactions"], "q": [0, 0, 0], "qdd": [0, 0, 0]}),
    ("publish", {}),
]


@pytest.mark.parametrize(("path", "body"), REFUSED)
def test_what_would_ignore_them_says_so(tied: TestClient, path: str, body: dict[str, Any]) -> None:
    answer = tied.post(f"/v1/trees/sleigh/{path}", json=body)
    assert answer.status_code == 422, answer.text
    (fault,) = answer.json()["errors"]
    assert fault["code"] == "has-velocity-constraints"
    assert "take simulations, linearisations, velocity-equations" in fault["message"]


@pytest.mark.parametrize("path", ["routhian", "curvature", "report", "export?target=simulink"])
def test_formulas_of_motions_refuse_too(tied: TestClient, path: str) -> None:
    answer = tied.get(f"/v1/trees/sleigh/{path}")
    assert answer.status_code == 422, answer.text[:300]
    assert answer.json()["errors"][0]["code"] == "has-velocity-constraints"
    if "simulink" in path:  # and what takes them instead
        (fault,) = answer.json()["errors"]
        assert fault["pointer"] == "/query/target"
        assert "does not take velocity constraints into account ('blade'): take target=fmu" in fault["message"]


def test_exports_without_constraints_and_contacts_name_the_fmu_alone(tied: TestClient) -> None:
    ball = {"name": "ball", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic"}, "mass": 1}]}
    spec = {"name": "bouncy", "instances": [{"name": "x", "definition": ball}]}
    spec |= {"contacts": [{"name": "floor", "point": "x.b"}]}
    assert tied.post("/v1/trees", json=spec).status_code == 201
    told = {
        "sleigh": "velocity constraints into account ('blade'): take the quantity 'velocity_dynamics', or target=fmu",
        "bouncy": "contacts into account ('floor'): take target=fmu",
    }
    for name, message in told.items():
        answer = tied.get(f"/v1/trees/{name}/export?target=c&quantities=forward_dynamics")
        (fault,) = answer.json()["errors"]
        assert fault["pointer"] == "/query/quantities"
        assert fault["message"] == f"'forward_dynamics' does not take {message}"
    (fault,) = tied.get("/v1/trees/bouncy/export?target=simulink").json()["errors"]
    assert (fault["pointer"], fault["code"]) == ("/query/target", "has-contacts")
    assert fault["message"].endswith("take target=fmu, which Simulink reads, too")


def test_formulas_of_the_tree_stay(tied: TestClient) -> None:
    for path in ("metric", "christoffel", "forces", "export?target=c", "export?target=urdf&bind=defaults"):
        answer = tied.get(f"/v1/trees/sleigh/{path}")
        assert answer.status_code == 200, (path, answer.text[:300])
    assert "velocity constraint 'blade'" in answer.text
    for path in ("/trees/sleigh", "/trees/sleigh/motion", "/trees/sleigh/edit", "/v1/trees/sleigh/scene"):
        assert tied.get(path).status_code == 200
    assert "<td>blade</td><td>knife_edge</td><td>s.b</td>" in tied.get("/trees/sleigh").text
    asked = {"quantities": ["metric", "inverse_dynamics"], "q": [0, 0, 0], "qdd": [0, 0, 0]}
    assert tied.post("/v1/trees/sleigh/evaluations", json=asked).status_code == 200


def test_faults_and_revisions(tied: TestClient) -> None:
    wrong = tied.post("/v1/trees", json={**TREE, "velocity_constraints": [EDGE, {**EDGE, "name": "b", "frame": "s.c"}]})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/velocity_constraints/1/frame")
    wrong = tied.post("/v1/trees", json={**TREE, "velocity_constraints": [{**EDGE, "type": "closure"}]})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/velocity_constraints/0/type")
    # a change of the tree keeps them, and is checked against them
    grown = tied.post("/v1/trees/sleigh/couplings", json={"name": "t", "definition": sleigh_part()})
    assert (grown.status_code, grown.json()["velocity_constraints"]) == (201, [EDGE])
    less = tied.delete("/v1/trees/sleigh/couplings/s")
    assert (less.status_code, less.json()["errors"][0]["pointer"]) == (422, "/velocity_constraints/0/frame")
    told = tied.get("/v1/trees/sleigh@1/difference?to=free").json()
    assert [each["place"] for each in told["definition"]] == ["/velocity_constraints/blade"]


def test_jobs_take_it() -> None:
    stored = {**TREE, "instances": [{"name": "s", "substructure": "sleigh"}]}
    library = MemoryLibrary([sleigh_part()], [stored])
    simulation = {"analysis": "simulations", "request": {**START, **VELOCITIES, "span": [0, 1]}}
    equations = {"quantity": "velocity-equations", "format": "text", "request": VELOCITIES}
    for kind, request in (("verify", {}), ("analyse", simulation), ("export", {"target": "c"}), ("export", equations)):
        for outcome in outcomes(library, kind, {"items": [{"tree": "sleigh", **request}]}):
            assert outcome.problem is None, (kind, outcome.problem)
    refused: list[tuple[str, dict[str, Any]]] = [
        (
            "analyse",
            {
                "items": [
                    {
                        "tree": "sleigh",
                        "analysis": "curvatures",
                        "request": {"q": [0, 0, 0]},
                    }
                ]
            },
        ),
        ("sweep", {"template": stored, "choices": {"s": ["sleigh"]}, "columns": {"mass": "mass"}}),
    ]
    for kind, request in refused:
        with pytest.raises(InvalidInput, match="velocity constraints 'blade'"):
            outcomes(library, kind, request)
    fmu = {"tree": "sleigh", "target": "fmu", "independent": ["s.x", "s.f"]}
    (found,) = outcomes(library, "export", {"items": [fmu]})
    assert found.problem is None
    (wrong,) = outcomes(library, "export", {"items": [{**fmu, "independent": ["s.x", "s.q"]}]})
    assert wrong.problem is not None
    assert wrong.problem["errors"][0]["pointer"] == "/independent/1"
    (other,) = outcomes(library, "export", {"items": [{**fmu, "target": "c"}]})
    assert other.problem is not None
    assert [(e["pointer"], e["code"]) for e in other.problem["errors"]] == [("/independent", "not-of-quantity")]


def test_every_analysis_and_quantity_takes_them_or_says_so() -> None:
    """By one table of the science, which the page of trees names."""
    spec = TreeSpec.read(TREE)
    model = couple(spec, {"s": derive(Definition.read(sleigh_part()))})
    source, taken = Source(Sources(model), "", Limits()), []
    for name in (*ANALYSES, *QUANTITIES):
        try:
            _ = analysis_of(name, model) if name in ANALYSES else made(source, name, {})
            taken.append(name)
        except InvalidInput as error:
            (fault,) = error.faults
            assert (fault.code, f"'{name}'" in fault.message) == ("has-velocity-constraints", True)
    assert {*taken, "velocity-equations"} == {*TAKES_CONSTRAINTS}
    page = Path(__file__).parents[2] / "docs" / "reference" / "http" / "trees.md"
    (told,) = (x for x in page.read_text().split("\n\n") if x.startswith("**Velocity constraints**"))
    assert {*re.findall(r"`([a-z_-]+)`", told.partition("Its ")[2].partition(" have")[0])} == {*TAKES_CONSTRAINTS}
