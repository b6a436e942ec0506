"""Everybody can read every page: axe finds nothing serious, in light and in dark, and none scrolls sideways."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

import pytest
from fastapi.testclient import TestClient

from .conftest import PENDULUM
from .fake_engine import export, submitted
from .one_store import filled, store
from .test_model_pages import READY, Tab, address, browser, in_browser

__all__ = ["address", "browser", "filled", "store"]
#: paths, and whether a view in three dimensions is awaited
PATHS = {
    "/": False,
    "/?q=pendulum": False,
    "/trees": False,
    "/jobs": False,
    "/docs": False,
    "/docs/explanation/notation": False,
    "/docs/interface": False,
    "/account": False,
    "/substructures/pendulum@1": True,
    "/trees/cell@2?entry=metric,0,1&pose=0.3,-0.8": True,
    "/trees/cell@2/motion?pose=0.3,-0.8&t=1.25": True,
    "/trees/cell@2/edit": True,
    "/trees/cell@1/difference?to=cell@2": False,
    "/v1/trees/cell@2/report?format=mathml": False,
}


def faults(tab: Tab) -> list[str]:
    """What axe finds that is serious or critical, with the first element."""
    pytest.importorskip("axe_playwright_python")
    tab.page.evaluate(files("axe_playwright_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    told = tab.page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [f"{v['id']}: {v['nodes'][0]['html'][:200]}" for v in told if v["impact"] in ("serious", "critical")]


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("width", [1280, 360])
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("path", PATHS)
def test_axe_finds_nothing_serious(browser: Any, address: str, path: str, scheme: str, width: int) -> None:
    tab = Tab(browser, address, path, width, color_scheme=scheme)
    if PATHS[path]:
        tab.until(READY)
    assert faults(tab) == []
    tab.close()


@in_browser
@pytest.mark.deep
def test_long_formulas_of_a_difference_are_broken(browser: Any, address: str, filled: TestClient) -> None:
    body = {**PENDULUM["bodies"][0], "mass": "m" + "*1.0000001" * 20}
    answer = filled.post("/v1/substructures", json={**PENDULUM, "name": "long", "bodies": [body]})
    assert answer.status_code == 201, answer.text
    Tab(browser, address, "/substructures/pendulum@1/difference?to=long", 390).close()


@in_browser
@pytest.mark.deep
def test_phones_show_how_far_jobs_are(browser: Any, address: str, filled: TestClient) -> None:
    submitted(filled, export("cell", "metric"))
    tab = Tab(browser, address, "/jobs", 360)
    bar = tab.page.locator(".share").first.bounding_box()
    assert bar is not None
    assert bar["width"] > 70
    assert bar["x"] + bar["width"] <= 360
    assert faults(tab) == []
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("path", ["/jobs", "/docs", "/trees/cell@2", "/v1/trees/cell@2/report?format=mathml"])
def test_a_page_that_is_loaded_again_is_what_it_was(browser: Any, address: str, path: str) -> None:
    """Its style, its scripts and its policy, which the browser has, and the server says so."""
    page, wrong = browser.new_page(), list[str]()  # what a Tab intercepts is not kept by the browser
    page.on("console", lambda message: wrong.append(message.text))
    page.goto(address + path)
    colour = "getComputedStyle(document.querySelector('a')).color"
    before = page.evaluate(colour)
    for _ in range(2):
        page.reload()
        assert page.evaluate(colour) == before
    page.close()
    assert wrong == []


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("path", ["/jobs", "/trees/cell@2"])
def test_paper_is_white(browser: Any, address: str, path: str) -> None:
    """Light letters of the dark scheme would not be seen on it."""
    tab = Tab(browser, address, path, color_scheme="dark")
    ground = "getComputedStyle(document.documentElement).getPropertyValue('--page').trim()"
    assert tab.page.evaluate(ground) == "#14171a"
    tab.page.emulate_media(media="print", color_scheme="dark")
    assert tab.page.evaluate(ground) == "#fff"
    tab.close()


@in_browser
@pytest.mark.deep
def test_axe_finds_a_planted_fault(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/jobs")
    tab.page.evaluate("document.querySelector('main').append(document.createElement('button'))")
    assert [each.partition(":")[0] for each in faults(tab)] == ["button-name"]
    tab.close()
