"""Pages of trees with quaternions: sliders are places and rotation vectors, numbers those of the interface."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.pages.model.chart import Chart, quaternion, rotation_vector

from .one_store import filled, store
from .test_ball_trees import POSITIONS, TREE
from .test_model_pages import READY, VALUE, address, browser, in_browser
from .test_motion_pages import POSE, computed, opened, ran

__all__ = ["address", "browser", "filled", "store"]
RATES = [f"s.{name}" for name in ("vx", "vy", "vz", "wx", "wy", "wz")]
CHART = Chart((*RATES, "s.spin"), ({"positions": POSITIONS[:-1], "velocities": RATES},))


@pytest.fixture(scope="module")
def trees(filled: TestClient) -> TestClient:
    """Knows a satellite on a wheel, and its part."""
    tree = {**TREE, "gravity": [0, 0, "-0.1"]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    assert filled.post("/v1/substructures", json=TREE["instances"][0]["definition"]).status_code == 201
    return filled


def test_rotation_vectors_are_quaternions_and_back() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        n = rng.normal(size=3)
        for theta in (0.0, 1e-12, 1e-7, 0.3, 2.0, np.pi - 1e-9):
            v = theta * n / np.linalg.norm(n)
            Q = quaternion(v.tolist())  # noqa: N806 -- symbol of the notation
            assert np.linalg.norm(Q) == pytest.approx(1, abs=1e-15)
            np.testing.assert_allclose(rotation_vector(Q), v, rtol=1e-7, atol=1e-15)
            np.testing.assert_allclose(rotation_vector([-x for x in Q]), v, rtol=1e-7, atol=1e-15)
    # a quarter turn about z
    np.testing.assert_allclose(quaternion([0, 0, np.pi / 2]), [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], atol=1e-15)


def test_sliders_are_as_many_as_coordinates() -> None:
    assert CHART.positions == tuple(POSITIONS)
    assert CHART.labels == (*POSITIONS[:3], "s.wx", "s.wy", "s.wz", "s.spin")
    assert json.dumps(CHART.turns) == "[[3, 3, true]]"
    assert CHART.rest == (0, 0, 0, 1, 0, 0, 0, 0)
    values = (1, 2, 3, 0.4, -0.5, 0.6, 7)
    assert CHART.values(CHART.state(values)) == pytest.approx(values, rel=1e-14)


@pytest.mark.parametrize("path", ["/trees/satellite", "/substructures/on-a-wheel"])
def test_without_scripts_the_form_gives_rotation_vectors(trees: TestClient, path: str) -> None:
    """And the address states; numbers are those of the interface."""
    values = (0.0, 0, 0, 0.4, -0.5, 0.6, 0.2)
    state = CHART.state(values)
    for query in ("&".join(f"q={x}" for x in values), f"pose={','.join(map(repr, state))}"):
        page = trees.get(f"{path}?{query}")
        assert page.status_code == 200, page.text
        assert 'value="-0.5' in page.text
        assert f"picture?q={state[0]!r}" in page.text
    wrong = trees.get(f"{path}?pose=0,0,0")
    assert wrong.status_code == 422


@in_browser
def test_numbers_follow_the_sliders(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/satellite?tab=forces&entry=forces,1")
    assert tab.until(READY) == "3d"
    for k, x in ((3, "0.7"), (4, "-0.4"), (1, "0.5")):
        tab.page.fill(f"[data-number='{k}']", x)
    values = [0, 0.5, 0, 0.7, -0.4, 0, 0]
    state = CHART.state(values)
    tab.until("new URL(location.href).searchParams.get('pose')?.split(',')[1] === '0.5'")
    q = [float(x) for x in tab.page.evaluate("new URL(location.href).searchParams.get('pose')").split(",")]
    assert q == pytest.approx(state, abs=1e-15)
    told = trees.post("/v1/trees/satellite/evaluations", json={"q": q, "quantities": ["forces"]}).json()["forces"][1]
    assert told != 0
    tab.until(f"Math.abs(Number({VALUE}) - {told}) <= 1e-12")
    # the plot over a rotation vector
    tab.page.select_option("#plots select >> nth=0", "3")
    tab.until("document.querySelector('#plots polyline') !== null")
    mark = float(tab.page.get_attribute("#plots circle", "cx") or "nan")
    low, high = (float(tab.page.get_attribute("#q3", name) or "nan") for name in ("min", "max"))
    assert (mark - 56) / (480 - 56 - 8) == pytest.approx((0.7 - low) / (high - low), abs=1e-3)
    tab.page.click("#random")
    tab.until("document.querySelectorAll('[data-number]')[3].value !== '0.7'")
    tab.close()


@in_browser
def test_a_motion_is_played_past_a_pitch_of_90_degrees(browser: Any, address: str, trees: TestClient) -> None:
    state = CHART.state([0, 0, 0, 0.1, 1.2, 0.3, 0])
    tab = opened(browser, address, f"/trees/satellite/motion?pose={','.join(map(repr, state))}")
    for k, x in enumerate((0.1, 0, 0.2, 0.3, 1, 0.2, 5)):
        tab.page.fill(f"[data-rate='{k}']", str(x))
    tab.page.fill("#span", "4")
    tab.page.click("#run")
    request = ran(tab)
    assert request["q"] == pytest.approx(state, abs=1e-12)
    times = [0.331, 1.777, 3.9]
    told = computed(trees, "satellite", {name: x for name, x in request.items() if name != "count"}, times=times)
    assert told["is_right"] is True
    for t, expected in zip(times, told["q"], strict=True):
        tab.page.evaluate(f"(() => {{ const bar = document.getElementById('time'); bar.value = {t}; "
                          "bar.dispatchEvent(new Event('input')); })()")  # fmt: skip
        shown = tab.page.evaluate(POSE)
        assert shown == pytest.approx(expected, abs=1e-6)
        assert np.linalg.norm(shown[3:7]) == pytest.approx(1, abs=1e-12)
    kinetic = tab.page.locator(".curves summary", has_text="energies")
    assert kinetic.count() == 1
    tab.close()


@in_browser
@pytest.mark.deep
def test_modes_turn_about_a_state(browser: Any, address: str, trees: TestClient) -> None:
    """A body on a spring about its ball: displacements of a mode are rotation vectors in the axes of the body."""
    ball = {"name": "b", "parent": "base", "mass": 1, "com": [0, 0, -1], "joint": {"type": "ball"},
            "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.3}}  # fmt: skip
    tree = {"name": "hung", "gravity": [0, 0, "-9.81"], "instances": [
        {"name": "x", "definition": {"name": "bob", "bodies": [ball]}}]}  # fmt: skip
    assert trees.post("/v1/trees", json=tree).status_code == 201
    tab = opened(browser, address, "/trees/hung/motion")
    tab.page.click("#linearise")
    tab.until("document.querySelector('#modes table') !== null")
    tab.page.click("[aria-label='play mode 1']")
    tab.until(f"Math.abs({POSE}[0]) < 0.9999")
    assert np.linalg.norm(tab.page.evaluate(POSE)) == pytest.approx(1, abs=1e-9)
    tab.close()
