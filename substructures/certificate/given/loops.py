"""The reduced level of parts with loops: where dependent coordinates are, from the closures of the documents.

Positions are solved by Newton's method from phi(y, z) = 0, of all solutions one on a side of det d phi / dz = 0 that
is asked for, one closure after the other. Then with G = d phi / dq and c = G' q' of the documents

    G (N y') = 0          q'' = N y'' + k(y'),  G_z k_z = -c at the velocities N y'          H_jk from k by polarisation

No formula of the program is looked at."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, arb_mat, ctx

from substructures.certificate.bodies import Bodies
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.closures import ROWS, closure_outputs
from substructures.certificate.described import closures_in, coordinates_in
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs

Array = Any
#: bodies of a tree at values of all symbols
Build = Callable[[Plain, Mapping[str, Plain], Mapping[str, Ball]], tuple[Numbers, Bodies, Any, Any]]
PRIMES = ("", "'", "''")
#: starts that are tried, and steps of Newton's method from each
STARTS, MANY, STEPS = 5, 40, 12
#: bits that floats are exact to at least; each step of Newton's method doubles them
EXACT = 40
#: of what no closure depends on
MASSES = frozenset(("mass", "com", "inertia"))
LAWS = frozenset(("stiffness", "rest", "damping", "armature", "limits", "friction"))


@dataclass
class Reduced:
    """``values``: of all symbols, those of dependent coordinates among them; N and H by coordinate: d q / d y and the
    symmetric second derivatives; ``pull``: H y' y'.
    """

    values: dict[str, Ball]
    N: dict[str, dict[str, Ball]]
    H: dict[str, dict[tuple[str, str], Ball]]
    pull: dict[str, Ball]


class Loops:
    """The closures of one instance by itself."""

    def __init__(self, name: str, definition: Plain, values: Mapping[str, Ball], build: Build) -> None:
        self.name, self.build = name, build
        bodies = [{key: x for key, x in body.items() if key not in MASSES} for body in definition["bodies"]]
        bodies = [{**b, "joint": {key: x for key, x in b["joint"].items() if key not in LAWS}} for b in bodies]
        self.definition = {**definition, "bodies": bodies, "loads": []}
        self.tree: Plain = {"instances": [{"name": name}]}
        self.kinds = coordinates_in(self.tree, {name: definition})
        self.y = [q for q in self.kinds if q.partition(".")[2] in definition["independent"]]
        self.z = [q for q in self.kinds if q not in self.y]
        self.values = dict(values) | {f"tau.{q}": arb(0) for q in self.z}
        self.values |= {f"{q}{p}": arb(0) for q in self.z for p in PRIMES}

    def rows(self, more: Mapping[str, Ball]) -> Outputs:
        """The outputs of the closures."""
        values, result = {**self.values, **more}, Outputs()
        numbers, bodies, inside, _ = self.build(self.tree, {self.name: self.definition}, values)
        closed = closures_in(self.tree, {self.name: self.definition}, numbers, inside)
        closure_outputs(result, bodies, closed, rates(bodies, values, "'"))
        return of_coordinates(result, bodies)

    def solve(self, found: Reduced, sides: Iterator[int]) -> None:
        """z and its derivatives, into what was found; ``sides``: 1 or -1, that of the start or the other one."""
        blocks = _blocks_at_start(_Start(f"{self.name} {self.definition}", self))
        blocks = tuple(replace(block, sign=block.sign * next(sides, 1)) for block in blocks)
        at = self._position(blocks)
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

    def _position(self, blocks: Sequence[_Block]) -> dict[str, Ball] | None:
        """z on the branch of the start, in balls."""
        floats: dict[str, float] = dict.fromkeys(self.z, 0.0)
        with ctx.workprec(64):
            for block in blocks:
                if not self._close(block, floats):
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
            turned = {q: self._turned(q, x) for q, x in at.items()}
        small = arb(2) ** (-precision - 16)
        return {q: x + (x.abs_upper() + 1) * arb(0, small) for q, x in turned.items()}

    def _turned(self, q: str, x: Ball) -> Ball:
        """Between -pi and pi of where it starts, if it is an angle."""
        if self.kinds[q] != "R":
            return x
        start = Numbers({}).read(self.definition.get("start", {}).get(q.partition(".")[2], 0))
        return x - 2 * arb.pi() * round(float((x - start) / (2 * arb.pi())))

    def _close(self, block: _Block, at: dict[str, float]) -> bool:
        """Newton's method for the coordinates of one closure, from several starts: many where it closes at all."""
        source = random.Random(1)  # noqa: S311 -- the same for everybody
        first = [float(Numbers({}).read(self.definition.get("start", {}).get(q.partition(".")[2], 0))) for q in block.z]
        tried, closes = 0, False
        while tried < (MANY if closes else STARTS):
            at |= zip(block.z, first, strict=True)
            if self._newton(block, at):
                if block.sign_at(self, at) == block.sign:
                    return True
                closes = True
            first, tried = [source.uniform(-3, 3) for _ in block.z], tried + 1
        return False

    def approach(self, block: _Block, at: dict[str, float]) -> None:
        """The nearest closed position."""
        source, start = random.Random(2), {q: at[q] for q in block.z}  # noqa: S311 -- the same for everybody
        found: list[tuple[float, dict[str, float]]] = []
        for k in range(STARTS):
            at |= start if k == 0 else {q: x + source.uniform(-3, 3) for q, x in start.items()}
            if self._newton(block, at):
                place = {q: float(self._turned(q, arb(at[q]))) for q in block.z}
                found.append((sum(abs(x - start[q]) for q, x in place.items()), place))
        at |= min(found, key=lambda pair: pair[0])[1] if found else start

    def _newton(self, block: _Block, at: dict[str, float]) -> bool:
        names = list(self.kinds)
        columns, every = [names.index(q) for q in block.z], [k for k, _ in block.all_rows]
        for _ in range(STEPS):
            phi, G, alignment = self._floats(at, every)
            step = np.linalg.lstsq(G[:, columns], phi, rcond=1e-12)[0]
            size = np.abs(step).max()
            at |= {q: at[q] - x * min(1.0, 1.0 / size) if size else at[q] for q, x in zip(block.z, step, strict=True)}
            if not np.isfinite(size):
                return False
            if size < 1e-13:
                return bool(np.abs(phi).max() < 1e-9 and min(alignment, default=1.0) > 0)
        return False

    def _floats(self, at: Mapping[str, float], rows: Sequence[int]) -> tuple[Array, Array, list[float]]:
        found = self.rows({q: arb(x) for q, x in at.items()})
        phi, G = (found[f"closure.{x}"].entries for x in ("residual", "jacobian"))
        some = np.array([float(phi.get((k,), arb(0))) for k in rows])
        matrix = np.array([[float(G.get((k, a), arb(0))) for a in range(len(self.kinds))] for k in rows])
        alignment = [float(found["closure.alignment"].entries[k,].mid()) for k in rows]
        return some, matrix, [x for x in alignment if x]


