"""Potentials that were found by integration: what their gradient has to be at a state, from the text of the forces.

Such a potential exists for as much of the forces as is a gradient, and is zero where all coordinates are zero: of
forces at rest, without inputs and without the terms of the sum, as it is written, that depend on the time, either all
of those that depend on each other's coordinates, or what each has of its own coordinate alone (notation.md, section 7).
Which of them is decided here by the curl, where the forces are polynomials and trigonometric polynomials. Of other
forces it may not have been found: then what was left out is told.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from substructures.certificate.by_coordinate import along, gathered
from substructures.certificate.expanded import MOST, Expanded, NoExpansionError, expanded
from substructures.certificate.linear import Ball, quaternion_product, turn_of
from substructures.certificate.loads.forces import Forces
from substructures.certificate.numbers import Plain
from substructures.certificate.outputs import Outputs, Values
from substructures.certificate.relations import is_ball, positions_of, rates_of
from substructures.certificate.texts import Steps, depends_on, names_of, slope, summands, value

#: what is not known: no finite value
UNKNOWN = arb("nan")
#: sums of alternatives that are looked at
MANY = 256
#: what may have been taken of a force, and whether something that has a potential is left out then
Choice = tuple[Ball, bool]


@dataclass(frozen=True)
class _Given:
    """The force on one coordinate at rest, and its terms.

    ``form``: the terms that are trigonometric polynomials of the coordinates ``order``, as one; ``exact``: all are.
    """

    terms: list[Steps]
    whole: Ball
    order: list[str]
    form: Expanded
    exact: bool

    def used(self) -> frozenset[str]:
        """The coordinates that it depends on."""
        if not self.exact:
            return frozenset(self.order)
        kept = [key for key, (c, _) in self.form.terms.items() if not c.contains(0)]
        return frozenset(name for i, name in enumerate(self.order) if any(n[i] or k[i] for n, k in kept))

    def own(self, name: str, names: Mapping[str, Ball]) -> Ball:
        """What depends on no coordinate but one, of the terms that are trigonometric polynomials."""
        found, total = self.form.values([names[q] for q in self.order]), arb(0)
        for (n, k), x in found.items():
            if not any(n[i] or k[i] for i, q in enumerate(self.order) if q != name):
                total = total + x
        return total


def is_found(some: Iterable[Forces]) -> bool:
    """Whether potentials may have been found by integration."""
    return any(forces.given or forces.bent for forces in some)


def integrated(forces: Forces) -> set[int]:
    """The joints whose forces may have potentials that were found so."""
    return {*forces.given, *(a for pulls in forces.bent for a in pulls)}


def _at_rest_names(forces: Forces) -> dict[str, Ball]:
    """The names of a definition; velocities and inputs are zero."""
    names, definition = forces.numbers.names, forces.definition
    placed = [name for name, a in forces.coordinates.items() if not forces.bodies.joints[a].group]
    steady = ["t", *placed, *definition.get("parameters", ())]
    moving = [f"{name}'" for name in forces.coordinates] + [f"tau.{name}" for name in forces.coordinates]
    return {name: names[name] for name in steady} | dict.fromkeys([*moving, *definition.get("inputs", ())], arb(0))


def gradient_instead(
    result: Outputs,
    name: str,
    some: Sequence[Forces],
    Q: Mapping[int, Ball],
    start: Ball,
    ways: Mapping[str, Mapping[str, Ball]],
) -> None:
    """In place of the value of a potential its gradient: -``Q`` of what is known in closed form, less alternatives.

    ``start``: the known potentials where all coordinates are zero (and velocities, inputs and the time are halved);
    behind the gradient. ``ways``: of rates of ball joints, how places and quaternions change.
    """
    bodies = some[0].bodies
    left, Q = along(bodies), gathered(bodies, Q)
    values = Values((), along=tuple(bodies.joints[a].coordinate for a in left), ways=ways)
    for i, a in enumerate(left):
        values.entries[i,] = -Q.get(a, arb(0))
    for forces in some:
        for a, choices in ((left.index(k), found) for k, found in alternatives(forces).items()):
            known = values.entries[a,]
            values.entries[a,] = known - choices[0][0]
            values.others[a,] = [(known - choice, leaves_out) for choice, leaves_out in choices[1:]]
    values.entries[len(left),] = start
    # what was found may have no value there
    values.others[len(left),] = []
    result[name] = values


def alternatives(forces: Forces) -> dict[int, list[Choice]]:
    """By joint, the forces -dV/dq^a that a potential may have which was found by integration; the first is likely."""
    found = _of_formulas(forces)
    for pulls in forces.bent:
        for a, pull in pulls.items():
            before = found.get(a, [(arb(0), False)])
            sums = [(x + y, left or out) for y, out in ((pull, False), (arb(0), True)) for x, left in before]
            found[a] = sums if len(sums) <= MANY else [*sums[:MANY], (UNKNOWN, False)]
    return found


def _of_formulas(forces: Forces) -> dict[int, list[Choice]]:
    names = _at_rest_names(forces)
    given = {a: _at_rest(forces, a, names) for a in forces.given}
    found: dict[int, list[Choice]] = {}
    for group in _groups(forces, given):
        some = [given[a] for a in group if a in given]
        exact = all(x.exact for x in some)
        # d_b F_a = d_a F_b where one of them depends on the other's coordinate
        curl = (
            _slope(given, a, _local(forces, b), names) - _slope(given, b, _local(forces, a), names)
            for a in group
            for b in _needed(forces, given, a)
        )
        is_gradient = all(x.contains(0) for x in curl)
        for a in group:
            if a in given:
                found[a] = _choices(given[a], _local(forces, a), names, exact, is_gradient)
    return found


def _choices(force: _Given, name: str, names: Mapping[str, Ball], exact: bool, is_gradient: bool) -> list[Choice]:
    """What may have been taken of a force; of one that is no trigonometric polynomial that is not known."""
    own = force.own(name, names)
    if exact:
        return [(force.whole if is_gradient else own, False)]
    some: list[Choice] = [(force.whole, False)] if is_gradient else []
    return [*some, (arb(0), is_gradient), (own, is_gradient), (own if force.exact else UNKNOWN, False)]


def _local(forces: Forces, a: int) -> str:
    return forces.bodies.joints[a].coordinate.rpartition(".")[2]


def _at_rest(forces: Forces, a: int, names: Mapping[str, Ball]) -> _Given:
    """What is left of the force on a joint."""
    kept: list[Steps] = []
    whole, exact = arb(0), True
    for term in (t for steps in forces.given[a] for t in summands(steps, "t")):
        if depends_on(term, names, "t"):
            continue
        here = value(term, names)
        exact &= here.is_finite()
        if here.is_finite():
            kept.append(term)
            whole = whole + here
    order = sorted(frozenset().union(*map(names_of, kept)) & forces.coordinates.keys())
    form = Expanded(len(order), {})
    for term in kept:
        try:
            form = form + expanded(term, names, order)
        except (NoExpansionError, ZeroDivisionError):
            exact = False
    return _Given(kept, whole, order, form, exact and len(form.terms) <= MOST)


def _slope(given: Mapping[int, _Given], a: int, along: str, names: Mapping[str, Ball]) -> Ball:
    return sum((slope(term, names, along) for term in given[a].terms), arb(0)) if a in given else arb(0)


def _needed(forces: Forces, given: Mapping[int, _Given], a: int) -> set[int]:
    """The joints on whose coordinates the force on a joint depends."""
    return {forces.coordinates[name] for name in given[a].used()} if a in given else set()


def _groups(forces: Forces, given: Mapping[int, _Given]) -> list[list[int]]:
    """Joints whose forces depend on each other's coordinates; those on which none acts, too."""
    groups: list[set[int]] = []
    for a in given:
        joined = {a} | _needed(forces, given, a)
        apart = [group for group in groups if not group & joined]
        groups = [*apart, joined.union(*(group for group in groups if group & joined))]
    return [sorted(group) for group in groups]


def ways_of(bodies: Iterable[Plain], values: Mapping[str, Ball], prefix: str = "") -> dict[str, dict[str, Ball]]:
    """By rate of ball and floating joints the changes of place and quaternion for 1: p' = R v, Q' = 1/2 Q (0, w)."""
    result: dict[str, dict[str, Ball]] = {}
    zero, half = arb(0), arb("0.5")
    for body in filter(is_ball, bodies):
        names, rates = [prefix + name for name in positions_of(body)], [prefix + name for name in rates_of(body)]
        quaternion = [values[name] for name in names[-4:]]
        R = turn_of(quaternion)
        for k in range(3):
            if len(names) > len(quaternion):
                result[rates[k]] = {names[i]: R[i, k] for i in range(3)}
            e = (zero, *(half if i == k else zero for i in range(3)))
            result[rates[k - 3]] = dict(zip(names[-4:], quaternion_product(quaternion, e), strict=True))
    return result
