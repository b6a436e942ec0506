"""The pages of parts and trees in a browser: what they show is what the interface says, and nothing else happens."""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import uvicorn
from fastapi.testclient import TestClient

from service.app import create_app
from service.pages.model import assets
from service.store.store import Store

from .conftest import HAND, PENDULUM, TREE
from .fake_engine import export, submitted
from .one_store import filled, store

__all__ = ["filled", "store"]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
in_browser = pytest.mark.skipif(CHROMIUM is None, reason="Chromium is not installed")
QUICK = ["metric,0,1", "forces,0"]
HOSTILE = "</script><img src=x onerror=alert(1)>\"'{{7*7}}"


@pytest.fixture(scope="module")
def address(filled: TestClient, store: Store) -> Iterator[str]:
    """A server with the tree cell@2, two pendulums, on a port of its own."""
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    assert filled.post("/v1/substructures", json={**PENDULUM, "name": "odd", "title": HOSTILE}).status_code == 201
    server = uvicorn.Server(uvicorn.Config(create_app(store), port=0, log_level="error", ws="none", lifespan="off"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield f"http://localhost:{server.servers[0].sockets[0].getsockname()[1]}"
    server.should_exit = True
    thread.join()


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    api = pytest.importorskip("playwright.sync_api")
    with api.sync_playwright() as playwright:
        flags = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        yield found
        found.close()


class Tab:
    """A page that notes what it must not do: messages, errors, requests to another host."""

    def __init__(self, browser: Any, address: str, path: str, width: int = 1280, **options: Any) -> None:
        self.page = browser.new_page(viewport={"width": width, "height": 800}, **options)
        self.page.set_default_timeout(20_000)
        self.wrong: list[str] = []
        self.page.on("console", lambda message: self.wrong.append(message.text))
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.on("dialog", lambda dialog: self.wrong.append(dialog.message))
        foreign = lambda request: request.url.startswith((address, "blob:")) or self.wrong.append(request.url)  # noqa: E731
        self.page.on("request", foreign)
        self.page.route("**/favicon.ico", lambda route: route.fulfill(status=204))
        self.page.goto(address + path)

    def until(self, script: str) -> Any:
        """The value of an expression as soon as it is one. A policy of the page forbids to wait within it."""
        is_on_its_way = suppress(pytest.importorskip("playwright.sync_api").Error)  # then nothing is there yet
        for _ in range(400):
            with is_on_its_way:
                if found := self.page.evaluate(script):
                    return found
            time.sleep(0.05)
        raise AssertionError(f"{script}; {self.wrong}; {self.page.inner_text('main')[:500]}")

    def close(self) -> None:
        assert self.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        self.page.close()
        assert self.wrong == []


READY = "document.getElementById('place').dataset.view"
VALUE = "document.getElementById('value').textContent"


HERE = "new URL(location.href).searchParams.get('pose')"
FIELDS = "[...document.querySelectorAll('[data-number]')].map((x) => Number(x.value)).join(',')"


def pose_of(tab: Tab) -> list[float]:
    """What the address holds when the slider has rested: what the fields show."""
    tab.until(f"{HERE} === {FIELDS}")
    return [float(x) for x in tab.page.evaluate(HERE).split(",")]


def checked(tab: Tab, client: TestClient, tree: str, entries: list[str]) -> None:
    """Every entry has the value of the interface after the keyboard has moved a slider."""
    for entry in entries:
        quantity, *index = entry.split(",")
        tab.page.evaluate(f"document.querySelector('.tabs [data-tab={quantity}]').click()")
        tab.until(f"document.querySelector('#grid table').dataset.quantity === '{quantity}'")
        tab.page.evaluate(f"document.querySelector('[data-entry=\"{entry}\"]').click()")
        tab.until(f"document.getElementById('entry').dataset.entry === '{entry}'")
        tab.page.focus("#q1")
        for key in ("ArrowRight", "ArrowRight", "PageDown"):
            tab.page.keyboard.press(key)
        q = pose_of(tab)
        told = client.post(f"/v1/trees/{tree}/evaluations", json={"q": q, "quantities": [quantity]}).json()[quantity]
        expected = np.array(told)[tuple(map(int, index))]
        tab.until(f"Math.abs(Number({VALUE}) - {expected}) <= {1e-12 + 1e-9 * abs(expected)}")


@in_browser
@pytest.mark.parametrize("width", [1280, *[pytest.param(360, marks=pytest.mark.deep)]])
def test_numbers_after_keyboard_moves(browser: Any, address: str, filled: TestClient, width: int) -> None:
    tab = Tab(browser, address, "/trees/cell@2", width)
    assert tab.until(READY) == "3d"
    checked(tab, filled, "cell@2", QUICK)
    share = "getComputedStyle(document.querySelector('.terms .bar-of')).getPropertyValue('--share')"
    tab.until(f"{share} !== ''")
    tab.until("document.querySelector('#plots polyline') !== null")
    tab.close()


@in_browser
@pytest.mark.deep
def test_first_integrals_are_a_tab(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/trees/cell@1?pose=0.3")
    tab.until(READY)
    tab.page.click("[data-tab=first_integrals]")
    tab.page.click("[data-entry='first_integrals,0']")
    tab.until("document.getElementById('entry').dataset.entry === 'first_integrals,0'")
    assert "energy" in tab.page.inner_text("#entry h2")
    tab.page.fill("[data-rate='0']", "1.5")
    request = {"q": [0.3], "qd": [1.5], "quantities": ["kinetic_energy", "potential_energy"]}
    told = filled.post("/v1/trees/cell@1/evaluations", json=request).json()
    energy = told["kinetic_energy"] + told["potential_energy"]
    tab.until(f"Math.abs(Number({VALUE}) - {energy}) < 1e-9")
    tab.close()


def test_first_integrals_without_scripts(filled: TestClient) -> None:
    page = filled.get("/trees/cell@1?tab=first_integrals").text
    assert 'data-entry="first_integrals,0"' in page
    assert "all forces have a potential" in page
    page = filled.get("/trees/cell@1?entry=first_integrals,0&pose=0.3").text
    told = filled.post("/v1/trees/cell@1/evaluations", json={"q": [0.3], "quantities": ["potential_energy"]}).json()
    assert repr(told["potential_energy"])[:12] in page
    assert filled.get("/trees/cell@1/entry?entry=first_integrals,9").status_code == 422
    assert filled.get("/substructures/pendulum/entry?entry=first_integrals,0").status_code == 404


def test_first_screens_are_kept_for_each_reference(filled: TestClient) -> None:
    """Also for revisions with one content: a change that was taken back."""
    assert filled.post("/v1/trees", json={**TREE, "name": "cell-too"}).status_code == 201
    assert filled.post("/v1/trees/cell-too/couplings", json=HAND).status_code == 201
    assert filled.delete("/v1/trees/cell-too/couplings/hand").status_code in (200, 201)
    digests = [filled.get(f"/v1/trees/cell-too@{number}").json()["digest"] for number in (1, 3)]
    assert digests[0] == digests[1]
    pages = {number: filled.get(f"/trees/cell-too@{number}").text for number in (1, 3)}
    for number, other in ((1, 3), (3, 1)):
        assert f"/trees/cell-too@{number}?entry=" in pages[number]
        assert f"/trees/cell-too@{other}?entry=" not in pages[number]
        assert f'action="/trees/cell-too@{other}"' not in pages[number]
    assert 'value="0.25"' in filled.get("/trees/cell@1?pose=0.25").text
    assert 'value="0.25"' not in filled.get("/trees/cell@1").text


@in_browser
def test_a_motion_is_the_trajectory(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/trees/cell@2/motion?pose=0.3,-0.8&t=1.25")
    tab.until("document.getElementById('place').dataset.ready")
    request = json.loads(tab.page.evaluate("document.getElementById('place').dataset.run"))
    assert request["q"] == [0.3, -0.8]
    asked = {**{name: x for name, x in request.items() if name != "count"}, "times": [1.25]}
    told = filled.post("/v1/trees/cell@2/simulations", json=asked)
    assert told.status_code == 200, told.text
    shown = [float(x) for x in tab.page.evaluate("document.getElementById('place').dataset.pose").split(",")]
    assert shown == pytest.approx(told.json()["q"][0], abs=1e-6)
    assert "right" in tab.page.inner_text("#verdict")
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_with_hostile_words_stay_silent(browser: Any, address: str, scheme: str) -> None:
    for width in (1280, 360):
        for path in ("/substructures/odd", "/trees/cell@2", "/trees/cell@1/motion"):
            tab = Tab(browser, address, path, width, color_scheme=scheme)
            tab.until(READY)
            tab.close()


@in_browser
@pytest.mark.deep
def test_a_view_without_a_graphics_card_is_sharp_at_rest(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2")
    tab.until(READY)
    pixels = "(({ width, clientWidth }) => width / clientWidth)(document.querySelector('.view canvas'))"
    tab.until(f"{pixels} === 2")
    tab.page.focus("#q1")
    tab.page.keyboard.press("ArrowRight")
    tab.until(f"{pixels} === 1")
    tab.until(f"{pixels} === 2")
    tab.close()


@in_browser
@pytest.mark.deep
def test_poses_at_the_limits(browser: Any, address: str, filled: TestClient) -> None:
    joint = {"type": "revolute", "coordinate": "q", "limits": [-0.5, 1.25]}
    body = {**PENDULUM["bodies"][0], "joint": joint}
    assert filled.post("/v1/substructures", json={**PENDULUM, "name": "limited", "bodies": [body]}).status_code == 201
    tab = Tab(browser, address, "/substructures/limited@1", 360)
    tab.until(READY)
    for name, value in (("lower limits", -0.5), ("upper limits", 1.25)):
        tab.page.click(f"[data-pose='{name}']")
        tab.until(f"{HERE} === '{value}'")
    tab.page.fill("[data-number='0']", "1e200")  # which no address of the page may have
    tab.page.wait_for_timeout(300)
    assert tab.page.evaluate(HERE) == "1.25"
    tab.page.click(".jumps a:has-text('about')")
    assert tab.page.evaluate("document.getElementById('about').getBoundingClientRect().top < innerHeight / 2")
    tab.close()


@in_browser
@pytest.mark.deep
def test_parameters_that_differ_come_first_and_count(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/trees/cell@2?entry=metric,1,1&pose=0.3,0.4")
    tab.until(READY)
    tab.page.evaluate("document.querySelector('.parameters').open = true")
    tab.page.fill("[aria-label='hand.l']", "2")
    tab.page.press("[aria-label='hand.l']", "Tab")
    request = {"q": [0.3, 0.4], "parameters": {"hand.l": 2}, "quantities": ["metric"]}
    told = filled.post("/v1/trees/cell@2/evaluations", json=request).json()["metric"][1][1]
    tab.until(f"Math.abs(Number({VALUE}) - {told}) < 1e-9")
    assert tab.page.inner_text("#parameters tr:first-child code") == "hand.l"
    tab.page.click("#reset")
    tab.until("document.getElementById('changed').textContent === ''")
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_reload_shows_the_same(browser: Any, address: str, filled: TestClient) -> None:
    """Pose, rates, parameters, tab and entry; and the eigenvalues are those of the parameters, too."""
    request = {"q": [0.3, 0.4], "parameters": {"hand.l": 2}, "quantities": ["metric"]}
    metric = filled.post("/v1/trees/cell@2/evaluations", json=request).json()["metric"]
    tab = Tab(browser, address, "/trees/cell@2?entry=metric,1,1&pose=0.3,0.4")
    tab.until(READY)
    tab.page.evaluate("document.querySelector('.parameters').open = true")
    tab.page.fill("[data-rate='0']", "2")
    tab.page.fill("[aria-label='hand.l']", "2")
    tab.page.press("[aria-label='hand.l']", "Tab")
    shown = [float(x) for x in tab.until("document.getElementById('eigenvalues').textContent").split(", ")]
    np.testing.assert_allclose(shown, np.linalg.eigvalsh(metric), rtol=5e-3)
    tab.page.click(".tabs [data-tab=forces]")
    tab.until("new URL(location.href).searchParams.get('qd') && document.querySelector('[data-quantity=forces]')")
    all_of_it = (
        "[...document.querySelectorAll('#grid, #value, #changed, #eigenvalues')].map((x) => x.textContent).join()"
    )
    before = tab.page.evaluate(all_of_it)
    tab.page.reload()
    tab.until(READY)
    assert tab.page.evaluate(all_of_it) == before
    assert tab.page.input_value("[data-rate='0']") == "2"
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_was_chosen_last_is_shown_whatever_comes_last(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2")
    tab.until(READY)
    held: list[Any] = []
    for slow in ("**/entry?*", "**/grid?tab=forces*"):
        tab.page.route(slow, lambda route: held.append(route))
    tab.page.click("[data-entry='metric,0,0']")
    tab.page.click("[data-entry='metric,1,1']")
    tab.page.click(".tabs [data-tab=forces]")
    tab.page.click(".tabs [data-tab=christoffel]")
    tab.until("document.querySelector('#grid table').dataset.quantity === 'christoffel'")
    for each in held:
        each.continue_()
        tab.page.wait_for_timeout(300)
    assert tab.page.evaluate("document.getElementById('entry').dataset.entry") == "metric,1,1"
    assert tab.page.evaluate("document.querySelector('#grid table').dataset.quantity") == "christoffel"
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_does_not_come_is_told(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2?entry=metric,1,1")
    tab.until(READY)
    for lost in ("**/entry?*", "**/grid?*"):
        tab.page.route(lost, lambda route: route.abort())
    tab.page.click("[data-entry='metric,0,0']")
    tab.until("document.querySelector('#entry .warn')?.textContent.includes('the connection is lost')")
    tab.page.click(".tabs [data-tab=forces]")
    tab.until("document.querySelector('#grid.warn')?.textContent.includes('the connection is lost')")
    tab.wrong = [each for each in tab.wrong if "ERR_FAILED" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_results_are_removed_when_somebody_is_sure(browser: Any, address: str, filled: TestClient) -> None:
    job = submitted(filled, export("cell", "metric"))
    assert filled.post(f"/v1/jobs/{job}/cancel").status_code == 200
    page = browser.new_page()
    page.goto(f"{address}/jobs/{job}")
    for act, status in (("dismiss", 200), ("accept", 404)):
        page.once("dialog", lambda dialog, act=act: getattr(dialog, act)())
        with page.expect_event("dialog"):
            page.get_by_role("button", name="Remove").click()
        if act == "accept":
            page.wait_for_url("**/jobs")
        assert filled.get(f"/v1/jobs/{job}").status_code == status
    page.close()


@in_browser
@pytest.mark.deep
def test_without_scripts_there_are_links_and_a_form(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2", java_script_enabled=False)
    tab.page.fill("[name=q] >> nth=0", "0.5")
    tab.page.click("#send")
    tab.page.click("[data-entry='metric,0,0']")
    assert "kg m²" in tab.page.inner_text("#entry")
    tab.page.close()


def test_the_built_script_is_the_one_of_the_manifest() -> None:
    digest, name = (assets.FOLDER / "view.sha256").read_text().split()
    assert hashlib.sha256((assets.FOLDER / name).read_bytes()).hexdigest() == digest
    assert (assets.FOLDER / name).read_bytes().startswith(b"/* three.js")


@pytest.mark.deep
def test_the_built_script_is_built_of_its_source(tmp_path: Path) -> None:
    """Needs Node and a registry of packages; without one it says so."""
    npm, node = shutil.which("npm"), shutil.which("node")
    if npm is None or node is None:
        pytest.skip("Node is not installed")
    source = tmp_path / "source"
    shutil.copytree(assets.FOLDER.with_name("source"), source, ignore=shutil.ignore_patterns("node_modules"))
    if subprocess.run([npm, "ci", "--ignore-scripts"], cwd=source, check=False, capture_output=True).returncode:
        pytest.skip("its packages cannot be had")
    subprocess.run([node, "build.mjs", str(tmp_path)], cwd=source, check=True)
    assert (tmp_path / "view.js").read_bytes() == (assets.FOLDER / "view.js").read_bytes()
