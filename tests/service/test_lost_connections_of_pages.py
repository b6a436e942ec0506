"""Motions that become jobs on their page, and connections that are lost on the way: nothing of them is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from substructures.client import Client

from .conftest import PENDULUM
from .farm import Server
from .one_store import filled, store
from .test_model_pages import Tab, address, browser, in_browser
from .test_motion_pages import SWING, TELLS, computed, opened, ran, trees

__all__ = ["address", "browser", "filled", "store", "trees"]


@pytest.fixture
def farm(tmp_path: Path) -> Iterator[Server]:
    """A server that runs jobs."""
    server = Server(f"sqlite:///{tmp_path}/store.db", tmp_path / "log")
    server.start()
    with Client(server.address) as client:
        client.request("POST", "/v1/substructures", json=PENDULUM)
        client.create_tree(SWING)
    yield server
    server.kill()


@contextmanager
def cut_short() -> Iterator[str]:
    """The address of a server whose answers end before their end."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", "1000000")
            self.end_headers()
            self.wfile.write(b'{"status": "finished", "t": [0, 1')

        do_GET = do_POST  # noqa: N815 -- as http.server calls it

        def log_message(self, *_: Any) -> None:
            """Nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        thread = Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}/"
        finally:
            server.shutdown()
            thread.join()


@in_browser
@pytest.mark.deep
def test_an_answer_that_ends_too_soon_is_asked_for_again(browser: Any, address: str, trees: TestClient) -> None:
    tab = opened(browser, address, "/trees/swing@1/motion?pose=0.4&t=1")
    told = computed(trees, "swing@1", ran(tab))
    with cut_short() as elsewhere:
        tab.page.route("**/simulations", lambda route: route.continue_(url=elsewhere))
        for button in ("text=CSV", "#run"):
            tab.page.click(button)
            tab.until(TELLS.format("the connection is lost: see whether the server runs, then try again"))
            assert tab.page.is_enabled(button)
        tab.page.unroute("**/simulations")
    with tab.page.expect_download() as found:
        tab.page.click("text=CSV")
    table = np.genfromtxt(Path(found.value.path()), delimiter=",", names=True)
    assert table["t"] == pytest.approx(told["t"])
    closed(tab)


def later(route: Any) -> None:
    """A request that becomes a job."""
    route.continue_(headers={**route.request.headers, "prefer": "respond-async"})


@in_browser
@pytest.mark.deep
def test_a_long_motion_is_a_job(browser: Any, farm: Server) -> None:
    tab = opened(browser, farm.address, "/trees/swing@1/motion?pose=0.4")
    tab.page.route("**/simulations", later)
    tab.page.click("#run")
    tab.until(TELLS.format("job"))
    assert "right" in (ran(tab) and tab.page.inner_text("#verdict"))
    assert tab.page.inner_text("#play") == "pause"
    tab.page.fill("#span", "1000000")
    tab.page.click("#run")
    tab.until(TELLS.format("running"))
    assert tab.page.is_disabled("#run")
    tab.page.click("#cancel")
    tab.until("document.getElementById('verdict').textContent === 'cancelled'")
    assert tab.page.is_enabled("#run")
    tab.close()


@in_browser
@pytest.mark.deep
def test_the_rows_of_a_sweep_come_with_its_end(browser: Any, farm: Server) -> None:
    arm = {"name": "arm", "substructure": "pendulum"}
    samples = {"method": "grid", "of": {"arm.l": {"uniform": [1, 2], "count": 400}}}
    body = {
        "kind": "sweep",
        "template": {"name": "s", "instances": [arm]},
        "samples": samples,
        "columns": {"m": "mass"},
    }
    tab = Tab(browser, farm.address, "/jobs")
    with Client(farm.address) as client:
        job = client.request("POST", "/v1/jobs", body).json()["id"]
    tab.page.goto(f"{farm.address}/jobs/{job}")
    tab.until("document.querySelector('#live [data-final]')")
    tab.until("document.querySelector('#rows table')")
    assert tab.page.locator("#rows").count() == 1
    tab.close()


LONG = {"q": [0.4], "span": [0, 30000]}


def in_between(tab: Tab, farm: Server, lost: str) -> None:
    """The server goes, which the page tells by an expression, and comes back."""
    farm.kill()
    tab.until(lost)
    farm.start()


def closed(tab: Tab) -> None:
    """Nothing was wrong but that the server was gone."""
    tab.wrong = [each for each in tab.wrong if "net::ERR_" not in each and "502" not in each]
    tab.close()


@in_browser
@pytest.mark.deep
def test_a_motion_is_followed_beyond_the_end_of_its_server(browser: Any, farm: Server) -> None:
    tab = opened(browser, farm.address, "/trees/swing@1/motion?pose=0.4")
    tab.page.route("**/simulations", later)
    tab.page.fill("#span", str(LONG["span"][1]))
    tab.page.click("#run")
    tab.until(TELLS.format("job"))
    in_between(tab, farm, TELLS.format("the connection is lost"))
    assert "right" in (ran(tab) and tab.page.inner_text("#verdict"))
    closed(tab)


@in_browser
@pytest.mark.deep
def test_the_motion_of_a_job_is_fetched_again_where_it_ends_too_soon(browser: Any, farm: Server) -> None:
    tab = opened(browser, farm.address, "/trees/swing@1/motion?pose=0.4")
    tab.page.route("**/simulations", later)
    with cut_short() as elsewhere:
        tab.page.route("**/files/*", lambda route: route.continue_(url=elsewhere), times=1)
        tab.page.click("#run")
        assert "right" in (ran(tab) and tab.page.inner_text("#verdict"))
    closed(tab)


@in_browser
@pytest.mark.deep
def test_the_page_of_a_job_follows_it_beyond_the_end_of_its_server(browser: Any, farm: Server) -> None:
    """Also where what stands before the server says that it is gone, after which a browser asks for no more events."""
    with Client(farm.address) as client:
        body = {"kind": "simulate", "items": [{"tree": "swing", "request": LONG}]}
        job = client.request("POST", "/v1/jobs", body).json()
    tab = Tab(browser, farm.address, f"/jobs/{job['id']}")
    gone = lambda route: route.fulfill(status=502, body="")  # noqa: E731
    tab.page.route("**/events", gone)
    in_between(tab, farm, "document.getElementById('told').textContent.includes('the connection is lost')")
    tab.page.unroute("**/events")
    tab.until("document.querySelector('#live [data-final]')")
    assert tab.page.inner_text("#told") == ""
    assert "succeeded" in tab.page.inner_text("#live")
    closed(tab)
