"""Expressions and conditions over columns, read as all expressions are and computed for many rows at once."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.errors import InvalidDocument, among
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Program, array, program
from substructures.expr.steps import ExpressionError

Truths = NDArray[np.bool_]
_COMPARISON = re.compile(r"(<=|>=|==|!=|<|>)")
_COMPARED = {
    "<": np.less,
    "<=": np.less_equal,
    ">": np.greater,
    ">=": np.greater_equal,
    "==": np.equal,
    "!=": np.not_equal,
}


@dataclass(frozen=True)
class Expression:
    """An expression in columns; ``text``: as it was written."""

    program: Program
    text: str = ""

    @cached_property
    def needs(self) -> tuple[str, ...]:
        """The columns that it names."""
        return tuple(symbol.name for symbol in self.program.symbols)

    def of(self, columns: Mapping[str, Array], rows: int) -> Array:
        """Its value in each row, (rows,)."""
        with np.errstate(all="ignore"):  # what is not finite is told of the row
            found = interpret_in_blocks(self.program, {name: columns[name] for name in self.needs}, ["value"], rows)
        return np.broadcast_to(found["value"], (rows,))


def read_expression(text: str, known: Collection[str], pointer: str) -> Expression:
    """An expression in columns of these names. Raises InvalidDocument at ``pointer``.

    >>> read_expression("m/(a + 1)", ["a", "m"], "/columns/use").of({"m": np.array([4.0]), "a": np.array([1.0])}, 1)
    array([2.])
    """
    graph, symbols = Graph(), dict[str, Symbol]()

    def lookup(name: str) -> Expr | None:
        """The symbol of a column."""
        if name not in known:
            message = f"unknown column '{name[:80]}'{among(name, known)}"
            raise InvalidDocument.at(pointer, "unknown-column", message)
        symbols.setdefault(name, Symbol(name, "parameter"))
        return graph.symbol(name)

    try:
        value = parse(graph, text, lookup)
        return Expression(program(graph, {"value": array((), lambda: value)}, symbols), text.strip())
    except ExpressionError as error:
        raise InvalidDocument.at(pointer, "bad-expression", str(error)) from None
    except ZeroDivisionError:
        raise InvalidDocument.at(pointer, "division-by-zero", f"'{text[:80]}' divides by zero") from None


@dataclass(frozen=True)
class Condition:
    """Comparisons (left, how, right), of which all of one of the groups have to hold; none: all rows are right."""

    groups: tuple[tuple[tuple[Expression, str, Expression], ...], ...]

    @property
    def needs(self) -> tuple[str, ...]:
        """The columns that it names."""
        sides = (side for group in self.groups for left, _, right in group for side in (left, right))
        return tuple(dict.fromkeys(name for side in sides for name in side.needs))

    def holds(self, columns: Mapping[str, Array], rows: int) -> Truths:
        """Whether it holds, (rows,); not where a number is none."""
        if not self.groups:
            return np.ones(rows, dtype=np.bool_)
        found = np.zeros(rows, dtype=np.bool_)
        for group in self.groups:
            here = np.ones(rows, dtype=np.bool_)
            for left, how, right in group:
                a, b = left.of(columns, rows), right.of(columns, rows)
                here &= _COMPARED[how](a, b) & ~(np.isnan(a) | np.isnan(b))
            found |= here
        return found


def read_condition(text: str, known: Collection[str], pointer: str) -> Condition:
    """Comparisons with ``and`` and ``or``, of which ``and`` binds first. Raises InvalidDocument at ``pointer``.

    >>> read_condition("0 < m <= 2 or a == 7", ["m", "a"], "").holds({"m": np.arange(4.0), "a": np.arange(4.0)}, 4)
    array([False,  True,  True, False])
    """
    groups = []
    for some in re.split(r"\bor\b", text) if text.strip() else ():
        group = []
        for one in re.split(r"\band\b", some):
            sides = _COMPARISON.split(one)
            if len(sides) < 3:
                message = f"'{one.strip()[:80]}' is no truth value: compare, as in 'mass < 3', with < <= > >= == !="
                raise InvalidDocument.at(pointer, "comparison-expected", message)
            if any(side.count("(") != side.count(")") for side in sides):
                message = "no parentheses around comparisons: 'and' binds before 'or'"
                raise InvalidDocument.at(pointer, "bad-expression", message)
            read = [read_expression(side, known, pointer) for side in sides[::2]]
            group += list(zip(read, sides[1::2], read[1:], strict=False))
        groups.append(tuple(group))
    return Condition(tuple(groups))
