"""States with ball joints: how they change along rates and displacements, in balls (notation.md, section 14)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from flint import arb

from substructures.certificate.derived.model_at import ModelAt, total
from substructures.certificate.linear import Ball, cross, quaternion_product, turn_of, vector

#: ``positions`` and ``velocities`` of ball joints
BallRows = Sequence[Mapping[str, Sequence[str]]]


def displacements(m: ModelAt, balls: BallRows) -> list[dict[str, Ball]]:
    """Of each coordinate the change of a state with it alone."""
    return [moved(m, balls, [arb(int(a == b)) for b in range(m.n)]) for a in range(m.n)]


def moved(m: ModelAt, balls: BallRows, rates: Sequence[Ball]) -> dict[str, Ball]:
    """The change of a state at rates: q', of ball joints p' = R v and Q' = 1/2 Q (0, w)."""
    result = dict(zip(m.coordinates, rates, strict=True))
    for ball in balls:
        names, w = ball["positions"], [result.pop(name) for name in ball["velocities"]]
        Q = [m.values[name] for name in names[-4:]]
        half = [x / 2 for x in quaternion_product(Q, (arb(0), *w[-3:]))]
        place = (turn_of(Q) * vector(*w[:3])).entries() if len(names) > len(Q) else []
        result |= dict(zip(names, (*place, *half), strict=True))
    return result


def motion(m: ModelAt, balls: BallRows, second: Sequence[Ball]) -> dict[str, Ball]:
    """The direction of a motion with these accelerations: the change of the state, of rates, and 1 for the time."""
    return m.motion(second) | moved(m, balls, m.rates)


def displacement_rates(m: ModelAt, balls: BallRows) -> list[list[Ball]]:
    """R d of unit displacements d: of ball joints -w x d, of floating ones before it -w x d - v x d_turn."""
    columns = [[arb(0)] * m.n for _ in range(m.n)]
    for ball, (a, column) in product(balls, enumerate(columns)):
        at, unit = [m.coordinates.index(name) for name in ball["velocities"]], [arb(int(a == b)) for b in range(m.n)]
        place, turn = at[:-3], at[-3:]
        w, turned = (vector(*(x[b] for b in turn)) for x in (m.rates, unit))
        changes = (-cross(w, turned)).entries()
        if place:
            v, d = (vector(*(x[b] for b in place)) for x in (m.rates, unit))
            changes = (-cross(w, d) - cross(v, turned)).entries() + changes
        for b, x in zip(at, changes, strict=True):
            column[b] = x
    return columns


def change_of_rates(m: ModelAt, balls: BallRows) -> dict[str, Ball]:
    """Of q', p' = R v and Q' = Q (0, w) / 2 along the symbols ``d.*``, by dR = R [2 Q^-1 dQ]x of the vector part."""
    rates = {name: m.values[f"d.{name}'"] for name in m.coordinates}
    result = moved(m, balls, list(rates.values()))
    for ball in balls:
        names, v = ball["positions"], [m.values[f"{name}'"] for name in ball["velocities"]]
        Q, change = ([m.values[f"{d}{name}"] for name in names[-4:]] for d in ("", "d."))
        half = [x / 2 for x in quaternion_product(change, (arb(0), *v[-3:]))]
        place = names[:-4]
        if place:
            back = [Q[0], *(-x for x in Q[1:])]
            turn = quaternion_product(back, [2 * x / total(y * y for y in Q) for x in change])
            half = [*(turn_of(Q) * cross(vector(*turn[1:]), vector(*v[:3]))).entries(), *half]
        result |= {name: result[name] + x for name, x in zip(names, half, strict=True)}
    return result
