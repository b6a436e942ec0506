"""Springs: ``1/2*k*(q - l)^2`` for its three terms, and ``k*(s - l)/s`` for ``k - k*l/s`` where ``s`` is a root.

Both are looked for among the terms of a sum: a square in what is multiplied by the same stiffness, and what is divided
by a length among what is not. Only terms that are there are used, so that nothing is added and taken away again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from substructures.textbook.atoms import MOVING, Atoms, Monomial, Polynomial, multiplied, times
from substructures.textbook.harmonics import Harmonics, Mode

#: terms of a sum in which springs are looked for, and of what is taken from a coordinate
MOST, LONGEST = 60, 4
#: monomial of all atoms -> harmonics of the angles
Content = Mapping[Monomial, Harmonics]


class Square(NamedTuple):
    """number * stiffness * (x - rest)^2 for a product x."""

    number: Fraction
    stiffness: Monomial
    x: Monomial
    rest: Polynomial


class Stretch(NamedTuple):
    """force * (s - length)/s for an atom s."""

    force: Content
    s: int
    length: tuple[Monomial, Fraction]


def squares(found: Content, atoms: Atoms) -> tuple[list[Square], Content]:
    """The squares among the terms without cosines and sines, and all that is left."""
    plain = {m: next(iter(h.values()))[0] for m, h in found.items() if len(h) == 1 and not any(next(iter(h)))}
    result, left = completed(plain, _squared(plain, atoms), atoms.roots) if len(plain) <= MOST else ([], plain)
    zero = next((k for h in found.values() for k in h if not any(k)), ())
    others = {m: h for m, h in found.items() if m not in plain}
    return result, others | {m: {zero: (c, Fraction(0))} for m, c in left.items()}


def completed(
    plain: Polynomial, places: Iterable[tuple[int, Monomial]], roots: Mapping[int, Polynomial]
) -> tuple[list[Square], Polynomial]:
    """The squares among terms, and what is left: (a*x - b)^2 for a^2*x^2 - 2*a*b*x + b^2.

    ``places``: x, and what x^2 may be multiplied with; ``roots``: what the squares of some atoms are.
    """
    left, result = plain, list[Square]()
    for x, stiffness in sorted(places):
        c = _factor(left, stiffness, roots.get(x, {((x, 2),): Fraction(1)}))
        one = times(stiffness, ((x, 1),))
        linear = {times(m, one, -1): v for m, v in left.items() if (x, 1) in m}
        rest = {m: -v / (2 * c) for m, v in linear.items() if c and _divides(m, stiffness)}
        if not 0 < len(rest) <= LONGEST:
            continue
        scale = _below(rest)
        inner = {times(m, scale): v for m, v in rest.items()}
        square = Square(c, times(stiffness, scale, -2), times(((x, 1),), scale), inner)
        new = _without(left, _spread(square, roots))
        if new is not None:
            left = new
            result.append(square)
    # no 2*x^2 for the 3/2*x^2 that a square has, with 1/2*x^2 beside it
    is_whole = all(
        (left.get(m, 0) / c).denominator == 1 for square in result for m, c in _spread(square, roots).items()
    )
    return (result, left) if is_whole else ([], plain)


def _below(rest: Iterable[Monomial]) -> Monomial:
    """The least product that makes all of them products of positive powers."""
    powers: dict[int, int] = {}
    for i, n in (item for monomial in rest for item in monomial):
        powers[i] = max(powers.get(i, 0), -n)
    return tuple(sorted((i, n) for i, n in powers.items() if n))


def _squared(plain: Polynomial, atoms: Atoms) -> set[tuple[int, Monomial]]:
    """Coordinates and lengths whose squares may occur, and the constants that these are multiplied with."""
    found = set[tuple[int, Monomial]]()
    for monomial in plain:
        for x, n in monomial:
            is_place = not atoms.is_rate(atoms.exprs[x]) or bool(atoms.exprs[x].args)
            if atoms.ranks[x] != MOVING or not is_place:
                continue
            others = tuple(item for item in monomial if item[0] != x and atoms.ranks[item[0]] != MOVING)
            if n == 2 and len(others) + 1 == len(monomial):
                found.add((x, others))
            elif n == 1 and x in atoms.roots:
                found |= {(x, (item,)) for item in others if item[1] == 1}
    return found


def _factor(left: Polynomial, stiffness: Monomial, square: Polynomial) -> Fraction:
    """What a square is multiplied by, by its last term, which moves."""
    last = max(square)
    return left.get(times(stiffness, last), Fraction(0)) / square[last]


def _divides(monomial: Monomial, stiffness: Monomial) -> bool:
    """Whether all powers are positive, but for those whose squares the stiffness has."""
    powers = dict(stiffness)
    return all(n > 0 or powers.get(i, 0) >= -2 * n for i, n in monomial)


def _spread(square: Square, roots: Mapping[int, Polynomial]) -> Polynomial:
    """The terms of a square."""
    inner: dict[Monomial, Fraction] = {square.x: Fraction(1)} | {m: -v for m, v in square.rest.items()}
    result: dict[Monomial, Fraction] = {}
    for monomial, v in multiplied(multiplied(inner, inner), {square.stiffness: square.number}).items():
        found = [i for i, n in monomial if n == 2 and i in roots]
        terms: Polynomial = {tuple(item for item in monomial if item[0] not in found): v}
        for i in found:
            terms = multiplied(terms, roots[i])
        for m, w in terms.items():
            result[m] = result.get(m, Fraction(0)) + w
    return result


def _without(left: Polynomial, some: Polynomial) -> dict[Monomial, Fraction] | None:
    """What is left of terms without some of them; None where these are not there as a whole."""
    if not all(_holds(left.get(m, Fraction(0)), v) for m, v in some.items()):
        return None
    result = {m: v - some.get(m, 0) for m, v in left.items()}
    return {m: v for m, v in result.items() if v}


def _holds(value: Fraction, part: Fraction) -> bool:
    """Whether a number is a part of another one, with the same sign."""
    return not part or (value * part > 0 and abs(value) >= abs(part))


def stretches(found: Content, atoms: Atoms) -> tuple[list[Stretch], Content]:
    """What is multiplied by 1 - length/s for roots s, and all that is left."""
    result, left = list[Stretch](), dict(found)
    below = {i for m in found for i, n in m if n == -1 and atoms.exprs[i].op == "sqrt" and atoms.ranks[i] == MOVING}
    for s in sorted(below) if len(found) <= MOST else ():
        above = {times(m, ((s, 1),)): h for m, h in left.items() if (s, -1) in m}
        others = {m: h for m, h in left.items() if (s, -1) not in m}
        ways = [way for length in _lengths(above, others, atoms) if (way := _stretch(above, others, s, length))]
        if ways:
            stretch, left = min(ways, key=lambda way: len(way[1]))
            result.append(stretch)
    return result, left


def _stretch(
    above: Content, others: Content, s: int, length: tuple[Monomial, Fraction]
) -> tuple[Stretch, dict[Monomial, Harmonics]] | None:
    """A stretch, and what is left of the others; None where it is not there, or a multiple of a parameter."""
    unit, number = length
    force = {times(m, unit, -1): _over(h, -number) for m, h in above.items()}
    left = _less(others, force)
    if left is None or (unit and number != 1 and len(left) > len(others) - len(force)):
        return None
    return Stretch(force, s, length), left


def _lengths(above: Content, others: Content, atoms: Atoms) -> Iterator[tuple[Monomial, Fraction]]:
    """What above may be divided by, with a minus, to be among the others: a number of a parameter, or a number."""
    shared = set.intersection(*({item for item in m if item[1] == 1} for m in above)) if above else set()
    for unit in [*(((i, 1),) for i, _ in sorted(shared) if atoms.ranks[i] != MOVING), ()]:
        ratios = set[Fraction]()
        for m, h in above.items():
            there = others.get(times(m, unit, -1), {})
            ratios |= {-x / y for k in h if k in there for x, y in zip(h[k], there[k], strict=True) if x and y}
        yield from ((unit, n) for n in sorted(ratios, reverse=True) if n > 0)


def _over(harmonics: Harmonics, number: Fraction) -> dict[Mode, tuple[Fraction, Fraction]]:
    return {k: (a / number, b / number) for k, (a, b) in harmonics.items()}


def _less(others: Content, force: Content) -> dict[Monomial, Harmonics] | None:
    """What is left of the others without the force; None where that is not there as a whole."""
    result: dict[Monomial, Harmonics] = dict(others)
    for m, h in force.items():
        here = dict(result.get(m, {}))
        for k, (a, b) in h.items():
            x, y = here.get(k, (Fraction(0), Fraction(0)))
            if not (_holds(x, a) and _holds(y, b)):
                return None
            here[k] = x - a, y - b
        result[m] = {k: both for k, both in here.items() if any(both)}
    return {m: h for m, h in result.items() if h}
