"""What acts along the axes of a <joint> of an SDF file: their limits, springs, dampers and rotors."""

from __future__ import annotations

from decimal import Decimal

from substructures.interchange.merge import ordered_limits
from substructures.interchange.numbers import ZERO, Number, decimal_of, is_zero, number_of, value
from substructures.interchange.report import Report
from substructures.interchange.xml import Node

_LAWS = {"damping": "damping", "rest": "spring_reference", "stiffness": "spring_stiffness"}
#: of limits, what is none
_NONE = Decimal("1e16")
_INFINITE = ("inf", "infinity")


def laws_of(axis: Node, joint: Node, report: Report) -> dict[str, Number]:
    """Of a motion; its dry friction is told."""
    laws: dict[str, Number] = {"armature": _armature(axis, joint, report)}
    dynamics = axis.one("dynamics")
    if dynamics is None:
        return laws
    if value(number(dynamics, "friction")):
        message = "dry friction is not read: add a load of the type 'friction', with a velocity, for it"
        report.lost(dynamics.place, message)
    return laws | {ours: number(dynamics, theirs) for ours, theirs in _LAWS.items()}


def tell_of_laws(joint: Node, what: str, report: Report) -> None:
    """Of a joint that has no coordinates along its axes: a ball, a gearbox, one that closes a loop."""
    for axis in joint.all("axis", "axis2"):
        told = Report()
        laws, limits = laws_of(axis, joint, told), limits_of(axis, "", told)
        if told.remarks or limits or not all(is_zero(laws.get(x, ZERO)) for x in ("damping", "stiffness")):
            message = f"damping, springs, friction and limits of {what} are not read: add loads for them"
            report.lost(axis.place, message)


def _armature(axis: Node, joint: Node, report: Report) -> Number:
    """Of a rotor behind gears, n^2 I, as Drake has it."""
    holder = axis if axis.one("rotor_inertia") is not None else joint
    inertia, ratio = (value(number(holder, tag, x)) for tag, x in (("rotor_inertia", "0"), ("gear_ratio", "1")))
    if inertia:
        report.merged(holder.place, f"the rotor inertia {inertia:g} by {ratio:g} squared is an armature")
    return decimal_of(ratio**2 * inertia)


def limits_of(axis: Node, kind: str, report: Report) -> tuple[Number, Number] | None:
    """Both ends, where there are two."""
    limit = axis.one("limit")
    if limit is None or kind == "continuous":
        return None
    low, high = _end(limit, "lower", -_NONE), _end(limit, "upper", _NONE)
    if low <= -_NONE and high >= _NONE:
        return None
    if low <= -_NONE or high >= _NONE:
        report.warning(limit.place, "one limit alone is left out: give both, lower and upper")
        return None
    return ordered_limits(limit.place, low, high, report)


def _end(limit: Node, tag: str, none: Decimal) -> Decimal:
    found = limit.one(tag)
    text = "" if found is None else found.text.strip().lower()
    if found is None or text.lstrip("+-") in _INFINITE:
        return -_NONE if text.startswith("-") else _NONE if text else none
    return number_of(text, found.place, tag)


def number(node: Node, tag: str, default: str = "0") -> Decimal:
    """What a child says, or the default of the format."""
    found = node.one(tag)
    return number_of(default if found is None else found.text, node.place if found is None else found.place, tag)
