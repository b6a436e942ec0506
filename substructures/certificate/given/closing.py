"""Closed positions of the closures of one instance, to the digits of floats, by Newton's method from several starts.

Each closure is looked at with nothing but the bodies that it depends on. No formula of the program is looked at.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, count, groupby
from typing import Any

import numpy as np
from flint import arb, ctx

from substructures.certificate.bodies import MASSES, Bodies, coordinates_of
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.closures import ROWS, closure_outputs
from substructures.certificate.described import closures_in, coordinates_in
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.relations import mover

Array = Any
#: bodies of a tree at values of all symbols
Build = Callable[[Plain, Mapping[str, Plain], Mapping[str, Ball]], tuple[Numbers, Bodies, Any]]
PRIMES = ("", "'", "''")
#: starts that are tried, and steps of Newton's method from each
STARTS, MANY, STEPS = 5, 40, 12
#: steps from the start to where independent coordinates are
WAY = 12
#: of what no closure depends on, beside masses
LAWS = frozenset(("stiffness", "rest", "damping", "armature", "limits", "friction"))


class Closing:
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
        numbers, bodies, inside = self.build(self.tree, {self.name: self.definition}, values)
        closed = closures_in(self.tree, {self.name: self.definition}, numbers, inside)
        closure_outputs(result, bodies, closed, rates(bodies, values, "'"))
        return of_coordinates(result, bodies)

    def turned(self, q: str, x: Ball) -> Ball:
        """Between -pi and pi of where it starts, if it is an angle."""
        if self.kinds[q] != "R":
            return x
        start = Numbers({}).read(self.definition.get("start", {}).get(q.partition(".")[2], 0))
        return x - 2 * arb.pi() * round(float((x - start) / (2 * arb.pi())))

    def close(self, block: Block, at: dict[str, float]) -> bool:
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

    def follow(self, blocks: Sequence[Block], at: dict[str, float]) -> bool:
        """Newton's method along the straight line of independent coordinates from the start, on one side."""
        start = {f"{self.name}.{q}": float(Numbers({}).read(x)) for q, x in self.definition.get("start", {}).items()}
        ends, sides = {q: float(self.values[q]) for q in self.y}, list[int]()
        at |= {q: start.get(q, 0.0) for q in self.z}
        for k in range(WAY + 1):
            here = {q: start.get(q, 0.0) + k / WAY * (x - start.get(q, 0.0)) for q, x in ends.items()}
            at |= here
            if not all(self._newton(block, at) for block in blocks):
                return False
            found = [block.sign_at(self, at) for block in blocks]
            sides = sides or found
            if found != sides:
                return False
        return True

    def approach(self, block: Block, at: dict[str, float]) -> None:
        """The nearest closed position."""
        source, start = random.Random(2), {q: at[q] for q in block.z}  # noqa: S311 -- the same for everybody
        found: list[tuple[float, dict[str, float]]] = []
        for k in range(STARTS):
            at |= start if k == 0 else {q: x + source.uniform(-3, 3) for q, x in start.items()}
            if self._newton(block, at):
                place = {q: float(self.turned(q, arb(at[q]))) for q in block.z}
                found.append((sum(abs(x - start[q]) for q, x in place.items()), place))
        at |= min(found, key=lambda pair: pair[0])[1] if found else start

    def _newton(self, block: Block, at: dict[str, float]) -> bool:
        names = list(self.kinds)
        columns, every = [names.index(q) for q in block.z], [k for k, _ in block.all_rows]
        for _ in range(STEPS):
            phi, G, alignment = self.floats(at, every)
            if not np.isfinite([*phi, *G.ravel()]).all():
                return False
            step = np.linalg.lstsq(G[:, columns], phi, rcond=1e-12)[0]
            size = np.abs(step).max()
            at |= {q: at[q] - x * min(1.0, 1.0 / size) if size else at[q] for q, x in zip(block.z, step, strict=True)}
            if size < 1e-13:
                return bool(np.abs(phi).max() < 1e-9 and min(alignment, default=1.0) > 0)
        return False

    @cached_property
    def _alone(self) -> dict[int, tuple[int, Closing]]:
        """By row its number in its closure, and this closure with nothing but the bodies that its ends are on."""
        rows = count()
        ones = [(each, Closing(self.name, _alone(self.definition, each), {}, self.build)) for each in self.closures]
        return {next(rows): (k, one) for each, one in ones for k, _ in enumerate(ROWS[each["type"]])}

    @property
    def closures(self) -> Sequence[Plain]:
        """Those of the definition."""
        found: Sequence[Plain] = self.definition["closures"]
        return found

    def floats(self, at: Mapping[str, float], rows: Sequence[int]) -> tuple[Array, Array, list[float]]:
        """phi and G of rows, and how the ends of their closures are aligned."""
        names, values = list(self.kinds), {**self.values, **{q: arb(x) for q, x in at.items()}}
        phi, matrix, alignment = np.zeros(len(rows)), np.zeros((len(rows), len(names))), list[float]()
        for _, some in groupby(enumerate(rows), lambda each: id(self._alone[each[1]][1])):
            places = [(i, self._alone[k]) for i, k in some]
            one = places[0][1][1]
            found, columns = one.rows(values), [names.index(q) for q in one.kinds]
            residual, G = (found[f"closure.{x}"].entries for x in ("residual", "jacobian"))
            for i, (k, _) in places:
                phi[i] = float(residual.get((k,), arb(0)))
                matrix[i, columns] = [float(G.get((k, a), arb(0))) for a in range(len(columns))]
                alignment.append(float(found["closure.alignment"].entries[k,].mid()))
        return phi, matrix, [x for x in alignment if x]


