"""The reduced level of parts with loops: where dependent coordinates are, from the closures of the documents.

Positions are solved by Newton's method from phi(y, z) = 0, of all solutions one on a side of det d phi / dz = 0 that
is asked for, one closure after the other. Then with G = d phi / dq and c = G' q' of the documents

    G (N y') = 0          q'' = N y'' + k(y'),  G_z k_z = -c at the velocities N y'          H_jk from k by polarisation

No formula of the program is looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

from flint import arb, arb_mat, ctx

from substructures.certificate.given.closing import PRIMES, Block, Closing, blocks_of
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers

#: bits that floats are exact to at least; each step of Newton's method doubles them
EXACT = 40
#: how exact formulas are that follow a position from the start, beside 1
FOLLOWED = arb(2) ** -80
#: of all closed positions that on the straight way from the start; none
WAY, NOWHERE = "way", "nowhere"


@dataclass
class Reduced:
    """``values``: of all symbols, those of dependent coordinates among them; N and H by coordinate: d q / d y and the
    symmetric second derivatives; ``pull``: H y' y'.
    """

    values: dict[str, Ball]
    N: dict[str, dict[str, Ball]]
    H: dict[str, dict[tuple[str, str], Ball]]
    pull: dict[str, Ball]


class Loops(Closing):
    """The closures of one instance, and what they make of its coordinates."""

    def solve(self, found: Reduced, sides: Iterator[int] | str) -> None:
        """z and its derivatives, into what was found; ``sides``: 1 or -1, that of the start or the other one; WAY; or
        NOWHERE.
        """
        blocks = _blocks_at_start(_Start(f"{self.name} {self.definition}", self))
        at = None if sides == NOWHERE else self._position(blocks, sides)
        if at is None:
            self._nowhere(found)
            return
        found.values |= at
        rows = [k for block in blocks for k in block.rows]
        jacobian = self.rows(at)["closure.jacobian"].entries
        names = list(self.kinds)

        def block(columns: Sequence[str]) -> arb_mat:
            """Of G."""
            return arb_mat(
                len(rows), len(columns), [jacobian.get((k, names.index(q)), arb(0)) for k in rows for q in columns]
            )

        G, N = block(self.z), _solved(block(self.z), block(self.y))
        for j, y in enumerate(self.y):
            found.N[y] = {y: arb(1)} | {q: -N[i, j] for i, q in enumerate(self.z)}

        def bent(speeds: Mapping[str, Ball]) -> list[Ball]:
            """k_z at velocities of y."""
            moving = {
                f"{q}'": sum((found.N[y].get(q, arb(0)) * v for y, v in speeds.items()), arb(0)) for q in self.kinds
            }
            c = self.rows({**at, **moving})["closure.acceleration"].entries
            return (-_solved(G, arb_mat(len(rows), 1, [c.get((k,), arb(0)) for k in rows]))).entries()

        moving = {q: found.values[f"{q}'"] for q in self.y}
        second = {q: found.values[f"{q}''"] for q in self.y}
        for i, (q, k) in enumerate(zip(self.z, bent(moving), strict=True)):
            found.pull[q] = k
            for mark, some, more in (("'", moving, arb(0)), ("''", second, k)):
                found.values[f"{q}{mark}"] = sum((-N[i, j] * some[y] for j, y in enumerate(self.y)), more)
        self._bends(found, bent)

    def _nowhere(self, found: Reduced) -> None:
        """Nothing is finite."""
        nan = arb("nan")
        found.values |= {f"{q}{p}": nan for q in self.z for p in PRIMES}
        found.N |= {y: {y: arb(1), **dict.fromkeys(self.z, nan)} for y in self.y}
        found.H |= {q: {(y, o): nan for a, y in enumerate(self.y) for o in self.y[a:]} for q in self.z}
        found.pull |= dict.fromkeys(self.z, nan)

    def _bends(self, found: Reduced, bent: Callable[[Mapping[str, Ball]], list[Ball]]) -> None:
        """H by polarisation."""
        own = {(y, y): bent({o: arb(int(o == y)) for o in self.y}) for y in self.y}
        for a, y in enumerate(self.y):
            for other in self.y[a:]:
                both = own[y, y]
                if other != y:
                    some = bent({o: arb(int(o in (y, other))) for o in self.y})
                    both = [(s - p - r) / 2 for s, p, r in zip(some, own[y, y], own[other, other], strict=True)]
                for q, x in zip(self.z, both, strict=True):
                    found.H.setdefault(q, {})[y, other] = x

    def _position(self, blocks: Sequence[Block], sides: Iterator[int] | str) -> dict[str, Ball] | None:
        """z in balls; on the way from the start to what steps of Newton's method leave open."""
        is_followed = isinstance(sides, str)
        if not isinstance(sides, str):
            blocks = tuple(replace(block, sign=block.sign * next(sides, 1)) for block in blocks)
        numbers = [(name, float(x)) for name, x in self.values.items()]
        # the same ones at all precisions of a state
        known = _Start(f"{self.name} {self.definition} {numbers}", self)
        floats = (_followed if is_followed else _closed)(known, blocks)
        if floats is None:
            return None
        at = {q: arb(x) for q, x in floats.items()}
        rows, names = [k for block in blocks for k in block.rows], list(self.kinds)
        precision = ctx.prec
        with ctx.workprec(precision + 64):
            for _ in range((ctx.prec // EXACT).bit_length()):
                found = self.rows(at)
                phi, jacobian = found["closure.residual"].entries, found["closure.jacobian"].entries
                G = arb_mat(
                    len(rows), len(self.z), [jacobian.get((k, names.index(q)), arb(0)) for k in rows for q in self.z]
                )
                step = _solved(G, arb_mat(len(rows), 1, [phi.get((k,), arb(0)) for k in rows])).entries()
                at = {q: (at[q] - x).mid() for q, x in zip(self.z, step, strict=True)}
            turned = at if is_followed else {q: self.turned(q, x) for q, x in at.items()}
        small = FOLLOWED if is_followed else arb(2) ** (-precision - 16)
        return {q: x + (x.abs_upper() + 1) * arb(0, small) for q, x in turned.items()}


@dataclass(frozen=True)
class _Start:
    """Closures by a text that tells them from others."""

    text: str
    loops: Loops = field(compare=False)


@lru_cache(maxsize=64)
def _closed(known: _Start, blocks: Sequence[Block]) -> Mapping[str, float] | None:
    """z of closed positions, to the digits of floats; what closes first is so on all sides of what closes then."""
    if not blocks:
        return dict.fromkeys(known.loops.z, 0.0)
    found = dict(_closed(known, blocks[:-1]) or {})
    with ctx.workprec(64):
        return found if found and known.loops.close(blocks[-1], found) else None


@lru_cache(maxsize=64)
def _followed(known: _Start, blocks: Sequence[Block]) -> Mapping[str, float] | None:
    """z on the straight way from the start, to the digits of floats."""
    found = dict[str, float]()
    with ctx.workprec(64):
        return {q: found[q] for q in known.loops.z} if known.loops.follow(blocks, found) else None


@lru_cache(maxsize=64)
def _blocks_at_start(start_of: _Start) -> tuple[Block, ...]:
    """The closures in an order in which each tells coordinates, at the start of the definition."""
    loops, definition = start_of.loops, start_of.loops.definition
    given = {p: x.get("value") for p, x in definition.get("parameters", {}).items()}
    numbers = {f"{loops.name}.{p}": Numbers({}).read(1 if x is None else x) for p, x in given.items()}
    start = {f"{loops.name}.{q}": Numbers({}).read(x) for q, x in definition.get("start", {}).items()}
    there = Loops(loops.name, definition, {**loops.values, **dict.fromkeys(loops.y, arb(0)), **numbers}, loops.build)
    there.values |= {q: start.get(q, arb(0)) for q in loops.y}
    return tuple(blocks_of(there, {q: float(start.get(q, arb(0))) for q in loops.z}))


def _solved(G: arb_mat, x: arb_mat) -> arb_mat:
    """G^-1 x, not finite where that is not known."""
    try:
        return G.solve(x)
    except ZeroDivisionError:
        return arb_mat(x.nrows(), x.ncols(), [arb("nan")] * (x.nrows() * x.ncols()))
