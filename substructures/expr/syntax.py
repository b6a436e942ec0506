"""The expression grammar of definitions and requests, read into its own syntax. Nothing is ever executed.

::

    sum     = product { ("+" | "-") product }
    product = sign { ("*" | "/") sign }
    sign    = { "+" | "-" } power
    power   = atom [ ("^" | "**") ( integer | sign number | name | "(" sum ")" ) ]
    atom    = number | name | function "(" sum { "," sum } ")" | table | measure | "(" sum ")"
    table   = "table" "(" sum ";" knot { "," knot } [ ";" "monotone" ] ")"
    knot    = [ "-" ] number ":" [ "-" ] number
    measure = ("distance" | "angle") [ "'" ] "(" name "," name ")"
    name    = letter { letter | digit | "_" } { "." name } { "'" }

Functions: ``sin cos tan sqrt`` and, with their numbers of arguments, :data:`.steps.LAWS`; constants: ``pi``. Numbers
are exact decimals. A measure of two frames of a tree, or its rate ('), is a name to whoever reads it further:
``distance(a.tip, b.tip)``, spaced like that.

What was read is a list of steps in postfix order, exactly as written: nothing is simplified, so that values straight
from the text (:mod:`substructures.expr.direct`) share nothing with the graph that formulas are built in.
"""

from __future__ import annotations

import re
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Literal

from substructures.expr.construction.exact import MAX_EXPONENT
from substructures.expr.steps import (
    CURVES,
    FUNCTIONS,
    LAWS,
    MAX_DIGITS,
    MEASURES,
    ExpressionError,
    Knots,
    Step,
    decimal_number,
)

#: longest text of which the steps are kept
SHORT = 100
MAX_LENGTH = 10_000
MAX_DEPTH = 64

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_]+)*'*)"
    r"|(?P<op>\*\*|[-+*/^(),;:]))",
    re.ASCII,
)


