"""Potentials that were found by integration: what their gradient may be at a state, from the text of the forces alone.

Such a potential is fixed up to a constant, and exists for as much of the forces as is a gradient: of forces at rest,
without inputs and without terms in the time, either all of those that depend on each other's coordinates, or what each
has of its own coordinate alone (notation.md, section 7). Which of them is decided here by the curl, where the forces
are polynomials and trigonometric polynomials; where they are not, each of them is right. Right is also nothing: parts
that were derived before potentials were looked for have none.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from flint import arb, fmpq

from substructures.certificate.expanded import MOST, NoExpansionError, expanded
from substructures.certificate.linear import Ball
from substructures.certificate.loads import Forces
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs, Values
from substructures.certificate.texts import Steps, names_of, slope, summands, value

#: what is not known: no finite value
UNKNOWN = arb("nan")
HALF = arb(fmpq(1, 2))
#: terms beside those in the time, and sums of alternatives, that are looked at
FEW, MANY = 8, 256


@dataclass(frozen=True)
class _Given:
    """The force on one coordinate at rest: the terms that are not zero for sure.

    ``cut``: whether terms depend on the time, or have no value; ``whole``: without these; ``own``: the terms of its own
    coordinate alone, None where the force is no trigonometric polynomial; ``atoms``: all terms without the time.
    """

    terms: list[Steps]
    cut: bool
    whole: Ball
    own: Ball | None
    atoms: list[Ball] | None


def is_found(some: Iterable[Forces]) -> bool:
    """Whether potentials may have been found by integration."""
    return any(forces.given or forces.bent for forces in some)


def halved(forces: Forces) -> Numbers:
    """Half the velocities, inputs and time."""
    return Numbers(_scaled(forces, HALF, HALF))


def _scaled(forces: Forces, share: Ball, share_of_time: Ball) -> dict[str, Ball]:
    """The names of a definition; velocities and inputs, and the time, are multiplied by these."""
    names, definition = forces.numbers.names, forces.definition
    steady = [*forces.coordinates, *definition.get("parameters", ())]
    moving = [f"{name}'" for name in forces.coordinates] + [f"tau.{name}" for name in forces.coordinates]
    moving += definition.get("inputs", ())
    found = {name: names[name] for name in steady} | {name: names[name] * share for name in moving}
    return found | {"t": names["t"] * share_of_time}


def gradient_instead(result: Outputs, name: str, some: Sequence[Forces], Q: Mapping[int, Ball], change: Ball) -> None:
    """In place of the value of a potential its gradient: -``Q`` of what is known in closed form, less alternatives.

    ``change``: of the known potentials when velocities, inputs and the time are halved; it stands behind the gradient.
    """
    joints = some[0].bodies.joints
    values = Values((), along=tuple(joint.coordinate for joint in joints))
    for a in range(len(joints)):
        values.entries[a,] = -Q.get(a, arb(0))
    for forces in some:
        for a, choices in alternatives(forces).items():
            known = values.entries[a,]
            values.entries[a,] = known - choices[0]
            values.others[a,] = [known - choice for choice in choices[1:]]
    if not any(forces.varying for forces in some):
        values.entries[len(joints),] = change
    result[name] = values


def alternatives(forces: Forces) -> dict[int, list[Ball]]:
    """By joint, the forces -dV/dq^a that a potential may have which was found by integration; the first is likely."""
    found = _of_formulas(forces)
    for pulls in forces.bent:
        for a, pull in pulls.items():
            sums = [x + y for x in found.get(a, [arb(0)]) for y in (pull, arb(0))]
            found[a] = sums if len(sums) <= MANY else [*sums[:MANY], UNKNOWN]
    return found


def _of_formulas(forces: Forces) -> dict[int, list[Ball]]:
    names = _scaled(forces, arb(0), arb(1))
    given = {a: _at_rest(forces, a, names) for a in forces.given}
    found: dict[int, list[Ball]] = {}
    for group in _groups(forces, given):
        some = [given[a] for a in group if a in given]
        exact = all(x.own is not None and not x.cut for x in some)
        # d_b F_a = d_a F_b where one of them depends on the other's coordinate
        curl = (
            _slope(given, a, _local(forces, b), names) - _slope(given, b, _local(forces, a), names)
            for a in group
            for b in _named(forces, given, a)
        )
        is_gradient = all(x.contains(0) for x in curl)
        for a in group:
            if a in given:
                found[a] = _choices(given[a], exact, is_gradient)
    return found


def _choices(force: _Given, exact: bool, is_gradient: bool) -> list[Ball]:
    """What may have been taken of a force."""
    if exact:
        return [force.whole if is_gradient else force.own, arb(0)]
    if not force.cut:
        return [force.whole, arb(0), UNKNOWN if force.own is None else force.own]
    if force.atoms is None or len(force.atoms) > FEW:
        return [force.whole, arb(0), UNKNOWN]
    # the terms that depend on the time took others with them, as far as a factor is common to them
    sizes = range(len(force.atoms), -1, -1)
    return [force.whole, *(sum(chosen, arb(0)) for n in sizes for chosen in combinations(force.atoms, n))]


def _local(forces: Forces, a: int) -> str:
    return forces.bodies.joints[a].coordinate.rpartition(".")[2]


def _at_rest(forces: Forces, a: int, names: Mapping[str, Ball]) -> _Given:
    """What is left of the force on a joint."""
    kept: list[Steps] = []
    cut, whole = False, arb(0)
    atoms: list[Ball] | None = []
    for term in (t for steps in forces.given[a] for t in summands(steps)):
        here = value(term, names)
        varies = "t" in names_of(term) and not slope(term, names, "t").contains(0)
        cut |= varies or "t" in names_of(term) or not here.is_finite()
        if not varies and here.is_finite():
            kept.append(term)
            whole = whole + here
        some = _atoms(forces, term, names)
        atoms = None if atoms is None or some is None else atoms + some
    return _Given(kept, cut, whole, _own(forces, a, kept, names), atoms)


def _atoms(forces: Forces, term: Steps, names: Mapping[str, Ball]) -> list[Ball] | None:
    """The terms of an expanded term that do not depend on the time; None where it is no trigonometric polynomial."""
    order = [*sorted(names_of(term) & forces.coordinates.keys()), "t"]
    try:
        values = expanded(term, names, order).values([names[name] for name in order])
    except ZeroDivisionError:
        return []
    except NoExpansionError:
        return None
    return [x for (n, k), x in values.items() if not n[-1] and not k[-1]]


def _own(forces: Forces, a: int, terms: Sequence[Steps], names: Mapping[str, Ball]) -> Ball | None:
    """What of a force depends on its own coordinate alone; None where it is no trigonometric polynomial."""
    own, total, count = _local(forces, a), arb(0), 0
    for term in terms:
        order = [own, *sorted(names_of(term) & forces.coordinates.keys() - {own})]
        try:
            values = expanded(term, names, order).values([names[name] for name in order])
        except (NoExpansionError, ZeroDivisionError):
            return None
        count += len(values)
        for (n, k), x in values.items():
            if not any(n[1:]) and not any(k[1:]):
                total = total + x
    return total if count <= MOST else None


def _slope(given: Mapping[int, _Given], a: int, along: str, names: Mapping[str, Ball]) -> Ball:
    return sum((slope(term, names, along) for term in given[a].terms), arb(0)) if a in given else arb(0)


def _named(forces: Forces, given: Mapping[int, _Given], a: int) -> set[int]:
    """The joints whose coordinates the force on a joint names."""
    named = (names_of(term) for term in given[a].terms) if a in given else ()
    return {forces.coordinates[name] for names in named for name in names & forces.coordinates.keys()}


def _groups(forces: Forces, given: Mapping[int, _Given]) -> list[list[int]]:
    """Joints whose forces depend on each other's coordinates; those on which none acts, too."""
    groups: list[set[int]] = []
    for a in given:
        joined = {a} | _named(forces, given, a)
        apart = [group for group in groups if not group & joined]
        groups = [*apart, joined.union(*(group for group in groups if group & joined))]
    return [sorted(group) for group in groups]
