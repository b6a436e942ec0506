"""A program with all operations, all symmetries, shapes of every rank, large and small numbers, zeros."""

from __future__ import annotations

from random_expressions import collected

from substructures.expr.graph import Graph
from substructures.expr.operations import Output
from substructures.expr.program import Formulas, Program
from substructures.expr.trigonometry import cos, sin

#: integer powers of a negative number and of a square root, short and long ones, and reciprocals
EXPONENTS = (2, -1, 3, -2, 7, -5, 16, -33)
POINT = {"arm.q1": 0.6, "arm.q1'": -0.4, "m": 1.3, "l": 0.8, "theta_x": 0.35}


def mixed_program() -> Program:
    g = Graph()
    q, v, m, length, th = (g.symbol(n) for n in POINT)
    k, h = m * length * cos(q), -m * length * sin(q)
    one = [g.function(f, th) for f in ("asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign", "tan")]
    numbers = [g.number(n) for n in (1, -2, 10**30, -(10**25) + 1)] + [
        g.one / 3,
        -g.one / 7,
        g.pi * 2,
        g.sqrt(g.number(2)),
    ]
    vector = [
        *one,
        g.function("atan2", v, q),
        -(k + h) / (m - length),
        (k - h) ** 3,
        g.zero,
        m / (q / v),
        v - (q - m),
    ]
    whole = collected(
        g,
        metric=Formulas((2, 2), {(0, 0): m + 2 * k + length**2, (0, 1): m + k, (1, 1): m}, "symmetric"),
        christoffel=Formulas(
            (3, 3, 3), {(0, 0, 1): h, (0, 1, 1): h, (1, 0, 2): h * 2, (0, 1, 2): -k, (0, 2, 2): k}, "christoffel"
        ),
        list=Formulas((len(vector),), {(i,): e for i, e in enumerate(vector)}),
        numbers=Formulas((len(numbers),), {(i,): e for i, e in enumerate(numbers)}),
        energy=m * v * v / 2,
        nothing=Formulas((2,), {(0,): g.zero}),
        Omega=Formulas((1, 3), {(0, 2): g.one}),
    )
    return _with_powers(whole)


def _with_powers(given: Program) -> Program:
    """With powers as operations of their own, as they are read from documents; graphs make products of them."""
    operations = list(given.operations)
    names = [s.name for s in given.symbols]
    v, m = (operations.index(("sym", names.index(name))) for name in ("arm.q1'", "m"))
    operations.append(("sqrt", m))
    root, entries = len(operations) - 1, []
    for base in (v, root):
        for n in EXPONENTS:
            entries.append(len(operations))
            operations.append(("powi", base, n))
    powers = Output((len(entries),), tuple((i,) for i in range(len(entries))), tuple(entries))
    return Program(given.symbols, tuple(operations), {**given.outputs, "powers": powers})
