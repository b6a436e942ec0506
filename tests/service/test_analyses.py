"""Numbers that follow from the equations of motion, over HTTP: each endpoint with a physical check."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service import arrow
from service.app import open_store
from service.negotiation import MEDIA_TYPES
from service.settings import Limits, Settings
from service.store import Store
from substructures import catalogue
from substructures.documents import write_json
from substructures.expr.program import Program

from .conftest import make_client
from .fake_engine import FakeEngine, finished, running

G = 9.81
BAR: dict[str, Any] = {
    "name": "bar",
    "bodies": [
        {"name": "bar", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1, "com": [1, 0, 0]}
    ],
    "ports": [{"name": "end", "body": "bar", "position": [1, 0, 0]}],
}
PIN = {"name": "pin", "type": "pin", "from": "c.end", "to": "world", "placement": {"position": [1, 0, 0]}}
SLED: dict[str, Any] = {
    "name": "sled",
    "bodies": [
        {
            "name": "sled",
            "parent": "base",
            "joint": {"type": "planar", "coordinate": ["x", "y", "phi"]},
            "mass": 2,
            "inertia": {"xx": 0.25, "yy": 0.25, "zz": 0.5},
        }
    ],
}
TREES: list[dict[str, Any]] = [
    {
        "name": "clock",
        "gravity": [0, 0, -G],
        "instances": [{"name": "p", "substructure": "simple-pendulum", "parameters": {"l": 1, "m": 2}}],
    },
    {"name": "cart", "gravity": [0, 0, -G], "instances": [{"name": "x", "substructure": "cart-pendulum"}]},
    {
        "name": "ring",
        "gravity": [0, -G, 0],
        "instances": [
            {"name": "a", "definition": BAR},
            {"name": "b", "definition": BAR, "at": "a.end"},
            {"name": "c", "definition": BAR, "at": "b.end"},
        ],
        "closures": [PIN],
    },
    {"name": "skate", "instances": [{"name": "s", "definition": SLED}]},
]


def submit(client: TestClient, name: str) -> None:
    """An entry of the catalogue, numbers exact."""
    body = write_json(catalogue.load(name))
    answer = client.post("/v1/substructures", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 201, answer.text


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    folder: Path = tmp_path_factory.mktemp("analyses")
    with open_store(Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False)) as store:
        yield store


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    client = make_client(store)
    for name in ("simple-pendulum", "cart-pendulum"):
        submit(client, name)
    for tree in TREES:
        answer = client.post("/v1/trees", json=tree)
        assert answer.status_code == 201, answer.text
    return client


def ask(client: TestClient, path: str, **request: Any) -> Any:
    answer = client.post(f"/v1/trees/{path}", json=request)
    assert answer.status_code == 200, answer.text
    return answer.json()


def rest(client: TestClient) -> list[float]:
    """The stable equilibrium of the clock."""
    found = ask(client, "clock/equilibria", count=8)["found"]
    return next(e["q"] for e in found if e["at"]["stability"]["verdict"] == "stable")


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
        ("energy", "constant", "J", True)
    ]
    assert len(found["t"]) == len(found["q"]) == len(found["series"]["energy"]) == 101


def test_a_violated_condition_is_told(client: TestClient) -> None:
    fixed = {"step": 0.1, "method": "semi-implicit-euler"}
    found = ask(client, "clock/simulations", q=[1.0], span=[0, 5], fixed_step=fixed)
    assert not found["is_right"]
    (check,) = found["checks"]
    assert check["time"] > 0
    assert check["relative"] > check["limit"]
    stopped = ask(client, "clock/simulations", q=[1.0], span=[0, 5], max_steps=3)
    assert stopped["status"] == "failed"
    assert "max_steps" in stopped["message"]


@pytest.mark.parametrize("media", ["application/x-npz", "text/csv", "image/svg+xml", arrow.MEDIA_TYPE])
def test_motions_as_files(client: TestClient, media: str) -> None:
    request = {"q": [0.3, 0.2], "span": [0, 1], "count": 11}
    asked = client.post("/v1/trees/cart/simulations", json=request, headers={"Accept": media})
    assert asked.status_code == 200, asked.text
    assert asked.headers["content-type"].startswith(media)
    expected = np.array(ask(client, "cart/simulations", **request)["q"])
    if media == "application/x-npz":
        with np.load(io.BytesIO(asked.content), allow_pickle=False) as arrays:
            assert np.array_equal(arrays["q"], expected)
            assert "series.energy" in arrays
            assert '"is_right":true' in str(arrays["summary"])
    elif media == "text/csv":
        rows = list(csv.reader(io.StringIO(asked.text)))
        assert rows[0][:3] == ["t", "x.q0", "x.q1"]
        assert np.array_equal(np.array(rows[1:], dtype=float)[:, 1:3], expected)
    elif media == "image/svg+xml":
        assert asked.text.count("<polyline") == 2 + 2  # coordinates; energy and momentum of the cart
        assert "checks hold" in asked.text
        assert "script" not in asked.text
    else:
        (part,) = arrow.read_tables(io.BytesIO(asked.content))
        assert np.array_equal(part["q"], expected)


def test_linearisation_has_the_frequency_of_small_swings(client: TestClient) -> None:
    found = ask(client, "clock/linearisations", q=rest(client), outputs={"angle": "p.q1"})
    assert found["is_equilibrium"]
    assert found["modes"][0]["frequency"] == pytest.approx(math.sqrt(G))
    assert np.array(found["A"]) == pytest.approx(np.array([[0, 1], [-G, 0]]))
    assert np.array(found["C"]).tolist() == [[1, 0]]


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
    found = ask(client, "cart/curvatures", q=[[0, 0.3], [0, 1.0]])
    riemann = np.array(found["riemann"])
    assert riemann == pytest.approx(-riemann.swapaxes(1, 2))


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


def test_a_skate_does_not_slip(client: TestClient) -> None:
    edge = {"type": "knife_edge", "name": "edge", "frame": "s.sled"}
    velocities = {"speed": "s.x'*cos(s.phi) + s.y'*sin(s.phi)", "turn": "s.phi'"}
    request = {"q": [0, 0, 0], "qd": [1, 0, 0.5], "span": [0, 4], "constraints": [edge]}
    found = ask(client, "skate/simulations", **request, velocities=velocities)
    assert found["is_right"], found
    x, y, phi = found["q"][-1]
    assert (x, y, phi) == pytest.approx((2 * math.sin(2), 2 - 2 * math.cos(2), 2))  # a circle of radius v/omega


def test_equations_of_a_skate_in_every_format(client: TestClient) -> None:
    edge = {"type": "knife_edge", "name": "edge", "frame": "s.sled"}
    speeds = {"speed": "s.x'*cos(s.phi) + s.y'*sin(s.phi)", "turn": "s.phi'"}
    body = {"constraints": [edge], "velocities": speeds}
    for name in MEDIA_TYPES:
        answer = client.post("/v1/trees/skate/velocity-equations", params={"format": name}, json=body)
        assert answer.status_code == 200, answer.text
        if name == "json":
            assert answer.json()["velocities"] == ["speed", "turn"]
            assert Program.from_bytes(answer.content).outputs["hamel_bias"].shape == (2,)
    wrong = client.post("/v1/trees/skate/velocity-equations", json={"constraints": [{**edge, "frame": "s.nobody"}]})
    assert wrong.status_code == 422
    assert wrong.json()["errors"][0]["pointer"] == "/constraints/0/frame"


def test_identification_finds_what_was_put_in(client: TestClient) -> None:
    rng = np.random.default_rng(4)
    motion = {name: rng.uniform(-1, 1, (20, 1)).tolist() for name in ("q", "qd", "qdd")}
    forces = ask(client, "clock/evaluations", quantities=["inverse_dynamics"], **motion)["inverse_dynamics"]
    assert ask(client, "clock/excitations", **motion)["is_good"]
    found = ask(client, "clock/identifications", **motion, tau=forces)
    assert found["status"] == "identified"
    assert max(found["residual"]) < 1e-12


WRONG = [
    ("simulations", {"q": [0]}, "/span"),
    ("simulations", {"q": [0, 0, 0], "span": [0, 1]}, "/q"),
    ("simulations", {"q": [0, 0], "span": [1, 0]}, "/"),
    ("simulations", {"q": [0, 0], "span": [0, 1], "inputs": {"tau.nobody": 1}}, "/inputs/tau.nobody"),
    ("simulations", {"q": [0, 0], "span": [0, 1], "constraints": [{"type": "magic"}]}, "/constraints/0"),
    ("sensitivities", {"q": [0, 0], "span": [0, 1], "by": ["x.nothing"]}, "/by/0"),
    ("linearisations", {"q": [0, 0], "of_inputs": ["tau.nobody"]}, "/of_inputs"),
    ("equilibria", {"count": -1}, "/count"),
    ("root-loci", {"parameter": "nothing", "values": [1], "q": [0, 0]}, "/parameter"),
    ("curvatures", {"q": ["x", 0]}, "/q"),
    ("cost-gradients", {"controls": ["u"], "horizon": 1, "intervals": 1, "q": [0, 0]}, "/controls/0"),
    ("optimal-controls", {"controls": ["tau.x.q0"], "horizon": -1, "intervals": 1, "q": [0, 0]}, "/horizon"),
    ("loop-states", {"q": [0, 0], "fixed": ["nobody"]}, "/fixed"),
    ("excitations", {"q": [[0, 0]]}, "/qdd"),
    ("identifications", {"q": [[0, 0]], "qdd": [[0, 0]], "tau": [[1]]}, "/tau"),
]


@pytest.mark.parametrize(("name", "request_", "pointer"), WRONG)
def test_wrong_requests(client: TestClient, name: str, request_: dict[str, Any], pointer: str) -> None:
    answer = client.post(f"/v1/trees/cart/{name}", json=request_)
    assert answer.status_code == 422, answer.text
    found = [error["pointer"] or "/" for error in answer.json()["errors"]]
    assert any(place.startswith(pointer) for place in found), answer.text
    assert client.post(f"/v1/trees/cart/{name}", json=[]).status_code == 422
    assert client.post(f"/v1/trees/nothing/{name}", json=request_).status_code == 404
    refused = client.post(f"/v1/trees/cart/{name}", json=request_, headers={"Accept": "image/gif"})
    assert refused.status_code == 406


def test_what_takes_long_becomes_a_job(tmp_path: Path) -> None:
    with open_store(Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False)) as store:
        client = make_client(store)
        submit(client, "simple-pendulum")
        assert client.post("/v1/trees", json=TREES[0]).status_code == 201
        limits = store.settings.limits
        store.settings = store.settings.model_copy(update={"limits": Limits(sync_seconds=0.3)})
        request = {"q": [1], "span": [0, 1e6], "method": "RK23", "max_steps": 10**8}
        answer = client.post("/v1/trees/clock/simulations", json=request)
        assert (answer.status_code, answer.json()["kind"]) == (202, "analyse")
        large = {"q": [1], "span": [0, 1e6], "count": 1_000_000}
        store.settings = store.settings.model_copy(update={"limits": limits.model_copy(update={"binary_bytes": 10**6})})
        assert client.post("/v1/trees/clock/simulations", json=large).json()["code"] == "too-large"


@pytest.mark.parametrize("headers", [{}, {"Accept": "text/csv"}])
def test_jobs_compute_the_same(client: TestClient, store: Store, headers: dict[str, str]) -> None:
    request = {"q": [0, 0.4], "span": [0, 1], "count": 5}
    answer = client.post("/v1/trees/cart/simulations", json=request, headers=headers)
    with running(store, FakeEngine()):
        waiting = client.post(
            "/v1/trees/cart/simulations", json=request, headers={**headers, "Prefer": "respond-async"}
        )
        assert waiting.status_code == 202, waiting.text
        job = finished(client, waiting.json()["id"])
        (item,) = client.get(job["result"]).json()["items"]
    assert (item["state"], item["result"]["status"], item["result"]["is_right"]) == ("succeeded", "finished", True)
    (file,) = item["files"]
    assert answer.headers["content-type"].startswith(file["media_type"])
    content = client.get(file["href"]).content
    if headers:
        assert content == answer.content
    else:
        assert client.get(file["href"]).json()["q"] == answer.json()["q"]


def test_many_at_a_time(client: TestClient) -> None:
    """Requests share compiled kernels, but no states."""
    starts = [{"q": [0.1 * k, 0.3], "span": [0, 2], "count": 20} for k in range(8)]
    alone = [ask(client, "cart/simulations", **start)["q"] for start in starts]
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(lambda start: ask(client, "cart/simulations", **start)["q"], starts * 2))
    assert together == alone * 2


def test_an_idempotency_key_is_accepted(client: TestClient) -> None:
    request = {"q": [0, 0.1], "span": [0, 0.1], "count": 3}
    headers = {"Idempotency-Key": "once"}
    first, second = (client.post("/v1/trees/cart/simulations", json=request, headers=headers) for _ in range(2))
    assert (first.status_code, second.status_code) == (200, 200)
    assert first.json()["q"] == second.json()["q"]
    other = client.post("/v1/trees/cart/simulations", json={**request, "count": 4}, headers=headers)
    assert other.status_code == 422
