"""Diagrams as SVG: lines over a common horizontal axis, panel under panel; no script, no style sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape

import numpy as np

from substructures.array import Array

WIDTH, PANEL = 720.0, 220.0
LEFT, RIGHT, TOP, BOTTOM = 76.0, 150.0, 34.0, 40.0
#: points of one line; more of them cannot be seen
POINTS = 1500
COLOURS = ("#1f5f8b", "#b4552d", "#3d7a3d", "#7a4b94", "#8a6d1f", "#4a5560", "#0f7f7f", "#a63d6b")
#: what is larger is left out, as what is not finite
LARGEST = 1e300
#: entries of a legend
NAMED = 8


@dataclass(frozen=True)
class Line:
    """Points (K,), joined; ``dots``: not joined."""

    name: str
    x: Array
    y: Array
    dots: bool = False


@dataclass(frozen=True)
class Panel:
    """Lines in one frame. ``marks``: vertical lines at x, by name."""

    title: str
    x_label: str
    y_label: str
    lines: tuple[Line, ...]
    marks: tuple[tuple[str, float], ...] = ()


def plot(title: str, panels: Sequence[Panel]) -> str:
    """SVG of panels, one under the other. What is not finite is left out."""
    height = TOP + (PANEL + BOTTOM + TOP) * len(panels)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {height:g}" role="img" '
    head += 'font-family="sans-serif" font-size="12">'
    shapes = [head, f"<title>{escape(title)}</title>", f'<rect width="{WIDTH:g}" height="{height:g}" fill="white"/>']
    shapes.append(_text(LEFT, 20, title, "start", ' font-size="15"'))
    for k, panel in enumerate(panels):
        shapes += _panel(panel, 2 * TOP + k * (PANEL + BOTTOM + TOP))
    return "\n".join([*shapes, "</svg>\n"])


def ticks(low: float, high: float, count: int = 5) -> list[float]:
    """Round numbers within an interval.

    >>> ticks(0.0, 1.0)
    [0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0]
    """
    raw = (high - low) / count
    size = 10.0 ** np.floor(np.log10(raw))
    step = float(size * next(m for m in (1, 2, 5, 10) if m * size >= raw * (1 - 1e-9)))
    first, last = int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9))
    return [k * step for k in range(first, last + 1)]


def _panel(panel: Panel, top: float) -> list[str]:
    x_range = _range([line.x for line in panel.lines])
    y_range = _range([line.y for line in panel.lines])
    width = WIDTH - LEFT - RIGHT

    def place(x: Array, y: Array) -> tuple[Array, Array]:
        """Data to coordinates of the picture."""
        across = LEFT + width * (x - x_range[0]) / (x_range[1] - x_range[0])
        return across, top + PANEL * (y_range[1] - y) / (y_range[1] - y_range[0])

    shapes = [f'<rect x="{LEFT:g}" y="{top:g}" width="{width:g}" height="{PANEL:g}" fill="none" stroke="#888"/>']
    for x in ticks(*x_range):
        at = float(place(np.array([x]), np.zeros(1))[0][0])
        shapes.append(_rule(at, top, at, top + PANEL, "#e4e4e4"))
        shapes.append(_text(at, top + PANEL + 15, f"{x:.6g}", "middle"))
    for y in ticks(*y_range):
        at = float(place(np.zeros(1), np.array([y]))[1][0])
        shapes.append(_rule(LEFT, at, LEFT + width, at, "#e4e4e4"))
        shapes.append(_text(LEFT - 6, at + 4, f"{y:.6g}", "end"))
    for name, x in panel.marks:
        at = float(place(np.array([x]), np.zeros(1))[0][0])
        shapes += [_rule(at, top, at, top + PANEL, "#d33"), _text(at + 3, top + 12, name, "start", ' fill="#d33"')]
    for k, line in enumerate(panel.lines):
        shapes.append(_line(line, *place(*_thinned(line)), COLOURS[k % len(COLOURS)]))
    shapes += _legend(panel, top)
    shapes.append(_text(LEFT, top - 8, panel.title, "start"))
    shapes.append(_text(LEFT + width / 2, top + PANEL + 31, panel.x_label, "middle"))
    turned = f' transform="rotate(-90 14 {top + PANEL / 2:g})"'
    shapes.append(_text(14, top + PANEL / 2, panel.y_label, "middle", turned))
    return shapes


def _range(columns: Sequence[Array]) -> tuple[float, float]:
    """From the least to the largest finite number, never empty."""
    flat = np.concatenate([np.ravel(c) for c in columns]) if columns else np.zeros(1)
    flat = flat[np.abs(flat) < LARGEST]
    low, high = (float(flat.min()), float(flat.max())) if len(flat) else (0.0, 1.0)
    room = 0.05 * (high - low)
    if room <= 1e-9 * max(abs(low), abs(high)):
        room = 0.5 * max(abs(low), abs(high)) or 1.0
    return low - room, high + room


def _thinned(line: Line) -> tuple[Array, Array]:
    keep = np.linspace(0, len(line.x) - 1, min(len(line.x), POINTS)).astype(np.int64)
    x, y = line.x[keep], line.y[keep]
    good = (np.abs(x) < LARGEST) & (np.abs(y) < LARGEST)
    return x[good], y[good]


def _line(line: Line, x: Array, y: Array, colour: str) -> str:
    pairs = zip(x.tolist(), y.tolist(), strict=True)
    if line.dots:
        return "\n".join(f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2" fill="{colour}"/>' for a, b in pairs)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in pairs)
    return f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.5"/>'


def _legend(panel: Panel, top: float) -> list[str]:
    shapes, x = [], WIDTH - RIGHT + 8
    for k, line in enumerate(panel.lines[:NAMED]):
        y = top + 12 + 16 * k
        shapes.append(_rule(x, y - 4, x + 14, y - 4, COLOURS[k % len(COLOURS)]))
        name = line.name if len(line.name) < 18 else line.name[:16] + "..."
        shapes.append(_text(x + 18, y, name, "start"))
    if len(panel.lines) > NAMED:
        shapes.append(_text(x, top + 12 + 16 * NAMED, f"and {len(panel.lines) - NAMED} more", "start"))
    return shapes


def _rule(x1: float, y1: float, x2: float, y2: float, colour: str) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}"/>'


def _text(x: float, y: float, text: str, anchor: str, more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{escape(text)}</text>'
