"""M of a tree that was never stored, computed in the browser out of two stored programs, is what the service says."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from substructures.catalogue import load as shipped
from substructures.documents import write_json

from .conftest import PENDULUM
from .one_store import filled, store
from .test_model_pages import READY, Tab, address, browser, in_browser
from .test_workbench import bench

__all__ = ["address", "bench", "browser", "filled", "store"]
ROWS = "[...document.querySelectorAll('#ahead tbody tr')]"
SHOWN = f"{ROWS}.map((row) => [...row.querySelectorAll('a')].map((x) => Number(x.title)))"
JSON = {"Content-Type": "application/json"}
HOSTS = {
    "chain": [("arm", "acrobot", "world"), ("hand", "screw-gripper", "arm.tip")],
    "puma": [("arm", "puma560", "world")],
    "rail": [("cart", "linear-rail", "world")],
}
#: host, where, part; a part with relations, one that hangs on a host with relations, one that does not move, ...
PAIRS = [
    ("puma", "arm.flange", "screw-gripper"),
    *(
        pytest.param(*each, marks=pytest.mark.deep)
        for each in (
            ("puma", "arm.link3", "flange-tool"),
            ("puma", "world", "parallel-gripper"),
            ("chain", "hand.left_pad", "ball-pendulum"),
            ("chain", "hand.grasp", "puma560"),
            ("rail", "cart.mount", "simple-pendulum"),
        )
    ),
]
PLACEMENT = {"position": [0.11, -0.2, 0.3], "rpy": [0.4, -0.7, 1.9]}
FIELDS = ("x", "y", "z", "roll", "pitch", "yaw")


def made(client: TestClient, host: str) -> str:
    """A tree of shipped parts."""
    others = {part for *_, part in (getattr(each, "values", each) for each in PAIRS)}
    for name in {part for _, part, _ in HOSTS[host]} | others:
        assert client.post("/v1/substructures", content=write_json(shipped(name)), headers=JSON).status_code in (
            200,
            201,
        )
    instances = [{"name": name, "substructure": part, "at": at} for name, part, at in HOSTS[host]]
    tree = {"name": f"{host}-host", "gravity": [0, 0, "-9.81"], "instances": instances}
    assert client.post("/v1/trees", json=tree).status_code in (200, 201)
    return f"{host}-host@1"


def until(holds: Callable[[], bool], seconds: float = 20) -> None:
    """Wait until something holds, which it has to."""
    end = time.monotonic() + seconds
    while not holds() and time.monotonic() < end:
        time.sleep(0.05)
    assert holds()


@in_browser
@pytest.mark.parametrize(("host", "at", "part"), PAIRS)
def test_m_before_anything_is_stored(
    browser: Any, address: str, filled: TestClient, host: str, at: str, part: str
) -> None:
    tree = made(filled, host)
    tab = Tab(browser, address, f"/trees/{tree}/edit")
    tab.until(READY)
    form = "[data-action=couplings]"
    values = [*PLACEMENT["position"], *PLACEMENT["rpy"]]
    for name, text in (
        ("substructure", part),
        ("name", "more"),
        ("at", at),
        *zip(FIELDS, map(str, values), strict=True),
    ):
        tab.page.fill(f"{form} [name={name}]", text)
    before = filled.get(f"/v1/trees/{tree}").json()["dof"]
    dof = before + filled.get(f"/v1/substructures/{part}").json()["dof"]
    tab.until(f"document.querySelectorAll('#ahead tbody tr').length === {dof}")
    tab.until(f"document.getElementById('view').dataset.ghost === '{at}'")
    body = {"name": "more", "substructure": part, "at": at, "placement": PLACEMENT}
    stored = filled.post(f"/v1/trees/{tree}/couplings", json=body).json()
    whole = f"{stored['name']}@{stored['revision']}"
    home = filled.get(f"/v1/trees/{whole}/scene").json()["poses"]["home"]
    asked = {"q": home, "quantities": ["metric"]}
    told = np.array(filled.post(f"/v1/trees/{whole}/evaluations", json=asked).json()["metric"])
    until(lambda: np.max(np.abs(np.array(tab.page.evaluate(SHOWN)) - told)) <= 1e-12 * np.max(np.abs(told)))
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_was_not_answered_is_asked_for_again(browser: Any, address: str, filled: TestClient) -> None:
    socket = [{**PENDULUM["ports"][0], "interface": "wide"}]
    for each in ({"name": "socket", "ports": socket}, {"name": "plug", "mount": {"interface": "narrow"}}):
        assert filled.post("/v1/substructures", json={**PENDULUM, **each}).status_code == 201
    tree = {"name": "lost", "instances": [{"name": "arm", "substructure": "socket"}]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    tab = Tab(browser, address, "/trees/lost/edit")
    tab.until(READY)
    lost = "**/v1/substructures/plug/{}"
    for what in ("program.wasm?quantities=*", "definition"):
        tab.page.route(lost.format(what), lambda route: route.fulfill(status=503, json={}), times=1)
    for name, text in (("substructure", "plug"), ("name", "hand"), ("at", "arm.tip")):
        tab.page.fill(f"[data-action=couplings] [name={name}]", text)
    tab.until("document.getElementById('told').textContent.includes('503')")
    tab.page.fill("[data-action=couplings] [name=x]", "0.1")
    tab.until("document.querySelectorAll('#ahead tbody tr').length === 2")
    assert "plug is made for a 'narrow'" in tab.page.inner_text("#ahead")
    tab.wrong = [each for each in tab.wrong if "503" not in each]  # the browser notes answers that are no success
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("what", ["program.wasm", "program.json", "scene"])
def test_a_tree_that_did_not_come_at_first_shows_m_all_the_same(
    browser: Any, address: str, bench: str, what: str
) -> None:
    tab = Tab(browser, address, "/docs")
    tab.page.route(f"**/v1/trees/{bench}@1/{what}", lambda route: route.fulfill(status=503, body="{}"), times=1)
    tab.page.goto(f"{address}/trees/{bench}/edit")
    assert tab.until(READY) == "picture"
    for name, text in (("substructure", "pendulum"), ("name", "hand"), ("at", "arm.tip")):
        tab.page.fill(f"[data-action=couplings] [name={name}]", text)
    tab.until(f"{ROWS}.length === 2")
    tab.wrong = [each for each in tab.wrong if "503" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_m_follows_while_a_part_is_dragged(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit?substructure=pendulum")
    tab.until(READY)
    tab.page.fill("[data-action=couplings] [name=at]", "arm.tip")
    tab.until("document.getElementById('view').dataset.ghost === 'arm.tip'")
    tab.until(f"{ROWS}.length === 2")
    before = tab.page.evaluate(SHOWN)
    given = "['x', 'y', 'z'].map((name) => Number(document.querySelector(`form [name=${name}]`).value))"
    box = tab.page.query_selector("#view canvas").bounding_box()
    for x, y in ((i / 14, j / 14) for j in range(1, 13) for i in range(2, 13)):
        tab.page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
        tab.page.mouse.down()
        tab.page.mouse.move(box["x"] + (x + 0.05) * box["width"], box["y"] + (y + 0.02) * box["height"], steps=4)
        tab.page.mouse.up()
        if any(tab.page.evaluate(given)):
            break
    position = tab.page.evaluate(given)
    assert any(position)
    tab.until(f"JSON.stringify({SHOWN}) !== {json.dumps(json.dumps(before, separators=(',', ':')))}")
    body = {"name": "more", "substructure": "pendulum", "at": "arm.tip", "placement": {"position": position}}
    stored = filled.post(f"/v1/trees/{bench}/couplings", json=body).json()
    asked = {"q": [0, 0], "quantities": ["metric"]}
    told = filled.post(f"/v1/trees/{bench}@{stored['revision']}/evaluations", json=asked).json()["metric"]
    until(lambda: np.allclose(tab.page.evaluate(SHOWN), told, rtol=0, atol=1e-12))
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_part_that_is_made_for_another_port_is_told_before(browser: Any, address: str, filled: TestClient) -> None:
    ports = [{**PENDULUM["ports"][0], "interface": "flange-50"}]
    for part in (
        {**PENDULUM, "name": "flanged", "ports": ports},
        {**PENDULUM, "name": "other", "mount": {"interface": "flange-80"}},
        {**PENDULUM, "name": "fitting", "mount": {"interface": "flange-50"}},
    ):
        assert filled.post("/v1/substructures", json=part).status_code == 201
    tree = {"name": "flanges", "instances": [{"name": "arm", "substructure": "flanged"}]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    tab = Tab(browser, address, "/trees/flanges/edit?substructure=other")
    tab.until(READY)
    tab.page.fill("[data-action=couplings] [name=at]", "arm.tip")
    told = "document.querySelector('#ahead .warn')?.textContent"
    tab.until(f"{told} === \"arm.tip is a 'flange-50', and other is made for a 'flange-80'\"")
    tab.page.fill("[data-action=couplings] [name=substructure]", "fitting")
    tab.until(f"{told} === undefined && {ROWS}.length === 2")
    tab.close()
