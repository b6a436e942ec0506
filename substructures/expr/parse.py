"""The expression grammar of definitions and requests, read into a graph. Nothing is ever executed.

::

    sum     = product { ("+" | "-") product }
    product = sign { ("*" | "/") sign }
    sign    = { "+" | "-" } power
    power   = atom [ ("^" | "**") integer ]
    atom    = number | name | function "(" sum ")" | "(" sum ")"
    name    = letter { letter | digit | "_" } { "." name } { "'" }

Functions: ``sin cos tan sqrt``; constants: ``pi``. Numbers are exact decimals.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction

from substructures.errors import TooLarge
from substructures.expr.graph import MAX_EXPONENT, Expr, Graph
from substructures.expr.trigonometry import cos, sin, tan

MAX_LENGTH = 10_000
MAX_DEPTH = 64
MAX_DIGITS = 400

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_-]+)*'*)"
    r"|(?P<op>\*\*|[-+*/^()]))",
    re.ASCII,
)
FUNCTIONS: dict[str, Callable[[Expr], Expr]] = {"sin": sin, "cos": cos, "tan": tan, "sqrt": lambda x: x.graph.sqrt(x)}
RESERVED = frozenset((*FUNCTIONS, "pi", "t"))


class ExpressionError(ValueError):
    """An expression that cannot be read; ``column`` counts from 1, ``name`` is the unknown name, if any."""

    def __init__(self, message: str, column: int, name: str | None = None) -> None:
        self.column, self.name = column, name
        super().__init__(f"{message} (column {column})")


def decimal_number(text: str) -> Fraction:
    """The exact value of a decimal literal of at most 400 digits (exponent included). Raises ValueError."""
    value = Decimal(text)
    exponent = value.as_tuple().exponent
    if not isinstance(exponent, int) or len(value.as_tuple().digits) + abs(exponent) > MAX_DIGITS:
        raise ValueError(f"number has more than {MAX_DIGITS} digits")
    return Fraction(value)


class _Parser:
    def __init__(self, graph: Graph, text: str, lookup: Callable[[str], Expr | None]) -> None:
        self.graph, self.text, self.lookup, self.depth = graph, text, lookup, 0
        self.tokens = self._tokens()
        self.at = 0

    def _tokens(self) -> list[tuple[str, str, int]]:
        """(kind, text, column) of every token, with an end mark."""
        tokens, position = [], 0
        end = len(self.text.rstrip())
        while position < end:
            match = _TOKEN.match(self.text, position)
            if match is None:
                column = position + len(self.text[position:]) - len(self.text[position:].lstrip()) + 1
                raise ExpressionError(f"unexpected character {self.text[column - 1]!r}", column)
            kind = str(match.lastgroup)
            tokens.append((kind, match.group(kind), match.start(kind) + 1))
            position = match.end()
        tokens.append(("end", "", end + 1))
        return tokens

    def take(self, *ops: str) -> str | None:
        """The operator at hand if it is one of these; then it is passed."""
        kind, text, _ = self.tokens[self.at]
        if kind == "op" and text in ops:
            self.at += 1
            return text
        return None

    def fail(self, expected: str) -> ExpressionError:
        """The error that something else was expected here."""
        kind, text, column = self.tokens[self.at]
        found = "the end" if kind == "end" else repr(text)
        return ExpressionError(f"expected {expected}, found {found}", column)

    def sum(self) -> Expr:
        """product (('+' or '-') product)*"""
        result = self.product()
        while op := self.take("+", "-"):
            column = self.tokens[self.at][2]
            term = self.product()
            try:
                result = result + term if op == "+" else result - term
            except TooLarge as error:
                raise ExpressionError(str(error), column) from None
        return result

    def product(self) -> Expr:
        """sign (('*' or '/') sign)*"""
        result = self.sign()
        while op := self.take("*", "/"):
            column = self.tokens[self.at][2]
            factor = self.sign()
            if op == "/" and factor.is_zero:
                raise ExpressionError("division by zero", column)
            try:
                result = result * factor if op == "*" else result / factor
            except TooLarge as error:
                raise ExpressionError(str(error), column) from None
        return result

    def sign(self) -> Expr:
        """('+' or '-')* power"""
        minus = False
        while op := self.take("+", "-"):
            minus ^= op == "-"
        result = self.power()
        return -result if minus else result

    def power(self) -> Expr:
        """atom ('^' '-'? integer)?"""
        base = self.atom()
        if not self.take("^", "**"):
            return base
        negative = self.take("-") is not None
        kind, text, column = self.tokens[self.at]
        if kind != "number" or not text.isdigit():
            raise self.fail("an integer exponent")
        self.at += 1
        if len(text) > 4 or int(text) > MAX_EXPONENT:
            raise ExpressionError(f"exponent {text[:20]} is beyond the limit of {MAX_EXPONENT}", column)
        if self.tokens[self.at][1] in ("^", "**"):
            raise ExpressionError("tower of exponents; use parentheses", self.tokens[self.at][2])
        if negative and base.is_zero:
            raise ExpressionError("division by zero", column)
        try:
            return base ** (-int(text) if negative else int(text))
        except TooLarge as error:
            raise ExpressionError(str(error), column) from None

    def atom(self) -> Expr:
        """number, name, call or parenthesis"""
        kind, text, column = self.tokens[self.at]
        if kind == "number":
            self.at += 1
            return self.number(text, column)
        if kind == "name":
            self.at += 1
            if text in FUNCTIONS:
                return self.call(text, column)
            return self.name(text, column)
        if self.take("("):
            return self.parenthesis()
        raise self.fail("a number, a name or '('")

    def number(self, text: str, column: int) -> Expr:
        """An exact number."""
        try:
            return self.graph.number(decimal_number(text))
        except (ValueError, ArithmeticError):
            raise ExpressionError(f"number has more than {MAX_DIGITS} digits", column) from None

    def name(self, text: str, column: int) -> Expr:
        """pi, or what the lookup knows."""
        if text == "pi":
            return self.graph.pi
        found = self.lookup(text)
        if found is None:
            raise ExpressionError(f"unknown name '{text[:80]}'", column, text)
        return found

    def call(self, name: str, column: int) -> Expr:
        """function parenthesis"""
        if not self.take("("):
            raise self.fail(f"'(' after {name}")
        argument = self.parenthesis()
        try:
            return FUNCTIONS[name](argument)
        except (ValueError, ZeroDivisionError) as error:
            raise ExpressionError(str(error), column) from None

    def parenthesis(self) -> Expr:
        """'(' was passed: sum ')'"""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise ExpressionError(f"more than {MAX_DEPTH} nested parentheses", self.tokens[self.at][2])
        result = self.sum()
        if not self.take(")"):
            raise self.fail("')'")
        self.depth -= 1
        return result


def parse(graph: Graph, text: str, lookup: Callable[[str], Expr | None]) -> Expr:
    """Read an expression. ``lookup`` returns the expression of a name, or None for an unknown one.

    Raises ExpressionError with the column.

    >>> graph = Graph()
    >>> parse(graph, "2*(l + 1/2) - 2*l", {"l": graph.symbol("l")}.get)
    1
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"expression has more than {MAX_LENGTH} characters", MAX_LENGTH + 1)
    parser = _Parser(graph, text, lookup)
    result = parser.sum()
    if parser.tokens[parser.at][0] != "end":
        raise parser.fail("an operator or the end")
    return result
