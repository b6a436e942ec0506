"""SYMORO files (``.par``): modified Denavit-Hartenberg parameters of trees, with symbols that stay parameters.

The rows are those of a definition (W. Khalil and J. F. Kleinfinger, 1986): gamma, b, alpha, d, theta, r are psi, sigma,
theta, d, phi, tau here. XX, XY, ... are entries of the inertia tensor about the origin of the link's frame, MX, MY, MZ
the first moments; IA is a rotor inertia, FV viscous friction. Joints with sigma = 2 are fixed.
"""

from __future__ import annotations

import re
from typing import Any

from substructures.errors import InvalidDocument
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.interchange.names import library_name, title_of
from substructures.interchange.report import Place, Report, refuse

_WORD = re.compile(r"\w+")
_NAME = re.compile(r"\(\*\s*Robotname\s*=\s*'([^']*)'")
_SYMBOL = re.compile(r"[A-Za-z]\w*", re.ASCII)
_FUNCTIONS = {"pi", "sin", "cos", "tan", "sqrt"}
_ROWS = {"gamma": "psi", "b": "sigma", "alpha": "theta", "d": "d"}
_UNITS = {"gamma": "rad", "alpha": "rad", "theta": "rad", "b": "m", "d": "m", "r": "m", "M": "kg"}
_MOMENTS = ("XX", "YY", "ZZ", "XY", "XZ", "YZ")
_FORCES = ("FX", "FY", "FZ", "CX", "CY", "CZ", "FS")
_MOST_LINKS = 200


def read_par(data: bytes) -> tuple[dict[str, Any], Report]:
    """The definition of a SYMORO file. Raises InvalidDocument with line and name."""
    text = data.decode("latin-1")
    return _Reader(text).definition()


def _without_comments(text: str) -> str:
    """Line breaks in the place of ``(* ... *)``; what is not closed is no comment."""
    kept: list[str] = []
    here = 0
    while (start := text.find("(*", here)) >= 0 and (end := text.find("*)", start + 2)) >= 0:
        kept += [text[here:start], "\n" * text.count("\n", start, end)]
        here = end + 2
    return "".join(kept) + text[here:]