@dataclass(frozen=True)
class _Block:
    """A closure: its unknown coordinates, all its rows by number and name, those that tell the coordinates, and the
    sign of their determinant on the branch.
    """

    z: tuple[str, ...]
    all_rows: tuple[tuple[int, str], ...]
    rows: tuple[int, ...]
    sign: int

    def sign_at(self, loops: Loops, at: Mapping[str, float]) -> int:
        """Of the determinant."""
        names = list(loops.kinds)
        _, G, _ = loops._floats(at, self.rows)
        return int(np.sign(np.linalg.det(G[:, [names.index(q) for q in self.z]])))


@dataclass(frozen=True)
class _Start:
    """Closures by a text that tells them from others."""

    text: str
    loops: Loops = field(compare=False)


@lru_cache(maxsize=64)
def _blocks_at_start(start_of: _Start) -> tuple[_Block, ...]:
    """The closures in an order in which each tells coordinates, at the start of the definition."""
    loops, definition = start_of.loops, start_of.loops.definition
    given = {p: x.get("value") for p, x in definition.get("parameters", {}).items()}
    numbers = {f"{loops.name}.{p}": Numbers({}).read(1 if x is None else x) for p, x in given.items()}
    start = {f"{loops.name}.{q}": Numbers({}).read(x) for q, x in definition.get("start", {}).items()}
    there = Loops(loops.name, definition, {**loops.values, **dict.fromkeys(loops.y, arb(0)), **numbers}, loops.build)
    there.values |= {q: start.get(q, arb(0)) for q in loops.y}
    return tuple(_told(there, {q: float(start.get(q, arb(0))) for q in loops.z}))


def _told(loops: Loops, at: dict[str, float]) -> Iterator[_Block]:
    """Closures one after the other, at the closed position near the start."""
    waiting: list[tuple[tuple[int, str], ...]] = []
    first = 0
    for closure in loops.definition["closures"]:
        names_of = ROWS[closure["type"]]
        waiting.append(tuple((first + i, row) for i, row in enumerate(names_of)))
        first += len(names_of)
    left, names = list(loops.z), list(loops.kinds)
    with ctx.workprec(64):
        while waiting and left:
            for rows in waiting:
                _, G, _ = loops._floats(at, [k for k, _ in rows])
                own = [q for q in left if np.abs(G[:, names.index(q)]).max() > 1e-12]
                columns = [names.index(q) for q in own]
                if own and np.linalg.matrix_rank(G[:, columns], tol=1e-9) == len(own):
                    loops.approach(_Block(tuple(own), rows, (), 0), at)
                    _, G, _ = loops._floats(at, [k for k, _ in rows])
                    block = _Block(tuple(own), rows, tuple(rows[i][0] for i in _pivots(G[:, columns])), 0)
                    yield replace(block, sign=block.sign_at(loops, at))
                    left = [q for q in left if q not in own]
                    waiting.remove(rows)
                    break
            else:
                return


def _pivots(G: Array) -> list[int]:
    """As many rows as there are columns, the largest first, each less what the others have of it."""
    rest, chosen = G.copy(), list[int]()
    for _ in range(G.shape[1]):
        chosen.append(int(np.argmax(np.linalg.norm(rest, axis=1))))
        e = rest[chosen[-1]] / np.linalg.norm(rest[chosen[-1]])
        rest = rest - np.outer(rest @ e, e)
    return sorted(chosen)


def _solved(G: arb_mat, x: arb_mat) -> arb_mat:
    """G^-1 x, not finite where that is not known."""
    try:
        return G.solve(x)
    except ZeroDivisionError:
        return arb_mat(x.nrows(), x.ncols(), [arb("nan")] * (x.nrows() * x.ncols()))
