"""The catalogue in a browser: results while one types, facets, the address, and files that are looked at first."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from .one_store import filled, store
from .test_model_pages import Tab, address, browser, in_browser
from .test_requested import ROBOT

__all__ = ["address", "browser", "filled", "store"]
TEXT = "document.getElementById('results').textContent"
HOSTILE = ROBOT.replace("</robot>", '<gazebo reference="&lt;img src=x onerror=alert(1)&gt;"/></robot>')


def chosen(tab: Tab, text: str, name: str) -> None:
    """A file that somebody chose, or dropped."""
    tab.page.set_input_files("#file", {"name": name, "mimeType": "application/xml", "buffer": text.encode()})


@in_browser
@pytest.mark.parametrize("width", [1280, *[pytest.param(360, marks=pytest.mark.deep)]])
def test_results_follow_what_is_typed(browser: Any, address: str, width: int) -> None:
    tab = Tab(browser, address, "/", width)
    tab.page.keyboard.press("/")
    tab.page.keyboard.type("slidng")
    tab.until(f"{TEXT}.includes('slider@1') && !{TEXT}.includes('pendulum@1') && location.search === '?q=slidng'")
    assert "'slidng' is nowhere" in tab.page.inner_text("#results")
    tab.page.fill("#filter", "")
    tab.until(f"{TEXT}.includes('pendulum@1') && location.search === ''")
    tab.page.click(".facets a[href='/?joints=P']")
    tab.until(f"!{TEXT}.includes('pendulum@1') && location.search === '?joints=P'")
    tab.page.select_option("[name=sort]", "-created")
    tab.until("location.search === '?sort=-created&joints=P'")
    tab.page.go_back()
    tab.until(f"{TEXT}.includes('pendulum@1') && location.search === ''")
    tab.close()


@in_browser
def test_a_file_is_looked_at_before_it_is_stored(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/")
    chosen(tab, ROBOT, "rod.urdf")
    tab.until("document.querySelector('#import img')?.naturalWidth > 0")
    shown = tab.page.inner_text("#import")
    assert "urdf: 1 dof R, 2 kg" in shown
    assert "Nothing is stored yet." in shown
    assert filled.get("/v1/substructures/rod").status_code == 404
    tab.page.fill("#name", "bar")
    tab.page.click("#store")
    tab.until("document.querySelector('#import a')?.textContent === 'bar@1'")
    assert filled.get("/v1/substructures/bar@1").json()["dof"] == 1
    chosen(tab, "<robot/>", "bad.urdf")
    tab.until("document.getElementById('import').textContent.includes('cannot be stored')")
    tab.wrong = [each for each in tab.wrong if "422" not in each]  # the browser notes answers that are no success
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_part_begins_a_tree_and_is_coupled_onto_one(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/?q=slider")
    tab.page.click("a:has-text('+ to tree')")
    tab.page.wait_for_selector("#begin button:enabled")
    tab.page.fill("[name=name]", "cell")
    tab.page.keyboard.press("Enter")
    tab.until("document.getElementById('told').textContent === \"there is a tree 'cell': choose another name\"")
    assert filled.get("/v1/trees/cell").json()["dof"] == 2
    tab.wrong = [each for each in tab.wrong if "412" not in each]
    tab.page.fill("[name=name]", "begun")
    tab.page.keyboard.press("Enter")
    tab.page.wait_for_url("**/trees/begun@1/edit")
    assert filled.get("/v1/trees/begun").json()["coordinates"] == ["slider.x"]
    tab.page.goto(f"{address}/trees?q=begun&part=pendulum")
    tab.page.click("a:has-text('begun@1')")
    tab.page.wait_for_selector("#place[data-view]")
    tab.page.fill("[data-action=couplings] [name=at]", "slider.top")
    tab.until("document.querySelectorAll('#ahead tbody tr').length === 2")
    tab.page.click("[data-action=couplings] button")
    tab.page.wait_for_url("**/trees/begun@2/edit*")
    tab.page.wait_for_selector("#place[data-view]")
    tab.page.keyboard.press("/")
    assert tab.page.evaluate("document.activeElement.id") == "find"
    tab.page.keyboard.type("pendulum")
    tab.page.keyboard.press("Enter")
    tab.page.wait_for_url("**/?q=pendulum")
    tab.wrong = [each for each in tab.wrong if "404" not in each]  # the browser notes that a name was free
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_file_is_stored_for_its_owner_alone(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/")
    chosen(tab, ROBOT, "hidden.urdf")
    tab.until("document.getElementById('store')")
    tab.page.fill("#name", "hidden")
    tab.page.select_option("#visibility", "private")
    tab.page.click("#store")
    tab.until("document.querySelector('#import a')?.textContent === 'hidden@1'")
    assert filled.get("/v1/substructures/hidden/visibility").json()["visibility"] == "private"
    tab.close()


@in_browser
@pytest.mark.deep
def test_hostile_files_stay_texts(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/", 360)
    chosen(tab, HOSTILE, "<img src=x onerror=alert(1)>.urdf")
    tab.until("document.querySelector('#import img')")
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_lost_connection_is_said_and_comes_back(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/")
    tab.page.context.set_offline(True)
    tab.page.fill("#filter", "slider")
    tab.until("document.querySelector('#results .warn')?.textContent.includes('connection is lost')")
    tab.page.context.set_offline(False)
    tab.page.fill("#filter", "sliding")
    tab.until(f"{TEXT}.includes('slider@1') && !{TEXT}.includes('pendulum@1')")
    tab.wrong = [each for each in tab.wrong if "ERR_INTERNET_DISCONNECTED" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_could_not_be_stored_can_be_stored_again(browser: Any, address: str, filled: TestClient) -> None:
    tab = Tab(browser, address, "/")
    chosen(tab, ROBOT, "rod.urdf")
    tab.until("document.getElementById('store')")
    tab.page.fill("#name", "mended")
    tab.page.route("**/v1/imports?*store=true*", lambda route: route.abort(), times=1)
    for words in ("cannot be stored", "Stored as mended@1"):
        tab.page.click("#store")
        tab.until(f"document.getElementById('import').textContent.includes('{words}')")
    assert filled.get("/v1/substructures/mended@1").status_code == 200
    tab.wrong = [each for each in tab.wrong if "ERR_FAILED" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_of_two_files_the_last_one_is_shown(browser: Any, address: str) -> None:
    """Whichever is read first."""
    tab = Tab(browser, address, "/")
    tab.page.route("**/v1/imports?file=slow*", lambda route: (tab.page.wait_for_timeout(1500), route.continue_()))
    chosen(tab, ROBOT.replace("rod", "slow"), "slow.urdf")
    chosen(tab, ROBOT, "quick.urdf")
    tab.until("document.querySelector('#import img')?.alt === 'Picture of quick.urdf'")
    tab.page.wait_for_timeout(2500)
    assert tab.page.get_attribute("#import img", "alt") == "Picture of quick.urdf"
    tab.close()
