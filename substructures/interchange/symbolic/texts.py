"""SymPy expressions as texts of the grammar of documents (:mod:`substructures.expr.syntax`)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from numbers import Number
from typing import Any

import sympy
from sympy.core.function import AppliedUndef
from sympy.physics.vector import dynamicsymbols
from sympy.printing.str import StrPrinter

from substructures.errors import InvalidArgument
from substructures.expr.steps import FUNCTIONS, LAWS, RESERVED

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_]+)*'*", re.ASCII)
#: names of functions here by those of SymPy
_CALLED = {name: name for name in (*FUNCTIONS, *LAWS) if name not in ("step", "sqrt")} | {
    "Abs": "abs",
    "Max": "max",
    "Min": "min",
}
_PLAIN = (sympy.Add, sympy.Mul, sympy.Pow, sympy.Rational, sympy.Float, sympy.Symbol)
_CONSTANTS = (sympy.pi, sympy.E)


def from_sympy(expression: Any, names: Mapping[Any, str] | None = None) -> str:
    """The text of an expression, which definitions, loads and inputs take wherever they take a formula.

    A function of time ``q(t)`` is the name ``q``, its derivative the velocity ``q'``. ``names``: the names of symbols
    and functions of time that have others, or whose names no document takes (``theta_{1}``). Numbers stay exact; a
    float is its shortest decimal.

    Raises InvalidArgument naming what has no counterpart: other functions, conditions, complex or infinite numbers.

    >>> import sympy
    >>> from substructures import from_sympy
    >>> q, k = sympy.symbols("q k")
    >>> from_sympy(-k * sympy.sin(q) ** 2 / 3)
    '-k*sin(q)**2/3'
    """
    given = expression_of(expression)
    known = {key: _checked(str(name)) for key, name in (names or {}).items()}
    _require(given, known)
    return str(_Printer(known).doprint(given))


def expression_of(given: Any) -> Any:
    """An expression of SymPy, or a number as such a one. A text is refused, and what may hold one: SymPy would evaluate
    it. Raises InvalidArgument.
    """
    if not isinstance(given, (sympy.Basic, sympy.MatrixBase, Number)):
        raise _refused(given, "is no expression of SymPy")
    # a number or a matrix of expressions: strict, no text is parsed, and nothing of the service comes here
    return sympy.sympify(given, strict=True)


def _refused(what: Any, why: str) -> InvalidArgument:
    return InvalidArgument.at("/expression", "no-counterpart", f"'{str(what)[:80]}' {why}")


def _checked(name: str) -> str:
    if not _NAME.fullmatch(name):
        raise _refused(name, "is no name of a document (letters, digits, '_' and '.'): give one in 'names'")
    if name in RESERVED and name != "t":
        raise _refused(name, "has a meaning of its own in documents: give another in 'names'")
    return name


def _require(given: Any, known: Mapping[Any, str]) -> None:
    """Raises for the first thing that the grammar does not have."""
    tree = sympy.preorder_traversal(given)
    for node in tree:
        if node in known or isinstance(node, AppliedUndef | sympy.Derivative):
            _moving(node, known)
            tree.skip()
        elif isinstance(node, sympy.Function | sympy.Max | sympy.Min | sympy.exp):
            if type(node).__name__ not in _CALLED:
                raise _refused(
                    node.func.__name__, f"is none of the functions {', '.join(sorted(set(_CALLED.values())))}"
                )
        elif not (isinstance(node, _PLAIN) or node in _CONSTANTS) or node.is_finite is False or not node.is_commutative:
            raise _refused(node, "has no counterpart in documents: real formulas of numbers and names alone")


def _moving(node: Any, known: Mapping[Any, str]) -> str:
    """The name of q(t), with a stroke for each derivative."""
    if node in known:
        return known[node]
    t = dynamicsymbols._t
    function, order = node, 0
    if isinstance(node, sympy.Derivative):
        function = node.expr
        ((variable, order),) = node.variable_count if len(node.variable_count) == 1 else ((None, 0),)
        if variable != t:
            raise _refused(node, "is no derivative by time")
    if function not in known and (not isinstance(function, AppliedUndef) or function.args != (t,)):
        raise _refused(node, "is no function of time alone")
    return (known.get(function) or _checked(function.func.__name__)) + "'" * int(order)


class _Printer(StrPrinter):  # type: ignore[misc]
    """SymPy's own text with our names."""

    def __init__(self, known: Mapping[Any, str]) -> None:
        super().__init__()
        self.known = known

    def _print_Symbol(self, node: Any) -> str:
        return self.known.get(node) or _checked(node.name)

    def _print_Function(self, node: Any) -> str:
        if isinstance(node, AppliedUndef):
            return _moving(node, self.known)
        return f"{_CALLED[type(node).__name__]}({', '.join(self._print(x) for x in node.args)})"

    def _print_Max(self, node: Any) -> str:
        """Of two arguments at a time."""
        first, *rest = node.args
        more = self._print(rest[0] if len(rest) == 1 else node.func(*rest))
        return f"{_CALLED[type(node).__name__]}({self._print(first)}, {more})"

    _print_Min = _print_Max
    _print_Abs = _print_Function

    def _print_Derivative(self, node: Any) -> str:
        return _moving(node, self.known)

    def _print_Exp1(self, _node: Any) -> str:
        return "exp(1)"

    def _print_Float(self, node: Any) -> str:
        if math.isinf(float(node)):
            raise _refused(node, "is beyond the range of doubles")
        return repr(float(node))