@dataclass(frozen=True)
class Block:
    """Closures, one or all that are left: their unknown coordinates, all rows by number and name, those that tell the
    coordinates, and the sign of their determinant on the branch.
    """

    z: tuple[str, ...]
    all_rows: tuple[tuple[int, str], ...]
    rows: tuple[int, ...]
    sign: int

    def sign_at(self, loops: Closing, at: Mapping[str, float]) -> int:
        """Of the determinant."""
        names = list(loops.kinds)
        _, G, _ = loops.floats(at, self.rows)
        return int(np.sign(np.linalg.det(G[:, [names.index(q) for q in self.z]])))


def blocks_of(loops: Closing, at: dict[str, float]) -> Iterator[Block]:
    """Closures one after the other, at the closed position near the start."""
    number = count()
    waiting = [tuple((next(number), row) for row in ROWS[each["type"]]) for each in loops.closures]
    left, names = list(loops.z), list(loops.kinds)
    with ctx.workprec(64):
        while waiting and left:
            # one by one, and where none tells its coordinates by itself all together
            for rows in (*waiting, tuple(chain(*waiting))):
                _, G, _ = loops.floats(at, [k for k, _ in rows])
                own = [q for q in left if np.abs(G[:, names.index(q)]).max() > 1e-12]
                columns = [names.index(q) for q in own]
                if own and np.linalg.matrix_rank(G[:, columns], tol=1e-9) == len(own):
                    loops.approach(Block(tuple(own), rows, (), 0), at)
                    _, G, _ = loops.floats(at, [k for k, _ in rows])
                    block = Block(tuple(own), rows, tuple(rows[i][0] for i in _pivots(G[:, columns])), 0)
                    yield replace(block, sign=block.sign_at(loops, at))
                    left = [q for q in left if q not in own]
                    waiting = [some for some in waiting if not set(some) <= set(rows)]
                    break
            else:
                return


def _alone(definition: Plain, closure: Plain) -> Plain:
    """A definition with one closure, the bodies between its ends and the base, and those whose joints move these."""
    bodies, ports = definition["bodies"], definition.get("ports", ())
    by_name = {body["name"]: body for body in bodies}
    moving = {q: body["name"] for body in bodies for q in coordinates_of(body)}
    of_port, kept = {port["name"]: port["body"] for port in ports}, set[str]()
    waiting = [of_port.get(end, end) for end in (closure["from"], closure.get("to", "world"))]
    while waiting:
        body = by_name.get(waiting.pop())
        if body is not None and body["name"] not in kept:
            kept.add(body["name"])
            waiting += [body["parent"], *(moving[mover(definition, q)] for q in coordinates_of(body))]
    relations = [each for each in definition.get("relations", ()) if moving[each["coordinate"]] in kept]
    own = {"bodies": [body for body in bodies if body["name"] in kept], "relations": relations}
    return {**definition, **own, "ports": [p for p in ports if p["body"] in (*kept, "base")], "closures": [closure]}


def _pivots(G: Array) -> list[int]:
    """As many rows as there are columns, the largest first, each less what the others have of it."""
    rest, chosen = G.copy(), list[int]()
    for _ in range(G.shape[1]):
        chosen.append(int(np.argmax(np.linalg.norm(rest, axis=1))))
        e = rest[chosen[-1]] / np.linalg.norm(rest[chosen[-1]])
        rest = rest - np.outer(rest @ e, e)
    return sorted(chosen)
