"""SYMORO files (``.par``): modified Denavit-Hartenberg parameters of trees, with symbols that stay parameters.

The rows are those of a definition (W. Khalil and J. F. Kleinfinger, 1986): gamma, b, alpha, d, theta, r are psi, sigma,
theta, d, phi, tau here. XX, XY, ... are entries of the inertia tensor about the origin of the link's frame, MX, MY, MZ
the first moments; IA is a rotor inertia, FV viscous friction. Joints with sigma = 2 are fixed.

A loop is closed by a joint k > NL, which is cut: frame k lies on its axis in the link ant(k), and would move by theta
or r; frame k + NJ - NL is fixed in the link at the other side, and both coincide as far as the joint demands (W. Khalil
and E. Dombre, Modeling, Identification and Control of Robots, 2002, chapter 7). NF = 2 NJ - NL frames in all.
"""

from __future__ import annotations

import re
from typing import Any

from substructures.documents.patterns import NAME
from substructures.errors import InvalidDocument, meant
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.interchange.names import library_name, symbols_in, title_of
from substructures.interchange.report import Place, Report, refuse

_LIST = re.compile(r"^[ \t]*([A-Za-z]\w*)[ \t]*=(?:\s*(\{[^{}]*\}?)|([^\n{]*))", re.ASCII | re.MULTILINE)
_NAME = re.compile(r"\(\*\s*Robotname\s*=\s*'([^']*)'")
_PI = re.compile(r"\bPi\b")
_ROWS = {"gamma": "psi", "b": "sigma", "alpha": "theta", "d": "d"}
_UNITS = {"gamma": "rad", "alpha": "rad", "theta": "rad", "b": "m", "d": "m", "r": "m", "M": "kg"}
_MOMENTS = ("XX", "YY", "ZZ", "XY", "XZ", "YZ")
_FORCES = ("FX", "FY", "FZ", "CX", "CY", "CZ", "FS")
_OF_LINKS = (*_MOMENTS, "MX", "MY", "MZ", "M", "IA", "FV", *_FORCES)
_TYPES = {"0": "revolute", "1": "prismatic", "2": "fixed"}
#: the closure of a joint that is cut
_CUTS = {"revolute": "pin", "prismatic": "slider", "fixed": "weld"}
#: what else stands in a file: (what becomes of it, values with which it is nothing)
_OTHERS: dict[str, tuple[str, tuple[float, ...]]] = {
    **dict.fromkeys(("W0", "WP0", "V0", "VP0"), ("the base stands still here: drive the part in a tree", (0,) * 3)),
    "Z": ("frame 0 is the interface here: give the part this placement in a tree", (*((1, *(0,) * 4) * 3), 1)),
}
_WITHOUT_INFLUENCE = ("Type", "mu", "QP", "QDP", "GAM")
_MOVING_BASE = ("is_mobile", "is_floating")
_KNOWN = ("NL", "NJ", "NF", "ant", "sigma", *_ROWS, "theta", "r", *_OF_LINKS, *_OTHERS, "G", *_MOVING_BASE)
#: the names of older files begin with capitals
_AS_HERE = {name.lower(): name for name in (*_KNOWN, *_WITHOUT_INFLUENCE)}
_MOST_LINKS = 200


def read_par(data: bytes) -> tuple[dict[str, Any], Report]:
    """The definition of a SYMORO file. Raises InvalidDocument with line and name."""
    text = data.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    return _Reader(text).definition()


def _without_comments(text: str) -> str:
    """Line breaks in the place of ``(* ... *)``; what is not closed is no comment."""
    kept: list[str] = []
    here = 0
    while (start := text.find("(*", here)) >= 0 and (end := text.find("*)", start + 2)) >= 0:
        kept += [text[here:start], "\n" * text.count("\n", start, end)]
        here = end + 2
    return "".join(kept) + text[here:]


def _entries(text: str) -> list[str]:
    """What commas separate, but for those between parentheses."""
    found, depth, start = [], 0, 0
    for here, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if letter == "," and not depth:
            found.append(text[start:here])
            start = here + 1
    return [_PI.sub("pi", entry.strip().replace("**", "^")) for entry in (*found, text[start:])]


def _value(text: str) -> float | None:
    """The number that a text is."""
    try:
        return float(text)
    except ValueError:
        return None


