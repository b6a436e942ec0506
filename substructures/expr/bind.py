"""Put numbers or expressions in for symbols of a program: any mixture of symbols and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from decimal import Decimal
from fractions import Fraction

from substructures.errors import Fault, InvalidDocument, TooLarge, among
from substructures.expr.construction.exact import MAX_BITS
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.program import Program
from substructures.expr.program import program as collect
from substructures.expr.replay import replay
from substructures.expr.steps import ExpressionError, decimal_number

Value = int | str | Decimal | Fraction


class _Fault(ValueError):
    """What is wrong with one value: code and message."""

    def __init__(self, code: str, message: str) -> None:
        self.code = code
        super().__init__(message)


def pointer(name: str) -> str:
    """RFC 6901 pointer to the value bound to a name."""
    return "/bind/" + name.replace("~", "~0").replace("/", "~1")


def bind(program: Program, values: Mapping[str, Value]) -> Program:
    """The program with symbols replaced by exact numbers, or by expressions in the symbols that stay free.

    Strings are read in the expression grammar; they may name free symbols, and symbols that are bound to constants.
    The program is simplified as it is rebuilt; elements that became zero are left out, remaining symbols keep kind and
    unit. Raises InvalidDocument (pointer ``/bind/<name>``) for unknown names, values that are not exact numbers or do
    not parse, and divisions by zero; TooLarge when a number outgrows the limit of the graph.
    """
    graph = Graph()
    known = {s.name: s for s in program.symbols}
    bindings, faults = _bindings(graph, known, values)
    if faults:
        raise InvalidDocument(faults)
    try:
        outputs = replay(program, graph, bindings)
    except (ZeroDivisionError, ValueError) as error:
        culprits = ", ".join(f"'{name}'" for name in sorted(values))
        raise InvalidDocument.at("/bind", "undefined", f"the formulas are undefined for {culprits}: {error}") from None
    found = collect(graph, outputs, known)
    graph.release()
    return found


def _bindings(
    graph: Graph, known: Mapping[str, object], values: Mapping[str, Value]
) -> tuple[dict[str, Expr], list[Fault]]:
    constants = {n: c for n, v in values.items() if isinstance(v, str) and (c := _constant(graph, v)) is not None}
    bound: dict[str, Expr] = {}
    faults: list[Fault] = []

    def lookup(name: str) -> Expr | None:
        """The value that a name has in an expression."""
        if name in constants:
            return constants[name]
        if name in values and isinstance(values[name], str):
            raise _Fault("bound", f"'{name}' is itself bound to an expression")
        if name in values:
            return _number(graph, values[name])
        return graph.symbol(name) if name in known else None

    for name, value in sorted(values.items()):
        try:
            if name not in known:
                raise _Fault("unknown-name", f"there is no symbol '{name[:80]}'{among(name, known, len(faults))}")
            bound[name] = parse(graph, value, lookup) if isinstance(value, str) else _number(graph, value)
        except ExpressionError as error:
            faults.append(Fault(pointer(name), "expression", str(error)))
        except _Fault as error:
            faults.append(Fault(pointer(name), error.code, str(error)))
    return bound, faults


def _constant(graph: Graph, text: str) -> Expr | None:
    """The value of an expression without names; None for one with names, or with faults (they are found later)."""
    try:
        return parse(graph, text, lambda _: None)
    except (ExpressionError, TooLarge):
        return None


def _number(graph: Graph, value: object) -> Expr:
    """An exact number of bounded size."""
    if isinstance(value, bool) or not isinstance(value, (int, Decimal, Fraction)):
        raise _Fault("number", f"an exact number or an expression is expected, not {type(value).__name__}")
    if isinstance(value, Decimal):
        if not value.is_finite():
            raise _Fault("number", f"{value} is not finite")
        try:
            return graph.number(decimal_number(str(value)))
        except ValueError as error:
            raise _Fault("number", str(error)) from None
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > MAX_BITS:
        raise _Fault("number", f"the number has more than {MAX_BITS} bits")
    return graph.number(value)
