"""Diagrams: all that is drawn lies inside, whatever the numbers are."""

from __future__ import annotations

import re

import numpy as np
import pytest

from substructures.pictures.plot import LEFT, RIGHT, WIDTH, Line, Panel, plot, ticks

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