class _Reader:
    """Lists by name, each with its line; ``moving``: what stands for a coordinate."""

    def __init__(self, text: str) -> None:
        found = _NAME.search(text)
        self.title = found[1] if found else ""
        self.lists: dict[str, list[str]] = {}
        self.lines: dict[str, int] = {}
        self.report = Report()
        self.parameters: dict[str, dict[str, Any]] = {}
        self.moving: dict[str, Place] = {}
        plain, line, here = _without_comments(text), 1, 0
        for each in _LIST.finditer(plain):
            line, here = line + plain.count("\n", here, each.start(1)), each.start(1)
            name = _AS_HERE.get(each[1].lower(), each[1])
            self.lines[name] = line
            if each[2] and not each[2].endswith("}"):
                raise refuse(self.place(name), "not-closed", f"the list '{name[:60]}' has no '}}' at its end")
            self.lists[name] = _entries((each[2] or each[3]).strip().strip("{}"))

    def definition(self) -> tuple[dict[str, Any], Report]:
        """Everything together."""
        links, frames = self._count("NL"), self._count("NF")
        joints = self._count("NJ") if "NJ" in self.lists else links
        if frames != 2 * joints - links or joints < links:
            message = (
                f"{frames} frames, {joints} joints, {links} links: NF = 2 NJ - NL with loops, NF = NJ = NL of a tree"
            )
            raise refuse(self.place("NF"), "loops", message)
        self._tell_of_others(links)
        bodies = [self._body(k) for k in range(links)]
        closures = []
        for k in range(links, joints):
            ends, closure = self._cut(k, k + joints - links, links)
            bodies += ends
            closures.append(closure)
        for name in sorted(self.parameters.keys() & self.moving.keys()):
            message = f"'{name}' stands for a coordinate, and where nothing moves: give one of them another name"
            raise refuse(self.moving[name], "duplicate-name", message)
        name = library_name(self.title, "symoro")
        document = {"name": name, "title": title_of(self.title), "bodies": bodies, "parameters": self.parameters}
        document["ports"] = [{"name": f"end{k + 1}", "body": f"link{k + 1}"} for k in self._leaves(links)]
        return document | ({"closures": closures} if closures else {}), self.report

    def place(self, name: str, k: int | None = None) -> Place:
        """Of an entry."""
        return Place(self.lines.get(name, 0), name[:60] if k is None else f"{name}[{k + 1}]")

    def _tell_of_others(self, links: int) -> None:
        """What no equation has."""
        for name in _MOVING_BASE:
            if self.lists.get(name, ["0"])[0].lower() not in ("0", "false", ""):
                message = "the lists of a base that moves begin with the base: write it as a link on joints"
                raise refuse(self.place(name), "moving-base", message)
        for name, (message, still) in _OTHERS.items():
            if name in self.lists and [_value(x) for x in self.lists[name]] != list(still):
                self.report.lost(self.place(name), message)
        if any(_value(x) != 0 for x in self.lists.get("G", ())):
            given = ", ".join(self.lists["G"])
            self.report.warning(self.place("G"), f'gravity is that of a tree: give it "gravity": [{given[:200]}]')
        for name in _OF_LINKS:
            if any(x and _value(x) != 0 for x in self.lists.get(name, [])[links:]):
                self.report.lost(self.place(name, links), f"there is no link {links + 1}: the entry is left out")
        for name in self.lists.keys() - set(_AS_HERE.values()):
            self.report.lost(self.place(name), f"'{name[:60]}' is not known, and left out{meant(name, _KNOWN)}")

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

    def number(self, name: str, k: int) -> str:
        """An expression, whose symbols become parameters."""
        text = self.entry(name, k)
        graph, symbols = Graph(), set[str]()

        def seen(symbol: str) -> Expr:
            """A symbol, which is noted."""
            symbols.add(symbol)
            return graph.symbol(symbol)

        try:
            parse(graph, text, seen)
        except (ValueError, ArithmeticError, InvalidDocument) as error:
            raise refuse(self.place(name, k), "bad-expression", f"'{text[:60]}': {error}") from None
        for symbol in sorted(symbols):
            self._require_name(symbol, self.place(name, k))
            unit = _UNITS.get(name, "kg m" if name in ("MX", "MY", "MZ") else "kg m^2" if name in _MOMENTS else "")
            self.parameters.setdefault(symbol, {"unit": unit} if unit and text == symbol else {})
        return text

    def _require_name(self, symbol: str, place: Place) -> None:
        if re.match(NAME, symbol) is None:
            message = f"'{symbol[:60]}' is no name: a letter and letters, digits and '_'"
            raise refuse(place, "bad-name", message)

    def _leaves(self, links: int) -> list[int]:
        carried = {int(self.entry("ant", k, None)) for k in range(links)}
        return [k for k in range(links) if k + 1 not in carried]

    def _parent(self, k: int, most: int) -> str:
        text = self.entry("ant", k, None)
        if not re.fullmatch("[0-9]{1,6}", text) or not 0 <= int(text) <= most:
            raise refuse(self.place("ant", k), "cycle", f"'{text[:20]}' is no number of a link before link {most + 1}")
        return f"link{int(text)}" if int(text) else "base"

    def _row(self, k: int) -> dict[str, Any]:
        """The joint of a frame, without what acts in it."""
        kind = _TYPES.get(self.entry("sigma", k, None))
        if kind is None:
            raise refuse(self.place("sigma", k), "unknown-type", "sigma is 0 (revolute), 1 (prismatic) or 2 (fixed)")
        joint: dict[str, Any] = {"type": kind} | {ours: self.number(name, k) for name, ours in _ROWS.items()}
        return joint | self._moving(k, kind)

    def _body(self, k: int) -> dict[str, Any]:
        joint = self._row(k)
        for name, law in (("IA", "armature"), ("FV", "damping")) if joint["type"] != "fixed" else ():
            if self.entry(name, k) != "0":
                joint[law] = self.number(name, k)
        for name in _FORCES:
            if _value(self.entry(name, k)) != 0 and (joint["type"] != "fixed" or name != "FS"):
                what = "dry friction" if name == "FS" else "an external force or moment"
                self.report.lost(self.place(name, k), f"{what} is left out: add a load for it")
        mass = self.number("M", k)
        body: dict[str, Any] = {"name": f"link{k + 1}", "parent": self._parent(k, k), "joint": joint, "mass": mass}
        moments = [self.number(name, k) for name in ("MX", "MY", "MZ")]
        if _value(mass) == 0 and any(_value(x) != 0 for x in moments):
            raise refuse(self.place("M", k), "no-mass", "a first moment without a mass")
        body["com"] = [f"({x})/({mass})" if _value(x) != 0 else "0" for x in moments]
        inertia = {name.lower(): self.number(name, k) for name in _MOMENTS}
        return body | {"inertia": inertia | {"about": "origin"}}

    def _cut(self, k: int, other: int, links: int) -> tuple[list[dict[str, Any]], dict[str, Any]]:
        """The frames of a joint that is cut, as bodies without mass that are fixed in their links; its closure."""
        if self.entry("sigma", other, None) != "2":
            message = f"frame {other + 1} is fixed in the link at the other side of joint {k + 1}: sigma is 2"
            raise refuse(self.place("sigma", other), "unknown-type", message)
        start, end = self._row(k), self._row(other)
        parents = [self._parent(each, links) for each in (k, other)]
        if parents[0] == parents[1]:
            message = f"joint {k + 1} is fixed in {parents[0]} at both sides: it has to join two links"
            raise refuse(self.place("ant", other), "same-body", message)
        kind = start["type"]
        moved = {"coordinate", *({"revolute": ("phi",), "prismatic": ("tau",)}.get(kind, ()))}
        rows = [{key: x for key, x in start.items() if key not in moved} | {"type": "fixed"}, end]
        names = [f"frame{each + 1}" for each in (k, other)]
        three = zip(names, parents, rows, strict=True)
        bodies = [{"name": name, "parent": parent, "joint": row} for name, parent, row in three]
        return bodies, {"name": f"joint{k + 1}", "type": _CUTS[kind], "from": names[0], "to": names[1]}

    def _moving(self, k: int, kind: str) -> dict[str, Any]:
        """theta and r; of what moves the symbol is the coordinate, and the rest an offset."""
        if kind == "fixed":
            return {"phi": self.number("theta", k), "tau": self.number("r", k)}
        moving, still, offset, constant = (
            ("theta", "r", "phi", "tau") if kind == "revolute" else ("r", "theta", "tau", "phi")
        )
        text = self.entry(moving, k)
        symbols, place = symbols_in(text) or [], self.place(moving, k)
        if len(symbols) != 1 or not re.fullmatch(rf"{symbols[0]}(\s*[-+][^A-Z]*)?", text):
            raise refuse(place, "no-coordinate", f"'{text[:60]}' is not a coordinate, perhaps with a constant added")
        if symbols[0] in self.moving:
            message = f"'{symbols[0]}' moves {self.moving[symbols[0]].element} already: give it another name"
            raise refuse(place, "duplicate-name", message)
        self._require_name(symbols[0], place)
        self.moving[symbols[0]] = place
        rest = text.removeprefix(symbols[0]).strip()
        joint: dict[str, Any] = {"coordinate": symbols[0], offset: rest.removeprefix("+").strip() or "0"}
        joint[constant] = self.number(still, k)
        return joint
