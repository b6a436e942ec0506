"""Corners of force laws along a motion: |x| and sign x change sides where x = 0, and the integrator begins anew there.

From one corner to the next x' = f(t, x) is smooth: |x| = s x and sign x = s with the side s = 1 or -1 that x is on,
also where a step goes too far, so that the zero of x is found on a smooth path, and steps keep their order. Corners are
those of ``abs``, ``sign``, ``min``, ``max`` and linear tables.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from substructures.analysis.equations.kernels import Known
from substructures.analysis.motion.zeros import Watch
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.corners import corners, inner, on_side
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.expr.walk import reachable

LAWS = frozenset(("abs", "sign"))
CORNERS = "corners"
#: of so many corners at most the places are looked for: a table of many knots is nearly smooth
MOST = 64
#: how far one looks ahead to see on which side of a corner a motion is, as a part of the time that it takes to change
AHEAD = 1e-6


@dataclass(frozen=True)
class Sided:
    """``on_sides``: the program with symbols in place of signs, ``names`` (k,); ``places``: its output ``corners`` (k,)
    is what the signs are of.
    """

    on_sides: Program
    places: Program
    names: tuple[str, ...]


def has_corners(source: Program) -> bool:
    """Whether any sign or absolute value is in a program."""
    return any(operation[0] in LAWS for operation in source.operations)


def sided(source: Program, moving: Collection[str]) -> Sided | None:
    """A program on one side of its corners, as far as they depend on symbols that are ``moving``, and on no inputs.

    None where there are no corners, or too many.
    """
    if not has_corners(source):
        return None
    graph = Graph()
    made = replay(source, graph, {})
    entries = [e for output in made.values() for e in output.entries.values() if isinstance(e, Expr)]
    nodes = [node for node in corners(entries) if node.op in LAWS and _moves(inner(node), moving, source)]
    found = list(dict.fromkeys(map(inner, nodes)))
    if not found or len(found) > MOST:
        return None
    names = tuple(f"side {k}" for k in range(len(found)))
    symbol = {x: graph.symbol(name) for x, name in zip(found, names, strict=True)}
    new = dict(zip(entries, on_side(entries, {node: symbol[inner(node)] for node in nodes}), strict=True))
    outputs = {
        name: Formulas(o.shape, {i: new[e] if isinstance(e, Expr) else e for i, e in o.entries.items()}, o.symmetry)
        for name, o in made.items()
    }
    symbols = {s.name: s for s in source.symbols} | {name: Symbol(name, "parameter") for name in names}
    places = {CORNERS: array((len(found),), lambda k: found[k])}
    return Sided(program(graph, outputs, symbols), program(graph, places, symbols), names)


def _moves(x: Expr, moving: Collection[str], source: Program) -> bool:
    names = {str(node.value) for node in reachable([x]) if node.op == "sym"}
    inputs = {s.name for s in source.symbols if s.kind == "input"}
    return bool(names & set(moving)) and not names & inputs


@lru_cache(maxsize=32)
def _kernels(source: Known, moving: tuple[str, ...], folder: Path | None) -> tuple[Kernel, Kernel, Sided] | None:
    found = sided(source.source, moving)
    if found is None:
        return None
    outputs = tuple(found.on_sides.outputs)
    return compile_program(found.on_sides, outputs, folder), compile_program(found.places, (CORNERS,), folder), found


def kernels(source: Program, moving: Sequence[str], folder: Path | None) -> tuple[Kernel, Kernel, Sided] | None:
    """The compiled programs of :func:`sided`; the same objects for the same program."""
    return _kernels(Known(source.digest, source), tuple(moving), folder)


class Corners:
    """The sides that a motion is on. ``places``: what the signs are of, at (t, x); ``rates``: x' = f(t, x) there;
    ``leave``: called when the motion slides along a corner, where it has no side.
    """

    def __init__(
        self,
        sides: Array,
        places: Callable[[float, Array], Array],
        rates: Callable[[float, Array], Array],
        leave: Callable[[], None],
    ) -> None:
        self.sides, self.places, self.leave, self._rates = sides, places, leave, rates
        self.watches = [Watch(CORNERS, self._place(k), stops=False, corner=_Side(self, k)) for k in range(len(sides))]

    def begin(self, t: float, x: Array) -> bool:
        """Take the sides of a start; False where it is between them, and does not leave to one."""
        self.sides[:] = np.sign(self.places(t, x))
        return all(side != 0 or self._leaves(k, t, x) for k, side in enumerate(self.sides))

    def _leaves(self, k: int, t: float, x: Array) -> bool:
        """Whether the motion goes from a corner to a side and stays on it, which becomes that of the corner."""
        for side in (1.0, -1.0):
            self.sides[k] = side
            if self.ahead(k, t, x) == side:
                return True
        return False

    def ahead(self, k: int, t: float, x: Array) -> float:
        """The side of a corner that the motion is on soon, as sides are taken now."""
        rates = self._rates(t, x)
        h = AHEAD * float(np.abs(x).max(initial=1.0) / max(np.abs(rates).max(initial=0.0), 1.0))
        middle = x + h / 2 * rates
        return float(np.sign(self.places(t + h, x + h * self._rates(t + h / 2, middle))[k]))

    def _place(self, k: int) -> Callable[[float, Array], float]:
        return lambda t, x: float(self.places(t, x)[k])


@dataclass(frozen=True)
class _Side:
    corners: Corners
    number: int

    @property
    def side(self) -> float:
        """The side that is taken."""
        return float(self.corners.sides[self.number])

    def turn(self) -> None:
        """Take the other one."""
        self.corners.sides[self.number] *= -1

    def stays(self, t: float, x: Array) -> bool:
        """Whether the motion goes on at that side; if not, no corner has one any more."""
        found = self.corners.ahead(self.number, t, x) == self.side
        if not found:
            self.corners.leave()
        return found
