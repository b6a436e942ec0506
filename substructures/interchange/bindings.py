"""Coordinates that are bound to others, q = k q_of + c: mimic joints (URDF, SDF), equality joints of MJCF.

Within a part they are relations of its definition: the joint that follows has no coordinate. Between two parts both
coordinates are free, and the binding comes along as a velocity constraint q' - k q_of' = 0; the positions have to meet
it at the start.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from decimal import Decimal
from fractions import Fraction
from math import isclose
from operator import add, mul, sub, truediv

from substructures.errors import meant
from substructures.interchange.numbers import Number
from substructures.interchange.report import Place, Report
from substructures.interchange.robot import Link, Mimic
from substructures.part.mass import number_of

#: a rational number, or a constant expression with pi as text
Exact = Fraction | str
_SIGNS = {"+": add, "-": sub, "*": mul, "/": truediv}
_SAME = 1e-12  #: how well numbers of several bindings have to agree
_AGAIN = "those before it say the same"
_HELD = "with those before it this holds joints at numbers, and is left out: add a prescribed motion for it"


def joints_of(links: Collection[Link]) -> dict[str, bool]:
    """The joints of a file, and whether they have one coordinate each."""
    compound = {link.joint: False for link in links if link.joint}
    return compound | {m.name: m.type in ("revolute", "prismatic") for link in links for m in link.motions}


def mimic_of(
    joint: str, of: str, factors: tuple[Number, Number], place: Place, joints: Mapping[str, bool], report: Report
) -> list[Mimic]:
    """A binding by multiplier and offset, told of; none, with a warning, but between two joints of one coordinate."""
    for each in (joint, of):
        if each not in joints:
            message = f"'{joint[:60]}' stays free: there is no joint '{each[:60]}'{meant(each, joints)}"
            report.lost(place, message, "topology")
            return []
    if joint == of or not (joints[joint] and joints[of]):
        message = f"'{joint[:60]}' is bound to '{of[:60]}', which are not two joints of one coordinate: it stays free"
        report.lost(place, message, "topology")
        return []
    return [Mimic(joint, of, *factors, place)]


def relations_of(
    mimics: Collection[Mimic], names: Mapping[str, str], report: Report
) -> tuple[list[dict[str, object]], list[Mimic]]:
    """Bindings as relations of a definition, and those to joints of other parts, told of; ``names``: its coordinates by
    joints.

    A joint that follows another already is let lead the one that it is bound to, if that is free, or else what it
    follows is bound to what the other one follows.
    """
    before: dict[str, tuple[str, Exact, Exact]] = {}
    found: list[dict[str, object]] = []
    left: list[Mimic] = []
    for mimic in mimics:
        if not {mimic.joint, mimic.of} <= names.keys():
            report.warning(mimic.place, mimic.message, "topology")
            left.append(mimic)
            continue
        bound = _bound(mimic, before)
        if isinstance(bound, str):
            tell = report.merged if bound == _AGAIN else report.lost
            tell(
                mimic.place, f"'{mimic.joint[:60]}' = {mimic.multiplier} * '{mimic.of[:60]}' + {mimic.offset}: {bound}"
            )
            continue
        follower, leader, k, c = bound
        before[follower] = leader, k, c
        report.merged(mimic.place, f"a relation: '{follower[:60]}' moves with '{leader[:60]}' and has no coordinate")
        is_own = (follower, leader) == (mimic.joint, mimic.of)
        factors = (mimic.multiplier, mimic.offset) if is_own else (_number(k), _number(c))
        relation = dict(zip(("multiplier", "offset"), factors, strict=True))
        found.append({"coordinate": names[follower], "of": names[leader], **relation})
    return found, left


def _bound(mimic: Mimic, before: Mapping[str, tuple[str, Exact, Exact]]) -> tuple[str, str, Exact, Exact] | str:
    """q = k q_of + c of a joint that follows none; or why there is none. ``before``: the same of those that do."""
    k, c = _exact(mimic.multiplier), _exact(mimic.offset)
    (a, mu_a, delta_a), (b, mu_b, delta_b) = (_lead(before, joint) for joint in (mimic.joint, mimic.of))
    # mu_a q_a + delta_a = k (mu_b q_b + delta_b) + c
    rest, mu_b = _combined("-", _combined("+", _combined("*", k, delta_b), c), delta_a), _combined("*", k, mu_b)
    if a == b:
        return _AGAIN if isclose(_float(mu_a), _float(mu_b), rel_tol=_SAME) and abs(_float(rest)) < _SAME else _HELD
    if a == mimic.joint:
        return a, mimic.of, k, c
    if b == mimic.of and _float(k):
        return b, mimic.joint, _combined("/", Fraction(1), k), _combined("/", _combined("-", Fraction(0), c), k)
    if _float(mu_a):
        return a, b, _combined("/", mu_b, mu_a), _combined("/", rest, mu_a)
    if _float(mu_b):
        return b, a, _combined("/", mu_a, mu_b), _combined("/", _combined("-", Fraction(0), rest), mu_b)
    return _HELD


def _lead(before: Mapping[str, tuple[str, Exact, Exact]], joint: str) -> tuple[str, Exact, Exact]:
    """The joint that leads one in the end, and q = mu q_lead + delta."""
    mu: Exact = Fraction(1)
    delta: Exact = Fraction(0)
    while joint in before:
        joint, k, c = before[joint]
        mu, delta = _combined("*", mu, k), _combined("+", _combined("*", mu, c), delta)
    return joint, mu, delta


def _combined(sign: str, x: Exact, y: Exact) -> Exact:
    """The sum, difference, product or quotient."""
    if isinstance(x, str) or isinstance(y, str):
        return f"({x}){sign}({y})"
    return _SIGNS[sign](x, y)


def _exact(x: Number) -> Exact:
    return Fraction(x) if isinstance(x, Decimal) else x


def _float(x: Exact) -> float:
    return float(number_of(x, {})) if isinstance(x, str) else float(x)


def _number(x: Exact) -> Number:
    """A decimal where it has few digits, else a quotient or another expression."""
    if isinstance(x, str):
        return x
    found = Decimal(x.numerator) / x.denominator
    return found if Fraction(found) == x else str(x)
