"""The page of a tree in Chromium: seconds until it can be used, from slider to drawing, bytes, CPU time of the server.

python -m benchmarks.pages [TREE] (default: humanoid; any other name is a part, alone)
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from contextlib import ExitStack
from statistics import median, quantiles
from time import perf_counter
from typing import Any

import httpx2
from playwright.sync_api import sync_playwright

from benchmarks.http import serving
from substructures.catalogue import load_tree

FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
MOVES = 100
READY = "document.getElementById('place').dataset.{}"
#: milliseconds from an input event to the frame that has drawn it
MOVE = """(k) => new Promise((done) => {
    const slider = document.querySelector('[data-q]');
    slider.value = String(Number(slider.min) + (k / 100) * (slider.max - slider.min));
    const start = performance.now();
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    requestAnimationFrame(() => done(performance.now() - start)); // after that of the page itself
})"""


def until(page: Any, script: str) -> None:
    """Wait for a value; the policy of the page forbids to wait within it."""
    while not page.evaluate(script):
        page.wait_for_timeout(5)


def opened(page: Any, address: str) -> tuple[float, float, int]:
    """Seconds until numbers are shown and until it is drawn, and bytes that were received."""
    sizes: list[int] = []
    client = page.context.new_cdp_session(page)
    client.send("Network.enable")
    client.on("Network.loadingFinished", lambda told: sizes.append(int(told["encodedDataLength"])))
    start = perf_counter()
    page.goto(address)
    until(page, READY.format("ready"))
    usable = perf_counter() - start
    until(page, READY.format("view"))
    return usable, perf_counter() - start, sum(sizes)


def main(name: str) -> None:
    with ExitStack() as stack:
        client, port = stack.enter_context(serving(stack.enter_context(tempfile.TemporaryDirectory())))
        one = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": name}]}
        tree = {**(load_tree(name) if name == "humanoid" else one), "name": "shown"}
        client.create_tree(tree)
        browser = stack.enter_context(sync_playwright()).chromium.launch(
            executable_path=shutil.which("chromium"), args=FLAGS
        )
        page, address = (
            browser.new_page(viewport={"width": 1280, "height": 900}),
            f"http://127.0.0.1:{port}/trees/shown@1",
        )
        for told in ("first", "with cache"):
            usable, drawn, received = opened(page, address)
            print(f"{told}: usable in {usable:.2f} s, drawn in {drawn:.2f} s, {received / 1000:.0f} kB received")
        times = [page.evaluate(MOVE, k) for k in range(MOVES)]
        script = [float(page.evaluate(READY.format("milliseconds")))]
        print(f"slider to drawing: median {median(times):.1f} ms, p95 {quantiles(times, n=20)[-1]:.1f} ms")
        print(f"script of a frame: {script[0]:.2f} ms (grid, panel, view; software rendering comes on top)")
        asked = stack.enter_context(httpx2.Client())
        asked.get(address)
        before = perf_counter()
        for _ in range(20):
            asked.get(address).raise_for_status()
        print(
            f"page over HTTP: {(perf_counter() - before) / 20 * 1000:.1f} ms, {len(asked.get(address).content):,} bytes"
        )
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "humanoid")
