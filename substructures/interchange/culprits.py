"""Which body and parameter makes two models different."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.interchange.sides import Carriers, Matched, Side

#: relative differences of numbers that count as equal
SAME = 1e-9
_MOMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_ENTRIES = ("xx", "yy", "zz", "xy", "xz", "yz")


@dataclass(frozen=True)
class Culprit:
    """A number of a body that is not the same; ``body`` as it is called in a (in b where a has none)."""

    body: str
    parameter: str
    a: Any
    b: Any

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {"body": self.body, "parameter": self.parameter, "a": self.a, "b": self.b}


@dataclass(frozen=True)
class _Carried:
    """What a coordinate carries, about the world's origin where all coordinates are zero: m, s, J."""

    name: str
    m: float
    s: Array
    J: Array

    def ten(self) -> Array:
        """m, s and the six moments."""
        return np.array([self.m, *self.s, *(self.J[i] for i in _MOMENTS)])

    def described(self) -> dict[str, float]:
        """Mass, mass centre and inertia tensor about it, in the axes of the world."""
        if not self.m:
            centre, J = np.zeros(3), self.J
        else:
            centre = self.s / self.m
            J = self.J - self.m * np.outer(centre, centre)
        theta = np.trace(J) * np.eye(3) - J
        numbers = {"mass": self.m} | {f"com.{e}": float(x) for e, x in zip("xyz", centre, strict=True)}
        return numbers | {f"inertia.{e}": float(theta[i]) for e, i in zip(_ENTRIES, _MOMENTS, strict=True)}


def culprits(a: Side, b: Side, names: Matched, values: Mapping[str, float]) -> tuple[Culprit, ...]:
    """The first kind of difference that is found: joints, else bodies, else laws of joints. ``names``: of a in b."""
    own = Carriers.of(a, list(range(a.model.dof)), values)
    other = Carriers.of(b, names.coordinates, values)
    found = tuple(_joints(a, own, other))
    if found:
        return found
    masses = _carried(a, own, values), _carried(b, other, values)
    found = tuple(_bodies(a, own, masses, values))
    return found or tuple(_laws(a, b, names, values))


def _joints(a: Side, own: Carriers, other: Carriers) -> Iterator[Culprit]:
    """Screws that are not the same: directions first, places where these agree."""
    for k, name in enumerate(a.names):
        x, y = own.screws[k], other.screws[k]
        scale = max(float(np.abs(x).max(initial=0)), 1.0)
        if np.abs(x - y).max() <= SAME * scale:
            continue
        body = next((f for f, c in own.carrier.items() if c == k), name)
        part = slice(0, 3) if np.abs(x[:3] - y[:3]).max() > SAME else slice(3, 6)
        if part.start and np.abs(x[:3]).max() < SAME:  # a slide: its direction is in v
            yield Culprit(_bare(a, body), "axis", x[3:].tolist(), y[3:].tolist())
        elif part.start:
            # the foot of the axis from the world's origin: omega x v
            yield Culprit(_bare(a, body), "position", np.cross(x[:3], x[3:]).tolist(), np.cross(y[:3], y[3:]).tolist())
        else:
            yield Culprit(_bare(a, body), "axis", x[:3].tolist(), y[:3].tolist())


def _bare(side: Side, frame: str) -> str:
    """The name of a frame, of a single instance without it."""
    return frame.removeprefix(side.single)


def _carried(side: Side, carriers: Carriers, values: Mapping[str, float]) -> dict[int, _Carried]:
    """By coordinate of a: the sum of all links that it carries."""
    Y, n = side.regressor, side.model.dof
    known = {name: x for name, x in side.given(values).items() if name in Y.parameters}
    zero = np.zeros(n)
    pi = np.asarray(Y.evaluate(side.resting, zero, zero, parameters=known)["inertial_parameters"], dtype=float)
    found: dict[int, _Carried] = {}
    for k, link in enumerate(_links(side)):
        c = carriers.carrier[link]
        R, r = carriers.R[link], carriers.r[link]
        m, s, six = pi[10 * k], R @ pi[10 * k + 1 : 10 * k + 4], pi[10 * k + 4 : 10 * k + 10]
        J = np.zeros((3, 3))
        for x, (i, j) in zip(six, _MOMENTS, strict=True):
            J[i, j] = J[j, i] = x
        # about the world's origin: J + s r^T + r s^T + m r r^T
        moved = R @ J @ R.T + np.outer(s, r) + np.outer(r, s) + m * np.outer(r, r)
        before = found.get(c, _Carried(_bare(side, link), 0.0, np.zeros(3), np.zeros((3, 3))))
        found[c] = _Carried(before.name, before.m + m, before.s + s + m * r, before.J + moved)
    return found


