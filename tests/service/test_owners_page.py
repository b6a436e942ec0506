"""Two owners in a browser: nobody sees what is another's, and signing out leaves nothing behind the back button."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import uvicorn
from fastapi.testclient import TestClient

from service.app import create_app
from service.store.store import Store

from .test_keys import new_key
from .test_model_pages import READY, Tab, browser, in_browser

__all__ = ["browser"]
SECRET = {
    "name": "secret",
    "visibility": "private",
    "gravity": [0, 0, "-9.81"],
    "instances": [{"name": "arm", "substructure": "pendulum"}],
}
#: of the private tree: pages, fragments, what scripts load
ADDRESSES = [
    "/trees/secret",
    "/trees/secret@1/edit",
    "/trees/secret@1/motion",
    "/trees/secret@1/entry?entry=metric,0,0",
    "/trees/secret@1/grid?tab=metric",
    "/trees/secret/difference?to=secret@1",
    "/v1/trees/secret@1/scene",
    "/v1/trees/secret@1/program.wasm",
    "/v1/trees/secret@1/program.json",
    "/v1/trees/secret@1/origins",
    "/v1/trees/secret@1/picture",
]


@pytest.fixture
def served(store: Store) -> Iterator[tuple[str, dict[str, str]]]:
    """The address of a server, and keys by owner."""
    keys = {}
    for owner in ("one", "two"):
        keys[owner] = new_key(store, "read", "write", owner=owner)["Authorization"].partition(" ")[2]
    server = uvicorn.Server(uvicorn.Config(create_app(store), port=0, log_level="error", ws="none", lifespan="off"))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        time.sleep(0.01)
    yield f"http://localhost:{server.servers[0].sockets[0].getsockname()[1]}", keys
    server.should_exit = True
    thread.join()


def signed_in(tab: Tab, key: str) -> None:
    tab.page.fill("[name=key]", key)
    tab.page.click("button:has-text('Sign in')")


def test_examples_of_the_interface_name_nothing_private(filled: TestClient, store: Store) -> None:
    one, two = (new_key(store, "read", "write", owner=owner) for owner in ("one", "two"))
    assert filled.post("/v1/trees", json=SECRET, headers=one).status_code == 201
    assert "secret@1" in filled.get("/docs/interface", headers=one).text
    assert "secret@1" not in filled.get("/docs/interface", headers=two).text
    assert filled.get("/docs/interface").status_code == 401


@in_browser
def test_two_owners(browser: Any, filled: TestClient, served: tuple[str, dict[str, str]]) -> None:
    address, keys = served
    made = filled.post("/v1/trees", json=SECRET, headers={"Authorization": f"Bearer {keys['one']}"})
    assert made.status_code == 201, made.text
    tab = Tab(browser, address, "/trees/secret")
    signed_in(tab, keys["one"])
    tab.until(READY)
    assert "one" in tab.page.inner_text("header")
    tab.page.goto(f"{address}/trees/secret@1/edit?substructure=pendulum")
    tab.until(READY)
    tab.page.fill("[data-action=couplings] [name=at]", "arm.tip")
    tab.page.click("[data-action=couplings] button")
    tab.page.wait_for_url("**/trees/secret@2/edit*")
    tab.until(READY)
    fetched = "fetch('{}').then((answer) => answer.status)"
    assert {tab.page.evaluate(fetched.format(each)) for each in ADDRESSES} == {200}
    tab.page.goto(f"{address}/account")
    tab.page.click("button:has-text('Sign out')")
    tab.page.wait_for_load_state()
    for _ in range(3):
        tab.page.go_back()
        assert "arm" not in tab.page.inner_text("body")
    tab.page.goto(f"{address}/trees/secret")
    signed_in(tab, keys["two"])
    assert "there is no tree 'secret'" in tab.page.inner_text("main")
    assert {tab.page.evaluate(fetched.format(each)) for each in ADDRESSES} == {404}
    tab.page.goto(f"{address}/?q=secret")
    assert "secret@" not in tab.page.inner_text("main")
    tab.page.goto(f"{address}/trees")
    assert "secret" not in tab.page.inner_text("main")
    tab.wrong = [each for each in tab.wrong if "401" not in each and "404" not in each]
    tab.close()
