"""Numbers that follow from the equations of motion, over HTTP: each endpoint with a physical check."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from fastapi.testclient import TestClient

from .analysis_trees import BAR, TREES, G, ask, client, rest, store

__all__ = ["client", "store"]  # fixtures


def test_a_pendulum_swings_with_its_period(client: TestClient) -> None:
    """T = 2 pi sqrt(l/g) (1 + phi^2/16 + 11 phi^4/3072 + ...)."""
    (q,) = rest(client)
    amplitude = 0.1
    event = {"name": "top", "quantity": "p.q1'", "action": "record", "direction": "both"}
    found = ask(client, "clock/simulations", q=[q + amplitude], span=[0, 5], events=[event])
    turns = [e["t"] for e in found["events"] if e["t"] > 1e-6]
    series = 1 + amplitude**2 / 16 + 11 * amplitude**4 / 3072
    assert turns[1] == pytest.approx(2 * math.pi * math.sqrt(1 / G) * series, rel=1e-8)
    assert (found["status"], found["is_right"]) == ("finished", True)
    assert [(c["name"], c["rule"], c["unit"], c["holds"]) for c in found["checks"]] == [
        ("energy", "constant", "J", True),
        ("steps", "accurate", "1", True),
    ]
    assert len(found["t"]) == len(found["q"]) == len(found["series"]["energy"]) == 101


def test_a_violated_condition_is_told(client: TestClient) -> None:
    fixed = {"step": 0.1, "method": "semi-implicit-euler"}
    found = ask(client, "clock/simulations", q=[1.0], span=[0, 5], fixed_step=fixed)
    assert found["is_right"] is False
    assert [check["name"] for check in found["checks"]] == ["energy", "steps"]
    for check in found["checks"]:
        assert check["time"] > 0
        assert check["relative"] > check["limit"]
    stopped = ask(client, "clock/simulations", q=[1.0], span=[0, 5], max_steps=3)
    assert (stopped["status"], stopped["is_right"]) == ("failed", None)
    assert "max_steps" in stopped["message"]


def test_verdicts_in_answers_and_headers(client: TestClient) -> None:
    """Three values, also where the format has no place for them."""
    swing = {"q": [1.0], "span": [0, 5]}
    loose = {"relative_tolerance": 0.1, "absolute_tolerance": 0.1}
    control = {"controls": ["tau.p.q1"], "cost": {"running": "p.q1^2"}, "horizon": 4, "intervals": 2, "q": [1.0]}
    for name, request, expected in (
        ("simulations", swing, "true"),
        ("simulations", swing | loose, "false"),
        ("simulations", swing | {"max_steps": 3}, "null"),
        ("sensitivities", swing | {"of_start": True}, "true"),
        ("sensitivities", swing | {"of_start": True} | loose, "false"),
        ("sensitivities", swing | {"of_start": True, "drift_limit": 1e-14}, "false"),
        ("cost-gradients", control | {"steps": 40}, "true"),
        ("cost-gradients", control, "false"),
        ("cost-gradients", control | {"steps": 40, "error_limit": 1e-12}, "false"),
        ("optimal-controls", control | {"steps": 20, "cost": {"running": "tau.p.q1^2 + p.q1^2"}}, "true"),
    ):
        found = client.post(f"/v1/trees/clock/{name}", json=request)
        assert found.status_code == 200, found.text
        told = found.json()
        assert json.dumps(told["is_right"]) == found.headers["trajectory-right"] == expected, (name, told["checks"])
        csv = client.post(f"/v1/trees/clock/{name}", json=request, headers={"Accept": "text/csv"})
        assert csv.headers["trajectory-right"] == expected


def test_linearisation_has_the_frequency_of_small_swings(client: TestClient) -> None:
    found = ask(client, "clock/linearisations", q=rest(client), outputs={"angle": "p.q1"})
    assert found["is_equilibrium"]
    assert found["modes"][0]["frequency"] == pytest.approx(math.sqrt(G))
    assert np.array(found["A"]) == pytest.approx(np.array([[0, 1], [-G, 0]]))
    assert np.array(found["C"]).tolist() == [[1, 0]]


def test_a_sled_that_spins_is_steady(client: TestClient) -> None:
    """All coordinates are cyclic: nothing is left that could move away; the pendulum's angle is not among them."""
    found = ask(client, "skate/steady-motions", rates={"s.phi": 2.0})
    assert found["moving"] == ["s.x", "s.y", "s.phi"]
    (motion,) = found["found"]
    assert motion["momenta"] == [0, 0, 1.0]
    assert motion["stability"] == {"verdict": "stable", "reason": "there is nothing that moves"}
    both = {
        each["stability"]["verdict"]: each for each in ask(client, "cart/steady-motions", rates={"x.q0": 1.0})["found"]
    }
    assert both.keys() == {"stable", "unstable"}
    assert both["stable"]["modes"][0]["frequency"] > 1
    answer = client.post("/v1/trees/clock/steady-motions", json={"rates": {"p.q1": 1}})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/rates/p.q1"


