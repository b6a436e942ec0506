"""The page of motions in a browser: what it plays, plots and tells is what the interface computes."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from .one_store import filled, store
from .test_accessible_pages import faults
from .test_model_pages import Tab, address, browser, in_browser

__all__ = ["address", "browser", "filled", "store"]
SWING: dict[str, Any] = {
    "name": "swing",
    "gravity": [0, "-9.81", 0],
    "instances": [{"name": "arm", "substructure": "pendulum"}],
    "loads": [{"type": "joint", "name": "rub", "coordinate": "arm.q", "force": "-0.3*arm.q'"}],
}
HAND = {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}
LOOP = {
    "name": "loop",
    "gravity": [0, "-9.81", 0],
    "instances": [*SWING["instances"], HAND],
    "closures": [{"name": "rod", "type": "rod", "from": "hand.tip", "to": "world", "length": 1.2}],
}
PLACE = "document.getElementById('place').dataset.{}"
POSE = f"{PLACE.format('pose')}.split(',').map(Number)"
TELLS = "document.getElementById('verdict').textContent.includes('{}')"


@pytest.fixture(scope="module")
def trees(filled: TestClient) -> TestClient:
    """Knows a damped pendulum and a closed loop of two."""
    for tree in (SWING, LOOP):
        answer = filled.post("/v1/trees", json=tree)
        assert answer.status_code == 201, answer.text
    return filled


def opened(browser: Any, address: str, path: str, **options: Any) -> Tab:
    tab = Tab(browser, address, path, **options)
    tab.until(PLACE.format("ready"))
    return tab


def computed(client: TestClient, tree: str, request: Any, **more: Any) -> Any:
    """What the interface answers to what the page has asked for."""
    answer = client.post(f"/v1/trees/{tree}/simulations", json={**request, **more})
    assert answer.status_code == 200, answer.text
    return answer.json()


def ran(tab: Tab) -> Any:
    """The request of a motion that has come."""
    tab.until(PLACE.format("run"))
    tab.until(TELLS.format("finished"))
    return json.loads(tab.page.evaluate(PLACE.format("run")))


@in_browser
@pytest.mark.deep
def test_a_motion_with_inputs_events_and_reactions(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4")
    tab.page.fill("[data-rate='0']", "0.5")
    tab.page.click("#more summary")
    tab.page.fill("[data-input='tau.arm.q']", "2*sin(3*t)")
    tab.page.fill("#events", "arm.q + 1; arm.q' - 1")
    tab.page.select_option("#reactions", "arm.q")
    tab.page.fill("#span", "2")
    tab.page.click("#run")
    request = ran(tab)
    assert (request["q"], request["qd"], request["span"]) == ([0.4], [0.5], [0, 2])
    told = computed(trees, "swing@1", request)
    assert tab.page.locator("#ticks span").count() == len(told["events"]) > 1
    assert f"{len(told['checks'])} of {len(told['checks'])} checks hold" in tab.page.inner_text("#plots")
    titles = " ".join(tab.page.locator(".curves summary").all_inner_texts())
    for words in ("coordinates [rad]", "energies [J]", "drift", "inputs [N m]", "force at arm.q", "moment at arm.q"):
        assert words in titles, titles
    tab.page.click("#happened button >> nth=1")
    shown = tab.page.evaluate(POSE)
    assert shown == pytest.approx(told["events"][1]["q"], abs=1e-6)
    assert "pause" not in tab.page.inner_text("#play")
    again = opened(browser, address, tab.page.url.removeprefix(address))
    assert ran(again) == request, "the address holds the motion"
    assert again.page.evaluate(POSE) == pytest.approx(shown, abs=1e-4), "and its time"
    again.page.check("#stop")
    again.page.click("#run")
    first = told["events"][0]["t"]
    again.until(f"Math.abs(Number(document.getElementById('time').max) - {first}) < 1e-6")
    again.close()
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_contacts_do_is_told_beside_events(browser: Any, address: str, trees: TestClient) -> None:
    """A box without angles that falls to the floor: its motion plays, to its end."""
    joint = {"type": "floating"}
    inertia = dict.fromkeys(("xx", "yy", "zz"), "0.01")
    box = {"name": "box", "parent": "base", "mass": 1, "joint": joint, "inertia": inertia}
    part = {"name": "box", "bodies": [box], "ports": [{"name": "foot", "body": "box", "position": [0, 0, -0.1]}]}
    floor = {"name": "floor", "point": "b.foot", "restitution": 0.5}
    instances = [{"name": "b", "definition": part}]
    made = {"name": "fall", "gravity": [0, 0, "-9.81"], "instances": instances, "contacts": [floor]}
    assert trees.post("/v1/trees", json=made).status_code == 201
    tab = opened(browser, address, "/trees/fall@1/motion?pose=0,0,0.5,1,0,0,0")
    tab.page.click("#more summary")
    tab.page.fill("#events", "b.r_box_z - 0.3")
    tab.page.fill("#span", "0.6")
    tab.page.click("#run")
    events = computed(trees, "fall@1", ran(tab))["events"]
    kinds = [event.get("kind") for event in events]
    assert kinds[:2] == [None, "impact"]
    tab.until("document.querySelectorAll('#happened button').length > 1")
    told = tab.page.locator("#happened button").all_inner_texts()
    assert told[0].startswith("b.r_box_z - 0.3: ")
    assert told[1].startswith("floor: impact: ")
    assert tab.page.locator("#ticks span").count() == len(events)
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_motion_begins_in_the_state_of_the_page_before(browser: Any, address: str, trees: TestClient) -> None:
    tab = Tab(browser, address, "/trees/swing@1")
    tab.until(PLACE.format("view"))
    tab.page.fill("[data-number='0']", "0.4")
    tab.page.fill("[data-rate='0']", "0.5")
    tab.page.click(".parameters summary")
    tab.page.fill("[aria-label='arm.l']", "2")
    tab.page.press("[aria-label='arm.l']", "Enter")
    tab.until("location.search.includes('0.4') && location.search.includes('0.5') && location.search.includes('arm.l')")
    tab.page.click("text=Simulate")
    tab.until(PLACE.format("ready"))
    tab.page.click("#run")
    request = ran(tab)
    assert (request["q"], request["qd"], request["parameters"]) == ([0.4], [0.5], {"arm.l": 2})
    told = computed(trees, "swing@1", request)
    assert told["checks"] != computed(trees, "swing@1", {**request, "parameters": {}})["checks"]
    tab.page.click("#linearise")
    tab.until("document.getElementById('modes').textContent.includes('does not rest')")
    tab.page.click("#modes button")
    tab.until("document.querySelector('#modes table')")
    upright = {"q": [np.pi / 2], "parameters": request["parameters"]}
    modes = trees.post("/v1/trees/swing@1/linearisations", json=upright).json()["modes"]
    assert all(f"{abs(mode['eigenvalue'][0]):.2f}" in tab.page.inner_text("#modes") for mode in modes)
    tab.page.click(".crumbs a >> nth=1")
    tab.until(PLACE.format("view"))
    assert tab.page.input_value("[aria-label='arm.l']") == "2"
    assert tab.page.input_value("[data-rate='0']") == "0.5"
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.usefixtures("trees")
def test_an_emptied_parameter_is_its_default(browser: Any, address: str) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?set=arm.m:,arm.l:3")
    tab.page.click(".parameters summary")
    assert float(tab.page.input_value("[aria-label='arm.m']")) == 2
    assert float(tab.page.input_value("[aria-label='arm.l']")) == 3
    tab.page.fill("[aria-label='arm.l']", "")
    tab.page.press("[aria-label='arm.l']", "Enter")
    assert float(tab.page.input_value("[aria-label='arm.l']")) == 1
    tab.until("!location.search.includes('set=')")
    tab.page.click("#run")
    assert ran(tab)["parameters"] == {}
    tab.close()


@in_browser
@pytest.mark.usefixtures("trees")
def test_warnings_are_no_green_and_power_has_a_unit(browser: Any, address: str) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4&t=0")
    ran(tab)
    assert "power [W]" in tab.page.locator(".curves summary").all_inner_texts()
    assert tab.page.get_attribute("#verdict", "class") == "right"

    def warned(route: Any) -> None:
        answer = route.fetch()
        route.fulfill(response=answer, json={**answer.json(), "warnings": [{"message": "mind the step"}]})

    tab.page.route("**/simulations", warned)
    tab.page.click("#run")
    tab.until(TELLS.format("mind the step"))
    assert tab.page.get_attribute("#verdict", "class") == "warn"
    tab.close()


@in_browser
def test_the_cursor_of_plots_is_the_pose(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4&t=0")
    request = ran(tab)
    box = tab.page.locator(".curves svg >> nth=2").bounding_box()
    tab.page.mouse.click(box["x"] + 0.7 * box["width"], box["y"] + 0.5 * box["height"])
    t = tab.page.evaluate("document.getElementById('time').valueAsNumber")
    assert 3 < t < 4
    tab.until("new URL(location.href).searchParams.get('t') !== '0'")
    at = {name: value for name, value in request.items() if name != "count"}
    told = computed(trees, "swing@1", at, times=[t])
    assert tab.page.evaluate(POSE) == pytest.approx(told["q"][0], abs=1e-6)
    body = {"q": told["q"][0], "qd": told["qd"][0], "quantities": ["kinetic_energy"]}
    kinetic = trees.post("/v1/trees/swing@1/evaluations", json=body).json()["kinetic_energy"]
    shown = tab.page.locator(".curves svg >> nth=2").locator(".key >> nth=0").text_content()
    assert float(shown.removeprefix("kinetic ")) == pytest.approx(kinetic, rel=0.05)  # of the nearest result
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.usefixtures("trees")
def test_it_is_played_once_or_again_and_again(browser: Any, address: str) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4")
    tab.page.fill("#span", "0.6")
    tab.page.click("#run")
    ran(tab)
    tab.page.select_option("#speed", "4")
    time = "document.getElementById('time').valueAsNumber"
    tab.until(f"{time} > 0.4")
    tab.until(f"{time} < 0.3")
    tab.page.uncheck("#loop")
    tab.until(f"{time} === 0.6")
    assert tab.page.inner_text("#play") == "play"
    tab.page.select_option("#speed", "0.1")
    tab.page.click("#play")
    tab.page.wait_for_timeout(500)
    assert 0 < tab.page.evaluate(time) < 0.1
    tab.page.fill("[data-number='0']", "0.9")
    assert tab.page.inner_text("#play") == "play", "who moves a slider sees it"
    tab.until(f"{POSE}[0] === 0.9")
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("width", [1280, 360])
def test_a_motion_of_a_closed_loop(browser: Any, address: str, trees: TestClient, width: int) -> None:
    tab = opened(browser, address, "/trees/loop@1/motion?pose=1.2,-1&t=0.5", width=width)
    request = ran(tab)
    told = computed(trees, "loop@1", {**request, "span": [0, 0.5]}, count=2)
    assert tab.page.evaluate(POSE) == pytest.approx(told["q"][-1], abs=1e-4)
    assert tab.page.locator(".curves[open]").count() >= 3
    assert "multipliers" in tab.page.inner_text("#plots")
    tab.close()


@in_browser
@pytest.mark.deep
def test_modes_and_roots_of_the_nearest_equilibrium(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=-1.2")
    tab.page.click("#linearise")
    tab.page.click("text=Go to the nearest equilibrium")
    tab.page.wait_for_selector("#modes table")
    tab.until(f"Math.abs({POSE}[0] + Math.PI / 2) < 1e-5")
    told = trees.post("/v1/trees/swing@1/linearisations", json={"q": [-np.pi / 2]}).json()
    cells = tab.page.locator("#modes tbody td").all_inner_texts()
    assert float(cells[1].removesuffix(" Hz")) == pytest.approx(told["modes"][0]["hertz"], rel=0.01)
    assert float(cells[2]) == pytest.approx(told["modes"][0]["damping_ratio"], rel=0.01)
    tab.page.click("[aria-label='play mode 1']")
    tab.until(f"{POSE}[0] > -1.5")
    tab.until(f"{POSE}[0] < -1.6")
    tab.page.click("#play")
    tab.page.select_option("[name=parameter]", "arm.l")
    for name, value in (("from", "0.5"), ("to", "3"), ("count", "6")):
        tab.page.fill(f"#locus [name={name}]", value)
    tab.page.click("#locus button")
    tab.page.wait_for_selector("#roots svg")
    assert tab.page.locator("#roots svg > :is(circle, path)").count() == 12
    assert "arm.l from 0.5 (cross) to 3 (circle) m: asymptotically stable" in tab.page.inner_text("#roots")
    assert faults(tab) == []
    tab.page.fill("#locus [name=from]", "")
    tab.page.click("#locus button")
    tab.page.wait_for_selector("#roots .warn")
    tab.wrong = [each for each in tab.wrong if "422" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_all_of_it_comes_as_files(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4&t=1")
    told = computed(trees, "swing@1", ran(tab))

    def saved(selector: str) -> bytes:
        """What a button offers."""
        with tab.page.expect_download() as found:
            tab.page.click(selector)
        return Path(found.value.path()).read_bytes()

    table = np.genfromtxt(io.BytesIO(saved("text=CSV")), delimiter=",", names=True)
    assert table["t"] == pytest.approx(told["t"])
    arrays = np.load(io.BytesIO(saved("text=npz")))
    assert arrays["q"] == pytest.approx(np.array(told["q"]), abs=1e-12)
    assert b"<svg" in saved("text=picture")
    drawn = saved("[aria-label='energies as SVG']").decode()
    assert drawn.startswith("<svg xmlns=")
    assert "rgb(" in drawn
    assert "class=" not in drawn
    tab.close()
