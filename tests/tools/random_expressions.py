"""Random expressions together with their values, computed apart from the package."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.trigonometry import cos, sin


@dataclass(frozen=True)
class Sample:
    """Expressions over the symbols x, y, q1, q2, their values at ``point``, and the number of operations tried."""

    graph: Graph
    exprs: list[Expr]
    floats: list[float]
    point: dict[str, float]


def sample(seed: int, size: int = 40, divide: bool = True) -> Sample:
    """Random sums, products, quotients, sines and cosines, many of them equal as functions."""
    rng = random.Random(seed)  # noqa: S311 -- test data
    graph = Graph()
    point = {name: rng.uniform(-1.5, 1.5) for name in ("x", "y", "q1", "q2")}
    exprs = [graph.symbol(n) for n in point] + [graph.number(rng.randint(-3, 3)) for _ in range(2)] + [graph.pi]
    floats = [*point.values(), *(float(int(e.value)) for e in exprs[4:6]), math.pi]
    angles = [(graph.symbol(n), point[n]) for n in ("q1", "q2")]
    while len(exprs) < size:
        i, j = rng.randrange(len(exprs)), rng.randrange(len(exprs))
        op = rng.choice("++-**nsct/" if divide else "++-**nsct")
        (a, u), (b, v) = (exprs[i], floats[i]), (exprs[j], floats[j])
        if op in "sc":
            k, m, n = rng.randint(-2, 2), rng.randint(-2, 2), rng.randint(-12, 12)
            angle = k * angles[0][0] + m * angles[1][0] + graph.pi * n / 6
            value = k * angles[0][1] + m * angles[1][1] + math.pi * n / 6
            new, number = (sin(angle), math.sin(value)) if op == "s" else (cos(angle), math.cos(value))
        elif op == "/":
            if abs(v) < 0.1 or b.is_zero:
                continue
            new, number = a / b, u / v
        else:
            new = {"+": a + b, "-": a - b, "*": a * b, "n": -a, "t": a * a}[op]
            number = {"+": u + v, "-": u - v, "*": u * v, "n": -u, "t": u * u}[op]
        if abs(number) < 1e3:
            exprs.append(new)
            floats.append(number)
    return Sample(graph, exprs, floats, point)


def collected(graph: Graph, **outputs: Formulas | Expr) -> Program:
    """A program of these outputs; all symbols are parameters."""
    formulas = {n: o if isinstance(o, Formulas) else Formulas((), {(): o}) for n, o in outputs.items()}
    names = {str(e.value) for e in graph.nodes if e.op == "sym"}
    return program(graph, formulas, {n: Symbol(n, "parameter", "m") for n in names})