def test_families_of_steady_motions(client: TestClient) -> None:
    """A pendulum on a cart at a constant rate hangs or stands, whatever the rate: nothing bifurcates."""
    asked = {"rates": {}, "vary": "x.q0", "between": [0.5, 1.0], "steps": 4}
    found = ask(client, "cart/steady-motions", **asked)
    assert (found["vary"], found["is_right"], found["bifurcations"]) == ("x.q0", True, [])
    for branch in (0, 1):
        values = [each["value"] for each in found["found"] if each["branch"] == branch]
        assert (values[0], values[-1]) == (0.5, 1.0)
    drawn = client.post("/v1/trees/cart/steady-motions", json=asked, headers={"Accept": "image/svg+xml"})
    assert (drawn.status_code, drawn.text.count("<circle")) == (200, len(found["found"])), drawn.text
    assert all(word in drawn.text for word in ("x.q1", "stable", "unstable", "0 bifurcations"))


def test_root_locus_of_a_longer_pendulum(client: TestClient) -> None:
    values = [9.81, 4.0, 1.0]
    tree = {**TREES[0], "name": "planets", "gravity": [0, 0, "-g"], "parameters": {"g": {"value": G}}}
    assert client.post("/v1/trees", json=tree).status_code in (200, 201)
    request = {"parameter": "g", "values": values, "q": rest(client)}
    found = ask(client, "planets/root-loci", **request)
    sizes = np.abs(np.array(found["eigenvalues"])[..., 1]).max(axis=1)
    assert sizes == pytest.approx(np.sqrt(values))
    drawn = client.post("/v1/trees/planets/root-loci", json=request, headers={"Accept": "image/svg+xml"})
    assert "eigenvalues" in drawn.text


def test_frequency_response_as_bode_diagram(client: TestClient) -> None:
    asked = {"q": [0, 0], "outputs": {"turn": "x.q1"}}
    drawn = client.post("/v1/trees/cart/frequency-responses", json=asked, headers={"Accept": "image/svg+xml"})
    assert (drawn.status_code, drawn.headers["content-type"]) == (200, "image/svg+xml"), drawn.text
    assert all(word in drawn.text for word in ("magnitude", "phase", "turn to tau.x.q0"))


def test_sensitivities_are_slopes(client: TestClient) -> None:
    request = {"q": [0.3, 0.5], "span": [0, 1], "count": 2}
    name = next(n for n in client.get("/v1/trees/cart").json()["parameters"] if n.startswith("x.m"))
    value = client.get("/v1/trees/cart").json()["parameters"][name]["value"]
    slope = ask(client, "cart/sensitivities", **request, by=[name])["series"][f"d.{name}"][-1]
    h = 1e-4
    ends = [
        ask(client, "cart/simulations", **request, parameters={name: float(value) + x}, relative_tolerance=1e-12)
        for x in (h, -h)
    ]
    difference = [(a - b) / (2 * h) for a, b in zip(*(e["q"][-1] + e["qd"][-1] for e in ends), strict=True)]
    assert slope == pytest.approx(difference, rel=1e-6, abs=1e-8)


def test_curvature_of_one_coordinate_is_none(client: TestClient) -> None:
    assert ask(client, "clock/curvatures", q=[0.3])["scalar_curvature"] == 0


def test_curvature_of_a_double_pendulum(client: TestClient) -> None:
    """S = 2 cos d / (1 + sin^2 d)^2 for equal masses 1 on rods of length 1, d the angle between them."""
    bars = [{"name": "a", "definition": BAR}, {"name": "b", "definition": BAR, "at": "a.end"}]
    assert client.post("/v1/trees", json={"name": "double", "instances": bars}).status_code in (200, 201)
    found = ask(client, "double/curvatures", q=[[0.2, 0.3], [0, 1.0]])
    exact = [2 * math.cos(d) / (1 + math.sin(d) ** 2) ** 2 for d in (0.3, 1.0)]
    assert found["scalar_curvature"] == pytest.approx(exact)


