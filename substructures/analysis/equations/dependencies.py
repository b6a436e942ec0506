"""Linear dependencies with constant coefficients between columns of functions, exactly.

Columns F_1(q), ..., F_m(q) are given as rows of formulas for exact values of q. These are combined:

* over a prime field (:mod:`substructures.expr.rings.modular`) the rank of samples at random points is that of the
  functions, with an error probability of about degree / 2**100; so are the reduced echelon form, the columns that take
  part in each dependency, and the values of their coefficients at one point;
* the coefficients themselves, functions of whatever symbols are not coordinates, follow from relations that are known
  beforehand, by elimination in sparse rows (:mod:`.relations`); small fractions are told by their values. Where these
  do not suffice, they follow from samples at exact points (angles that are multiples of a quarter turn, then of an
  eighth), where every row is a small formula in these symbols: one small linear system for each dependent column. They
  are compared with their values in the field.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from substructures.analysis.equations.relations import Entry, Relations
from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Symbol, program
from substructures.expr.rings.modular import Field, NoSquareRoot

#: exact samples after which the search for rows ends
MAX_SAMPLES = 400
#: of these, samples at quarter turns, and with those at eighths; behind them there are multiples of 15 degrees: a field
#: may have square roots in none of the few positions of one coordinate
COARSE, FINE = 8, 72
#: numerators and denominators of coefficients that are told by their values in the field
SMALL = 2**16


@dataclass(frozen=True)
class Functions:
    """The columns. ``angular``: for every coordinate, whether it is an angle; ``random``: rows of values at a new
    random point of the field (with fixed values of all other symbols); ``exact``: rows of formulas in a graph for
    values of the coordinates; ``symbols``: values in the field of all symbols that are not coordinates; ``known``:
    rows of formulas r with sum_j r_j F_j = 0, if any are known; columns beyond the last one are to be eliminated.
    """

    columns: int
    angular: Sequence[bool]
    field: Field
    random: Callable[[], list[dict[int, int]]]
    exact: Callable[[Graph, Sequence[Expr]], list[dict[int, Expr]]]
    symbols: Mapping[str, int]
    known: Callable[[Graph], list[dict[int, Expr]]] | None = None


@dataclass(frozen=True)
class Dependencies:
    """``base``: numbers of independent columns, as far left as possible. ``others``: for every other column its
    coefficients by column of the base: F_j = sum_b others[j][b] F_b; empty for zero columns."""

    base: tuple[int, ...]
    others: Mapping[int, Mapping[int, Expr]]


def dependencies(functions: Functions) -> Dependencies:
    """All dependencies. Raises TooLarge where MAX_SAMPLES exact points do not suffice for a coefficient."""
    echelon, rows, is_new = _Echelon(functions.field.prime), functions.random(), True
    while is_new:
        for row in rows:
            echelon.add(row)
        # a random sum of rows of another random point that is in the span of those before tells that all are
        rows = functions.random()
        is_new = echelon.add(_random_sum(rows, functions.field))
    reduced = echelon.reduced()
    expected = {
        j: {b: row[j] for b, row in sorted(reduced.items()) if j in row}
        for j in range(functions.columns)
        if j not in reduced
    }
    return Dependencies(tuple(sorted(reduced)), _solved(functions, expected))


def _random_sum(rows: Iterable[Mapping[int, int]], field: Field) -> dict[int, int]:
    """Rows times random elements."""
    found: dict[int, int] = {}
    for row in rows:
        factor = field.draw()
        for j, x in row.items():
            found[j] = found.get(j, 0) + factor * x
    return {j: x % field.prime for j, x in found.items()}


def _solved(functions: Functions, expected: Mapping[int, Mapping[int, int]]) -> dict[int, dict[int, Expr]]:
    """Formulas of all coefficients, from their values: by what is known of the columns, and the rest by samples."""
    search, prime = _Search(functions), functions.field.prime
    one, known = Entry(search.graph.one, 1), search.known()
    auxiliary = {j for row in known for j in row if j >= functions.columns}
    relations = Relations(prime, expected, auxiliary)
    # columns that are zero first: nothing else is to be written in them
    for row in [*({j: one} for j, coefficients in expected.items() if not coefficients), *known]:
        relations.add(row)
    equal: dict[tuple[tuple[int, int], ...], int] = {}
    for j, coefficients in expected.items():
        # of columns that are equal one is searched for
        twin = equal.setdefault(tuple(coefficients.items()), j)
        if j not in relations.rows:
            # unless what is known of the other one is in terms of this one
            known_there = twin != j and j not in relations.rows[twin]
            found = {twin: one} if known_there else search.coefficients(j, coefficients)
            relations.add({j: one, **{b: Entry(-x.formula, -x.value % prime) for b, x in found.items()}})
    result = {}
    for j, coefficients in expected.items():
        row = {b: x for b, x in sorted(relations.rows[j].items()) if b != j}
        if {b: -x.value % prime for b, x in row.items()} != coefficients:
            raise ArithmeticError("the coefficients of a dependency differ from their values in the field")
        result[j] = {b: -x.formula for b, x in row.items()}
    return result


def _fraction(value: int, prime: int) -> Fraction | None:
    """The small fraction that has this value in the field, by Euclid's algorithm; None where there is none, as for all
    but one of some 2^60 values.

    Source: P. S. Wang, A p-adic algorithm for univariate partial fractions, SYMSAC 1981.
    """
    (a, b), (s, t) = (prime, value % prime), (0, 1)
    while b > SMALL:
        n = a // b
        (a, b), (s, t) = (b, a - n * b), (t, s - n * t)
    return Fraction(b, t) if 0 < abs(t) <= SMALL else None


class _Echelon:
    """Rows over the prime field by pivot column; the pivot is one, and the leftmost entry."""

    def __init__(self, prime: int) -> None:
        self.prime = prime
        self.rows: dict[int, dict[int, int]] = {}

    def add(self, entries: Mapping[int, int]) -> bool:
        """Whether the row was independent of those before."""
        row = {j: x for j, x in entries.items() if x}
        while row:
            pivot = min(row)
            known = self.rows.get(pivot)
            if known is None:
                inverse = pow(row[pivot], -1, self.prime)
                self.rows[pivot] = {j: x * inverse % self.prime for j, x in row.items()}
                return True
            # row - row_pivot known, whose pivot is one
            row = self._minus(row, row[pivot], known)
        return False

    def reduced(self) -> dict[int, dict[int, int]]:
        """The reduced echelon form."""
        result: dict[int, dict[int, int]] = {}
        for pivot in sorted(self.rows, reverse=True):
            row = self.rows[pivot]
            for j in [j for j in row if j in result]:
                row = self._minus(row, row[j], result[j])
            result[pivot] = row
        return result

    def _minus(self, row: Mapping[int, int], factor: int, other: Mapping[int, int]) -> dict[int, int]:
        result = dict(row)
        for j, x in other.items():
            value = (result.get(j, 0) - factor * x) % self.prime
            if value:
                result[j] = value
            else:
                result.pop(j, None)
        return result


class _Search:
    """Exact samples, made as they are needed."""

    def __init__(self, functions: Functions) -> None:
        # a graph of its own: no constant may be written in the symbols of other formulas
        self.functions, self.graph, self.prime = functions, Graph(), functions.field.prime
        self.rows: list[dict[int, Entry]] = []
        self.number, self.random = 0, np.random.default_rng(0)

    def known(self) -> list[dict[int, Entry]]:
        """Rows of relations that need no search."""
        return self._entries(self.functions.known(self.graph)) if self.functions.known else []

    def coefficients(self, j: int, expected: Mapping[int, int]) -> dict[int, Entry]:
        """c with F_j = sum c_b F_b: small fractions, or by as many independent rows as there are coefficients."""
        numbers = {b: _fraction(value, self.prime) for b, value in expected.items()}
        if None not in numbers.values():
            return {b: Entry(self.graph.number(x or 0), expected[b]) for b, x in numbers.items()}
        support, echelon, at = list(expected), _Echelon(self.prime), 0
        chosen: list[dict[int, Entry]] = []
        while len(chosen) < len(support):
            while at == len(self.rows):
                self._more()
            row = self.rows[at]
            at += 1
            if echelon.add({b: row[b].value for b in support if b in row}):
                chosen.append(row)
        zero = Entry(self.graph.zero, 0)
        found = self._solved([[row.get(b, zero) for b in (*support, j)] for row in chosen], len(support))
        return dict(zip(support, found, strict=True))

    def _more(self) -> None:
        if self.number == MAX_SAMPLES:
            raise TooLarge("the search for dependencies (in samples)", self.number + 1, MAX_SAMPLES)
        parts = 4 if self.number < COARSE else 8 if self.number < FINE else 24
        point = []
        for turns in self.functions.angular:
            k = int(self.random.integers(parts)) if self.number else 0
            point.append(self.graph.pi * (2 * k) / parts if turns else self.graph.number(k))
        self.number += 1
        # not where a loop cannot be closed, or in a position whose square roots the field has not
        with suppress(NoSquareRoot, ZeroDivisionError, ValueError):
            rows = [row for row in self.functions.exact(self.graph, point) if row]
            self.rows += sorted(self._entries(rows), key=len)

    def _entries(self, rows: list[dict[int, Expr]]) -> list[dict[int, Entry]]:
        """Formulas with their values."""
        index: dict[tuple[int, ...], Expr | int] = {(r, j): x for r, row in enumerate(rows) for j, x in row.items()}
        size = (len(rows), max((j for row in rows for j in row), default=0) + 1)
        symbols = {name: Symbol(name, "parameter") for name in self.functions.symbols}
        formulas = program(self.graph, {"rows": Formulas(size, index)}, symbols)
        values = self.functions.field.evaluate(formulas, self.functions.symbols, "rows")
        return [
            {j: Entry(x, values[r, j]) for j, x in row.items() if values.get((r, j), 0)} for r, row in enumerate(rows)
        ]

    def _solved(self, system: list[list[Entry]], size: int) -> list[Entry]:
        """Gaussian elimination; pivots are numbers where there are any."""
        place: dict[int, int] = {}
        for _ in range(size):
            open_rows = [r for r in range(size) if r not in place.values()]
            r, c = min(
                ((r, c) for r in open_rows for c in range(size) if c not in place and system[r][c].value),
                key=lambda at: (not system[at[0]][at[1]].formula.is_number, system[at[0]][at[1]].formula.index),
            )
            # divide the row by its pivot, and take it from all others (Gauss and Jordan)
            place[c] = r
            pivot = system[r][c]
            inverse = pow(pivot.value, -1, self.prime)
            system[r] = [Entry(x.formula / pivot.formula, x.value * inverse % self.prime) for x in system[r]]
            for other in range(size):
                if other != r and system[other][c].value:
                    system[other] = self._without(system[other], system[other][c], system[r])
        return [system[place[c]][-1] for c in range(size)]

    def _without(self, row: list[Entry], factor: Entry, other: list[Entry]) -> list[Entry]:
        result = []
        for x, y in zip(row, other, strict=True):
            value = (x.value - factor.value * y.value) % self.prime
            # what is zero in the field is zero
            result.append(Entry(x.formula - factor.formula * y.formula if value else self.graph.zero, value))
        return result