class _Reader:
    def __init__(self, text: str) -> None:
        self.text, self.depth = text, 0
        self.tokens = self._tokens()
        self.at = 0
        self.steps: list[Step] = []

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

    def step(self, op: str, column: int, value: Fraction | str | int | Knots | None = None) -> None:
        """One step more."""
        self.steps.append(Step(op, value, column))

    def sum(self) -> None:
        """product (('+' or '-') product)*"""
        self.product()
        while op := self.take("+", "-"):
            column = self.tokens[self.at][2]
            self.product()
            self.step("add" if op == "+" else "sub", column)

    def product(self) -> None:
        """sign (('*' or '/') sign)*"""
        self.sign()
        while op := self.take("*", "/"):
            column = self.tokens[self.at][2]
            self.sign()
            self.step("mul" if op == "*" else "div", column)

    def sign(self) -> None:
        """('+' or '-')* power"""
        minus, column = False, self.tokens[self.at][2]
        while op := self.take("+", "-"):
            minus ^= op == "-"
        self.power()
        if minus:
            self.step("neg", column)

    def power(self) -> None:
        """atom ('^' '-'? integer)?"""
        self.atom()
        if not self.take("^", "**"):
            return
        negative = self.take("-") is not None
        kind, text, column = self.tokens[self.at]
        if kind != "number" or not text.isdigit():
            self.exponent(negative, column)
            return
        self.at += 1
        if len(text) > 4 or int(text) > MAX_EXPONENT:
            raise ExpressionError(f"exponent {text[:20]} is beyond the limit of {MAX_EXPONENT}", column)
        if self.tokens[self.at][1] in ("^", "**"):
            raise ExpressionError("tower of exponents; use parentheses", self.tokens[self.at][2])
        self.step("pow", column, -int(text) if negative else int(text))

    def exponent(self, negative: bool, column: int) -> None:
        """a number, name or parenthesis as exponent"""
        kind, text, _ = self.tokens[self.at]
        if kind not in ("number", "name") and (kind, text) != ("op", "("):
            raise self.fail("an exponent")
        self.atom()
        if self.tokens[self.at][1] in ("^", "**"):
            raise ExpressionError("tower of exponents; use parentheses", self.tokens[self.at][2])
        if negative:
            self.step("neg", column)
        self.step("power", column)

    def atom(self) -> None:
        """number, name, call or parenthesis"""
        kind, text, column = self.tokens[self.at]
        if kind == "number":
            self.at += 1
            self.step("number", column, self.number(text, column))
        elif kind == "name":
            self.at += 1
            if text in FUNCTIONS:
                self.call(text, column)
            elif text in LAWS and self.take("("):
                self.arguments(text, column)
            elif text == "table" and self.take("("):
                self.table(column)
            elif text.removesuffix("'") in MEASURES and self.take("("):
                self.step("name", column, f"{text}({self.frame(',')}, {self.frame(')')})")
            elif self.tokens[self.at][1] == "(":
                raise ExpressionError(f"unknown function '{text[:80]}'", column, text)
            else:
                self.step(*("pi", column) if text == "pi" else ("name", column, text))
        elif self.take("("):
            self.parenthesis()
        else:
            raise self.fail("a number, a name or '('")

    def number(self, text: str, column: int) -> Fraction:
        """An exact number."""
        try:
            return decimal_number(text)
        except (ValueError, ArithmeticError):
            raise ExpressionError(f"number has more than {MAX_DIGITS} digits", column) from None

    def arguments(self, name: str, column: int) -> None:
        """'(' was passed: sum (',' sum)* ')'"""
        for k in range(LAWS[name]):
            self.nested("," if k + 1 < LAWS[name] else ")")
        self.step("call", column, name)

    def table(self, column: int) -> None:
        """'(' was passed: sum ';' knots ')'"""
        self.nested(";")
        x, y = [self.signed(":")], [self.signed("")]
        while self.take(","):
            x.append(self.signed(":"))
            y.append(self.signed(""))
        kind: Literal["linear", "monotone", "smooth"] = "linear"
        if self.take(";"):
            word = self.tokens[self.at][1]
            if word not in CURVES:
                raise self.fail("'monotone' or 'smooth'")
            self.at, kind = self.at + 1, "monotone" if word == "monotone" else "smooth"
        if not self.take(")"):
            raise self.fail("',' or ')'")
        if len(x) < 2 or any(a >= b for a, b in pairwise(x)):
            raise ExpressionError("a table has two places at least, which rise", column)
        self.step("table", column, Knots(tuple(x), tuple(y), kind))

    def signed(self, end: str) -> Fraction:
        """'-'? number, and what comes after it"""
        minus = self.take("-") is not None
        kind, text, column = self.tokens[self.at]
        if kind != "number":
            raise self.fail("a number")
        self.at += 1
        if end and not self.take(end):
            raise self.fail(f"'{end}'")
        value = self.number(text, column)
        return -value if minus else value

    def frame(self, end: str) -> str:
        """A name and what comes after it: a frame of a measure"""
        kind, text, _ = self.tokens[self.at]
        if kind != "name" or text.endswith("'"):
            raise self.fail("a frame")
        self.at += 1
        if not self.take(end):
            raise self.fail(f"'{end}'")
        return text

    def call(self, name: str, column: int) -> None:
        """function parenthesis"""
        if not self.take("("):
            raise self.fail(f"'(' after {name}")
        self.parenthesis()
        self.step("call", column, name)

    def parenthesis(self) -> None:
        """'(' was passed: sum ')'"""
        self.nested(")")

    def nested(self, end: str) -> None:
        """sum and what comes after it"""
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise ExpressionError(f"more than {MAX_DEPTH} nested parentheses", self.tokens[self.at][2])
        self.sum()
        if not self.take(end):
            raise self.fail(f"'{end}'")
        self.depth -= 1


def tokens(text: str) -> list[tuple[str, str, int]]:
    """(kind, text, column) of all tokens of an expression, with an end mark. Raises ExpressionError.

    >>> [token for _, token, _ in tokens("2*l'")]
    ['2', '*', "l'", '']
    """
    return _Reader(text).tokens


def read(text: str) -> tuple[Step, ...]:
    """The steps of an expression. Raises ExpressionError with the column.

    >>> [step.op for step in read("2*(l + 1)")]
    ['number', 'name', 'number', 'add', 'mul']
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(f"expression has more than {MAX_LENGTH} characters", MAX_LENGTH + 1)
    return _steps_of_short(text) if len(text) <= SHORT else _steps(text)


def _steps(text: str) -> tuple[Step, ...]:
    reader = _Reader(text)
    reader.sum()
    if reader.tokens[reader.at][0] != "end":
        raise reader.fail("an operator or the end")
    return tuple(reader.steps)


#: a text is read for its units, its formula and its certificate, and often again
_steps_of_short = lru_cache(maxsize=4096)(_steps)
