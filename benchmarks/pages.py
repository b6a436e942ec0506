"""The pages of a tree in Chromium: seconds until it can be used, from slider to drawing, frames of a motion, bytes.

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

from playwright.sync_api import sync_playwright

from benchmarks.http import cpu_seconds, serving
from substructures.catalogue import load_tree
from substructures.client import Client

FLAGS = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"]  # as on a machine without a graphics card
MOVES, FRAMES, ASKED = 100, 60, 30
#: pages whose work in the server is measured
PAGES = (
    "/",
    "/?q=gripper",
    "/substructures/puma560@1",
    "/trees",
    "/trees/shown@1",
    "/trees/shown@1?entry=metric,0,1",
    "/trees/shown@1/edit",
    "/trees/shown@1/motion",
    "/jobs",
    "/docs/explanation/notation",
    "/docs/interface",
    f"/trees/shown@1?pose={','.join(['0.123456'] * 34)}",
)
READY = "document.getElementById('place').dataset.{}"
#: milliseconds from an input event to the frame that has drawn it
MOVE = """(k) => new Promise((done) => {
    const sliders = document.querySelectorAll('[data-q]');
    const slider = sliders[sliders.length >> 1];
    slider.value = String(Number(slider.min) + (k / 100) * (slider.max - slider.min));
    const start = performance.now();
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    requestAnimationFrame(() => done(performance.now() - start)); // after that of the page itself
})"""
#: keeps how long keys took until what they changed was on the screen, in steps of 8 ms, from 16 on
KEYS = """() => {
    window.keys = [];
    const keep = (list) => window.keys.push(...list.getEntries().filter(({ name }) => name === 'keydown'));
    new PerformanceObserver(keep).observe({ type: 'event', durationThreshold: 16 });
    const sliders = document.querySelectorAll('[data-q]');
    sliders[sliders.length >> 1].focus();
}"""


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


def pressed(page: Any) -> list[float]:
    """Milliseconds from keys that move a slider to pixels on the screen, as the browser's Event Timing tells them."""
    page.evaluate(KEYS)
    for _ in range(MOVES):
        page.keyboard.press("ArrowLeft")
        page.wait_for_timeout(40)
    page.wait_for_timeout(500)
    found = [float(x) for x in page.evaluate("window.keys.map(({ duration }) => duration)")]
    return [8.0] * (MOVES - len(found)) + found


#: frames that are drawn in two seconds
COUNTED = """() => new Promise((done) => {
    const start = performance.now();
    let frames = 0;
    const count = (now) => (now < start + 2000 ? requestAnimationFrame(count, frames++) : done(frames));
    requestAnimationFrame(count);
})"""


def played(page: Any, address: str) -> tuple[list[float], float]:
    """Milliseconds of the script in frames of a motion of a second, again and again, and frames a second."""
    page.goto(address)
    until(page, READY.format("ready"))
    page.fill("#span", "1")
    page.click("#run")
    until(page, READY.format("run"))
    found = []
    for _ in range(FRAMES):
        page.wait_for_timeout(30)
        found.append(float(page.evaluate(READY.format("milliseconds"))))
    return found, float(page.evaluate(COUNTED)) / 2


def works(client: Client) -> None:
    """CPU of the server for every page."""
    for path in PAGES:
        asked = [client.request("GET", path) for _ in range(2)][-1]
        before = cpu_seconds(client)
        for _ in range(ASKED):
            client.request("GET", path)
        used = (cpu_seconds(client) - before) / ASKED * 1e3
        print(f"{path[:40]:40} {used:6.1f} ms of CPU, {len(asked.content):,} bytes")


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
        print(f"slider to its frame: median {median(times):.1f} ms, p95 {quantiles(times, n=20)[-1]:.1f} ms")
        times = pressed(page)
        print(f"key to screen: median {median(times):.0f} ms, p95 {quantiles(times, n=20)[-1]:.0f} ms, steps of 8 ms")
        print(f"script of a frame: {script[0]:.2f} ms (grid, panel, view; software rendering comes on top)")
        times, rate = played(page, f"{address}/motion")
        print(f"script of a frame of a motion: median {median(times):.2f} ms (pose, plots, values at the cursor, view)")
        print(f"frames of a motion: {rate:.0f} a second")
        works(client)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "humanoid")