def _links(side: Side) -> list[str]:
    """Names of the links of the regressor."""
    return [name.removesuffix(".m") for name in side.regressor.names[::10]]


def _bodies(
    a: Side, own: Carriers, masses: tuple[dict[int, _Carried], dict[int, _Carried]], values: Mapping[str, float]
) -> Iterator[Culprit]:
    """The bodies whose differences are seen in Y: those that are not, alone or in pairs, are left out."""
    nothing = _Carried("", 0.0, np.zeros(3), np.zeros((3, 3)))
    pairs = {k: (masses[0].get(k, nothing), masses[1].get(k, nothing)) for k in {*masses[0], *masses[1]} if k >= 0}
    whole = _effects(a, own, {k: x.ten() for k, (x, _) in pairs.items()}, values)
    scale = max((float(np.abs(x).max(initial=0)) for x in whole.values()), default=0.0)
    for k in _seen(_effects(a, own, {k: x.ten() - y.ten() for k, (x, y) in pairs.items()}, values), SAME * scale):
        x, y = (side.described() for side in pairs[k])
        largest = {
            kind: max(abs(v) for side in (x, y) for n, v in side.items() if n.startswith(kind)) or 1.0
            for kind in ("mass", "com", "inertia")
        }
        for name, value in x.items():
            if abs(value - y[name]) > 1e-8 * largest[name.partition(".")[0]]:
                yield Culprit(pairs[k][0].name or pairs[k][1].name, name, value, y[name])


def _seen(effects: Mapping[int, Array], least: float) -> list[int]:
    """What has an effect of its own, which no other one takes back."""
    left = {k for k, x in effects.items() if np.abs(x).max(initial=0) > least}
    for j, k in combinations(sorted(left), 2):
        if {j, k} <= left and np.abs(effects[j] + effects[k]).max() <= least:
            left -= {j, k}
    return sorted(left)


def _effects(a: Side, own: Carriers, numbers: Mapping[int, Array], values: Mapping[str, float]) -> dict[int, Array]:
    """Y at random motions times ten numbers (about the world's origin at q = 0) for every coordinate's body."""
    Y, n = a.regressor, a.model.dof
    rng = np.random.default_rng(2)
    known = {name: x for name, x in a.given(values).items() if name in Y.parameters}
    q, (qd, qdd) = a.states(rng, 12), rng.uniform(-1, 1, (2, 12, n))
    W = np.asarray(Y.evaluate(q, qd, qdd, parameters=known)["regressor"], dtype=float)
    found: dict[int, Array] = {}
    for k, link in enumerate(_links(a)):
        c = own.carrier[link]
        if c not in numbers or c in found:
            continue
        m, s, J = numbers[c][0], numbers[c][1:4], np.zeros((3, 3))
        for x, (i, j) in zip(numbers[c][4:], _MOMENTS, strict=True):
            J[i, j] = J[j, i] = x
        R, r = own.R[link], own.r[link]
        # into the frame of the link: s - m r, J - s r^T - r s^T + m r r^T, turned back
        local = J - np.outer(s, r) - np.outer(r, s) + m * np.outer(r, r)
        back, first = R.T @ local @ R, R.T @ (s - m * r)
        found[c] = W[:, :, 10 * k : 10 * k + 10] @ np.array([m, *first, *(back[i] for i in _MOMENTS)])
    for c, ten in numbers.items():
        if c not in found:  # a has no body there
            found[c] = np.full((12, n), float(np.abs(ten).max()))
    return found


def _laws(a: Side, b: Side, matched: Matched, values: Mapping[str, float]) -> Iterator[Culprit]:
    """Of coordinates: armature, forces at rest (springs, loads), forces of motion (dampers)."""
    n, order = a.model.dof, matched.coordinates
    place, seats = np.argsort(order), np.argsort(matched.positions)
    rng = np.random.default_rng(3)
    q, qd = a.states(rng, 1), rng.uniform(-1, 1, (1, n))
    names = ["metric", "forces", "gravity"]
    for law, speed in (("armature", 0 * qd), ("stiffness", 0 * qd), ("damping", qd)):
        ours = a.evaluate(names, values, q=q, qd=speed)
        theirs = b.evaluate(names, values, q=q[:, seats], qd=speed[:, place])
        if law == "armature":
            x, y = np.diagonal(ours["metric"][0]), np.diagonal(theirs["metric"][0])[order]
        else:
            x, y = ours["forces"][0], theirs["forces"][0][order]
        scale = max(float(np.abs(x).max(initial=0)), 1e-12)
        for k in range(n):
            if abs(x[k] - y[k]) > SAME * scale:
                yield Culprit(a.names[k], law, float(x[k]), float(y[k]))
        if any(abs(x - y) > SAME * scale):
            return
