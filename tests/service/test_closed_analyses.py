"""Analyses of trees with closures over HTTP, as jobs, and by the command line; what is refused, with which advice."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.cli.main import main
from service.jobs.kinds import run
from substructures.client.numbers import Evaluation
from substructures.documents import read_json, write_json
from substructures.formats.arrays import as_answer, view_npz

from .jobs_library import MemoryLibrary
from .one_store import filled, store

__all__ = ["filled", "store"]  # fixtures

G = 9.81
DOWN = np.pi / 2
#: a hanging parallelogram: two cranks and a table of length 1, masses 1, 1, 2
PART: dict[str, Any] = {
    "name": "swing",
    "parameters": {"c": {"value": 0, "unit": "N*m*s"}},
    "bodies": [
        {"name": "left", "parent": "base", "mass": 1, "com": [1, 0, 0],
         "joint": {"type": "revolute", "coordinate": "left", "damping": "c"}},
        {"name": "right", "parent": "base", "mass": 1, "com": [1, 0, 0],
         "joint": {"type": "revolute", "coordinate": "right", "d": 1}},
        {"name": "table", "parent": "left", "mass": 2, "com": [0.5, 0, 0],
         "joint": {"type": "revolute", "coordinate": "table", "d": 1}},
    ],
    "ports": [
        {"name": "edge", "body": "table", "position": [1, 0, 0]},
        {"name": "end", "body": "right", "position": [1, 0, 0]},
    ],
}  # fmt: skip
TREE: dict[str, Any] = {
    "name": "swing",
    "gravity": [0, -G, 0],
    "instances": [{"name": "s", "definition": PART}],
    "closures": [{"name": "pin", "type": "pin", "from": "s.edge", "to": "s.end"}],
}
HANGING = [-DOWN, -DOWN, DOWN]


@pytest.fixture(scope="module")
def swing(filled: TestClient) -> TestClient:
    made = filled.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    return filled


def ask(client: TestClient, what: str, **request: Any) -> Any:
    answer = client.post(f"/v1/trees/swing/{what}", json=request)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_equilibria_vibrations_and_root_loci(swing: TestClient) -> None:
    """w^2 = g/l, whatever the masses at distance l."""
    found = ask(swing, "linearisations", q=HANGING)
    assert (found["status"], found["is_equilibrium"], len(found["A"])) == ("finished", True, 2)
    assert found["modes"][0]["frequency"] == pytest.approx(np.sqrt(G), rel=1e-12)
    assert len(found["modes"][0]["shape"]) == 3
    assert found["stability"]["verdict"] == "stable"
    assert set(found["independent"]) < {"s.left", "s.right", "s.table"}
    assert found["constraints"] == [f"pin.{row}" for row in ("x", "y", "z", "rx", "ry")]
    verdicts = [e["at"]["stability"]["verdict"] for e in ask(swing, "equilibria", count=12)["found"]]
    assert {"stable", "unstable"} <= set(verdicts)
    locus = ask(swing, "root-loci", parameter="s.c", values=[0, 4, 8], q=HANGING)
    assert np.shape(locus["eigenvalues"]) == (3, 2, 2)
    np.testing.assert_allclose([z[0][0] for z in locus["eigenvalues"]], [0, -0.5, -1], atol=1e-9)
    drawn = swing.post(
        "/v1/trees/swing/root-loci",
        json={"parameter": "s.c", "values": [0, 4], "q": HANGING},
        headers={"Accept": "image/svg+xml"},
    )
    assert drawn.status_code == 200


def test_accelerations_of_a_closed_tree(swing: TestClient) -> None:
    """a = g sin(angle from below) for all; open states are failures with advice."""
    turned = [-DOWN + 0.3, -DOWN + 0.3, DOWN - 0.3]
    answer = ask(swing, "evaluations", quantities=["forward_dynamics"], q=[turned, [0.1, 0.2, 0.3]])
    np.testing.assert_allclose(answer["forward_dynamics"][0], -G * np.sin(0.3) * np.array([1, 1, -1]), rtol=1e-12)
    assert answer["forward_dynamics"][1] is None
    assert "loop states" in answer["failures"][0]["message"]
    made = swing.post("/v1/trees/swing/kernels", json={"quantities": ["forward_dynamics"]})
    assert made.status_code in (200, 201), made.text
    assert "closure.jacobian" in made.json()["kernels"][0]["outputs"]
    again = ask(swing, "evaluations", quantities=["forward_dynamics"], q=turned)
    np.testing.assert_allclose(again["forward_dynamics"], answer["forward_dynamics"][0], rtol=1e-12)


def test_rows_of_closures_in_numbers(swing: TestClient) -> None:
    """The Jacobian is the derivative of the residual; the same as npz, whose names are nested at dots."""
    a, b, c = -1.2, -1.1, 1.3
    quantities = ["closure.jacobian", "closure.residual"]
    told = ask(swing, "evaluations", quantities=quantities, q=[[a, b, c]])
    assert told["rows"] == [f"pin.{row}" for row in ("x", "y", "z", "rx", "ry")]
    moved = np.array(ask(swing, "evaluations", quantities=quantities, q=[[a, b + 1e-7, c]])["closure.residual"])
    slope = (moved - np.array(told["closure.residual"]))[0] / 1e-7
    np.testing.assert_allclose(np.array(told["closure.jacobian"])[0, :, 1], slope, atol=1e-6)
    content = swing.post(
        "/v1/trees/swing/evaluations",
        json={"quantities": quantities, "q": [[a, b, c]]},
        headers={"Accept": "application/x-npz"},
    ).content
    found = Evaluation(as_answer(view_npz(np.frombuffer(content, np.uint8))), {"q": [[a, b, c]]})
    np.testing.assert_allclose(found["closure.jacobian"], told["closure.jacobian"], rtol=1e-13, atol=1e-15)
    column = found.columns()["closure.jacobian.pin.x.s.right"]
    np.testing.assert_allclose(column, [told["closure.jacobian"][0][0][1]], rtol=1e-13)


def test_an_open_tree_has_no_rows_of_closures(swing: TestClient) -> None:
    made = swing.post("/v1/trees", json={**TREE, "name": "open", "closures": []})
    assert made.status_code == 201, made.text
    answer = swing.post("/v1/trees/open/evaluations", json={"quantities": ["closure.jacobian"], "q": HANGING})
    assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "not-of-tree")
    assert answer.json()["errors"][0]["pointer"] == "/quantities/0"


def test_formulas_of_a_closed_tree(swing: TestClient) -> None:
    found = swing.get("/v1/trees/swing/perturbation").json()
    assert found["multipliers"] == [f"lambda.pin.{row}" for row in ("x", "y", "z", "rx", "ry")]
    assert "closure.jacobian" in found["outputs"]
    (energy,) = swing.get("/v1/trees/swing/first_integrals").json()["integrals"]
    assert energy["rule"] == "falling"
    assert energy["reason"].endswith("the closures 'pin' do no work")


def test_control_of_a_closed_tree(swing: TestClient) -> None:
    """Gradient and optimum on the closures, from the nearest closed state: what is demanded twice counts once."""
    control = {
        "controls": ["tau.s.left"],
        "cost": {"running": "tau.s.left^2"},
        "horizon": 0.4,
        "intervals": 4,
        "steps": 4,
    }
    found = ask(swing, "cost-gradients", **control, q=HANGING, values={"tau.s.left": 2})
    assert (found["status"], found["is_right"]) == ("finished", True)
    (check,) = [each for each in found["checks"] if each["name"] == "closures"]
    assert check["holds"]
    to = -DOWN + 0.05
    end = {"q": {"s.left": to, "s.right": to}, "qd": [0, 0, 0]}
    found = ask(swing, "optimal-controls", **control, q=HANGING, end=end)
    assert found["status"] == "optimal"
    assert found["trajectory"]["q"][-1][0] == pytest.approx(to, abs=1e-6)
    symbols = swing.get("/v1/trees/swing/adjoint", params={"controls": "tau.s.left"}).json()["symbols"]
    assert {"rho.pin.x", "nu.pin.x", "mu.s.left"} <= {symbol["name"] for symbol in symbols}


def test_identification_of_a_closed_tree(swing: TestClient) -> None:
    """One equation is left of three; accelerations along the loop with any torques show what it tells."""
    x = 0.4 * np.sin(np.linspace(0, 5, 40))
    angles, torque = (-DOWN + x, -DOWN + x, DOWN - x), 3 * np.cos(np.linspace(0, 3, 40))
    second = (torque[:, None] * [1, 1, -1]).tolist()
    motion = {"q": np.stack(angles, axis=1).tolist(), "qd": [[0, 0, 0]] * 40, "qdd": second}
    shown = ask(swing, "excitations", **motion)
    found = ask(swing, "identifications", **motion, tau=[[u, 0, 0] for u in torque], known=False, error_limit=10)
    assert found["names"] == shown["names"]
    assert set(found["combinations"]) == set(found["names"])
    assert len(found["independent"]) == len(found["residual"]) == 1


REFUSED = [
    ("forward_dynamics", {}, "evaluate it"),
    ("forward_dynamics_derivative", {}, "linearisations"),
    ("curvature", {}, "independent coordinates"),
    ("routhian", {}, "first integrals"),
    ("base_parameters", {}, "regressor"),
]


@pytest.mark.parametrize(("quantity", "options", "advice"), REFUSED)
def test_formulas_that_closures_would_falsify(
    swing: TestClient, quantity: str, options: dict[str, str], advice: str
) -> None:
    answer = swing.get(f"/v1/trees/swing/{quantity}", params=options)
    assert answer.status_code == 422, answer.text
    (error,) = answer.json()["errors"]
    assert error["code"] == "has-closures"
    assert "'pin'" in error["message"]
    assert advice in error["message"]


NUMBERS: list[tuple[str, dict[str, Any], str]] = [
    ("curvatures", {"q": HANGING}, "has-closures"),
    ("velocity-equations", {"constraints": []}, "open-closure"),
    ("linearisations", {"q": [HANGING, HANGING]}, "one-state"),
    ("evaluations", {"quantities": ["forward_dynamics_derivative"], "q": HANGING, "along": {}}, "has-closures"),
]


@pytest.mark.parametrize(("what", "request_", "code"), NUMBERS)
def test_numbers_that_closures_would_falsify(swing: TestClient, what: str, request_: dict[str, Any], code: str) -> None:
    answer = swing.post(f"/v1/trees/swing/{what}", json=request_)
    assert answer.status_code == 422, answer.text
    assert [error["code"] for error in answer.json()["errors"]] == [code]


#: swinging down through oil: c a' = -4 g sin a after some milliseconds
STIFF: dict[str, Any] = {"q": [-DOWN + 0.1, -DOWN + 0.1, DOWN - 0.1], "span": [0, 100], "count": 2}
STIFF |= {"parameters": {"s.c": 1e4}, "method": "BDF", "relative_tolerance": 1e-8}


@pytest.mark.parametrize("method", ["Radau", "BDF"])
@pytest.mark.parametrize("reduction", ["projection", "partitioning"])
def test_stiff_motions(swing: TestClient, method: str, reduction: str) -> None:
    found = ask(swing, "simulations", **STIFF | {"method": method, "reduction": reduction})
    assert (found["is_right"], found["figures"]["evaluations"] < 2000) == (True, True), found["checks"]
    angle = 2 * np.arctan(np.tan(0.05) * np.exp(-4 * G * 100 / 1e4))
    assert found["q"][-1][0] == pytest.approx(angle - DOWN, abs=1e-6)


def test_a_method_that_cannot_go_on_from_closures(swing: TestClient) -> None:
    answer = swing.post("/v1/trees/swing/simulations", json=STIFF | {"method": "LSODA"})
    (error,) = answer.json()["errors"]
    assert (answer.status_code, error["pointer"], error["code"]) == (422, "/method", "literal-error")
    assert "'Radau' or 'BDF'" in error["message"]


def test_the_same_as_a_job() -> None:
    library = MemoryLibrary([PART], [TREE | {"instances": [{"name": "s", "substructure": "swing"}]}])
    items = [
        {"tree": "swing", "analysis": "linearisations", "request": {"q": HANGING}},
        {"tree": "swing", "analysis": "equilibria", "request": {"count": 4}},
    ]
    items = [read_json(write_json(item)) for item in library.items("analyse", {"items": items})]
    first, second = (run("analyse", item, library.blobs, lambda _: None) for item in items)
    assert first.problem is None
    found = json.loads(first.files["result"])
    assert found["modes"][0]["frequency"] == pytest.approx(np.sqrt(G), rel=1e-12)
    assert json.loads(second.files["result"])["found"]


def test_the_same_by_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "swing.json").write_text(json.dumps(TREE))
    (tmp_path / "q.json").write_text(json.dumps({"q": HANGING}))
    assert main(["analyse", str(tmp_path / "swing.json"), "linearisations", str(tmp_path / "q.json")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["modes"][0]["frequency"] == pytest.approx(np.sqrt(G), rel=1e-12)
    (tmp_path / "stiff.json").write_text(json.dumps(STIFF))
    assert main(["simulate", str(tmp_path / "swing.json"), str(tmp_path / "stiff.json")]) == 0
    assert "s.right = -1.50322" in capsys.readouterr().out
    assert main(["analyse", str(tmp_path / "swing.json"), "curvature"]) == 1
    assert "'pin'" in capsys.readouterr().err
