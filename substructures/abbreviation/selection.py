"""Which changes of a program are worth it: those that save most operations for the least error, one after the other.

Errors of all changes at some states come from one reverse differentiation of every element; a change is made only if
the errors of the changed program at these states stay within what is allowed. That proves nothing: see :mod:`.bound`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from substructures.abbreviation.changes import Change, changed, possible
from substructures.abbreviation.ranges import Box
from substructures.abbreviation.samples import elements_of, probe, sensitivities, values_of
from substructures.abbreviation.sums import Index
from substructures.array import Array
from substructures.expr.program import Program

#: the power mean of errors, by which changes are compared
POWER = 4
#: changes that are tried in a round, and the part of the operations that may go in one round
TRIED, SHARE = 40, 0.01
#: an error of formulas that are equal, in units of the largest value of the element
ROUNDING = 1e-11
#: an error of no account, in units of what is allowed
NOTHING = 1e-9


@dataclass
class Selection:
    """Programs with more and more left out, the first one the full one.

    ``allowed``: the largest error of every element at the states; elements without are not changed. ``limits``: these,
    in the order of the elements.
    """

    full: Program
    box: Box
    allowed: dict[Index, float]
    report: Callable[[], object] = lambda: None
    programs: list[Program] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._probe = probe(self.full, self.box)
        self._elements = list(next(iter(self.full.outputs.values())).index)
        self._exact = self._values(self.full)
        # what rounding does is no error, also where none is allowed
        rounding = ROUNDING * self._probe.sizes(self._exact).max(axis=1, initial=0.0)
        found = np.array([self.allowed.get(i, 0.0) for i in self._elements])
        self.limits: Array = np.maximum(found, np.maximum(rounding, np.finfo(float).tiny))
        self.programs = self.programs or [self.full]

    def _values(self, program: Program) -> Array:
        count = self._probe.count
        found = elements_of(program, values_of(program, self._probe.states), count)
        zero = np.zeros(count)
        return np.stack([found.get(i, zero) for i in self._elements]) if self._elements else np.zeros((0, count))

    def errors(self, program: Program) -> dict[Index, float]:
        """The largest error of every element at the states."""
        found = self._probe.sizes(self._values(program) - self._exact).max(axis=1, initial=0.0)
        return dict(zip(self._elements, found.tolist(), strict=True))

    def extend(self) -> None:
        """Leave out as much as is allowed."""
        while self._step():
            self.report()

    def _step(self) -> bool:
        current = self.programs[-1]
        count = current.count()["total"]
        ranked = _Ranking(self, current).changes()
        several = ranked[: max(1, int(SHARE * count))]
        if len(several) > 1 and self._made(current, several, count):
            return True
        return any(self._made(current, [change], count) for change in ranked[:TRIED])

    def _made(self, current: Program, changes: Iterable[Change], count: int) -> bool:
        try:
            found = changed(current, changes)
        except (ZeroDivisionError, ValueError):
            return False
        if found.count()["total"] >= count or not self.is_allowed(self.errors(found)):
            return False
        self.programs.append(found)
        return True

    def is_allowed(self, errors: Mapping[Index, float]) -> bool:
        """Whether errors at the states are within what is allowed."""
        return all(errors[i] <= limit for i, limit in zip(self._elements, self.limits, strict=True))

    def sizes(self, errors: Array) -> Array:
        """The sizes of errors at all states by element and place."""
        return self._probe.sizes(errors)

    def ranking(self, program: Program) -> tuple[dict[int, Array], Array, list[dict[int, Array]]]:
        """The values of a program at the states, its errors, and the sensitivities of its elements."""
        values = values_of(program, self._probe.states)
        output = next(iter(program.outputs.values()))
        entries = dict(zip(output.index, output.entries, strict=True))
        slopes = [sensitivities(program, values, entries[i]) if i in entries else {} for i in self._elements]
        return values, self._values(program) - self._exact, slopes


class _Ranking:
    """The changes of a program, by what they save for the error that they add."""

    def __init__(self, selection: Selection, program: Program) -> None:
        self.program, self.limits = program, selection.limits
        self.values, self.errors, self.slopes = selection.ranking(program)
        self.scaled = self.errors / self.limits[:, None]
        self.sizes = selection.sizes
        self.before = _mean(self.sizes(self.scaled))

    def changes(self) -> list[Change]:
        """The best ones first."""
        with np.errstate(all="ignore"):
            found = [(self._cost(change), change) for change in possible(self.program, self.values)]
        kept = [(cost / change.saved, change.place, change) for cost, change in found if np.isfinite(cost)]
        return [change for _, _, change in sorted(kept, key=lambda each: each[:2])]

    def _cost(self, change: Change) -> float:
        """How much larger the errors become; infinite for one that is not allowed."""
        new, difference = self.scaled.copy(), change.difference(self.program, self.values)
        for a, slopes in enumerate(self.slopes):
            slope = slopes.get(change.place)
            if slope is not None:
                new[a] += difference * slope / self.limits[a]
        sizes = self.sizes(new)
        if not sizes.max(initial=0.0) <= 1:
            return np.inf
        return max(_mean(sizes) - self.before, NOTHING)


def _mean(errors: Array) -> float:
    if not errors.size:
        return 0.0
    with np.errstate(all="ignore"):  # infinite is as bad as it gets
        return float((errors**POWER).mean() ** (1 / POWER))
