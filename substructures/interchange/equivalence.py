"""Whether two models are the same: formulas with all parameters free, numbers at random states otherwise.

Metric, gravity and velocity forces, all forces and the equations of closures are compared, these row by row; a
different split of masses over links that the equations of motion do not see is no difference (base parameters). Where
numbers differ, the culprits are looked for

* among the screws of the joints where all coordinates are zero (axis, place);
* among the ten inertial numbers of the bodies that a coordinate carries, up to what Y(q, q', q'') does not see
  (M. Gautier and W. Khalil, 1990; notation.md, section 7);
* among armature, stiffness, damping and loads of the coordinates otherwise.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument, InvalidInput, listed
from substructures.expr.graph import Expr, Graph
from substructures.expr.replay import replay
from substructures.interchange.culprits import Culprit, culprits
from substructures.interchange.sides import CLOSURES, Matched, Side, matching

QUANTITIES = ("metric", "gravity", "bias", "forces")
#: relative difference of numbers that are equal
TOLERANCE = 1e-9
STATES = 4
#: of the largest element of the metric: forces are compared relative to no less
_CANCELLING = 1e-4


@dataclass(frozen=True)
class Equivalence:
    """``level``: what decided, ``formulas`` or ``values``; ``quantities``: whether the formulas of each are the same
    (None: parameters have other names) and the relative difference of its numbers."""

    equal: bool
    level: str
    quantities: dict[str, dict[str, Any]]
    first_difference: dict[str, Any] | None
    culprits: tuple[Culprit, ...]

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "equal": self.equal,
            "level": self.level,
            "quantities": self.quantities,
            "first_difference": self.first_difference,
            "culprits": [c.plain() for c in self.culprits],
        }


def equivalence(a: Side, b: Side, coordinates: Mapping[str, str] | None = None) -> Equivalence:
    """Compare two models; ``coordinates``: names in a to names in b, where they are not the same.

    Raises InvalidArgument for coordinates that cannot be matched, MissingValue for parameters of one side alone that
    have no value.
    """
    if a.model.dof != b.model.dof:
        told = {"quantity": "coordinates", "a": list(a.names), "b": list(b.names)}
        return Equivalence(False, "values", {}, told, ())
    rows = [[row for closure in side.model.closures for row in closure.rows] for side in (a, b)]
    if rows[0] != rows[1]:
        told = {"quantity": "closures", "a": rows[0], "b": rows[1]}
        return Equivalence(False, "values", {}, told, ())
    order = _order(a, b, coordinates or {})
    names = matching(a, b, order)
    if names is None:
        told = {"quantity": "balls", "a": _turning(a), "b": _turning(b)}
        return Equivalence(False, "values", {}, told, ())
    formulas = _formulas(a, b, names)
    rng = np.random.default_rng(1)
    values = _open_parameters(a, b, rng)
    numbers = _numbers(a, b, names, values, rng)
    # what cancels has no scale of its own: rates are about 1 here, so that the metric gives one
    least = _CANCELLING * max(float(np.abs(x).max(initial=0)) for x in numbers["metric"][:2])
    found = [_Difference.of(name, *sides, 0 if name in CLOSURES else least) for name, sides in numbers.items()]
    quantities = {d.name: {"formulas": formulas.get(d.name), "error": d.error} for d in found}
    if all(d.error <= TOLERANCE for d in found):
        level = "formulas" if formulas and all(formulas.values()) else "values"
        return Equivalence(True, level, quantities, None, ())
    first = next(d for d in found if d.error > TOLERANCE)
    return Equivalence(False, "values", quantities, first.plain(a.names), culprits(a, b, names, values))


def _turning(side: Side) -> list[str]:
    """The positions of its joints with quaternions."""
    return [name for ball in side.model.balls for name in ball["positions"]]


def _order(a: Side, b: Side, given: Mapping[str, str]) -> list[int]:
    """Of every coordinate of a the number of the one in b."""
    unknown = [*(x for x in given if x not in a.names), *(x for x in given.values() if x not in b.names)]
    matched = _by_last_names(a.names, b.names)
    wanted = [given.get(name, name if name in b.names else matched.get(name, name)) for name in a.names]
    missing = [name for name in wanted if name not in b.names]
    if unknown or missing or len(set(wanted)) < len(wanted):
        message = (
            f"coordinates cannot be matched by name ({listed(unknown or missing)}): a has {listed(a.names)}, b has "
            f"{listed(b.names)}; give 'coordinates', names in a to names in b"
        )
        raise InvalidArgument.at("/coordinates", "unknown-coordinate", message)
    return [b.names.index(name) for name in wanted]


def _by_last_names(ours: Sequence[str], theirs: Sequence[str]) -> dict[str, str]:
    """Coordinates that are called the same but for their instances, where no two of a side are: arm.q1 and q1."""
    last = [Counter(name.rpartition(".")[2] for name in names) for names in (ours, theirs)]
    found = {name.rpartition(".")[2]: name for name in theirs}
    tails = {name: name.rpartition(".")[2] for name in ours}
    return {name: found[tail] for name, tail in tails.items() if last[0][tail] == last[1][tail] == 1}


def _formulas(a: Side, b: Side, matched: Matched) -> dict[str, bool]:
    """For every quantity whether its formulas are the same functions; empty where parameters have other names."""
    graph, order = Graph(), matched.coordinates
    pairs = zip(a.model.positions, matched.positions, strict=True)
    renamed = {b.model.positions[k]: graph.symbol(name) for name, k in pairs}
    for k, name in enumerate(a.model.coordinates):
        for primes in ("'", "''"):
            renamed[b.model.coordinates[order[k]] + primes] = graph.symbol(name + primes)
        renamed[f"tau.{b.model.coordinates[order[k]]}"] = graph.symbol(f"tau.{name}")
    names = [q for q in QUANTITIES if q in a.model.program.outputs and q in b.model.program.outputs]
    if a.parameters.keys() != b.parameters.keys():
        return {}
    renamed |= {b.parameters[name]: graph.symbol(own) for name, own in a.parameters.items()}
    try:
        ours, theirs = (replay(s.model.program, graph, m, names) for s, m in ((a, {}), (b, renamed)))
    except ZeroDivisionError:
        return {}
    return {name: _same(graph, ours[name].entries, theirs[name].entries, order) for name in names}


def _same(graph: Graph, ours: Mapping[Any, Any], theirs: Mapping[Any, Any], order: list[int]) -> bool:
    """Entry by entry, those of b at the places of a; symmetric ones are in either triangle."""
    place = {k: i for i, k in enumerate(order)}
    moved: dict[tuple[int, ...], Any] = {}
    for index, x in theirs.items():
        moved[tuple(sorted(place[i] for i in index))] = x
    here = {tuple(sorted(index)): x for index, x in ours.items()}
    return all(_is_zero(graph, here.get(k, 0), moved.get(k, 0)) for k in {*here, *moved})


def _is_zero(graph: Graph, x: Expr | int, y: Expr | int) -> bool:
    return (graph.lift(x) - graph.lift(y)).is_zero


def _open_parameters(a: Side, b: Side, rng: np.random.Generator) -> dict[str, float]:
    """The same random values for parameters of both sides that have none."""
    missing = [
        {name for name, own in side.parameters.items() if side.model.parameters[own].get("value") is None}
        for side in (a, b)
    ]
    return {name: float(rng.uniform(0.5, 1.5)) for name in sorted(missing[0] & missing[1])}


def _numbers(
    a: Side, b: Side, matched: Matched, values: Mapping[str, float], rng: np.random.Generator
) -> dict[str, tuple[Array, Array, dict[str, Array]]]:
    """Of every quantity both sides at random states, in the order of a, and the states."""
    states = {"q": a.states(rng, STATES), "qd": rng.uniform(-1, 1, (STATES, a.model.dof))}
    names, order, places = list(QUANTITIES), matched.coordinates, map(np.argsort, reversed(matched))
    own = {name: x[:, place] for (name, x), place in zip(states.items(), places, strict=True)}
    # what varies beside the state: the time, and inputs of both sides
    t, shared = rng.uniform(0.5, 1.5, STATES), sorted({*a.model.input_names} & {*b.model.input_names})
    inputs = {name: rng.uniform(-1, 1, STATES) for name in shared if not name.startswith("tau.")}
    ours, theirs = (s.evaluate(names, values, **x, t=t, inputs=inputs) for s, x in ((a, states), (b, own)))
    result, told = {}, {**states, "t": t[:, None]}
    for name in names:
        other = np.asarray(theirs[name], dtype=float)[:, order]
        other = other[:, :, order] if name == "metric" else other
        result[name] = np.asarray(ours[name], dtype=float), other, told
    loops = [s.closures(values, x["q"], t=t, inputs=inputs) for s, x in ((a, states), (b, own))]
    for name, rows in loops[0].items():
        result[name] = rows, loops[1][name][:, :, order] if name == "closure.jacobian" else loops[1][name], told
    return result


@dataclass(frozen=True)
class _Difference:
    """How far the numbers of a quantity are apart, relative to its largest element, and where most."""

    name: str
    error: float
    index: tuple[int, ...]
    a: float
    b: float
    state: dict[str, list[float]]

    @classmethod
    def of(cls, name: str, ours: Array, theirs: Array, states: dict[str, Array], least: float) -> _Difference:
        """Of both sides at some states, relative to ``least`` at least. Raises InvalidInput for what is not finite."""
        if not (np.isfinite(ours).all() and np.isfinite(theirs).all()):
            raise InvalidInput.at("", "not-finite", f"'{name}' is not finite at a random state")
        if not ours.size:
            return cls(name, 0.0, (), 0.0, 0.0, {})
        apart = np.abs(ours - theirs)
        at = tuple(int(i) for i in np.unravel_index(int(apart.argmax()), apart.shape))
        scale = max(float(np.abs(ours).max()), float(np.abs(theirs).max()), least, 1e-12)
        state = {key: [float(x) for x in values[at[0]]] for key, values in states.items()}
        return cls(name, float(apart[at]) / scale, at[1:], float(ours[at]), float(theirs[at]), state)

    def plain(self, names: Sequence[str]) -> dict[str, Any]:
        """As JSON data."""
        is_row = self.name.startswith("closure.")
        index = [f"row {i}" if is_row and not k else names[i] for k, i in enumerate(self.index)]
        return {"quantity": self.name, "index": index, "a": self.a, "b": self.b, "at": self.state}
