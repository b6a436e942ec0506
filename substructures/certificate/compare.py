"""Whether stored programs agree with what the documents say: every element of every output, in balls, at random states.

Both sides are enclosures of exact values. Where they do not meet, the stored formula is wrong, whatever rounding does;
where they meet they have to be narrow beside the value itself (:data:`TOLERANCE`), so that no choice of units hides a
fault. What is zero has no scale of its own: it counts as agreed where the enclosures are narrow beside the largest
element of the output, or where both still contain zero at eight times the precision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from flint import arb, ctx

from substructures.certificate.linear import Ball
from substructures.certificate.outputs import Outputs, Values
from substructures.certificate.slopes import stored_gradient
from substructures.certificate.states import WITHOUT_DEFAULTS, State, draws
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.errors import VerificationFailed
from substructures.expr.operations import Output

#: bits of the arithmetic, and where these do not suffice
PRECISIONS = (128, 1024)
#: how far an enclosure may reach, relative to its value
TOLERANCE = 2.0**-40
#: what needs no closer look
PRECISE, SMALL, LARGE = 2.0**-80, 1e-200, 1e200
NOT_FINITE = (
    "has no finite value where the documents give one; if a law has a root of what is cut off at zero, which has an "
    "infinite slope there, as max(0, x)^0.5, take sqrt(max(0, x) + 1e-6)"
)

Expected = Callable[[State], Outputs]
Index = tuple[int, ...]
#: elements that are to be compared, by output
Elements = dict[str, set[Index]]


class Compared(NamedTuple):
    """``errors``: of every output the largest relative difference that enclosures leave open; None where an element has
    no finite value at any state. ``left_out``: coordinates on which forces act that have a potential, of which the
    stored one is without. ``at_defaults``: whether random values of all parameters did not suffice, and states with
    their defaults were looked at.
    """

    errors: dict[str, float | None]
    left_out: list[str]
    at_defaults: bool

    @property
    def not_judged(self) -> list[str]:
        """The outputs of which it cannot be told whether they are right."""
        return [name for name, error in self.errors.items() if error is None]


def compare(
    program: Stored, kinds: Mapping[str, str], expected: Expected, defaults: Mapping[str, Any], states: int
) -> Compared:
    """Every output of a program beside what is ``expected``.

    ``kinds``: of the symbols that it may have; ``defaults``: of parameters, where random values lead out of a domain;
    ``states``: how many are needed (:func:`substructures.certificate.states.states_needed`).
    Raises VerificationFailed, which names output and element.
    """
    for symbol in program.symbols:
        if kinds.get(symbol.name) != symbol.kind:
            raise VerificationFailed(f"the symbol '{symbol.name[:80]}' ({symbol.kind}) is none of the documents")
    comparison = _Comparison(program, expected, defaults)
    tried = 0
    for some in draws(kinds, defaults, states):
        comparison.at(some)
        tried += 1
        if not comparison.open:
            break
    return Compared(comparison.result(), sorted(comparison.left_out), tried > WITHOUT_DEFAULTS)


@dataclass
class _Comparison:
    """What was found so far; None before the first state.

    ``open``: elements that had no finite value at some state; ``never``: at none so far; ``given``: elements that the
    documents gave one where the program had none. ``here``: the state that is looked at, and what is expected there.
    """

    program: Stored
    expected: Expected
    defaults: Mapping[str, Any]
    errors: dict[str, float] = field(default_factory=dict)
    left_out: set[str] = field(default_factory=set)
    open: Elements | None = None
    never: Elements | None = None
    given: Elements = field(default_factory=dict)
    here: tuple[State, Outputs] = field(default_factory=lambda: ({}, Outputs()))

    def at(self, states: list[State]) -> None:
        """Compare what is open at some states."""
        outside = [self._refined(state, self.open) for state in states]
        names = {name for some in outside for name in some}
        self.open = {name: set().union(*(some.get(name, set()) for some in outside)) for name in names}
        nowhere = {name: set.intersection(*(some.get(name, set()) for some in outside)) for name in names}
        before = nowhere if self.never is None else self.never
        self.never = {name: some & before.get(name, set()) for name, some in nowhere.items()}

    def _refined(self, state: State, elements: Elements | None) -> Elements:
        """Compare at one state, more exactly where balls are too wide; returns what is not finite there."""
        outside: Elements = {}
        for precision in PRECISIONS:
            wide = self._once(state, elements, precision, outside)
            if not wide:
                return outside
            elements = wide
        for name, some in wide.items():
            outside.setdefault(name, set()).update(some)
        return outside

    def _once(self, state: State, elements: Elements | None, precision: int, outside: Elements) -> Elements:
        """Compare with one precision; returns the elements whose balls are too wide to tell."""
        wide: Elements = {}
        with ctx.workprec(precision):
            wanted = self.expected({name: arb(x) for name, x in state.items()})
            self.here = state, wanted
            found = operations_in_balls(self.program, {name: arb(x) for name, x in state.items()})
            for name in self.program.outputs.keys() - wanted.keys():
                raise VerificationFailed(f"{name[:80]} is no output that the documents know of")
            for name in wanted if elements is None else elements:
                values = wanted[name]
                stored = _stored(name, self.program, values, found, state)
                some = {**values.entries, **stored} if elements is None else elements[name]
                self._elements(name, some, stored, values, (wide, outside), precision == PRECISIONS[-1])
        return wide

    def _elements(
        self,
        name: str,
        some: Iterable[Index],
        stored: Mapping[Index, Ball],
        values: Values,
        unsure: tuple[Elements, Elements],
        last: bool,
    ) -> None:
        """Compare elements of one output; notes those that are too wide, and those that are not finite."""
        zero, worst, entries, others = arb(0), self.errors.get(name, 0.0), values.entries, values.others
        for index in some:
            a = stored.get(index, zero)
            b = self._like(values, index, a) if index in others else entries.get(index, zero)
            difference, size = float((a - b).abs_upper()), abs(float(b))
            # most are precise; what is not finite, zero, or beyond the range of doubles is looked at below
            if difference <= size * PRECISE and SMALL < size < LARGE:
                if difference > worst * size:
                    worst = difference / size
            elif size or difference or not (a.is_zero() and b.is_zero()):
                worst = max(worst, self._element(name, index, a, b, values, unsure, last))
        self.errors[name] = worst

    def _like(self, values: Values, index: Index, stored: Ball) -> Ball:
        """What an element of several choices has to be; notes what is left out then."""
        ball, leaves_out = values.like(index, stored)
        if leaves_out:
            self.left_out.add(values.along[index[0]])
        return ball

    def _element(
        self, name: str, index: Index, a: Ball, b: Ball, values: Values, unsure: tuple[Elements, Elements], last: bool
    ) -> float:
        """The relative error of an element; noted instead where it is not finite, or too wide."""
        wide, outside = unsure
        # what was found by integration may have no value where the law that it comes from has one
        if not b.is_finite() or (index in values.others and not a.is_finite()):
            outside.setdefault(name, set()).add(index)
        elif not a.is_finite():
            if last and self._is_inside():
                raise VerificationFailed(f"{_place(name, index, values)} {NOT_FINITE}")
            (outside if last else wide).setdefault(name, set()).add(index)
            self.given.setdefault(name, set()).add(index)
        elif not a.overlaps(b):
            raise VerificationFailed(_told(_place(name, index, values), a, b))
        elif not _both_zero(a, b, values, last):
            error = (a - b).abs_upper() / b.abs_lower()
            if error <= TOLERANCE:
                return float(error)
            wide.setdefault(name, set()).add(index)
        return 0.0

    def _is_inside(self) -> bool:
        """Whether the documents have values here as a whole, and no parameter is negative that is not so by default.

        What is put together otherwise leaves its domain where it may, sqrt(l) - sqrt(l) with l < 0: another state
        decides.
        """
        state, wanted = self.here
        negative = (n for n, x in state.items() if float(x) < 0 and x is not self.defaults.get(n))
        if any(
            symbol.kind == "parameter" for name in negative for symbol in self.program.symbols if symbol.name == name
        ):
            return False
        return all(x.is_finite() for values in wanted.values() for x in values.entries.values())

    def result(self) -> dict[str, float | None]:
        """The errors by output; None for those with an element that was finite nowhere. Raises VerificationFailed for
        one that was finite nowhere in the program alone.
        """
        never = self.never or {}
        for name, some in never.items():
            for index in sorted(some & self.given.get(name, set())):
                raise VerificationFailed(
                    f"{_place(name, index)} has a finite value nowhere, and the documents give one"
                )
        return {name: None if never.get(name) else error for name, error in self.errors.items()}


def _stored(name: str, program: Stored, values: Values, found: list[Ball], state: State) -> dict[Index, Ball]:
    """The stored elements of an output that is of the shape and symmetry that it has to be; or its derivatives."""
    output: Output | None = program.outputs.get(name)
    if output is None:
        raise VerificationFailed(f"{name} is missing")
    if (tuple(output.shape), output.symmetry) != (values.shape, values.symmetry):
        wanted, kept = (f"{'x'.join(map(str, x.shape)) or 'scalar'} {x.symmetry}" for x in (values, output))
        raise VerificationFailed(f"{name} is {kept}, and has to be {wanted}")
    if values.along:
        entry = next(iter(output.entries), None)
        stored = stored_gradient(
            program, entry, found, {n: arb(x) for n, x in state.items()}, values.along, values.ways
        )
        return {index: x for index, x in stored.items() if index in values.entries}
    return {tuple(index): found[entry] for index, entry in zip(output.index, output.entries, strict=True)}


def _both_zero(a: Ball, b: Ball, values: Values, last: bool) -> bool:
    """Whether both sides are zero, as far as one can tell: with the last precision, or beside the other elements."""
    if not (a.contains(0) and b.contains(0)):
        return False
    return last or bool((a - b).abs_upper() <= values.size() * TOLERANCE)


def _told(place: str, a: Ball, b: Ball) -> str:
    found, wanted = (x.str(12, radius=False) for x in (a, b))
    return f"{place} is {found} at a random state, and has to be {wanted} by the documents"


def _place(name: str, index: Index, values: Values | None = None) -> str:
    if values is not None and values.along:
        if index[0] == len(values.along):
            return f"{name} where all coordinates are zero"
        return f"the change of {name} with {values.along[index[0]]}"
    return f"{name}[{', '.join(map(str, index))}]" if index else name
