"""Formulas of a model with what is negligible left out: fewer operations, and how wrong they can be, proven.

**What ``simplify`` means.** Every element of a quantity (every entry of g_ab, every inverse dynamics tau_a, ...) may be
wrong, anywhere in the ranges, by at most ``simplify`` times the largest absolute value that the same element takes on
in the ranges. Both are certain: errors are bounded from above over all of the ranges (:mod:`.bound`, exact coefficients
of the difference by :mod:`.sums`), largest values from below by the value in one state of the ranges, a ball.

**How.** States in the ranges say what could be left out (:mod:`.selection`), from nothing to much. Of these programs
the last one counts whose errors are proven; where proofs leave something to spare, more is left out and proven again.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from substructures.abbreviation.bound import Prover
from substructures.abbreviation.ranges import Box, Interval, Ranges, fixed_values, read_box
from substructures.abbreviation.samples import attained
from substructures.abbreviation.selection import Selection
from substructures.abbreviation.sums import AngleSums, Differences, Index
from substructures.errors import InvalidArgument, TooLarge, among
from substructures.expr.bind import bind
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program
from substructures.quantities.formulas import kept
from substructures.quantities.quantity import DERIVED
from substructures.tree.given.ties import require_chains
from substructures.tree.model import Model

#: told how much is done, may raise
Report = Callable[[float], object]
#: errors that are proven, in units of those at states, before anything is known; and by how much these may differ
FIRST_FACTOR, MOST_FACTOR = 1.3, 8.0
#: how often more is left out after a proof
ROUNDS = 4
#: operations of formulas, beyond which proofs would take hours
MOST_OPERATIONS = 3000
#: products of variables of an element that are listed
LISTED = 12


@dataclass(frozen=True)
class Neglected:
    """A part of the difference: ``product`` of variables times a sum of ``terms`` cosines and sines of angles, whose
    absolute value never exceeds ``largest`` [unit of the element].
    """

    product: str
    terms: int
    largest: float


@dataclass(frozen=True)
class ElementError:
    """How wrong an element can be: ``bound`` [its unit] is never exceeded in the ranges, ``attained`` is at most the
    largest absolute value of the element there, ``relative`` is bound over attained.

    ``neglected``: the largest parts of the difference; ``others``: how many more there are.
    """

    index: Index
    bound: float
    attained: float
    relative: float
    neglected: tuple[Neglected, ...] = ()
    others: int = 0


@dataclass(frozen=True, repr=False)
class Abbreviation:
    """``program``: the output ``quantity`` with what is negligible left out, as a function of what has a range.

    ``full``: the same with nothing left out; ``errors``: of all elements that are not exact; ``ranges``: of the
    symbols; ``values``: numbers of all that has no range.
    """

    program: Program
    full: Program
    quantity: str
    simplify: float
    errors: tuple[ElementError, ...]
    ranges: Box = field(hash=False)
    values: Mapping[str, Any] = field(hash=False)

    def __repr__(self) -> str:
        said = f"{self.quantity}: {self.operations_before} operations before, {self.operations} after"
        return f"Abbreviation({said}; errors at most {self.bound:.3g} of the largest values, proven)"

    @property
    def operations_before(self) -> int:
        """Additions, subtractions, multiplications and divisions of the full formulas."""
        return self.full.count()["total"]

    @property
    def operations(self) -> int:
        """Those of the abbreviated ones."""
        return self.program.count()["total"]

    @property
    def bound(self) -> float:
        """The largest error of an element in units of the largest absolute value of that element."""
        return max((error.relative for error in self.errors), default=0.0)


def abbreviate(
    model: Model,
    quantity: str,
    simplify: float,
    ranges: Ranges | None = None,
    parameters: Mapping[str, Any] | None = None,
    report: Report = lambda _: None,
) -> Abbreviation:
    """A quantity of a model with what is negligible left out.

    ``simplify``: from 0 to below 1, see above. ``ranges``: (lowest, highest) by name of a coordinate, velocity
    (``arm.q1'``), acceleration (``arm.q1''``), input, parameter or t, in SI, and ``coordinates``, ``velocities``,
    ``accelerations`` for all that are not named. Coordinates without a range have that of their limits, those of
    revolute joints without limits a whole turn; inputs are 0. ``parameters``: numbers of those without a range, beside
    their defaults. Couple the model with ``group=True`` for the fewest operations.

    The numbers of operations of both are those of :meth:`substructures.expr.program.Program.count`. Nothing depends on
    how fast a machine is: the same request has the same result. Raises InvalidArgument (``/quantity``, ``/simplify``,
    ``/ranges/name``, ``/parameters/name``), TooLarge.
    """
    require_chains(model.balls)
    simplify = _criterion(simplify)
    whole = _program(model, quantity)
    ranges = dict(ranges or {})
    fixed = fixed_values(model, whole, ranges, parameters)
    full = hoisted(bind(whole, fixed))
    if len(full) > MOST_OPERATIONS:
        raise TooLarge("the formulas to be abbreviated (in operations)", len(full), MOST_OPERATIONS)
    box = read_box(model, full, ranges, fixed)
    report(0.0)
    if not simplify or not full.operations:
        return Abbreviation(full, full, quantity, simplify, (), box, fixed)
    found, errors = _Search(full, box, simplify, report).result()
    return Abbreviation(found, full, quantity, simplify, errors, box, fixed)


class _Search:
    """What can be proven, and what is left out then."""

    def __init__(self, full: Program, box: Box, simplify: float, report: Report) -> None:
        self.full, self.box, self.report = full, box, report
        self.attained = {i: float(x) for i, x in attained(full, box).items()}
        self.allowed = {i: simplify * x for i, x in self.attained.items()}
        self.differences = Differences(full, box)
        angles: list[Interval] = [box[name] for name in self.differences.angles]
        self.prover = Prover(angles, lambda: report(self.share))
        self.share = 0.0

    def result(self) -> tuple[Program, tuple[ElementError, ...]]:
        """The last program that was proven, and its errors."""
        factors = dict.fromkeys(self.allowed, FIRST_FACTOR)
        programs = [self.full]
        for k in range(ROUNDS):
            self.share = k / ROUNDS
            good = len(programs) - 1
            limits = {i: x / factors[i] for i, x in self.allowed.items()}
            selection = Selection(self.full, self.box, limits, lambda: self.report(self.share), programs)
            selection.extend()
            last = self._proven(programs, good)
            if last == good and k:
                break
            factors = self._factors(selection, programs[min(last + 1, len(programs) - 1)])
            del programs[last + 1 :]
        return programs[last], self._errors(programs[last])

    def _proven(self, programs: list[Program], good: int) -> int:
        """The number of the last program whose errors are proven; errors grow with the number, as a rule."""
        bad = len(programs)
        probe = bad - 1
        while bad - good > 1:
            if self._is_proven(programs[probe]):
                good = probe
            else:
                bad = probe
            probe = (good + bad) // 2
        return good

    def _is_proven(self, program: Program) -> bool:
        found = self.differences.of(program)
        # an element that needs no search first
        by_size = sorted(found, key=lambda i: len(found[i].weights))
        return all(self.prover.bound(found[i], self.allowed[i]).proven <= self.allowed[i] for i in by_size)

    def _factors(self, selection: Selection, program: Program) -> dict[Index, float]:
        """By element, what is proven over what is seen at the states; infinite where nothing can be proven."""
        seen, found = selection.errors(program), self.differences.of(program)
        result: dict[Index, float] = {}
        for i in self.allowed:
            proven = self.prover.bound(found[i]).proven if i in found else 0.0
            ratio = proven / seen[i] if seen.get(i) else FIRST_FACTOR
            result[i] = min(max(1.0, ratio), MOST_FACTOR) if math.isfinite(proven) else math.inf
        return result

    def _errors(self, program: Program) -> tuple[ElementError, ...]:
        found = self.differences.of(program)
        return tuple(self._error(i, found[i]) for i in sorted(found))

    def _error(self, index: Index, sums: AngleSums) -> ElementError:
        allowed, largest = self.allowed[index], self.attained[index]
        bound = min(self.prover.bound(sums).proven, self.prover.bound(sums, allowed).proven)
        sizes = sums.sizes.tolist()
        counts = [b - a for a, b in zip(sums.starts, [*sums.starts[1:], len(sums.multiples)], strict=True)]
        parts = sorted(map(Neglected, sums.products, counts, sizes), key=lambda part: -part.largest)
        relative = bound / largest if largest else math.inf
        return ElementError(index, bound, largest, relative, tuple(parts[:LISTED]), max(0, len(parts) - LISTED))


def _criterion(given: Any) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0 <= given < 1:
        message = f"'simplify' is a number from 0 to below 1, found {repr(given)[:80]}"
        raise InvalidArgument.at("/simplify", "not-in-range", message)
    return float(given)


def _program(model: Model, quantity: str) -> Program:
    """The program of one output. Raises InvalidArgument."""
    if isinstance(quantity, str) and quantity in model.program.outputs:
        return model.program.select([quantity])
    if isinstance(quantity, str) and quantity in DERIVED:
        found = kept(model, quantity)
        if quantity in found.outputs:
            return found.select([quantity])
    names = dict.fromkeys([*model.program.outputs, *DERIVED])
    message = f"unknown quantity '{str(quantity)[:80]}'{among(quantity, names)}"
    raise InvalidArgument.at("/quantity", "unknown-quantity", message)
