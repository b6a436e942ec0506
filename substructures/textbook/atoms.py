"""The quantities that formulas are written in, and their order in a product.

An atom is a symbol, or a function that is no cosine or sine. Masses and moments of inertia come first, lengths and
other parameters next, what moves (coordinates, velocities, accelerations) last: ``m2*l1*l2*q1'``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

from substructures.expr.graph import Expr
from substructures.expr.program import Symbol
from substructures.expr.rings.generators import natural
from substructures.expr.walk import reachable

NUMBER, MASS, PARAMETER, INPUT, MOVING = range(5)
_MOVING = ("coordinate", "velocity", "acceleration", "time")
#: units of momenta, which change with time as velocities do
_MOMENTA = ("kg m/s", "kg m^2/s")

#: terms of what is under a root
SHORT = 20
#: powers of atoms, by their place in the order
Monomial = tuple[tuple[int, int], ...]
#: a polynomial (also with negative powers) in atoms
Polynomial = Mapping[Monomial, Fraction]


@dataclass(frozen=True)
class Atoms:
    """Atoms in their order; ``symbols`` describes the symbols by name."""

    exprs: tuple[Expr, ...]
    symbols: Mapping[str, Symbol]

    @cached_property
    def ranks(self) -> tuple[int, ...]:
        """One of NUMBER to MOVING for every atom."""
        return tuple(self._rank(e) for e in self.exprs)

    @cached_property
    def place(self) -> Mapping[Expr, int]:
        """Where an atom stands in the order."""
        return {e: i for i, e in enumerate(self.exprs)}

    def _rank(self, atom: Expr) -> int:
        if atom.op == "sym":
            return _rank_of(self.symbols[str(atom.value)])
        names = [str(e.value) for e in reachable([atom]) if e.op == "sym"]
        # those of constant angles are none of the program
        ranks = [_rank_of(self.symbols[name]) for name in names if name in self.symbols]
        if not ranks:
            return NUMBER
        return MOVING if MOVING in ranks else PARAMETER

    @cached_property
    def roots(self) -> Mapping[int, Polynomial]:
        """What the squares of roots are, which occur in their place: numbers, and sums of products of symbols."""
        arguments = {i: e.args[0] for i, e in enumerate(self.exprs) if e.op == "sqrt"}
        found = _polynomials(arguments.values(), self.place) if arguments else {}
        return {i: found[arg] for i, arg in arguments.items() if arg in found}

    def is_rate(self, atom: Expr) -> bool:
        """Whether it changes with velocities, accelerations or time, or is a function of what moves."""
        is_place = atom.op == "sym" and self.symbols[str(atom.value)].kind == "coordinate"
        return self.ranks[self.place[atom]] == MOVING and not is_place

    def is_momentum(self, atom: Expr) -> bool:
        """Whether it is a momentum, which is written before cosines and sines."""
        return atom.op == "sym" and self.symbols[str(atom.value)].unit in _MOMENTA

    def acts(self, found: Iterable[object]) -> bool:
        """Whether an input is among them."""
        return any(isinstance(x, Expr) and self.ranks[self.place[x]] == INPUT for x in found)

    def split(self, monomial: Monomial) -> tuple[Monomial, Monomial]:
        """What is constant, and what moves."""
        at_rest = tuple((i, n) for i, n in monomial if self.ranks[i] != MOVING)
        return at_rest, tuple((i, n) for i, n in monomial if self.ranks[i] == MOVING)

    def factors(self, monomial: Monomial) -> list[tuple[Expr, int]]:
        """The powers in their order."""
        return [(self.exprs[i], n) for i, n in monomial]


def ordered(exprs: Iterable[Expr], symbols: Mapping[str, Symbol]) -> Atoms:
    """Atoms in the order of products: by rank, then by name."""
    raw = Atoms(tuple(dict.fromkeys(exprs)), symbols)
    ranks = dict(zip(raw.exprs, raw.ranks, strict=True))
    return Atoms(tuple(sorted(raw.exprs, key=lambda e: (ranks[e], _name(e)))), symbols)


def _rank_of(symbol: Symbol) -> int:
    if symbol.kind in _MOVING or symbol.unit in _MOMENTA:
        return MOVING
    if symbol.kind == "input":
        return INPUT
    # masses and moments of all orders: kg, kg m, kg m^2
    is_mass = symbol.kind == "inertia" or symbol.unit.partition("*")[0].partition(" ")[0] == "kg"
    is_mass = is_mass and not {"s", "rad"} & set(_letters(symbol.unit))
    return MASS if is_mass else PARAMETER


def _letters(unit: str) -> list[str]:
    return "".join(c if c.isalpha() else " " for c in unit).split()


def _name(expr: Expr) -> Any:
    if expr.op == "sym":
        name = str(expr.value)
        return 0, natural(name.rpartition(".")[2]), natural(name)
    return 1, natural(expr.op), tuple(sorted(_name(e) for e in reachable([expr]) if e.op == "sym")), expr.index


def monomial_key(monomial: Monomial) -> tuple[Any, ...]:
    """Order of terms: by degree, then by atoms, high powers first."""
    return sum(n for _, n in monomial), tuple((i, -n) for i, n in monomial)


def times(a: Monomial, b: Monomial, power: int = 1) -> Monomial:
    """a * b^power."""
    powers = dict(a)
    for i, n in b:
        powers[i] = powers.get(i, 0) + n * power
    return tuple(sorted((i, n) for i, n in powers.items() if n))


def multiplied(a: Polynomial, b: Polynomial) -> dict[Monomial, Fraction]:
    """a * b."""
    result: dict[Monomial, Fraction] = {}
    for (m, v), (n, w) in product(a.items(), b.items()):
        key = times(m, n)
        result[key] = result.get(key, Fraction(0)) + v * w
    return {m: c for m, c in result.items() if c}


def _operation(op: str, args: Sequence[Polynomial]) -> Polynomial:
    if op == "mul":
        return multiplied(*args)
    sign = 1 if op == "add" else -1
    first = args[0] if len(args) > 1 else {}
    found = {m: first.get(m, Fraction(0)) + sign * args[-1].get(m, Fraction(0)) for m in {*first, *args[-1]}}
    return {m: c for m, c in found.items() if c}


def _polynomials(exprs: Iterable[Expr], place: Mapping[Expr, int]) -> dict[Expr, Polynomial]:
    """Those of the expressions, and of what they consist of, that are short sums of products of symbols."""
    found: dict[Expr, Polynomial] = {}
    for node in reachable(list(exprs)):
        args = [found[a] for a in node.args if a in found]
        if node in place and node.op == "sym":
            found[node] = {((place[node], 1),): Fraction(1)}
        elif node.is_number:
            found[node] = {(): Fraction(node.value)}
        elif node.op in ("add", "sub", "mul", "neg") and len(args) == len(node.args):
            some = _operation(node.op, args)
            if len(some) <= SHORT:
                found[node] = some
    return found
