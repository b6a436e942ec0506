"""Drawings of conventions in the documentation; ``python tests/drawings.py`` writes them."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, pi, sin
from pathlib import Path

import numpy as np

DOCS = Path(__file__).parents[2] / "docs" / "explanation"
SCALE, TURNED, RAISED = 130.0, 0.45, 0.45  # from where it is seen
Points = Sequence[np.ndarray]
STYLE = (
    "text{font:15px sans-serif;fill:currentColor}.small{font-size:12px}path{fill:none;stroke:currentColor}"
    "svg{color:#57626d}.p{stroke:#2a78ad}.k{stroke:#c7663a}.way{stroke-width:3}.thin{stroke-dasharray:4 4}"
    "@media(prefers-color-scheme:dark){svg{color:#c3cbd2}.p{stroke:#6fb7e8}.k{stroke:#ef9a70}}"
)


def turn(axis: int, angle: float) -> np.ndarray:
    """About an axis, in the sense of the right hand."""
    c, s = cos(angle), sin(angle)
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    found = np.eye(3)
    found[i, i] = found[j, j] = c
    found[i, j], found[j, i] = -s, s
    return found


class Drawing:
    """Lines, arrows, arcs and words in three dimensions, seen obliquely."""

    def __init__(self, words: str, width: int, height: int, middle: tuple[float, float]) -> None:
        self.words, self.size, self.middle = words, (width, height), middle
        self.parts: list[str] = []

    def at(self, point: np.ndarray) -> tuple[float, float]:
        """On the paper."""
        x, y, z = turn(2, TURNED) @ point
        return self.middle[0] + SCALE * y, self.middle[1] - SCALE * (z * cos(RAISED) - x * sin(RAISED))

    def line(self, points: Points, kind: str = "", tip: bool = False) -> None:
        """Through points, with a tip at the last one."""
        placed = [self.at(point) for point in points]
        if tip:
            (x0, y0), (x, y) = placed[-2:]
            angle = atan2(y - y0, x - x0)
            for side in (pi - 0.35, pi + 0.35):
                end = (x + 9 * cos(angle + side), y + 9 * sin(angle + side))
                self.parts.append(f'<path class="{kind}" d="M{x:.1f} {y:.1f}L{end[0]:.1f} {end[1]:.1f}"/>')
        self.parts.append(f'<path class="{kind}" d="M' + "L".join(f"{x:.1f} {y:.1f}" for x, y in placed) + '"/>')

    def word(self, point: np.ndarray, text: str, shift: tuple[float, float] = (0, 0), kind: str = "") -> None:
        """Beside a point."""
        x, y = self.at(point)
        self.parts.append(f'<text class="{kind}" x="{x + shift[0]:.1f}" y="{y + shift[1]:.1f}">{text}</text>')

    def frame(self, origin: np.ndarray, axes: np.ndarray, name: str, kind: str, size: float = 0.55) -> None:
        """Three arrows with the names of the axes; columns of ``axes``."""
        for i in range(3):
            end = origin + size * axes[:, i]
            self.line([origin, end], kind, tip=True)
            self.word(origin + (size + 0.09) * axes[:, i], f"{i + 1}{name}", (-6, 5), "small")

    def arc(self, origin: np.ndarray, axes: np.ndarray, axis: int, angle: float, text: str) -> None:
        """From the next axis of ``axes`` about one of them."""
        start = np.eye(3)[:, 0 if axis == 2 else 2] * 0.34
        bent = [origin + axes @ turn(axis, angle * k / 12) @ start for k in range(13)]
        self.line(bent, "", tip=True)
        self.word(origin + axes @ turn(axis, angle / 2) @ start * 1.35, text, (-4, 5))

    def text(self) -> str:
        """SVG."""
        width, height = self.size
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
        body = "\n".join(self.parts)
        return f"{head}\n<title>{self.words}</title>\n<style>{STYLE}</style>\n{body}\n</svg>\n"


def joint_row() -> Drawing:
    """From frame p to the axis of joint k by the six numbers of a row."""
    told = "Rz(psi) Tz(sigma) Rx(theta) Tx(d) Rz(phi) Tz(tau): from frame p to the body frame of k"
    made = Drawing(told, 620, 400, (90, 310))
    psi, sigma, theta, d, phi, tau = 0.55, 0.9, -0.75, 2.1, 0.9, 1.0
    zero, p = np.zeros(3), np.eye(3)
    up = zero + sigma * p[:, 2]
    turned = p @ turn(2, psi)
    tilted = turned @ turn(0, theta)
    foot = up + d * tilted[:, 0]
    last = tilted @ turn(2, phi)
    origin = foot + tau * last[:, 2]
    made.line([zero, up + 0.7 * p[:, 2]], "thin")
    made.line([foot - 0.6 * last[:, 2], origin + 0.9 * last[:, 2]], "thin")
    made.frame(zero, p, "", "p")
    made.word(zero, "p", (-20, 16))
    made.line([zero, up], "way")
    made.word(zero + 0.8 * up, "&#963;", (-20, 0))
    made.line([up, foot], "way")
    made.word(up + 0.6 * (foot - up), "d", (0, -10))
    made.line([up, up + 0.45 * p[:, 0]], "thin")
    made.line([foot, foot + 0.45 * tilted[:, 0]], "thin")
    made.line([foot, origin], "way")
    made.word(foot + 0.5 * (origin - foot), "&#964;", (8, 8))
    made.arc(up, p, 2, psi, "&#968;")
    made.arc(foot, turned, 0, theta, "&#952;")
    made.arc(foot, tilted, 2, phi, "&#966;")
    made.line([foot, foot + 0.5 * turned[:, 2]], "thin")
    made.frame(origin, last, "", "k")
    made.word(foot, "O of k", (-44, 18), "small")
    made.word(origin, "body frame of k", (12, 22), "small")
    made.word(origin + 0.9 * last[:, 2], "joint axis k", (8, 4), "small")
    return made


def mounting() -> Drawing:
    """A part on a port of a host, by a placement."""
    told = "The interface of a part, at a placement from a port that is fixed in a body of the host"
    made = Drawing(told, 640, 330, (110, 190))
    host, port = np.zeros(3), np.array([0.5, 1.3, 0.55])
    of_port = turn(2, 0.3) @ turn(0, -0.3)
    shift = of_port @ np.array([0.5, 1.5, 0.5])
    interface = port + shift
    axes = of_port @ turn(2, 0.5) @ turn(1, 0.5) @ turn(0, -0.5)
    foot = host - 0.55 * np.eye(3)[:, 2]
    made.frame(host, np.eye(3), "", "p")
    made.word(host, "body frame h", (-92, 0), "small")
    made.word(foot, "O of h", (-50, 6), "small")
    made.line([foot, host], "way")
    made.word(0.5 * foot, "&#964;", (-20, 4))
    made.line([host, port], "way")
    made.frame(port, of_port, "", "p", 0.4)
    made.word(port, "port", (-20, 34), "small")
    made.line([port, interface], "way", tip=True)
    made.word(port + 0.5 * shift, "placement", (-40, -10), "small")
    made.frame(interface, axes, "", "k")
    made.word(interface, "interface I of the part", (-60, 84), "small")
    made.line([foot, interface], "thin", tip=True)
    made.word(0.5 * (foot + interface), "z, A", (4, 24))
    return made


DRAWINGS = {"joint-row.svg": joint_row, "mounting.svg": mounting}

if __name__ == "__main__":
    for name, draw in DRAWINGS.items():
        (DOCS / name).write_text(draw().text(), encoding="utf-8")