class _Reader:
    """Lists by name, each with its line."""

    def __init__(self, text: str) -> None:
        found = _NAME.search(text)
        self.title = found[1] if found else ""
        self.lists: dict[str, list[str]] = {}
        self.lines: dict[str, int] = {}
        self.report = Report()
        self.parameters: dict[str, dict[str, Any]] = {}
        for number, line in enumerate(_without_comments(text).splitlines(), 1):
            name, equals, entries = line.partition("=")
            if equals and _WORD.fullmatch(name.strip()):
                self.lists[name.strip()] = [x.strip() for x in entries.strip().strip("{}").split(",")]
                self.lines[name.strip()] = number

    def definition(self) -> tuple[dict[str, Any], Report]:
        """Everything together."""
        links, frames = self._count("NL"), self._count("NF")
        if frames != links:
            message = f"{frames} frames of {links} links: loops are not read, cut them and add closures to a tree"
            raise refuse(self.place("NF"), "loops", message)
        bodies = [self._body(k) for k in range(links)]
        name = library_name(self.title, "symoro")
        document = {"name": name, "title": title_of(self.title), "bodies": bodies, "parameters": self.parameters}
        document["ports"] = [{"name": f"end{k + 1}", "body": f"link{k + 1}"} for k in self._leaves(links)]
        return document, self.report

    def place(self, name: str, k: int | None = None) -> Place:
        """Of an entry."""
        return Place(self.lines.get(name, 0), name if k is None else f"{name}[{k + 1}]")

    def _count(self, name: str) -> int:
        text = self.lists.get(name, [""])[0]
        if not re.fullmatch("[0-9]{1,6}", text) or not 1 <= int(text) <= _MOST_LINKS:
            raise refuse(self.place(name), "bad-number", f"{name} has to be a number from 1 to {_MOST_LINKS}")
        return int(text)

    def entry(self, name: str, k: int, default: str | None = "0") -> str:
        """Entry k of a list, as text."""
        found = self.lists.get(name)
        if found is None or k >= len(found) or not found[k]:
            if default is None or found is not None:
                raise refuse(self.place(name, k), "missing", f"the list '{name}' has no entry {k + 1}")
            return default
        return found[k]

    def number(self, name: str, k: int, without: str = "") -> str:
        """An expression, whose symbols become parameters."""
        text = self.entry(name, k).replace("**", "^")
        try:
            graph = Graph()
            parse(graph, text, graph.symbol)
        except (ValueError, ArithmeticError, InvalidDocument) as error:
            raise refuse(self.place(name, k), "bad-expression", f"'{text[:60]}': {error}") from None
        for symbol in sorted(set(_SYMBOL.findall(text)) - _FUNCTIONS - {without}):
            unit = _UNITS.get(name, "kg m" if name in ("MX", "MY", "MZ") else "kg m^2" if name in _MOMENTS else "")
            self.parameters.setdefault(symbol, {"unit": unit} if unit and text == symbol else {})
        return text

    def _leaves(self, links: int) -> list[int]:
        carried = {int(self.entry("ant", k, None)) for k in range(links)}
        return [k for k in range(links) if k + 1 not in carried]

    def _parent(self, k: int) -> str:
        text = self.entry("ant", k, None)
        if not re.fullmatch("[0-9]{1,6}", text) or not 0 <= int(text) <= k:
            raise refuse(self.place("ant", k), "cycle", f"'{text[:20]}' is no number of a link before link {k + 1}")
        return f"link{int(text)}" if int(text) else "base"

    def _body(self, k: int) -> dict[str, Any]:
        kind = {"0": "revolute", "1": "prismatic", "2": "fixed"}.get(self.entry("sigma", k, None))
        if kind is None:
            raise refuse(self.place("sigma", k), "unknown-type", "sigma is 0 (revolute), 1 (prismatic) or 2 (fixed)")
        joint: dict[str, Any] = {"type": kind} | {ours: self.number(name, k) for name, ours in _ROWS.items()}
        joint |= self._moving(k, kind)
        for name in _FORCES:
            if self.entry(name, k) not in ("0", "") and (kind != "fixed" or name != "FS"):
                what = "dry friction" if name == "FS" else "an external force or moment"
                self.report.lost(self.place(name, k), f"{what} is left out: add a load for it")
        mass = self.number("M", k)
        body: dict[str, Any] = {"name": f"link{k + 1}", "parent": self._parent(k), "joint": joint, "mass": mass}
        moments = [self.number(name, k) for name in ("MX", "MY", "MZ")]
        if mass == "0" and any(x != "0" for x in moments):
            raise refuse(self.place("M", k), "no-mass", "a first moment without a mass")
        body["com"] = [f"({x})/({mass})" if x != "0" else "0" for x in moments]
        inertia = {name.lower(): self.number(name, k) for name in _MOMENTS}
        return body | {"inertia": inertia | {"about": "origin"}}

    def _moving(self, k: int, kind: str) -> dict[str, Any]:
        """theta and r; of what moves the symbol is the coordinate, and the rest an offset."""
        if kind == "fixed":
            return {"phi": self.number("theta", k), "tau": self.number("r", k)}
        moving, still, offset, constant = (
            ("theta", "r", "phi", "tau") if kind == "revolute" else ("r", "theta", "tau", "phi")
        )
        text = self.entry(moving, k)
        symbols = [s for s in _SYMBOL.findall(text) if s not in _FUNCTIONS]
        if len(symbols) != 1 or not re.fullmatch(rf"{symbols[0]}(\s*[-+][^A-Z]*)?", text):
            message = f"'{text[:60]}' is not a coordinate, perhaps with a constant added"
            raise refuse(self.place(moving, k), "no-coordinate", message)
        rest = text.removeprefix(symbols[0]).strip()
        joint: dict[str, Any] = {"coordinate": symbols[0], offset: rest.removeprefix("+").strip() or "0"}
        joint[constant] = self.number(still, k)
        for name, law in (("IA", "armature"), ("FV", "damping")):
            if self.entry(name, k) != "0":
                joint[law] = self.number(name, k)
        return joint