def test_gradient_of_a_cost(client: TestClient) -> None:
    """J = integral of u^2 over 1 s at u = 3: 9, and its derivatives by both ends of a linear control are 3."""
    found = ask(
        client,
        "clock/cost-gradients",
        controls=["tau.p.q1"],
        cost={"running": "tau.p.q1^2"},
        horizon=1,
        intervals=1,
        steps=20,
        q=[0],
        values={"tau.p.q1": 3},
    )
    assert found["cost"] == pytest.approx(9)
    assert np.array(found["controls"]).ravel() == pytest.approx([3, 3])


def test_optimal_control_moves_a_cart(client: TestClient) -> None:
    """A mass M over a distance d in time T from rest to rest: the least integral of u^2 is 12 M^2 d^2 / T^3."""
    sled = {"controls": ["tau.s.x"], "cost": {"running": "tau.s.x^2"}, "horizon": 2, "intervals": 10}
    end = {"q": {"s.x": 1}, "qd": {"s.x": 0}}
    found = ask(client, "skate/optimal-controls", **sled, q=[0, 0, 0], end=end)
    assert found["status"] == "optimal"
    assert found["cost"] == pytest.approx(12 * 2**2 / 2**3, rel=1e-6)


def test_closed_loops(client: TestClient) -> None:
    start = {"q": [1.8, -2.0, -1.5]}
    state = ask(client, "ring/loop-states", **start)
    assert state["mobility"]["degrees_of_freedom"] == 1
    assert state["consistent"]["residual"] < 1e-12 if "consistent" in state else state["residual"] < 1e-12
    found = ask(client, "ring/simulations", **start, span=[0, 0.5])
    assert (found["status"], found["is_right"]) == ("finished", True)
    assert max(found["series"]["position_residual"]) < 1e-9


def test_closed_loops_in_independent_coordinates(client: TestClient) -> None:
    """As with multipliers; a place beyond the dead centre is named."""
    asked = {"independent": ["a.q"], "start": {"a.q": 1.8, "b.q": -2.0, "c.q": -1.5}}
    found = ask(client, "ring/reduced-equations", **asked, q={"a.q": {"value": 90, "unit": "deg"}}, qd={"a.q": 1})
    assert found["is_right"], found
    other = ask(client, "ring/loop-states", q=found["q"], qd=found["qd"])
    assert found["qdd"] == pytest.approx(other["qdd"], rel=1e-10)
    inertia, bent = found["metric"][0][0], found["christoffel"][0][0][0]
    assert found["accelerations"][0] == pytest.approx((found["forces"][0] - bent) / inertia, rel=1e-12)
    two = ask(client, "ring/reduced-equations", **asked, q={"a.q": {"value": [100, 90], "unit": "deg"}}, qd={"a.q": 1})
    assert two["is_right"], two
    assert two["metric"][1] == [pytest.approx(row, rel=1e-12) for row in found["metric"]]
    refused = client.post("/v1/trees/ring/reduced-equations", json={"q": {"a.q": 1}})
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/independent", "missing")]


def test_a_skate_does_not_slip(client: TestClient) -> None:
    edge = {"type": "knife_edge", "name": "edge", "frame": "s.sled"}
    velocities = {"speed": "s.x'*cos(s.phi) + s.y'*sin(s.phi)", "turn": "s.phi'"}
    request = {"q": [0, 0, 0], "qd": [1, 0, 0.5], "span": [0, 4], "constraints": [edge]}
    found = ask(client, "skate/simulations", **request, velocities=velocities)
    assert found["is_right"], found
    x, y, phi = found["q"][-1]
    assert (x, y, phi) == pytest.approx((2 * math.sin(2), 2 - 2 * math.cos(2), 2))  # a circle of radius v/omega


def test_identification_finds_what_was_put_in(client: TestClient) -> None:
    rng = np.random.default_rng(4)
    motion = {name: rng.uniform(-1, 1, (20, 1)).tolist() for name in ("q", "qd", "qdd")}
    forces = ask(client, "clock/evaluations", quantities=["inverse_dynamics"], **motion)["inverse_dynamics"]
    assert ask(client, "clock/excitations", **motion)["is_good"]
    found = ask(client, "clock/identifications", **motion, tau=forces)
    assert found["status"] == "identified"
    assert max(found["residual"]) < 1e-12
    told = ask(client, "clock/identifications", **motion, tau=forces, held_out=0.2, consistent=True)
    assert told["is_right"]
    assert told["inertia"]["is_right"]
    assert max(told["held_out"]) < 1e-12
    (part,) = told["parts"].values()
    stored = client.post("/v1/substructures", json=part)
    assert stored.status_code == 201, stored.json()
    assert stored.json()["derived_from"] == f"{part['name']}@1"
