"""Reading the numbers and expressions of a document into a graph, with pointers to faults."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from substructures.documents.fields import in_si, unit_advice
from substructures.errors import SOUGHT, Fault, InvalidDocument, TooLarge, meant
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse, parse_terms
from substructures.expr.steps import MAX_DIGITS, ExpressionError, decimal_number, measured
from substructures.expr.trigonometry import cos_sin
from substructures.mechanics.linear3 import Planar, Rotation

#: a name to what it stands for; None for one that is not known
Lookup = Callable[[str], Expr | None]
ExprVector = tuple[Expr, Expr, Expr]


def no_names(_name: str) -> Expr | None:
    """The lookup of expressions that may not name anything."""
    return None


@dataclass
class Scope:
    """A graph with the symbols that expressions may name. Faults are collected; :meth:`finish` raises them.

    ``notices``: what should be known about a document that can be used: pointer, code, message. ``more``: names that
    lookups may know beside those: coordinates, velocities, inputs.
    """

    graph: Graph
    names: dict[str, Expr] = field(default_factory=dict)
    symbols: dict[str, Symbol] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    notices: list[dict[str, str]] = field(default_factory=list)
    more: Sequence[str] = ()

    def declare(self, name: str, kind: str, unit: str = "", alias: str | None = None) -> Expr:
        """A symbol of the program, known in expressions by ``alias`` (default: its name)."""
        symbol = self.graph.symbol(name)
        self.symbols[name] = Symbol(name, kind, unit)
        self.names[name if alias is None else alias] = symbol
        return symbol

    def fault(self, pointer: str, code: str, message: str) -> None:
        """Note a fault, once."""
        fault = Fault(pointer, code, message)
        if fault not in self.faults:
            self.faults.append(fault)

    def finish(self) -> None:
        """Raise InvalidDocument when there were faults."""
        if self.faults:
            raise InvalidDocument(self.faults)

    def read(self, value: Any, pointer: str, lookup: Lookup | None = None) -> Expr:
        """An exact number in SI, or an expression in the known names; zero after a fault."""
        try:
            value = in_si(value)
            if isinstance(value, str):
                return parse(self.graph, value, lookup or self.names.get)
            if isinstance(value, Decimal):
                return self.graph.number(decimal_number(str(value)))
            if abs(value) >= 10**MAX_DIGITS:
                raise ValueError(f"number has more than {MAX_DIGITS} digits")
            return self.graph.number(value)
        except ExpressionError as error:
            code = "unknown-name" if error.name is not None else "bad-expression"
            advice = "; measures of frames stand in loads" if measured(error.name or "") else unit_advice(str(value))
            known = [*self.names, *(() if lookup is None else self.more)]
            if error.name in known:
                advice = "; here a constant is needed"
            elif error.name is not None and lookup is not no_names and len(self.faults) < SOUGHT:
                advice = advice or meant(error.name, known)
            self.fault(pointer, code, str(error) + advice)
        except (ValueError, ArithmeticError) as error:
            self.fault(pointer, "bad-number", str(error))
        except TooLarge as error:
            self.fault(pointer, "too-large", str(error))
        return self.graph.zero

    def terms(self, value: Any, pointer: str, lookup: Lookup | None = None) -> list[Expr]:
        """The terms of an expression as it is written, what names the time apart, whose sum it is; none after a fault
        that :meth:`read` notes.
        """
        value = in_si(value)
        if not isinstance(value, str):
            return [self.read(value, pointer)]
        try:
            return parse_terms(self.graph, value, lookup or self.names.get, "t")
        except (ValueError, ArithmeticError, TooLarge):
            return []

    def vector(self, values: Sequence[Any], pointer: str, lookup: Lookup | None = None) -> ExprVector:
        """Three numbers or expressions."""
        x, y, z = (self.read(v, f"{pointer}/{i}", lookup) for i, v in enumerate(values))
        return x, y, z

    def rpy(self, values: Sequence[Any], pointer: str, lookup: Lookup | None = None) -> Rotation:
        """E of a frame turned by fixed-axis roll, pitch, yaw: v' = Rx(roll)^T Ry(pitch)^T Rz(yaw)^T v."""
        # the factors of E = Rx(roll)^T Ry(pitch)^T Rz(yaw)^T from the right; a turn by zero is left out
        angles = self.vector(values, pointer, lookup)
        factors = ((2, angles[2]), (1, angles[1]), (0, angles[0]))
        return Rotation(tuple(Planar(axis, *cos_sin(angle)) for axis, angle in factors if not angle.is_zero))
