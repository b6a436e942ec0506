"""The workbench in a browser: what is done by hand is what the interface does, and can be undone to the digest."""

from __future__ import annotations

import json
import subprocess
from typing import Any

import pytest
from fastapi.testclient import TestClient

from .one_store import filled, store
from .test_accessible_pages import faults
from .test_model_pages import READY, Tab, address, browser, in_browser

__all__ = ["address", "browser", "filled", "store"]


@pytest.fixture
def bench(filled: TestClient, request: pytest.FixtureRequest) -> str:
    """A tree of one pendulum of its own name."""
    name = f"bench-{abs(hash(request.node.name)) % 10**8}"
    tree = {"name": name, "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "pendulum"}]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    return name


def digest(client: TestClient, reference: str) -> str:
    found: str = client.get(f"/v1/trees/{reference}").json()["digest"]
    return found


def arrived(tab: Tab, path: str) -> None:
    tab.page.wait_for_url(f"**{path}*")
    tab.page.wait_for_selector("#place[data-view]")


def typed(tab: Tab, *fields: str) -> None:
    """Fields one after the other, by the keyboard alone."""
    for text in fields:
        tab.page.keyboard.press("Control+A")
        tab.page.keyboard.type(text)
        tab.page.keyboard.press("Tab")


@in_browser
def test_coupled_by_keyboard_undone_and_done_again(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    assert tab.until(READY) == "3d"
    tab.page.focus("[data-action=couplings] [name=substructure]")
    typed(tab, "pendulum", "hand", "arm.tip", "0.1")
    tab.until("document.getElementById('view').dataset.ghost === 'arm.tip'")
    request = tab.page.evaluate("document.querySelector('[data-request=curl]').textContent")
    tab.page.keyboard.press("Enter")
    arrived(tab, f"/trees/{bench}@2/edit")
    placement = {"position": [0.1, 0, 0], "rpy": [0, 0, 0]}
    other = {"name": "hand", "substructure": "pendulum", "at": "arm.tip", "placement": placement}
    assert json.loads(request.partition("-d '")[2][:-1]) == other
    first, made = digest(filled, f"{bench}@1"), digest(filled, f"{bench}@2")
    assert filled.post(f"/v1/trees/{bench}@1/couplings", json=other).json()["digest"] == made
    shown = tab.page.inner_text("#changed")
    assert "degrees of freedom\t1\t2" in shown
    assert "operations of metric" in shown
    tab.page.focus("#undo")
    tab.page.keyboard.press("Enter")
    arrived(tab, f"/trees/{bench}@4/edit")
    assert digest(filled, bench) == first
    tab.page.click("#redo")
    arrived(tab, f"/trees/{bench}@5/edit")
    assert digest(filled, bench) == made
    tab.close()


@in_browser
def test_frames_are_picked_for_loads_and_loops(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    tab.page.click("summary:has-text('Add a load')")
    tab.page.fill("[data-action=loads] [name=name]", "pull")
    tab.page.focus("[data-action=loads] [name=from]")
    tab.page.click("[data-frame='world']")
    tab.page.click("[data-frame='arm.tip']")
    tab.page.fill("[data-action=loads] [name=stiffness]", "20")
    tab.page.click("[data-action=loads] button")
    arrived(tab, f"/trees/{bench}@2/edit")
    told = filled.get(f"/v1/trees/{bench}").json()["loads"]
    assert [(x["type"], x["to"], x["stiffness"]) for x in told] == [("spring", "arm.tip", 20)]
    tab.page.click("[aria-label='remove pull']")
    arrived(tab, f"/trees/{bench}@3/edit")
    assert digest(filled, bench) == digest(filled, f"{bench}@1")
    tab.page.click("summary:has-text('Close a loop')")
    tab.page.fill("[data-action=closures] [name=name]", "rod")
    tab.page.select_option("[data-action=closures] [name=type]", "rod")
    tab.page.fill("[data-action=closures] [name=from]", "arm.tip")
    tab.page.fill("[data-action=closures] [name=length]", "1.5")
    tab.page.click("[data-action=closures] button")
    arrived(tab, f"/trees/{bench}@4/edit")
    (told,) = filled.get(f"/v1/trees/{bench}").json()["closures"]
    assert (told["name"], told["type"], told["from"]) == ("rod", "rod", "arm.tip"), told
    tab.close()


@in_browser
def test_parameters_and_gravity_by_hand(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    """What is given shows in the outline and in the fields, to the last digit; an empty field is the default again."""
    hand = {"name": "hand", "substructure": "pendulum", "at": "arm.tip", "parameters": {"l": "0.12345678901234567890"}}
    assert filled.post(f"/v1/trees/{bench}/couplings", json=hand).status_code == 201
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    tab.page.click("summary:has-text('Set parameters')")
    form = "form:has(fieldset[data-type='hand'])"
    tab.page.select_option(f"{form} [name=instance]", "hand")
    assert tab.page.input_value(f"{form} [data-type=hand] [name=l]") == "0.12345678901234567890"
    assert tab.page.get_attribute(f"{form} [data-type=hand] [name=m]", "placeholder") == "2"
    tab.page.focus(f"{form} [data-type=hand] [name=m]")
    tab.page.keyboard.type("750 g")
    told = tab.page.evaluate("document.querySelector('[data-request=Python]').textContent")
    assert f'change_coupling("{bench}@2", "hand", **{{"parameters":' in told
    tab.page.keyboard.press("Enter")
    arrived(tab, f"/trees/{bench}@3/edit")
    given = filled.get(f"/v1/trees/{bench}").json()["instances"][1]["parameters"]
    assert given == {"l": "0.12345678901234567890", "m": {"unit": "g", "value": "750"}}
    assert "m = 750 g" in tab.page.inner_text("#outline")
    tab.page.click("summary:has-text('Set parameters')")
    tab.page.select_option(f"{form} [name=instance]", "hand")
    for name in ("l", "m"):
        tab.page.fill(f"{form} [data-type=hand] [name={name}]", "")
    assert faults(tab) == []
    tab.page.click(f"{form} button")
    arrived(tab, f"/trees/{bench}@4/edit")
    assert not filled.get(f"/v1/trees/{bench}").json()["instances"][1].get("parameters")
    tab.page.click("summary:has-text('Set gravity')")
    assert tab.page.input_value("[name=gravity]") == "0, 0, -9.81"
    tab.page.fill("[name=gravity]", "0, -1.62 m/s^2, 0")
    python = tab.page.evaluate("document.querySelector('[data-request=Python]').textContent")
    assert f'change_tree("{bench}@4", **{{"gravity":' in python
    tab.page.click("button:has-text('Set gravity')")
    arrived(tab, f"/trees/{bench}@5/edit")
    assert filled.get(f"/v1/trees/{bench}").json()["gravity"] == [0, {"unit": "m/s^2", "value": "-1.62"}, 0]
    assert "gravity 0, -1.62 m/s^2, 0" in tab.page.inner_text("#outline")
    tab.close()


def test_a_tree_without_instances_has_a_workbench(filled: TestClient) -> None:
    assert filled.post("/v1/trees", json={"name": "bare", "instances": []}).status_code == 201
    page = filled.get("/trees/bare/edit")
    assert page.status_code == 200
    assert "Couple a part" in page.text


@in_browser
@pytest.mark.deep
def test_what_to_do_is_told_where_a_gateway_answers_or_a_tree_is_gone(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    """No sentence about JSON, nor a number alone."""
    tab, tree = Tab(browser, address, f"/trees/{bench}/edit"), Tab(browser, address, f"/trees/{bench}@1")
    tab.until(READY)
    tree.until(READY)
    gateway = lambda route: route.fulfill(status=502, body="<html>Bad gateway</html>", content_type="text/html")  # noqa: E731
    tab.page.route(f"**/v1/trees/{bench}@1", gateway)
    tab.page.click("summary:has-text('Set gravity')")
    tab.page.click("button:has-text('Set gravity')")
    tab.until("document.getElementById('told').textContent.includes('see whether the server runs')")
    assert filled.delete(f"/v1/trees/{bench}").status_code == 204
    tree.page.click(".tabs [data-tab=christoffel]")
    tree.until("document.getElementById('grid').textContent.includes('it is there no more')")
    for each in (tab, tree):
        each.wrong = [text for text in each.wrong if "502" not in text and "404" not in text]
        each.close()


@in_browser
@pytest.mark.deep
def test_loads_of_every_type_by_hand(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    form = "[data-action=loads]"
    sent: list[dict[str, Any]] = [
        {"type": "cable", "along": ["world", "arm.tip"], "stiffness": 30, "slack": True},
        {"type": "force", "from": "world", "to": "arm.tip", "vector": [0, "2*sin(arm.q)", 1], "axes": "world"},
        {"type": "joint", "coordinate": "arm.q", "force": "-3*arm.q"},
        {"type": "friction", "coordinate": "arm.q", "coulomb": 0.2, "velocity": 0.01},
    ]
    for k, load in enumerate(sent):
        tab.until(READY)
        tab.page.click("summary:has-text('Add a load')")
        tab.page.fill(f"{form} [name=name]", f"load{k}")
        tab.page.select_option(f"{form} [name=type]", load["type"])
        fields = f"{form} fieldset:not([hidden]) "
        for name, value in load.items():
            if name == "along":
                tab.page.focus(f"{fields}[name=along]")
                for frame in value:
                    tab.page.click(f"[data-frame='{frame}']")
            elif name in ("axes", "coordinate"):
                tab.page.select_option(f"{fields}[name={name}]", value)
            elif value is True:
                tab.page.check(f"{fields}[name={name}]")
            elif name != "type":
                text = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
                tab.page.fill(f"{fields}[name={name}]", text)
        python = tab.page.evaluate("document.querySelector('[data-request=Python]').textContent")
        assert eval(python.partition("load(")[2].removesuffix("))"))[1] == {"name": f"load{k}", **load}  # noqa: S307
        tab.page.click(f"{form} button")
        arrived(tab, f"/trees/{bench}@{k + 2}/edit")
    told = filled.get(f"/v1/trees/{bench}").json()["loads"]
    assert [each["type"] for each in told] == [each["type"] for each in sent]
    tab.close()


@in_browser
@pytest.mark.deep
def test_an_instance_is_replaced_and_revisions_are_compared(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    hand = {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}
    assert filled.post(f"/v1/trees/{bench}/couplings", json=hand).status_code == 201
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    tab.page.click("[aria-label='replace hand']")
    assert tab.page.evaluate("document.activeElement.name") == "substructure"
    tab.page.keyboard.type("slider")
    told = tab.page.evaluate("document.querySelector('[data-request=curl]').textContent")
    assert f"-X PATCH {address}/v1/trees/{bench}@2/couplings/hand" in told
    tab.page.keyboard.press("Enter")
    arrived(tab, f"/trees/{bench}@3/edit")
    found = filled.get(f"/v1/trees/{bench}").json()
    assert found["coordinates"] == ["arm.q", "hand.x"]
    tab.page.select_option("[name=to]", f"{bench}@1")
    tab.page.click("button:has-text('Compare')")
    tab.page.wait_for_url(lambda url: f"/trees/{bench}@3/difference" in url)
    assert "hand" in tab.page.inner_text("main")
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_frame_is_picked_in_the_view(browser: Any, address: str, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    tab.page.focus("[data-action=couplings] [name=at]")
    box = tab.page.query_selector("#view canvas").bounding_box()
    field = "document.querySelector('[data-action=couplings] [name=at]').value"
    for x, y in ((i / 12, j / 12) for j in range(1, 11) for i in range(3, 10)):
        tab.page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
        if tab.page.evaluate(field) == "arm.tip":
            break
    assert tab.page.evaluate(field) == "arm.tip"
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_is_wrong_is_told_and_nothing_changes(browser: Any, address: str, filled: TestClient, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit", 360)
    tab.until(READY)
    for name, text in (("substructure", "nothing"), ("name", "hand"), ("at", "arm.tipp")):
        tab.page.fill(f"[data-action=couplings] [name={name}]", text)
    tab.page.click("[data-action=couplings] button")
    tab.until("document.getElementById('told').className === 'warn'")
    assert "nothing" in tab.page.inner_text("#told")
    assert filled.get(f"/v1/trees/{bench}").json()["revision"] == 1
    tab.wrong = [each for each in tab.wrong if "40" not in each and "422" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_published_and_the_requests_of_other_programs(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    for name, text in (("substructure", "pendulum"), ("name", "hand"), ("at", "arm.tip"), ("z", "-0.2")):
        tab.page.fill(f"[data-action=couplings] [name={name}]", text)
    command = tab.page.evaluate("document.querySelector('[data-request=curl]').textContent")
    told = subprocess.run(["/bin/bash", "-c", command], capture_output=True, text=True, check=True).stdout
    assert json.loads(told)["revision"] == 2
    python = tab.page.evaluate("document.querySelector('[data-request=Python]').textContent")
    assert "couple(" in python
    exec(compile(python.replace(f"{bench}@1", f"{bench}@2").replace('"hand"', '"other"'), "shown", "exec"), {})  # noqa: S102
    assert filled.get(f"/v1/trees/{bench}").json()["dof"] == 3
    tab.page.click("summary:has-text('Publish as a part')")
    tab.page.fill("[data-action=publish] [name=name]", f"{bench}-part")
    tab.page.click("[data-action=publish] button")
    tab.page.wait_for_url(f"**/substructures/{bench}-part@1")
    tab.until(READY)
    tab.close()


@in_browser
@pytest.mark.deep
def test_without_scripts_the_outline_is_there(browser: Any, address: str, bench: str) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit", java_script_enabled=False)
    assert "Steps are taken by a script" in tab.page.inner_text("main")
    assert "arm" in tab.page.inner_text("#outline")
    forms = tab.page.locator("form[data-action] [type=submit]")
    assert forms.count() > 5
    assert all(forms.nth(k).is_disabled() for k in range(forms.count())), "nothing is sent as a query of the page"
    tab.page.goto(f"{address}/trees/{bench}/motion")
    assert all(tab.page.is_disabled(each) for each in ("#run", "#locus [type=submit]"))
    tab.page.close()


@in_browser
@pytest.mark.deep
def test_a_part_of_the_catalogue_comes_named_and_is_coupled_in_other_units(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    tab = Tab(browser, address, f"/trees?part=pendulum@1&q={bench}")
    tab.page.click(f"a:has-text('{bench}')")
    tab.until(READY)
    form = "[data-action=couplings]"
    assert tab.page.input_value(f"{form} [name=name]") == "pendulum"
    assert tab.page.evaluate(f"document.querySelector('{form} [name=name]').validity.valid")
    tab.page.fill(f"{form} [name=at]", "arm.tip")
    tab.until("document.getElementById('view').dataset.ghost === 'arm.tip'")
    for name, text in (("x", "100 mm"), ("roll", "-30deg"), ("yaw", "pi/2"), ("y", "1e-3")):
        tab.page.fill(f"{form} [name={name}]", text)
    tab.until("document.getElementById('ahead').textContent.includes('numbers with units count as 0')")
    tab.page.click(f"{form} button")
    arrived(tab, f"/trees/{bench}@2/edit")
    told = filled.get(f"/v1/trees/{bench}").json()["instances"][1]["placement"]
    position, rpy = [{"unit": "mm", "value": "100"}, 0.001, 0], [{"unit": "deg", "value": "-30"}, 0, "pi/2"]
    assert (told["position"], told["rpy"]) == (position, rpy)
    tab.close()


@in_browser
@pytest.mark.deep
def test_pressed_twice_is_one_step_and_a_lost_connection_says_what_to_do(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    tab = Tab(browser, address, f"/trees/{bench}/edit")
    tab.until(READY)
    for name, text in (("substructure", "pendulum"), ("name", "hand"), ("at", "arm.tip")):
        tab.page.fill(f"[data-action=couplings] [name={name}]", text)
    tab.until("document.getElementById('view').dataset.ghost === 'arm.tip'")
    tab.page.context.set_offline(True)
    tab.page.click("[data-action=couplings] button")
    tab.until("document.getElementById('told').textContent.includes('see whether the server runs')")
    tab.page.context.set_offline(False)
    tab.page.evaluate("for (let k = 0; k < 2; k++) document.querySelector('[data-action=couplings]').requestSubmit()")
    arrived(tab, f"/trees/{bench}@2/edit")
    assert filled.get(f"/v1/trees/{bench}").json()["revision"] == 2
    tab.wrong = [each for each in tab.wrong if "ERR_INTERNET_DISCONNECTED" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("page", ["edit", "motion"])
def test_the_longest_names_and_deep_trees_fit_a_phone(
    browser: Any, address: str, filled: TestClient, page: str
) -> None:
    name, places = "n" * 64, [chr(ord("a") + k) * 64 for k in range(16)]
    ats = ["world", *(f"{place}.tip" for place in places)]
    instances = [{"name": each, "substructure": "pendulum", "at": at} for each, at in zip(places, ats, strict=False)]
    assert filled.post("/v1/trees", json={"name": name, "instances": instances}).status_code in (200, 201)
    tab = Tab(browser, address, f"/trees/{name}/{page}", 390)
    tab.until(READY)
    if page == "motion":
        tab.page.click("#start summary")
        assert tab.page.is_visible("[data-rate='0']")
    tab.close()


@in_browser
def test_what_the_address_keeps_is_of_the_revision_shown(
    browser: Any, address: str, filled: TestClient, bench: str
) -> None:
    tab, motion = Tab(browser, address, f"/trees/{bench}"), Tab(browser, address, f"/trees/{bench}/motion")
    assert tab.until(READY) == "3d"
    motion.until("document.getElementById('place').dataset.ready")
    for each in (tab, motion):
        assert "@" not in each.page.url, "nothing is kept: the newest revision is shown"
        each.page.fill("[data-number='0']", "0.4")
        each.until("location.search.includes('pose=0.4')")
    other = {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}
    assert filled.post(f"/v1/trees/{bench}/couplings", json=other).status_code == 201
    for each, path in ((tab, f"/trees/{bench}@1"), (motion, f"/trees/{bench}@1/motion")):
        assert each.page.reload().status == 200
        assert each.page.evaluate("location.pathname") == path
        assert each.page.input_value("[data-number='0']") == "0.4"
        each.close()
