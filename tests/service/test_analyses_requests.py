"""Requests for analyses over HTTP: files, faults, jobs, several at a time, formulas with a body."""

from __future__ import annotations

import csv
import io
from concurrent.futures import ThreadPoolExecutor
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.messages.negotiation import MEDIA_TYPES
from service.settings import Limits, Settings
from service.store.store import Store
from substructures.expr.program import Program
from substructures.formats import arrow

from .analysis_trees import TREES, ask, client, store, submit
from .conftest import make_client
from .fake_engine import FakeEngine, finished, running

__all__ = ["client", "store"]  # fixtures


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
        assert asked.text.count("<polyline") == 2 + 3  # coordinates; energy, momentum and centre of mass of the cart
        assert "checks hold" in asked.text
        assert "script" not in asked.text
    else:
        (part,) = arrow.read_tables(io.BytesIO(asked.content))
        assert np.array_equal(part["q"], expected)


@pytest.mark.parametrize("level", [3.0, 9.0])
def test_sections_as_files(client: TestClient, level: float) -> None:
    """Also those that are not met."""
    body = {"q": [0.3, 0.2], "quantity": "x.q1", "level": level, "direction": "both", "count": 4, "duration": 9}
    expected = np.array(ask(client, "cart/poincare-sections", **body)["q"])
    assert expected.size == (8 if level == 3 else 0)
    for media in ("application/x-npz", "text/csv", arrow.MEDIA_TYPE):
        asked = client.post("/v1/trees/cart/poincare-sections", json=body, headers={"Accept": media})
        assert (asked.status_code, asked.headers["trajectory-right"]) == (200, "true"), asked.text
        if media == "text/csv":
            assert len(asked.text.splitlines()) == 1 + len(expected)
        elif media == arrow.MEDIA_TYPE:
            (part,) = arrow.read_tables(io.BytesIO(asked.content))
            assert np.array_equal(part["q"], expected.reshape(-1, 2))
        else:
            with np.load(io.BytesIO(asked.content), allow_pickle=False) as arrays:
                assert np.array_equal(arrays["q"], expected.reshape(-1, 2))
    drawn = client.post("/v1/trees/cart/poincare-sections", json=body, headers={"Accept": "image/svg+xml"})
    assert (drawn.status_code, drawn.text.count("<circle")) == (200, 2 * len(expected))
    assert "x.q1' in rad/s" in drawn.text


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
            assert "warnings" not in answer.json()
        chosen = client.post(
            "/v1/trees/skate/velocity-equations", params={"format": name}, json={"constraints": [edge]}
        )
        if name == "json":
            (warning,) = chosen.json()["warnings"]
            assert warning["code"] == "singular-velocities"
            assert "do not describe the motion where " in warning["message"]
        else:
            (line,) = [each for each in chosen.text.splitlines() if "Warning: the velocities s." in each]
            assert "do not describe the motion where " in line
    wrong = client.post("/v1/trees/skate/velocity-equations", json={"constraints": [{**edge, "frame": "s.nobody"}]})
    assert wrong.status_code == 422
    assert wrong.json()["errors"][0]["pointer"] == "/constraints/0/frame"


