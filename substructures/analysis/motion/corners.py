"""Corners of force laws along a motion: |x| and sign x change sides where x = 0, and the integrator begins anew there.

From one corner to the next x' = f(t, x) is smooth: |x| = s x and sign x = s with the side s = 1 or -1 that x is on,
also where a step goes too far, so that the zero of x is found on a smooth path, and steps keep their order. Corners are
those of ``abs``, ``sign``, ``min``, ``max`` and linear tables, in the formulas of a model and in those of its inputs.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.motion.integrators.zeros import Watch
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.calculus.corners import corners, inner, on_side
from substructures.expr.graph import Expr, Graph
from substructures.expr.known import Known
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
#: so much of x' jumps at least where a motion slides
JUMPS = 1e-9


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
    """A program on one side of its corners, as far as they depend on symbols that are ``moving``.

    None where there are no corners, or too many.
    """
    if not has_corners(source):
        return None
    graph = Graph()
    made = replay(source, graph, {})
    entries = [e for output in made.values() for e in output.entries.values() if isinstance(e, Expr)]
    nodes = [node for node in corners(entries) if node.op in LAWS and _moves(inner(node), moving)]
    found = list(dict.fromkeys(map(inner, nodes)))
    if not found or len(found) > MOST:
        return None
    names = tuple(f"side {k}" for k in range(len(found)))
    symbol = {x: graph.symbol(name) for x, name in zip(found, names, strict=True)}
    every = [*entries, *found]
    sides = {node: symbol[inner(node)] for node in nodes}
    new = dict(zip(every, on_side(every, sides, goes_on=True), strict=True))
    outputs = {
        name: Formulas(o.shape, {i: new[e] if isinstance(e, Expr) else e for i, e in o.entries.items()}, o.symmetry)
        for name, o in made.items()
    }
    symbols = {s.name: s for s in source.symbols} | {name: Symbol(name, "parameter") for name in names}
    places = {CORNERS: array((len(found),), lambda k: new[found[k]])}
    return Sided(program(graph, outputs, symbols), program(graph, places, symbols), names)


def _moves(x: Expr, moving: Collection[str]) -> bool:
    return any(node.op == "sym" and str(node.value) in moving for node in reachable([x]))


@lru_cache(maxsize=64)
def _kernels(source: Known, moving: tuple[str, ...], folder: Path | None) -> tuple[Kernel, Kernel, Sided] | None:
    found = sided(source.source, moving)
    if found is None:
        return None
    pairs = (found.on_sides, tuple(found.on_sides.outputs)), (found.places, (CORNERS,))
    on_sides, places = (compile_program(some, outputs, folder, single=True) for some, outputs in pairs)
    return on_sides, places, found


def kernels(source: Program, moving: Sequence[str], folder: Path | None) -> tuple[Kernel, Kernel, Sided] | None:
    """The compiled programs of :func:`sided`; the same objects for the same program."""
    return _kernels(Known(source.digest, source), tuple(moving), folder)


class Laws:
    """A program that a motion evaluates by :attr:`run`, as its formulas are or on one side of their corners.

    ``outputs``: its outputs and where they are written; ``values`` and ``columns``: of its symbols.
    """

    def __init__(
        self,
        source: Program,
        kernel: Kernel,
        outputs: Mapping[str, Array],
        values: Mapping[str, Any],
        columns: Sequence[tuple[Sequence[str], Array]],
    ) -> None:
        self._source, self._outputs, self._values, self._columns = source, outputs, dict(values), columns
        self.run = self._plain = kernel.bind(outputs, values, columns=columns)

    def plain(self) -> None:
        """The formulas as they are."""
        self.run = self._plain

    def on_sides(self, moving: Sequence[str], folder: Path | None) -> tuple[Array, Callable[[], Array]] | None:
        """Take sides (k,), which are not set yet; what looks at the places that they are of (k,), as bound.

        None where there are no corners.
        """
        found = kernels(self._source, moving, folder)
        if found is None:
            return None
        kernel, places, of = found
        sides, levels = np.ones(len(of.names)), np.zeros((1, len(of.names)))
        values = self._values | {name: sides[k : k + 1] for k, name in enumerate(of.names)}
        self.run = kernel.bind(self._outputs, values, columns=self._columns)
        look = places.bind({CORNERS: levels}, values, columns=self._columns)

        def looked() -> Array:
            """The places at the state at hand."""
            look()
            return levels[0]

        return sides, looked


def follow(
    laws: Sequence[Laws],
    moving: Sequence[str],
    move: Callable[[float, Array], None],
    rates: Callable[[float, Array], Array],
    start: tuple[float, Array],
    folder: Path | None,
) -> list[Watch]:
    """Follow laws on one side of their corners, from a start (t, x) on; the corners are to be watched.

    ``moving``: symbols that change along a motion; ``move``: makes (t, x) the state at hand, ``rates``: x' there. Laws
    stand behind those that they depend on.
    """
    found = [taken for law in laws if (taken := law.on_sides(moving, folder)) is not None]
    places = [(sides, k) for sides, _ in found for k in range(len(sides))]

    def levels(t: float, x: Array) -> Array:
        """What the signs are of."""
        move(t, x)
        return np.concatenate([look() for _, look in found])

    def leave() -> None:
        """Take no sides."""
        for law in laws:
            law.plain()

    corners = Corners(places, levels, rates, leave)
    if corners.begin(*start) or any(corners.slides(k, *start) for k in np.flatnonzero(levels(*start) == 0).tolist()):
        return corners.watches
    leave()
    return []


class Corners:
    """The sides that a motion is on: ``sides`` are elements of arrays; ``places``: what the signs are of, at (t, x);
    ``rates``: x' = f(t, x) there; ``leave``: called when the motion slides along a corner, where it has no side.
    """

    def __init__(
        self,
        sides: Sequence[tuple[Array, int]],
        places: Callable[[float, Array], Array],
        rates: Callable[[float, Array], Array],
        leave: Callable[[], None],
    ) -> None:
        self._sides, self.places, self.leave, self._rates = sides, places, leave, rates
        self.watches = [Watch(CORNERS, self._place(k), stops=False, corner=_Side(self, k)) for k in range(len(sides))]

    def side(self, k: int) -> float:
        """The side of a corner that is taken."""
        where, place = self._sides[k]
        return float(where[place])

    def take(self, k: int, side: float) -> None:
        """Take a side of a corner."""
        where, place = self._sides[k]
        where[place] = side

    def begin(self, t: float, x: Array) -> bool:
        """Take the sides of a start; False where it is between them, and does not leave to one."""
        every = range(len(self._sides))
        # one corner may be inside another: those inside come first
        for k in every:
            self._starts(k, t, x)
        return all(self._starts(k, t, x) or self._leaves(k, t, x) for k in every)

    def _starts(self, k: int, t: float, x: Array) -> bool:
        """Whether a start is beside a corner; then the corner has that side."""
        side = float(np.sign(self.places(t, x)[k]))
        if side:
            self.take(k, side)
        return bool(side)

    def _leaves(self, k: int, t: float, x: Array) -> bool:
        """Whether the motion goes from a corner to a side and stays on it, which becomes that of the corner."""
        for side in (1.0, -1.0):
            self.take(k, side)
            if self.ahead(k, t, x) == side:
                return True
        return False

    def ahead(self, k: int, t: float, x: Array) -> float:
        """The side of a corner that the motion is on soon, as sides are taken now."""
        rates = self._rates(t, x)
        h = AHEAD * float(np.abs(x).max(initial=1.0) / max(np.abs(rates).max(initial=0.0), 1.0))
        middle = x + h / 2 * rates
        return float(np.sign(self.places(t + h, x + h * self._rates(t + h / 2, middle))[k]))

    def slides(self, k: int, t: float, x: Array) -> bool:
        """Whether a motion at a corner comes back from both sides, as x' is another one there."""
        kept, found = self.side(k), list[Array]()
        for side in (1.0, -1.0):
            self.take(k, side)
            found += [self._rates(t, x)] if self.ahead(k, t, x) == -side else []
        self.take(k, kept)
        return len(found) > 1 and bool(np.abs(found[0] - found[1]).max() > JUMPS * np.abs(found).max())

    def _place(self, k: int) -> Callable[[float, Array], float]:
        return lambda t, x: float(self.places(t, x)[k])


@dataclass(frozen=True)
class _Side:
    corners: Corners
    number: int

    @property
    def side(self) -> float:
        """The side that is taken."""
        return self.corners.side(self.number)

    def take(self, side: float) -> None:
        """Take a side."""
        self.corners.take(self.number, side)

    def stays(self, t: float, x: Array) -> bool:
        """Whether the motion goes on at that side."""
        return self.corners.ahead(self.number, t, x) == self.side

    def slides(self, t: float, x: Array) -> bool:
        """Whether it comes back from both sides."""
        return self.corners.slides(self.number, t, x)

    def leave(self) -> None:
        """No corner has a side any more."""
        self.corners.leave()
