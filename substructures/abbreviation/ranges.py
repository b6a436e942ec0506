"""What the variables of a formula may be: reading of ranges, and what they are where none are given."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from typing import Any

from substructures.abbreviation.balls import above, below, enclosures
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.bind import Value, bind
from substructures.expr.direct import ball
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Program
from substructures.expr.replay import replay
from substructures.expr.steps import ExpressionError
from substructures.tree.model import Model

#: names that stand for all of a kind that are not named themselves
GROUPS = {"coordinates": "coordinate", "velocities": "velocity", "accelerations": "acceleration"}
#: a number, or a text without names such as -pi/2; floats stand for their shortest decimal text
Number = int | float | Decimal | Fraction | str
Ranges = Mapping[str, Sequence[Number]]


@dataclass(frozen=True)
class Interval:
    """All numbers from ``low`` to ``high``, in SI."""

    low: Fraction
    high: Fraction

    @property
    def middle(self) -> Fraction:
        """The number in the middle."""
        return (self.low + self.high) / 2

    @property
    def half(self) -> Fraction:
        """Half of its width."""
        return (self.high - self.low) / 2


Box = Mapping[str, Interval]


def fixed_values(model: Model, program: Program, ranges: Ranges, given: Mapping[str, Any] | None) -> dict[str, Value]:
    """Numbers of all parameters and inputs of a program that have no range: given, or defaults; other inputs are 0.

    Raises InvalidArgument (``/parameters/name``) for unknown names, for parameters without any value, and for those
    with a number and a range.
    """
    given, faults, result = given or {}, list[Fault](), dict[str, Value]()
    for name in given:
        if name not in model.parameters:
            message = f"unknown parameter '{name[:80]}'{among(name, model.parameters, len(faults))}"
            faults.append(Fault(f"/parameters/{name}", "unknown-parameter", message))
        elif name in ranges:
            faults.append(Fault(f"/parameters/{name}", "twice", f"'{name}' has a number and a range"))
    for symbol in program.symbols:
        name = symbol.name
        if name in ranges or symbol.kind not in ("parameter", "input"):
            continue
        if symbol.kind == "input":
            value = (model.inputs.get(name) or {}).get("default") or 0
        else:
            value = given.get(name, model.parameters[name].get("value"))
        if value is None:
            message = f"'{name}' has no default: it needs a number or a range"
            faults.append(Fault(f"/parameters/{name}", "missing", message))
        else:
            result[name] = Decimal(repr(value)) if isinstance(value, float) else value
    if faults:
        raise InvalidArgument(faults)
    return result


def read_box(model: Model, program: Program, ranges: Ranges, fixed: Mapping[str, Value]) -> dict[str, Interval]:
    """The ranges of all symbols of a program, in which ``fixed`` numbers are bound already.

    Coordinates that have none: their limits, those of revolute joints without limits from -pi to pi. Raises
    InvalidArgument (``/ranges/name``) for unknown names, for what is no range, and for symbols that need one.
    """
    read, faults = _read(model, ranges)
    limits = _limits(model, fixed)
    result: dict[str, Interval] = {}
    for symbol in program.symbols:
        group = next((name for name, kind in GROUPS.items() if kind == symbol.kind), "")
        found = read.get(symbol.name, read.get(group, limits.get(symbol.name)))
        if found is not None:
            result[symbol.name] = found
        elif symbol.name not in ranges and group not in ranges:
            what = f"'{symbol.name}' ({symbol.kind})" + (f", or '{group}' for all," if group else "")
            faults.append(Fault(f"/ranges/{symbol.name}", "missing", f"a range [lowest, highest] of {what} is needed"))
    if faults:
        raise InvalidArgument(faults)
    return result


def _read(model: Model, ranges: Ranges) -> tuple[dict[str, Interval], list[Fault]]:
    known = {*GROUPS, *model.parameters, *model.input_names, "t"}
    known |= {name + primes for name in model.coordinates for primes in ("", "'", "''")}
    result, faults = dict[str, Interval](), list[Fault]()
    for name, given in ranges.items():
        place = f"/ranges/{name}"
        try:
            if name not in known:
                message = f"nothing is called '{name[:80]}'{among(name, sorted(known), len(faults))}"
                raise InvalidArgument.at(place, "unknown-name", message)
            result[name] = interval(given, place)
        except InvalidArgument as error:
            faults += error.faults
    return result, faults


def interval(given: Any, place: str) -> Interval:
    """A pair of numbers. Raises InvalidArgument."""
    if not isinstance(given, list | tuple) or len(given) != 2:
        message = f"a range is a pair [lowest, highest], found {repr(given)[:80]}"
        raise InvalidArgument.at(place, "range-expected", message)
    low, high = (_number(x, f"{place}/{i}") for i, x in enumerate(given))
    if below(low) > above(high):
        raise InvalidArgument.at(place, "empty-range", f"the range is empty: {given[0]} is more than {given[1]}")
    # what is not rational is rounded outwards
    return Interval(_end(given[0], below(low)), _end(given[1], above(high)))


def _end(given: Number, rounded: float) -> Fraction:
    try:
        return Fraction(Decimal(repr(given)) if isinstance(given, float) else given)
    except ValueError:
        return Fraction(rounded)


def _number(given: Any, place: str) -> Any:
    """A number as a ball."""
    if isinstance(given, bool) or not isinstance(given, int | float | Decimal | Fraction | str):
        raise InvalidArgument.at(place, "number-expected", f"a number is needed, found {repr(given)[:80]}")
    try:
        found = ball(Decimal(repr(given)) if isinstance(given, float) else given)
    except (ExpressionError, ValueError, ArithmeticError) as error:
        raise InvalidArgument.at(place, "number-expected", f"no finite number: {error}"[:300]) from None
    if not (isfinite(below(found)) and isfinite(above(found))):
        message = f"the number is not finite, or beyond those of double precision: {str(given)[:80]}"
        raise InvalidArgument.at(place, "number-not-finite", message)
    return found


def _limits(model: Model, fixed: Mapping[str, Value]) -> dict[str, Interval]:
    """Limits of coordinates as far as they are numbers, and a turn of revolute joints."""
    turn = interval(("-pi", "pi"), "")
    result = {name: turn for name, kind in zip(model.coordinates, model.joints, strict=True) if kind == "R"}
    if "limits" not in model.program.outputs:
        return result
    rows = model.program.select(["limits"])
    names = {s.name for s in rows.symbols}
    found = replay(bind(rows, {n: x for n, x in fixed.items() if n in names}), Graph(), {})["limits"].expanded()
    for a in {a for a, _ in found}:
        ends = [found.get((a, i), 0) for i in range(2)]
        if is_constant(x for x in ends if isinstance(x, Expr)):
            low, high = enclosures((Graph().lift(x) if isinstance(x, int) else x for x in ends), {})
            result[model.coordinates[a]] = Interval(Fraction(below(low)), Fraction(above(high)))
    return result


def is_constant(expressions: Iterable[Expr]) -> bool:
    """Whether expressions depend on no symbol."""
    stack = list(expressions)
    while stack:
        node = stack.pop()
        if node.op == "sym":
            return False
        stack.extend(node.args)
    return True
