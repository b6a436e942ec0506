"""States in the ranges, by which is chosen what to leave out. Nothing here is proven but :func:`attained`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from substructures.abbreviation.balls import PRECISION, enclosures, exact
from substructures.abbreviation.ranges import Box
from substructures.abbreviation.sums import Index
from substructures.array import Array
from substructures.expr.graph import Graph
from substructures.expr.interpret import operations
from substructures.expr.program import Program, operands
from substructures.expr.replay import replay

STATES, LEAST_PLACES = 512, 12
#: states at a place, at most
MOST_POINTS = 200
#: states among which, and rounds in which, the largest value of an element is looked for
FIRST, NEAR, ROUNDS = 8192, 64, 24
#: kinds of which formulas are polynomials of low degree, largest at the ends of ranges
AT_ENDS = ("velocity", "acceleration", "input")
#: the part of states that they are at an end in; at ends alone squares were constant
AT_END = 0.7

States = Mapping[str, Array]


def only_output(program: Program) -> str:
    """The name of the output of a program of one."""
    (name,) = program.outputs
    return name


def elements_of(program: Program, values: Mapping[int, Array], count: int) -> dict[Index, Array]:
    """The values of its independent elements, each (count,)."""
    output = program.outputs[only_output(program)]
    return {i: np.broadcast_to(values[e], (count,)) for i, e in zip(output.index, output.entries, strict=True)}


def values_of(program: Program, states: States) -> dict[int, Array]:
    """The value of every operation."""
    return operations(program, states, program.outputs)


@dataclass
class Sampler:
    """Random states of the symbols of a program."""

    program: Program
    box: Box
    seed: int = 0

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(self.seed)
        self.at_ends = {s.name for s in self.program.symbols if s.kind in AT_ENDS}
        self._ends = {name: (float(x.low), float(x.high)) for name, x in self.box.items()}

    def states(self, count: int) -> dict[str, Array]:
        """As many states, each symbol anywhere in its range or at an end."""
        return {name: self._drawn(name, count) for name in self._ends}

    def _drawn(self, name: str, count: int) -> Array:
        ends = self._ends[name]
        anywhere = self._random.uniform(*ends, count)
        if name not in self.at_ends:
            return anywhere
        return np.where(self._random.random(count) < AT_END, self._random.choice(ends, count), anywhere)

    def near(self, states: States, step: float) -> dict[str, Array]:
        """Some symbols of states drawn again, the others moved by a part of their range at most."""
        result: dict[str, Array] = {}
        for name, x in states.items():
            low, high = self._ends[name]
            moved = x if name in self.at_ends else x + step * (high - low) * self._random.uniform(-1, 1, len(x))
            again = self._random.random(len(x)) < 0.15
            result[name] = np.where(again, self._drawn(name, len(x)), np.clip(moved, low, high))
        return result


@dataclass(frozen=True)
class Probe:
    """States at which errors are measured: ``places`` of the other variables, and at each the same number of states of
    those that occur as polynomials of second degree. ``fold`` (M, M): from values there to the coefficients of these.

    The size of an element at a place is the sum of the absolute coefficients: with any signs, what it can become.
    """

    states: States
    fold: Array
    places: int

    @property
    def count(self) -> int:
        """Of all states."""
        return self.places * len(self.fold)

    def sizes(self, values: Array) -> Array:
        """Of values (..., states): (..., places)."""
        at_places = values.reshape(*values.shape[:-1], self.places, len(self.fold))
        return np.abs(at_places @ self.fold.T).sum(axis=-1)


def probe(program: Program, box: Box) -> Probe:
    """States for the symbols of a program; one at each place if the others are too many."""
    sampler = Sampler(program, box)
    folded = sorted(sampler.at_ends)
    points, fold = _second_degree(len(folded), [program_kind(program, name) == "velocity" for name in folded])
    if len(points) > MOST_POINTS:
        return Probe(sampler.states(STATES), np.ones((1, 1)), STATES)
    places = max(LEAST_PLACES, STATES // len(points))
    states = {name: np.repeat(x, len(points)) for name, x in sampler.states(places).items()}
    for name, column in zip(folded, points.T, strict=True):
        states[name] = np.tile(float(box[name].middle) + float(box[name].half) * column, places)
    return Probe(states, fold, places)


def program_kind(program: Program, name: str) -> str:
    """The kind of a symbol."""
    return next(s.kind for s in program.symbols if s.name == name)


def _second_degree(count: int, squared: Sequence[bool]) -> tuple[Array, Array]:
    """Points (M, count) of -1, 0, 1, and how coefficients follow from values there: of 1, x_i, x_i^2 and x_i x_j."""
    unit = np.eye(count)
    both = [i for i in range(count) if squared[i]]
    pairs = [(i, j) for i in both for j in both if i < j]
    points = [np.zeros(count), *unit, *(-unit[i] for i in both), *(unit[i] + unit[j] for i, j in pairs)]
    rows = np.array([[1.0, *x, *(x[i] ** 2 for i in both), *(x[i] * x[j] for i, j in pairs)] for x in points])
    return np.array(points), np.linalg.inv(rows)


def attained(full: Program, box: Box) -> dict[Index, Fraction]:
    """Of every element a number that its absolute value takes on or exceeds somewhere in the box, near the largest.

    States are searched in floating point; the value at the best one, in numbers inside the box, is a ball.
    """
    sampler = Sampler(full, box, seed=1)
    states = sampler.states(FIRST)
    found = elements_of(full, values_of(full, states), FIRST)
    best = {i: _at(states, int(np.nanargmax(np.abs(x))) if np.isfinite(x).any() else 0) for i, x in found.items()}
    for step in np.geomspace(0.2, 1e-3, ROUNDS):
        best = _improved(full, sampler, best, float(step))
    return {i: _certain(full, i, box, state) for i, state in best.items()}


def _at(states: States, k: int) -> dict[str, float]:
    return {name: float(x[k]) for name, x in states.items()}


def _improved(
    full: Program, sampler: Sampler, best: Mapping[Index, dict[str, float]], step: float
) -> dict[Index, dict[str, float]]:
    """Of states near the best ones the better ones."""
    names = list(sampler.box)
    here = {name: np.repeat([state[name] for state in best.values()], NEAR) for name in names}
    states = sampler.near(here, step)
    for name in names:  # the best one itself
        states[name][::NEAR] = here[name][::NEAR]
    count = NEAR * len(best)
    values = elements_of(full, values_of(full, states), count)
    result: dict[Index, dict[str, float]] = {}
    for n, i in enumerate(best):
        own = np.abs(values[i][n * NEAR : (n + 1) * NEAR])
        result[i] = _at(states, n * NEAR + int(np.nanargmax(own))) if np.isfinite(own).any() else best[i]
    return result


def _certain(full: Program, index: Index, box: Box, state: Mapping[str, float]) -> Fraction:
    inside = {name: min(max(Fraction(x), box[name].low), box[name].high) for name, x in state.items()}
    element = replay(full, Graph(), {})[only_output(full)].entries[index]
    (value,) = enclosures([element], {name: exact(x) for name, x in inside.items()})
    if not value.is_finite():
        return Fraction(0)
    with flint.ctx.workprec(PRECISION):
        low = value.abs_lower()
        return Fraction(float(low.mid()) * (1 - 2**-40)) if low > 0 else Fraction(0)


#: partial derivatives with respect to the operands, from their values and the value itself; of what is not here they
#: count as zero, which the states themselves show to be wrong
_PARTIAL: dict[str, Callable[..., tuple[Any, ...]]] = {
    "add": lambda *_: (1.0, 1.0),
    "sub": lambda *_: (1.0, -1.0),
    "mul": lambda a, b, _: (b, a),
    "div": lambda _, b, own: (1 / b, -own / b),
    "neg": lambda *_: (-1.0,),
    "sin": lambda a, _: (np.cos(a),),
    "cos": lambda a, _: (-np.sin(a),),
    "sqrt": lambda _, own: (0.5 / own,),
    "exp": lambda _, own: (own,),
}


def sensitivities(program: Program, values: Mapping[int, Array], entry: int) -> dict[int, Array]:
    """d entry / d operation for every operation that it depends on, by reverse differentiation."""
    found: dict[int, Array] = {entry: np.ones(())}
    with np.errstate(all="ignore"):
        for i in range(entry, -1, -1):
            operation = program.operations[i]
            partial = _PARTIAL.get(operation[0])
            if i not in found or partial is None:
                continue
            args = operands(operation)
            for x, slope in zip(args, partial(*(values[x] for x in args), values[i]), strict=True):
                share = found[i] * slope
                found[x] = found[x] + share if x in found else share
    return found
