"""How far single precision may be from the exact value: a proven bound over ranges, by error analysis in balls.

Every operation of a program has the ball of its exact values (arb, so that nothing of the ranges is lost) and a bound e
of the error with which it is computed. With the unit roundoff u and operands x, y of the errors ex, ey

    x + y   e = ex + ey + u (|x + y| + ex + ey)         x y   e = |x| ey + |y| ex + ex ey, and u (|x y| + e)
    f(x)    e = sup |f'| ex + 2 u |f(x)|                x / y e = (ex + |x / y| ey) / (|y| - ey), and u (|x / y| + e)

(N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 3.3). Functions of the library are taken
to be within one unit in the last place. Arguments count as given; default values of parameters are rounded. Where a
divisor could vanish, as far as its ball tells, what it depends on is halved again and again: so accelerations have a
bound where the ranges are no wider than that takes. What has none in the middle of the ranges has none at all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import inf, isfinite
from typing import NamedTuple

import flint

from substructures.errors import InvalidArgument, among
from substructures.export.exported import Function
from substructures.export.interface import Interface
from substructures.expr.program import Program
from substructures.expr.rationals import to_fmpq

#: of single precision: unit roundoff, smallest normal number
UNIT, SMALLEST = 2.0**-24, 2.0**-126
STATED = "angles up to pi, all else but parameters up to 1 in SI units, parameters at their defaults"
#: operations on balls that a bound may take
WORK = 400_000
#: lowest and highest value by the name of an element, or of a vector for all elements of it that are not named
Ranges = Mapping[str, tuple[float, float]]
_Box = Mapping[str, "_Rounded"]


class _Rounded(NamedTuple):
    """``exact``: ball of the exact values, ``size`` at most; ``error``: bound of the distance of what is computed."""

    exact: flint.arb
    error: float
    size: float

    @classmethod
    def of(cls, exact: flint.arb, error: float) -> _Rounded:
        """Of a ball."""
        return cls(exact, error, float(exact.abs_upper()))

    @property
    def width(self) -> float:
        """Half of the range of the exact values; zero where there is none."""
        found = float(self.exact.rad())
        return found if isfinite(found) else 0.0


def read_ranges(text: str, interface: Interface) -> Ranges:
    """``arm.q1:-1:1,qd:-2:2``: of elements of arguments, and of all others of an argument, by the names of both.

    Raises InvalidArgument naming what is none.
    """
    vectors = [each for each in interface.vectors.values() if each.names]
    known = [*(each.symbol for each in vectors), *(name for each in vectors for name in each.names)]
    found = {}
    for item in filter(None, (item.strip() for item in text.split(","))):
        name, *ends = item.split(":")
        if name not in known:
            message = f"'{name[:80]}' is no argument and no element of one{among(name, known)}"
            raise InvalidArgument.at("/ranges", "unknown-name", message)
        try:
            low, high = map(float, ends)
        except ValueError:
            low, high = inf, -inf
        if not (isfinite(low) and isfinite(high) and low <= high):
            message = f"'{item[:80]}' is no range: name:lowest:highest, numbers in SI units"
            raise InvalidArgument.at("/ranges", "bad-range", message)
        found[name] = low, high
    return found


def bounds(function: Function, ranges: Ranges) -> dict[str, tuple[float, float]]:
    """Of every output the bound of the error of its elements, and the most that their exact values are; infinite where
    nothing can be said: quotients whose divisor may vanish, parameters without value.
    """
    program, whole = function.program, _box(function.interface, ranges)
    cut = [name for name in _in_divisors(program) if name in whole and whole[name].width > 0]
    middle = _outputs(program, {name: _Rounded.of(x.exact.mid(), x.error) for name, x in whole.items()}) if cut else {}
    bounded = [name for name, (error, _) in middle.items() if isfinite(error)]
    boxes, left, found = [whole], WORK // max(1, len(program)), dict.fromkeys(program.outputs, (0.0, 0.0))
    while boxes:
        box = boxes.pop()
        some = _outputs(program, box)
        if left > 0 and not all(isfinite(some[name][0]) for name in bounded):
            boxes += _halves(box, max(cut, key=lambda name: box[name].width))
            left -= 2
        else:
            found = {name: (max(found[name][0], e), max(found[name][1], s)) for name, (e, s) in some.items()}
            if left <= 0 and not any(isfinite(error) for error, _ in found.values()):
                break
    return found


def _outputs(program: Program, box: _Box) -> dict[str, tuple[float, float]]:
    """As :func:`bounds`, of one box."""
    results = _operations(program, box)
    return {name: _largest([results[entry] for entry in output.entries]) for name, output in program.outputs.items()}


def _largest(elements: Sequence[_Rounded]) -> tuple[float, float]:
    return max((x.error for x in elements), default=0.0), max((x.size for x in elements), default=0.0)


def _in_divisors(program: Program) -> list[str]:
    """The names that divisors depend on."""
    depends: dict[int, frozenset[str]] = {}
    found = set[str]()
    for i in program.reachable():
        op, *rest = program.operations[i]
        if op == "sym":
            depends[i] = frozenset((program.symbols[rest[0]].name,))
        elif op in ("int", "rat", "pi"):
            depends[i] = frozenset()
        else:
            operands = rest[:1] if op == "powi" else rest
            depends[i] = frozenset().union(*(depends[k] for k in operands))
            if op == "div":
                found |= depends[rest[1]]
            elif op == "sqrt" or (op == "powi" and int(rest[1]) < 0):
                found |= depends[rest[0]]
    return sorted(found)


def _halves(box: _Box, name: str) -> list[_Box]:
    """The box cut in two where ``name`` is in the middle of its range."""
    whole = box[name].exact
    quarter = flint.arb(whole.rad()) / 2
    parts = [flint.arb(whole.mid() + sign * quarter, quarter) for sign in (-1, 1)]
    return [{**box, name: _Rounded.of(part, box[name].error)} for part in parts]


def _box(interface: Interface, ranges: Ranges) -> _Box:
    """Every argument in its range."""
    known: dict[str, _Rounded] = {}
    for vector in interface.vectors.values():
        for i, (name, unit) in enumerate(zip(vector.names, vector.units, strict=True)):
            given = ranges.get(name, ranges.get(vector.symbol))
            if given is not None:
                known[name] = _Rounded.of(flint.arb(given[0]).union(flint.arb(given[1])), 0.0)
            elif vector.symbol == "p":
                x = vector.defaults[i] if vector.defaults else inf
                known[name] = _Rounded.of(flint.arb(x), abs(x) * UNIT) if isfinite(x) else _UNKNOWN
            else:
                largest = flint.arb.pi() if unit == "rad" else flint.arb(1)
                known[name] = _Rounded.of(flint.arb(0, largest), 0.0)
    return known


_UNKNOWN = _Rounded(flint.arb("nan"), inf, inf)


def _operations(program: Program, box: _Box) -> dict[int, _Rounded]:
    results: dict[int, _Rounded] = {}
    for i in program.reachable():
        op, *rest = program.operations[i]
        if op == "sym":
            results[i] = box.get(program.symbols[rest[0]].name, _UNKNOWN)
        elif op in ("int", "rat", "pi"):
            results[i] = _constant(op, rest)
        elif op == "powi":
            results[i] = _power(results[rest[0]], int(rest[1]))
        elif op in _ARITHMETIC:
            results[i] = _ARITHMETIC[op](*(results[k] for k in rest))
        elif op in _FUNCTIONS:
            results[i] = _applied(op, results[rest[0]])
        else:  # corners and jumps
            results[i] = _UNKNOWN
    return results


def _constant(op: str, rest: list[object]) -> _Rounded:
    if op == "pi":
        return _Rounded.of(flint.arb.pi(), 4 * UNIT)
    number = Fraction(int(str(rest[0])), int(str(rest[1])) if op == "rat" else 1)
    exact = flint.arb(to_fmpq(number))
    is_float = number.denominator == 1 and abs(number.numerator) <= 2**24
    size = float(exact.abs_upper())
    return _Rounded(exact, 0.0 if is_float else size * UNIT, size)


def _rounded(exact: flint.arb, error: float, units: int = 1) -> _Rounded:
    """With the rounding of the result itself; what is added here is large beside the roundings of these sums."""
    size = float(exact.abs_upper())
    whole = (error + units * UNIT * (size + error) + SMALLEST) * (1 + 1e-12)
    return _Rounded(exact, whole, size) if whole < inf else _UNKNOWN


def _sum(x: _Rounded, y: _Rounded) -> _Rounded:
    return _rounded(x.exact + y.exact, x.error + y.error)


def _difference(x: _Rounded, y: _Rounded) -> _Rounded:
    return _rounded(x.exact - y.exact, x.error + y.error)


def _product(x: _Rounded, y: _Rounded) -> _Rounded:
    return _rounded(x.exact * y.exact, x.size * y.error + y.size * x.error + x.error * y.error)


def _quotient(x: _Rounded, y: _Rounded) -> _Rounded:
    least = float(y.exact.abs_lower()) - y.error
    if not least > 0:
        return _UNKNOWN
    exact = x.exact / y.exact
    return _rounded(exact, (x.error + float(exact.abs_upper()) * y.error) / least)


def _power(x: _Rounded, n: int) -> _Rounded:
    if n < 0:
        return _quotient(_Rounded.of(flint.arb(1), 0.0), _power(x, -n))
    error = abs(n) * (x.size + x.error) ** (n - 1) * x.error if n else 0.0
    return _rounded(x.exact**n, error, 2)


def _applied(name: str, x: _Rounded) -> _Rounded:
    function, slope = _FUNCTIONS[name]
    wide = x.exact + flint.arb(0, x.error) if x.error else x.exact
    return _rounded(function(x.exact), float(slope(wide).abs_upper()) * x.error, 2)


_ARITHMETIC: Mapping[str, Callable[..., _Rounded]] = {
    "add": _sum,
    "sub": _difference,
    "mul": _product,
    "div": _quotient,
    "neg": lambda x: _Rounded(-x.exact, x.error, x.size),
    "abs": lambda x: _Rounded(abs(x.exact), x.error, x.size),
}
_FUNCTIONS: Mapping[str, tuple[Callable[[flint.arb], flint.arb], Callable[[flint.arb], flint.arb]]] = {
    "sin": (flint.arb.sin, flint.arb.cos),
    "cos": (flint.arb.cos, flint.arb.sin),
    "tan": (flint.arb.tan, lambda x: 1 + x.tan() ** 2),
    "sqrt": (flint.arb.sqrt, lambda x: 1 / (2 * x.sqrt())),
    "exp": (flint.arb.exp, flint.arb.exp),
    "log": (flint.arb.log, lambda x: 1 / x),
    "atan": (flint.arb.atan, lambda x: 1 / (1 + x**2)),
    "asin": (flint.arb.asin, lambda x: 1 / (1 - x**2).sqrt()),
    "acos": (flint.arb.acos, lambda x: 1 / (1 - x**2).sqrt()),
}
