"""Two sets of formulas entry by entry: the same functions by fingerprint, and how far their numbers are apart.

Entries are found by what their axes mean (coordinates, bodies, ports by name): a joint more does not shift them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from math import prod
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret_entries
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, program

#: random states at which numbers are compared
STATES = 16
#: of coordinates, velocities and accelerations, in SI units
RANGE = (-1.5, 1.5)
#: relative difference of numbers that are equal
TOLERANCE = 1e-12
#: of the largest number of a quantity, where relative differences end
NEGLIGIBLE = 1e-6
#: the names of an entry, or its numbers
Place = tuple[str | int, ...]


@dataclass(frozen=True)
class FormulaSet:
    """The formulas of one side in a graph that both share.

    ``labels``: what the indices along the axes of an output are called, None where they are numbers; ``symbols``: by
    name; ``defaults``: numbers of the parameters that have some.
    """

    formulas: Mapping[str, Formulas]
    labels: Callable[[str], tuple[tuple[str, ...] | None, ...]]
    symbols: Mapping[str, Symbol]
    defaults: Mapping[str, float]


@dataclass(frozen=True)
class EntryDifference:
    """An entry that is not the same. ``change``: the largest of its numbers at the defaults of both, over the random
    states, relative to the largest number, and ``rms`` the root of the mean square; None where that is none. ``state``:
    of its formula: ``equal``, ``changed``, ``new`` or ``gone``.
    """

    place: Place
    state: str
    change: float | None
    rms: float | None

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {"place": list(self.place), "state": self.state, "change": self.change}


@dataclass(frozen=True)
class QuantityDifference:
    """Of ``entries`` independent ones so many have ``equal`` formulas; ``moved``: whose numbers differ at the defaults,
    by ``change`` at most; ``differing``: those of which anything differs.
    """

    name: str
    entries: int
    differing: tuple[EntryDifference, ...]

    def count(self, state: str) -> int:
        """How many entries are ``changed``, ``new`` or ``gone``."""
        return sum(each.state == state for each in self.differing)

    def without(self, labels: Collection[str | int]) -> QuantityDifference:
        """The same but for entries at a place with one of these labels."""
        return replace(self, differing=tuple(each for each in self.differing if not set(labels) & set(each.place)))

    @property
    def moved(self) -> int:
        """How many have other numbers."""
        return sum(each.change is None or each.change > TOLERANCE for each in self.differing)

    @property
    def change(self) -> float | None:
        """The largest change of numbers; None where there is none that is a number."""
        return max((each.change for each in self.differing if each.change is not None), default=None)

    @property
    def rms(self) -> float | None:
        """The largest root mean square of changes of an entry; None where there is none that is a number."""
        return max((each.rms for each in self.differing if each.rms is not None), default=None)

    def plain(self, most: int) -> dict[str, Any]:
        """As JSON data, with the first ``most`` entries that differ."""
        counts = {state: self.count(state) for state in ("changed", "new", "gone")}
        return {
            "entries": self.entries,
            "equal": self.entries - sum(counts.values()),
            **counts,
            "moved": self.moved,
            "change": self.change,
            "rms": self.rms,
            "differing": [each.plain() for each in self.differing[:most]],
        }


def compared(graph: Graph, a: FormulaSet, b: FormulaSet) -> list[QuantityDifference]:
    """All quantities that at least one of both has; there is no size where it would depend on a parameter without a
    default on either side.
    """
    values = _values(a, b)
    names = [*a.formulas, *(name for name in b.formulas if name not in a.formulas)]
    return [_quantity(graph, name, a, b, values) for name in names]


def _quantity(
    graph: Graph, name: str, a: FormulaSet, b: FormulaSet, values: tuple[dict[str, Array], dict[str, Array]]
) -> QuantityDifference:
    x, y = a.formulas.get(name), b.formulas.get(name)
    is_alike = x is not None and y is not None and x.shape == y.shape and a.labels(name) == b.labels(name)
    ours, theirs = (_placed(f, side.labels(name), is_alike) if f else {} for f, side in ((x, a), (y, b)))
    (numbers, used), (others, used_there) = (
        _numbers(graph, some, side.symbols, v) for some, side, v in zip((ours, theirs), (a, b), values, strict=True)
    )
    has_size = all(s.kind != "parameter" or s.name in a.defaults or s.name in b.defaults for s in used | used_there)
    changes = _changes(numbers, others, has_size)
    states = {place: _state(graph, ours.get(place), theirs.get(place)) for place in changes}
    differing = tuple(
        EntryDifference(place, states[place], change, rms)
        for place, (change, rms) in changes.items()
        if states[place] != "equal" or change is None or change > TOLERANCE
    )
    size = max(_size(f, is_alike) for f in (x, y) if f is not None)
    return QuantityDifference(name, max(size, len(changes)), differing)


def _changes(
    x: Mapping[Place, Array], y: Mapping[Place, Array], has_size: bool
) -> dict[Place, tuple[float | None, float | None]]:
    """By element how far the numbers are apart, at most and rms; None where they are, and without sizes nobody can tell
    how far.
    """
    # an entry that is as good as zero beside the others is not compared with itself
    least = NEGLIGIBLE * max((float(np.abs(v).max()) for some in (x, y) for v in some.values()), default=0.0)
    found = {place: _change(x.get(place), y.get(place), least) for place in {**x, **y}}
    unknown = None, None
    return {place: c if has_size or c[0] is None or c[0] <= TOLERANCE else unknown for place, c in found.items()}


def _placed(formulas: Formulas, labels: tuple[tuple[str, ...] | None, ...], is_alike: bool) -> dict[Place, Expr]:
    """The elements that are not zero, by what their indices mean; where axes differ all that follow from symmetries."""
    entries = formulas.entries if is_alike else formulas.expanded()
    return {
        tuple(label[i] if label else i for i, label in zip(index, labels, strict=True)): x
        for index, x in entries.items()
        if isinstance(x, Expr) and not x.is_zero
    }


def _size(formulas: Formulas, is_alike: bool) -> int:
    """How many independent elements there are."""
    n = formulas.shape[0] if formulas.shape else 1
    independent = {
        "symmetric": n * (n + 1) // 2,
        "christoffel": n * (n * n - 1) // 3,
        "connection": n * n * (n + 1) // 2,
    }
    return independent[formulas.symmetry] if is_alike and formulas.symmetry in independent else prod(formulas.shape)


def _state(graph: Graph, x: Expr | None, y: Expr | None) -> str:
    if x is None or y is None:
        return "new" if x is None else "gone"
    return "equal" if x is y or (graph.lift(x) - graph.lift(y)).is_zero else "changed"


def _numbers(
    graph: Graph, entries: Mapping[Place, Expr], symbols: Mapping[str, Symbol], values: Mapping[str, Array]
) -> tuple[dict[Place, Array], set[Symbol]]:
    """The elements at the random states, and what they depend on."""
    listed = Formulas((len(entries),), {(k,): x for k, x in enumerate(entries.values())})
    found = program(graph, {"entries": listed}, symbols)
    with np.errstate(all="ignore"):
        numbers = interpret_entries(found, {s.name: values[s.name] for s in found.symbols}, ["entries"])["entries"]
    return dict(zip(entries, (np.broadcast_to(x, (STATES,)) for x in numbers), strict=True)), set(found.symbols)


def _change(x: Array | None, y: Array | None, least: float) -> tuple[float | None, float | None]:
    """The largest difference over the largest number, and the rms; None where there is no number to compare with."""
    if x is None or y is None:
        return None, None
    apart, scale = np.abs(y - x), max(float(np.abs(x).max()), least)
    most = float(apart.max())
    if not most:
        return 0.0, 0.0
    if not (scale and np.isfinite(most / scale)):
        return None, None
    return most / scale, most / scale * float(np.sqrt(np.mean((apart / most) ** 2)))


def _values(a: FormulaSet, b: FormulaSet) -> tuple[dict[str, Array], dict[str, Array]]:
    """Random numbers for coordinates, velocities, accelerations, the time and given motions, the same for both; 0 for
    other inputs; defaults of parameters, or that of the other side, or the same random number where there is none.
    """
    rng, given, common = np.random.default_rng(5), np.random.default_rng(6), dict[str, Array]()
    kinds = {name: symbol.kind for side in (a, b) for name, symbol in sorted(side.symbols.items())}
    for name, kind in sorted(kinds.items()):
        if kind == "time" or (kind == "input" and (name.endswith("'") or f"{name}'" in kinds)):
            common[name] = given.uniform(0.5, 1.5, STATES)
        elif kind == "input":
            common[name] = np.zeros(STATES)
        elif kind == "parameter":
            common[name] = np.full(STATES, rng.uniform(0.5, 1.5))
        else:
            common[name] = rng.uniform(*RANGE, STATES)
    ours, theirs = ({name: np.full(STATES, x) for name, x in side.defaults.items()} for side in (a, b))
    return {**common, **theirs, **ours}, {**common, **ours, **theirs}
