"""What the canonical form is built from: symbols, roots, other functions, and angles; one number for each.

Functions are recognised by the canonical form of their arguments, so that equal ones get the same number.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import gcd
from typing import Any, NamedTuple

from flint import fmpz

from substructures.expr.graph import Expr
from substructures.expr.walk import build

ANGULAR = frozenset(("sin", "cos", "tan"))
RATIONAL = frozenset(("int", "rat", "sym", "add", "sub", "mul", "neg", "div"))
_MAX_FACTORED_BITS = 128


class Basis(NamedTuple):
    """A basis function: product of powers of generators, times 1, cos or sin of a combination of angle atoms."""

    monomial: tuple[tuple[int, int], ...] = ()
    trig: str = ""
    angle: tuple[tuple[int, Fraction], ...] = ()


class Sum(NamedTuple):
    """A linear combination of basis functions over another one (empty: over 1), both in display order."""

    terms: tuple[tuple[Basis, Fraction], ...]
    denominator: tuple[tuple[Basis, Fraction], ...] = ()


@dataclass(frozen=True, slots=True)
class Angle:
    """Argument of a trigonometric function: combination of angle atoms, plus turns * pi."""

    atoms: dict[int, Fraction]
    turns: Fraction


@dataclass(frozen=True, slots=True)
class Product:
    """Any other function: a rational number times generators."""

    factor: Fraction
    ids: tuple[int, ...]


def is_function(node: Expr) -> bool:
    """True for everything that is not a rational operation."""
    return node.op not in RATIONAL


@dataclass
class Generators:
    """The numbering. ``squares`` holds what the square of a root is: an integer, or a sum."""

    keys: dict[tuple[Any, ...], int] = field(default_factory=dict)
    atoms: list[Expr] = field(default_factory=list)
    order: list[tuple[Any, ...]] = field(default_factory=list)
    squares: dict[int, int | Sum] = field(default_factory=dict)
    forms: dict[Expr, Angle | Product] = field(default_factory=dict)

    def intern(self, key: tuple[Any, ...], expr: Expr, rank: int) -> int:
        """Number of the generator with this key; ``expr`` represents it, ``rank`` and name give its place."""
        found = self.keys.get(key)
        if found is None:
            found = self.keys[key] = len(self.atoms)
            self.atoms.append(expr)
            text = str(expr.value) if expr.op == "sym" else expr.op
            self.order.append((rank, natural(text), expr.index))
        return found

    def symbol(self, node: Expr) -> int:
        """Number of a symbol."""
        return self.intern(("sym", node.value), node, 2)

    def root(self, graph: Any, n: int) -> int:
        """Number of the square root of a prime (or of a number that is not factored)."""
        i = self.intern(("root", n), graph.sqrt(graph.number(n)), 0)
        self.squares[i] = n
        return i

    def plain(self, nodes: Sequence[Expr]) -> set[int]:
        """What nodes consist of but angles: symbols, functions, and roots with what they are roots of."""
        forms = [self.forms[n] for n in nodes if is_function(n)]
        used = {self.symbol(n) for n in nodes if n.op == "sym"}
        used.update(i for f in forms if isinstance(f, Product) for i in f.ids)
        if any(isinstance(f, Angle) and (f.turns * 2).denominator != 1 for f in forms):
            used.update(self.root(nodes[0].graph, n) for n in (2, 3))
        stack = list(used)
        while stack:
            square = self.squares.get(stack.pop())
            if isinstance(square, Sum):
                new = {i for basis, _ in square.terms for i, _ in basis.monomial} - used
                used |= new
                stack.extend(new)
        return used

    def classify(self, node: Expr, args: list[Sum]) -> None:
        """Enter a function node, given the canonical forms of its arguments."""
        if node.op in ANGULAR:
            self.forms[node] = self._angle(node, args[0])
        elif node is node.graph.pi:
            self.forms[node] = Product(Fraction(1), (self.intern(("pi",), node, 1),))
        elif node.op == "sqrt":
            self.forms[node] = self._square_root(node, args[0])
        else:
            self.forms[node] = Product(Fraction(1), (self.intern((node.op, *args), node, 3),))

    def _square_root(self, node: Expr, arg: Sum) -> Product:
        x = node.args[0]
        if x.op == "int" and x.value > 0 and x.value.bit_length() <= _MAX_FACTORED_BITS:
            outside, ids = 1, []
            for prime, power in fmpz(int(x.value)).factor():
                outside *= int(prime) ** (power // 2)
                if power % 2:
                    ids.append(self.root(node.graph, int(prime)))
            return Product(Fraction(outside), tuple(ids))
        i = self.intern(("sqrt", arg), node, 3)
        if not arg.denominator and all(not b.trig and all(e > 0 for _, e in b.monomial) for b, _ in arg.terms):
            self.squares[i] = arg
        return Product(Fraction(1), (i,))

    def _angle(self, node: Expr, arg: Sum) -> Angle:
        pi = Basis(((self.intern(("pi",), node.graph.pi, 1), 1),))
        if arg.denominator:
            first = arg.terms[0][1]
            key = ("angle", Sum(tuple((b, c / first) for b, c in arg.terms), arg.denominator))
            return Angle({self.intern(key, node.args[0] / node.graph.number(first), 3): first}, Fraction(0))
        turns = dict(arg.terms).get(pi, Fraction(0))
        atoms = {self._atom(node, b): c for b, c in arg.terms if b != pi}
        # what is left of pi after quarter turns stays an angle, unless its sine and cosine are built from roots
        if (turns * 12).denominator != 1:
            atoms[self._atom(node, pi)] = turns % Fraction(1, 2)
            turns -= turns % Fraction(1, 2)
        return Angle(atoms, turns % 2)

    def _atom(self, node: Expr, basis: Basis) -> int:
        return self.intern(("angle", basis), self.basis_expr(basis, node), 2)

    def basis_expr(self, basis: Basis, like: Expr) -> Expr:
        """A basis function as expression, in the graph of ``like``."""
        graph = like.graph
        result = graph.one
        for i, power in basis.monomial:
            result = times_power(result, self.atoms[i], power)
        if basis.trig:
            angle = graph.sum(self.atoms[i] * graph.number(c) for i, c in basis.angle)
            result = result * build(graph, basis.trig, [angle])
        return result

    def units(self, angles: Iterable[Angle]) -> dict[int, Fraction]:
        """For every angle atom the largest angle of which all occurring ones are multiples."""
        result: dict[int, Fraction] = {}
        for angle in angles:
            for i, c in angle.atoms.items():
                u = result.get(i, Fraction(0))
                common = gcd(u.numerator * c.denominator, c.numerator * u.denominator)
                result[i] = Fraction(common, u.denominator * c.denominator)
        return result


def turned(turns: Fraction, constant: Callable[[int], Any], root: Callable[[int], Any]) -> tuple[Any, Any]:
    """(cos, sin) of turns * pi, a multiple of pi/12, in a ring that has numbers and the roots of 2 and 3."""
    n = int(turns * 12)
    # n/12 = a/4 + b/6
    a, b = n % 2, (n - 3 * (n % 2)) // 2
    re, im = (constant(x) for x in [(1, 0), (0, 1), (-1, 0), (0, -1)][b // 3 % 4])
    if b % 3:
        small, large = constant(1) / 2, root(3) / 2
        x, y = (large, small) if b % 3 == 1 else (small, large)
        re, im = re * x - im * y, re * y + im * x
    if a:
        half = root(2) / 2
        re, im = (re - im) * half, (re + im) * half
    return re, im


def natural(text: str) -> tuple[Any, ...]:
    """Sort key by which q2 comes before q10."""
    parts = re.split(r"(\d+)", text, flags=re.ASCII)
    return tuple((len(p.lstrip("0")), p) if i % 2 else p for i, p in enumerate(parts))


def times_power(result: Expr, base: Expr, power: int) -> Expr:
    """result * base**power without a limit on the exponent."""
    n, square = abs(power), base
    while n:
        if n & 1:
            result = result * square if power > 0 else result / square
        n >>= 1
        square = square * square if n else square
    return result
