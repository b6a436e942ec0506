"""Numbers in place of parameters in formulas: the text of ``bind=``, ``name:value,...``.

A value is a number or an expression in other parameters, or a constant and a unit: ``l:1200 mm``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from service.messages.refusals import unprocessable
from substructures.certificate.rebuilt import require_same
from substructures.documents.fields import Quantity, in_si, quantity_of
from substructures.documents.units import UnknownUnitError, read_unit
from substructures.errors import Fault, InvalidInput, among
from substructures.expr.bind import bind
from substructures.expr.program import Program
from substructures.expr.units.dimensions import Dimensioned
from substructures.expr.units.unit_check import UnitCheck, dimension_of

Parameters = Mapping[str, Mapping[str, Any]]
DEFAULTS, PLACE = "defaults", "/query/bind"


def bindings(text: str) -> Iterator[tuple[str, str | None]]:
    """Name and value as they stand there; None where there is no value."""
    for item in filter(None, (item.strip() for item in text.split(","))):
        name, colon, value = item.partition(":")
        yield name, value if colon else None


def bound_names(with_default: Iterable[str], text: str) -> set[str]:
    """The parameters that ``text`` puts numbers in place of."""
    found: set[str] = set()
    for name, value in bindings(text):
        found |= set(with_default) if value is None and name == DEFAULTS else {name}
    return found


def bound(program: Program, parameters: Parameters, text: str, inputs: Parameters | None = None) -> Program:
    """The program with numbers in place of parameters; ``text`` may contain ``defaults``, also those of ``inputs``.

    Raises Refused 422 naming the parameter.
    """
    values: dict[str, Any] = {}
    for name, value in bindings(text):
        if value is None and name == DEFAULTS:
            given = {n: p["value"] for n, p in parameters.items() if p.get("value") is not None}
            given |= {n: u["default"] for n, u in (inputs or {}).items() if u.get("default") is not None}
            values = {**given, **values}
        elif value is None:
            raise unprocessable("bind", f"'{name[:80]}' is not name:value", PLACE)
        elif name not in parameters:
            message = f"there is no parameter '{name[:80]}'{among(name, parameters)}"
            raise unprocessable("unknown-parameter", message, PLACE)
        else:
            values[name] = quantity_of(value)
            for fault in unit_faults(name, values[name], parameters):
                raise unprocessable(fault.code, fault.message, PLACE)
    used = {symbol.name for symbol in program.symbols}
    chosen = {name: in_si(value) for name, value in values.items() if name in used}
    if not chosen:
        return program
    try:
        result = bind(program, chosen)
        found = require_same(result, program, chosen, "formulas with numbers in them")
    except InvalidInput as error:
        message = "; ".join(fault.message for fault in error.faults)
        raise unprocessable("bind", message, PLACE) from None
    return result.marked(program.not_judged.union(found))


def unit_faults(name: str, value: str | Quantity, parameters: Parameters) -> list[Fault]:
    """What is wrong with the unit of a value, or with the dimension of an expression, for a parameter."""
    if isinstance(value, Quantity):
        try:
            read_unit(value.unit)
        except UnknownUnitError as error:
            return [Fault(PLACE, "unknown-unit", f"'{name[:80]}': {error}")]
    known = {n: dimension_of(str(p.get("unit", ""))) for n, p in parameters.items()}
    expected = known.get(name, "unknown")
    check = UnitCheck(lambda n: known.get(n, "unknown"))
    check.check([(PLACE, value, expected.dimension if isinstance(expected, Dimensioned) else None)], False)
    return [Fault(PLACE, fault.code, f"'{name[:80]}': {fault.message}") for fault in check.faults]
