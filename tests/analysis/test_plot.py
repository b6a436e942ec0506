"""Diagrams: all that is drawn lies inside, whatever the numbers are."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from substructures.analysis import drawings
from substructures.analysis.motion.trajectory import Crossing, Trajectory
from substructures.analysis.orbits.sections import PoincareSection
from substructures.analysis.plot import LEFT, RIGHT, WIDTH, Line, Panel, plot, ticks
from substructures.analysis.stability.frequency_response import FrequencyResponse
from substructures.analysis.stability.root_locus import RootLocus
from substructures.analysis.verdict import Check

GRID = np.linspace(0.0, 1.0, 11)
COLUMNS = {
    "plain": np.sin(GRID),
    "constant": np.full(11, 3.0),
    "zero": np.zeros(11),
    "tiny": 1e-14 * GRID,
    "huge": 1e299 * GRID,
    "broken": np.where(GRID > 0.5, np.nan, GRID),
    "infinite": np.where(GRID > 0.5, np.inf, GRID),
    "beyond": np.where(GRID > 0.5, 1.7e308, -1.7e308),
    "nothing": np.full(11, np.nan),
}


@pytest.mark.parametrize("name", COLUMNS)
def test_lines_lie_inside(name: str) -> None:
    drawn = plot("<title>", [Panel("p", "x", "y", (Line(name, GRID, COLUMNS[name]),), (("event", 0.5),))])
    assert "<title>&lt;title&gt;</title>" in drawn
    assert "nan" not in re.sub(r">[^<]*<", "><", drawn)
    (points,) = re.findall(r'polyline points="([^"]*)"', drawn)
    for pair in points.split():
        x, y = map(float, pair.split(","))
        assert LEFT <= x <= WIDTH - RIGHT
        assert 68 <= y <= 68 + 220


def test_an_empty_motion_is_drawn() -> None:
    assert "<polyline" in plot("t", [Panel("p", "x", "y", (Line("a", np.zeros(0), np.zeros(0)),))])


@pytest.mark.parametrize(("low", "high"), [(0, 1), (-1e-12, 3e-12), (5, 1e9), (-0.3, 0.7), (1e290, 9e299)])
def test_ticks_are_few_and_inside(low: float, high: float) -> None:
    found = ticks(low, high)
    assert 2 <= len(found) <= 7
    room = 1e-6 * (high - low)
    assert low - room <= found[0] <= found[-1] <= high + room


def drawn_panels(monkeypatch: pytest.MonkeyPatch, draw: Callable[[], str]) -> tuple[str, dict[str, Panel]]:
    """Title and panels by title of what a function draws."""
    found: list[tuple[str, Sequence[Panel]]] = []

    def plot_noted(title: str, panels: Sequence[Panel]) -> str:
        found.append((title, panels))
        return ""

    monkeypatch.setattr(drawings, "plot", plot_noted)
    draw()
    ((title, panels),) = found
    return title, {panel.title: panel for panel in panels}


def test_a_motion_is_drawn_with_the_drifts_of_what_is_constant(monkeypatch: pytest.MonkeyPatch) -> None:
    """Angles and distances apart; (value - first value) / scale, of an energy less the work; no line of what falls."""
    t, q = np.array([0.0, 1.0, 2.0]), np.array([[1.0, 10], [2, 20], [3, 30]])
    series = {"energy": np.array([2.0, 2.5, 3]), "work": np.array([0, 0.5, 0.9]), "momentum.a": np.array([4.0, 4, 6])}
    checks = (
        Check("energy-balance", "constant", "", "J", 0.1, 2, 1e-3, 2.0),
        Check("energy", "falling", "", "J", 1, 2, 1e-3, 1.0),
        Check("momentum.a", "constant", "", "N s", 2, 4, 1),
    )
    events = (Crossing("top", 0.5, q[0], q[0]),)
    motion = Trajectory(("a", "b"), t, q, q, series, checks, events=events)
    title, panels = drawn_panels(monkeypatch, lambda: drawings.draw_trajectory(motion, "RP"))
    assert title == "finished, WRONG: energy violated at t = 1 s"
    lines = {name: [(line.name, *line.y.tolist()) for line in panel.lines] for name, panel in panels.items()}
    assert lines["angles"] == [("a", 1, 2, 3)]
    assert lines["distances"] == [("b", 10, 20, 30)]
    (balance, momentum) = lines["drift over scale of what must be constant"]
    assert balance == ("energy-balance", 0, 0, pytest.approx(0.05))
    assert momentum == ("momentum.a", 0, 0, 0.5)
    assert {panel.marks for panel in panels.values()} == {(("top", 0.5),)}
    right = Trajectory(("a", "b"), t, q, q, series, checks[2:])
    assert drawn_panels(monkeypatch, lambda: drawings.draw_trajectory(right, "RP"))[0] == "finished: all 1 checks hold"


def test_a_root_locus_is_drawn_in_the_plane_and_over_its_parameter(monkeypatch: pytest.MonkeyPatch) -> None:
    roots = np.array([[-1 + 2j, -1 - 2j], [1 + 3j, 1 - 3j]])
    locus = RootLocus(np.array([5.0, 6]), np.zeros((2, 1)), roots, ("", ""))
    title, panels = drawn_panels(monkeypatch, lambda: drawings.draw_root_locus(locus))
    assert title == "root locus, finished: 2 values"
    plane, parts = panels.values()
    assert [(line.x.tolist(), line.y.tolist()) for line in plane.lines] == [([-1, 1], [2, 3]), ([-1, 1], [-2, -3])]
    assert [(line.x.tolist(), line.y.tolist()) for line in parts.lines] == [([5, 6], [-1, 1])] * 2
    assert plane.marks == (("", 0.0),)


def test_a_section_is_drawn_in_the_planes_of_coordinates_and_velocities(monkeypatch: pytest.MonkeyPatch) -> None:
    q, qd = np.array([[1.0, 10], [2, 20]]), np.array([[3.0, 30], [4, 40]])
    found = PoincareSection(("a", "b"), np.array([0.5, 1.5]), q, qd)
    title, panels = drawn_panels(monkeypatch, lambda: drawings.draw(found, "RP"))
    assert title == "section, finished, not known to be right"
    assert [(panel.x_label, panel.y_label) for panel in panels.values()] == [
        ("a in rad", "a' in rad/s"),
        ("b in m", "b' in m/s"),
    ]
    for a, panel in enumerate(panels.values()):
        (line,) = panel.lines
        assert (line.dots, line.x.tolist(), line.y.tolist()) == (True, q[:, a].tolist(), qd[:, a].tolist())


def test_a_frequency_response_is_a_bode_diagram(monkeypatch: pytest.MonkeyPatch) -> None:
    """G = 1/(1 + i w): 0 dB and -20 dB a decade, 0 and -90 degrees; what has no logarithm is left out."""
    w = np.array([0.0, 0.01, 1.0, 100.0])
    found = FrequencyResponse(("tau",), ("x", "none"), w, np.zeros((4, 2, 1), complex), np.array([-1 + 0j]))
    found.response[:, 0, 0] = 1 / (1 + 1j * w)
    title, panels = drawn_panels(monkeypatch, lambda: drawings.draw(found, "P"))
    assert title == "frequency response, finished: 4 frequencies"
    (size, nothing), (phase, _) = panels["magnitude"].lines, panels["phase"].lines
    assert (size.name, len(nothing.x)) == ("x to tau", 0)
    assert size.x.tolist() == pytest.approx([-2, 0, 2])
    assert size.y.tolist() == pytest.approx([0, -10 * np.log10(2), -40], abs=1e-3)
    assert phase.y.tolist() == pytest.approx([-0.573, -45, -89.427], abs=1e-3)
