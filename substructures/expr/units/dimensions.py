"""The dimension of an expression, from the dimensions of the names in it; nothing is evaluated.

What has no unit may stand for anything: a name without a unit, and a number. A number that multiplies something with a
unit is taken for a pure number first (``2*l`` is a length), but it may have been meant with a unit (``9.81*m`` is a
force): what would be a contradiction only if it is pure is a *doubt*, and what is one in any case is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from substructures.documents.units import NUMBER, Dimension, si_text
from substructures.expr.steps import Step

#: of names without a unit; of numbers; of sines and cosines, which are pure numbers but may stand alone for anything
Open = Literal["unknown", "number", "pure"]


class DimensionError(ValueError):
    """Quantities that do not go together, whatever the numbers in the expression mean."""


@dataclass(frozen=True, slots=True)
class Dimensioned:
    """``sure``: even if numbers in the expression have units. Coordinates are not: ``-x`` may be a force."""

    dimension: Dimension
    sure: bool = True

    def __str__(self) -> str:
        return si_text(self.dimension)


Inferred = Dimensioned | Open


@dataclass
class Inference:
    """Infers dimensions; ``doubts`` are what numbers with units would have to explain.

    >>> from substructures.expr.syntax import read
    >>> known = {"l": Dimensioned((1, 0, 0, 0, 0, 0, 0)), "m": Dimensioned((0, 1, 0, 0, 0, 0, 0))}
    >>> str(Inference(lambda name: known.get(name, "unknown")).of(read("m*(l^2 + 1)/12*sin(a)")))
    'kg m^2'
    """

    dimension_of: Callable[[str], Inferred]
    #: whether whole numbers and pi have no unit in any case
    counts: bool = False

    def __post_init__(self) -> None:
        self.doubts: list[str] = []

    def of(self, steps: Sequence[Step]) -> Inferred:
        """The dimension of an expression. Raises DimensionError."""
        stack: list[Inferred] = []
        for step in steps:
            if step.op == "name":
                stack.append(self.dimension_of(str(step.value)))
            elif step.op in ("number", "pi"):
                is_count = self.counts and (step.op == "pi" or getattr(step.value, "denominator", 0) == 1)
                stack.append("pure" if is_count else "number")
            elif step.op == "call":
                args = stack[len(stack) - step.operands :]
                del stack[len(stack) - step.operands :]
                stack.append(self._call(str(step.value), args, step.column))
            elif step.op == "table":
                stack[-1] = "unknown"
            elif step.op == "power":
                exponent, base = stack.pop(), stack.pop()
                self._call("exponent", [exponent], step.column)
                stack.append("unknown" if isinstance(base, Dimensioned) and base.dimension != NUMBER else base)
            elif step.op == "pow":
                stack.append(_power(stack.pop(), step.exponent))
            elif step.op != "neg":
                b, a = stack.pop(), stack.pop()
                stack.append(self._sum(a, b, step.column) if step.op in ("add", "sub") else _product(a, b, step.op))
        return stack.pop()

    def require(self, found: Inferred, expected: Dimension) -> None:
        """Raises DimensionError unless the expression can stand where this dimension is expected."""
        if isinstance(found, Dimensioned) and found.dimension != expected:
            self._contradict(f"{found} found where {si_text(expected)} is expected", found.sure)

    def _sum(self, a: Inferred, b: Inferred, column: int) -> Inferred:
        """What is added has one dimension; what has none takes that of the other."""
        if not isinstance(a, Dimensioned) or not isinstance(b, Dimensioned):
            return a if isinstance(a, Dimensioned) or b == "pure" else b
        if a.dimension == b.dimension:
            return a if a.sure else b
        self._contradict(f"{a} and {b} are added (column {column})", a.sure and b.sure)
        return b if b.sure else a

    def _call(self, name: str, args: Sequence[Inferred], column: int) -> Inferred:
        x = args[0]
        if name == "sqrt":
            return _scaled(x, Fraction(1, 2))
        if name in ("abs", "sign"):
            return x if name == "abs" else "pure"
        if len(args) > 1:
            for other in args[1:]:
                x = self._sum(x, other, column)
            return x if name in ("min", "max") else "pure"
        if isinstance(x, Dimensioned) and x.dimension != NUMBER:
            self._contradict(f"{name} of {x} (column {column})", x.sure)
        return "pure"

    def _contradict(self, message: str, sure: bool) -> None:
        if sure:
            raise DimensionError(message)
        self.doubts.append(message)


def _product(a: Inferred, b: Inferred, op: str) -> Inferred:
    """The dimensions are added, or subtracted; a number as factor leaves open whether it has one."""
    if op == "div":
        b = _scaled(b, Fraction(-1))
    if isinstance(a, Dimensioned) and isinstance(b, Dimensioned):
        total = tuple(x + y for x, y in zip(a.dimension, b.dimension, strict=True))
        return Dimensioned(total, a.sure and b.sure)
    if "unknown" in (a, b):
        return "unknown"
    known = a if isinstance(a, Dimensioned) else b
    is_number = "number" in (a, b)
    if isinstance(known, Dimensioned) and not (is_number and known.dimension == NUMBER):
        return Dimensioned(known.dimension, known.sure and not is_number)
    return "number" if is_number else "pure"


def _power(x: Inferred, n: int) -> Inferred:
    return _scaled(x, Fraction(n)) if n else "number"


def _scaled(x: Inferred, n: Fraction) -> Inferred:
    return Dimensioned(tuple(n * k for k in x.dimension), x.sure) if isinstance(x, Dimensioned) else x
