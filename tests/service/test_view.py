"""The view in three dimensions: a shade of a part is dragged, and what is beside it turns the view."""

from __future__ import annotations

from typing import Any

import pytest

from service.pages.model import assets

from .one_store import filled, store
from .test_model_pages import READY, Tab, address, browser, in_browser

__all__ = ["address", "browser", "filled", "store"]
#: a view of its own over the page, whose shade in the frame arm.tip follows what is told
OPEN = """async (root) => {
    const [{ View }, { load }] = await Promise.all([import(root + "view.js"), import(root + "program.js")]);
    const place = document.getElementById("view");
    const [program] = await load("/v1/trees/cell@2");
    const view = new View(place, await (await fetch("/v1/trees/cell@2/scene")).json());
    program.vectors.q.set([0.4, 0.7]);
    view.pose(program);
    const shown = (shift) => {
        const line = [[0, 0, 0], [0.5, 0.2, 0.1]];
        view.ghost([line.map((point) => point.map((x, i) => x + shift[i]))], "arm.tip");
    };
    shown([0, 0, 0]);
    window.told = [];
    view.drag((shift) => {
        window.told.push(shift);
        if (shift) shown(shift);
    });
    window.end = () => view.camera.pixel(view.shade.ends()[1]);
    window.posed = (...q) => {
        program.vectors.q.set(q);
        view.pose(program);
        return view.camera.pixel(view.middle);
    };
    window.seen = () => view.camera.seen.position.toArray();
    window.corners = () => {
        const { min, max } = view.box();
        const all = [0, 1, 2, 3, 4, 5, 6, 7].map((k) =>
            min.clone().set(...["x", "y", "z"].map((axis, i) => (k & (1 << i) ? max : min)[axis])),
        );
        return all.map((corner) => view.camera.pixel(corner));
    };
}"""


@in_browser
def test_the_ghost_follows_the_pointer(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2")
    tab.until(READY)
    script = tab.page.get_attribute("script[type=module]", "src")
    tab.page.evaluate(OPEN, script.rpartition("/")[0] + "/")
    box = tab.page.query_selector("#view canvas").bounding_box()
    x, y = tab.page.evaluate("end()")
    seen = tab.page.evaluate("seen()")
    mouse = tab.page.mouse
    mouse.move(box["x"] + x + 5, box["y"] + y - 3)
    mouse.down()
    mouse.move(box["x"] + x - 60, box["y"] + y + 37, steps=4)
    assert tab.page.evaluate("end()") == pytest.approx([x - 65, y + 40], abs=1)
    mouse.up()
    told = tab.page.evaluate("told")
    assert told[-1] is None
    assert len(told) == 5
    assert tab.page.evaluate("seen()") == seen, "the view was turned"
    mouse.move(box["x"] + 20, box["y"] + 20)
    mouse.down()
    mouse.move(box["x"] + 80, box["y"] + 60, steps=4)
    mouse.up()
    assert tab.page.evaluate("told") == told, "beside the shade nothing is dragged"
    assert tab.page.evaluate("seen()") != seen
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("style", ["", "width: 90px; aspect-ratio: 0.3", "aspect-ratio: 4"])
def test_all_is_within_the_picture(browser: Any, address: str, style: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2")
    tab.until(READY)
    script = tab.page.get_attribute("script[type=module]", "src")
    tab.page.evaluate("style => document.getElementById('view').style = style", style)
    tab.page.evaluate(OPEN, script.rpartition("/")[0] + "/")
    width, height = tab.page.evaluate("['clientWidth', 'clientHeight'].map((x) => document.querySelector('#view')[x])")
    corners = tab.page.evaluate("corners()")
    assert all(0 <= x <= width and 0 <= y <= height for x, y in corners), (corners, width, height)
    tab.close()


@in_browser
@pytest.mark.deep
@pytest.mark.parametrize("path", ["/trees/cell@2", "/trees/cell@2/edit", "/trees/cell@2/motion"])
def test_switches_hide_nothing(browser: Any, address: str, path: str) -> None:
    tab = Tab(browser, address, path, 360)
    tab.until("document.querySelector('canvas ~ .label')")
    drawn, bar = (tab.page.query_selector(each).bounding_box() for each in ("#view canvas", ".switches"))
    assert bar["y"] >= drawn["y"] + drawn["height"]
    tab.close()


@in_browser
@pytest.mark.deep
def test_what_moves_away_is_followed(browser: Any, address: str) -> None:
    tab = Tab(browser, address, "/trees/cell@2")
    tab.until(READY)
    script = tab.page.get_attribute("script[type=module]", "src")
    tab.page.evaluate(OPEN, script.rpartition("/")[0] + "/")
    first, away = tab.page.evaluate("[posed(0, 0), posed(1, 0.5)]")
    assert abs(away[0] - first[0]) + abs(away[1] - first[1]) > 20
    tab.page.check("label:has-text('follow') input")
    assert tab.page.evaluate("posed(-1, 0.5)") == pytest.approx(away, abs=0.01)
    tab.close()


def test_modules_are_short() -> None:
    """Own ones; those that are built come of them."""
    folders = assets.FOLDER, assets.FOLDER.with_name("source")
    own = [path for folder in folders for path in folder.rglob("*.js") if "node_modules" not in path.parts]
    long = [path.name for path in own if path != assets.FOLDER / "view.js" and path.read_text().count("\n") >= 150]
    assert long == []