def test_orbits_through_events(client: TestClient) -> None:
    """A ball of 2 kg that bounces for ever from 1 m."""
    slide = {"type": "prismatic", "coordinate": "z"}
    ball = {"name": "ball", "bodies": [{"name": "b", "parent": "base", "joint": slide, "mass": 2}]}
    tree = {"name": "court", "gravity": [0, 0, "-9.81"], "instances": [{"name": "b", "definition": ball}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    floor = {"name": "floor", "quantity": "b.z", "direction": "falling", "reset": {"b.z'": "-b.z'"}}
    wanted = {"q": [1], "period": 0.9, "hold": ["b.z", "b.z'"], "events": [floor]}
    (orbit,) = client.post("/v1/trees/court/periodic-orbits", json=wanted).json()["found"]
    assert (orbit["is_right"], orbit["stability"]) == (True, "neutral")
    assert orbit["period"] == pytest.approx(2 * (2 / 9.81) ** 0.5)
    section = {"quantity": "b.z", "level": 0.5, "direction": "falling"}
    unknown = {name: given for name, given in wanted.items() if name not in ("period", "hold")} | {"section": section}
    (again,) = client.post("/v1/trees/court/periodic-orbits", json=unknown).json()["found"]
    assert (again["is_right"], again["q"]) == (True, pytest.approx([0.5]))
    assert again["period"] == pytest.approx(orbit["period"])
    assert {"section", "start"} <= {check["name"] for check in again["checks"]}
    wrong = client.post("/v1/trees/court/periodic-orbits", json=unknown | {"section": section | {"quantity": "b.x"}})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/section/quantity")


def test_a_family_of_orbits(client: TestClient) -> None:
    """x'' + d x' + (1 + 0.2 cos 2t) x = 0 awakes near d = 0.1."""
    joint = {"type": "prismatic", "coordinate": "x", "damping": "d"}
    part = {"name": "mathieu", "bodies": [{"name": "b", "parent": "base", "joint": joint, "mass": 1}]}
    part |= {"parameters": {"d": {"value": 0.2, "unit": "N s/m"}}, "inputs": {"s": {"unit": "N/m"}}}
    part |= {"loads": [{"type": "potential", "potential": "(1 + s)*x^2/2"}]}
    tree = {"name": "shaken", "instances": [{"name": "p", "definition": part}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    wanted = {
        "q": [0],
        "period": pi,
        "inputs": {"p.s": "0.2*cos(2*t)"},
        "vary": "p.d",
        "between": [0.2, 0.05],
        "steps": 3,
    }
    answer = client.post("/v1/trees/shaken/periodic-orbits", json=wanted)
    assert answer.status_code == 200, answer.text
    (met,) = answer.json()["bifurcations"]
    assert (met["kind"], met["at"]["value"]) == ("period-doubling", pytest.approx(0.1, rel=1e-3))
    wrong = client.post("/v1/trees/shaken/periodic-orbits", json=wanted | {"values": [0.1]})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/between")


WRONG = [
    ("simulations", {"q": [0]}, "/span", "missing"),
    ("simulations", {"q": [0, 0, 0], "span": [0, 1]}, "/q", "wrong-length"),
    ("simulations", {"q": [0, 0], "span": [1, 0]}, "/span", "empty-span"),
    ("simulations", {"q": [0, 0], "span": [0, 1], "inputs": {"tau.nobody": 1}}, "/inputs/tau.nobody", "unknown-input"),
    (
        "simulations",
        {"q": [0, 0], "span": [0, 1], "constraints": [{"type": "magic"}]},
        "/constraints/0/type",
        "union-tag-invalid",
    ),
    ("sensitivities", {"q": [0, 0], "span": [0, 1], "by": ["x.nothing"]}, "/by/0", "unknown-parameter"),
    ("linearisations", {"q": [0, 0], "of_inputs": ["tau.nobody"]}, "/of_inputs/0", "unknown-input"),
    ("equilibria", {"count": -1}, "/count", "greater-than-equal"),
    ("root-loci", {"parameter": "nothing", "values": [1], "q": [0, 0]}, "/parameter", "unknown-parameter"),
    ("curvatures", {"q": ["x", 0]}, "/q/0", "number-expected"),
    ("cost-gradients", {"controls": ["u"], "horizon": 1, "intervals": 1, "q": [0, 0]}, "/controls/0", "unknown-input"),
    (
        "optimal-controls",
        {"controls": ["tau.x.q0"], "horizon": -1, "intervals": 1, "q": [0, 0]},
        "/horizon",
        "greater-than",
    ),
    ("loop-states", {"q": [0, 0], "fixed": ["nobody"]}, "/fixed/0", "unknown-coordinate"),
    (
        "periodic-orbits",
        {"q": [0, 1], "period": 1, "events": [{"name": "still", "quantity": "x.q0"}]},
        "/events/0/reset",
        "missing",
    ),
    ("poincare-sections", {"q": [0, 1], "quantity": "x.q9", "duration": 1}, "/quantity", "unknown-name"),
    ("poincare-sections", {"q": [0, 1], "quantity": "x.q1", "duration": 1, "count": 0}, "/count", "greater-than-equal"),
    ("excitations", {"q": [[0, 0]]}, "/qdd", "missing"),
    ("identifications", {"q": [[0, 0]], "qdd": [[0, 0]], "tau": [[1]]}, "/tau", "wrong-length"),
]


@pytest.mark.parametrize(("name", "request_", "pointer", "code"), WRONG)
def test_wrong_requests(client: TestClient, name: str, request_: dict[str, Any], pointer: str, code: str) -> None:
    answer = client.post(f"/v1/trees/cart/{name}", json=request_)
    assert answer.status_code == 422, answer.text
    assert [(error["pointer"], error["code"]) for error in answer.json()["errors"]] == [(pointer, code)]
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


def test_a_field_of_other_simulations_is_named_with_them(client: TestClient) -> None:
    """Not as unknown with a field that there is not, either."""
    body = {"q": [0, 0, 0], "span": [0, 1], "constraints": [{"type": "knife_edge", "name": "e", "frame": "s.sled"}]}
    answer = client.post("/v1/trees/skate/simulations", json=body | {"powers": True})
    assert answer.status_code == 422
    (error,) = answer.json()["errors"]
    assert (error["pointer"], error["code"]) == ("/powers", "extra-forbidden")
    assert "not of those with velocity constraints" in error["message"]
    (error,) = client.post("/v1/trees/skate/simulations", json=body | {"reactions": True}).json()["errors"]
    assert (error["pointer"], error["code"]) == ("/reactions", "not-supported")
    assert "make the constraints part of the tree" in error["message"]
    plain = {"q": [0, 0, 0], "span": [0, 1], "v": [1]}
    (error,) = client.post("/v1/trees/skate/simulations", json=plain).json()["errors"]
    assert error["message"].startswith("'v' is a field of simulations with velocity constraints")
