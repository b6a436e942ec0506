"""The ranges of coordinates in numbers, straight from the limits of joints in a definition."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.part.definition import Definition
from substructures.part.mass import number_of
from substructures.part.topology import topology

UNITS = ("rad", "m")  #: of a revolute and of a prismatic coordinate


def limits_in_numbers(definition: Definition, names: Mapping[str, Any]) -> dict[str, tuple[Any, Any, str]]:
    """Lowest and highest value, and unit, of coordinates that have limits; those of joints that relations move bound
    the coordinate that moves them. ``names``: values of parameters, numbers or arrays.
    """
    found: dict[str, tuple[Any, Any, str]] = {}
    layout = topology(definition)
    for joint in layout.joints:
        limits = definition.bodies[joint.body].joint.limits
        pair = limits[joint.step] if limits and isinstance(limits[0], tuple) else limits
        low, high = (number_of(x, names) for x in pair or (None, None))
        if low is None or high is None:
            continue
        q, low, high = _of_mover(definition, names, joint.coordinate, low, high)
        known = found.get(q, (-np.inf, np.inf))
        # of all joints that one coordinate moves: each of them stops it
        if joint.coordinate != q or q in found:
            low, high = np.maximum(low, known[0]), np.minimum(high, known[1])
        if np.isfinite(low).any() or np.isfinite(high).any():
            found[q] = low, high, UNITS[layout.joints[layout.movers[layout.coordinates.index(q)]].s]
    return found


def _of_mover(definition: Definition, names: Mapping[str, Any], name: str, low: Any, high: Any) -> tuple[str, Any, Any]:
    """The coordinate that moves a joint, and its range while the joint is between two values."""
    relations = {each.coordinate: each for each in definition.relations}
    while name in relations:
        mu, delta = (number_of(x, names) for x in (relations[name].multiplier, relations[name].offset))
        name = relations[name].of
        if mu is None or delta is None:
            # a factor without a value bounds nothing; the way goes on to the coordinate that moves it
            low, high = -np.inf, np.inf
            continue
        # q = (q^d - delta) / mu, between the smaller and the larger one of the ends; all q where mu is 0
        with np.errstate(all="ignore"):
            ends, moves = [np.true_divide(x - delta, mu) for x in (low, high)], np.not_equal(mu, 0)
        low, high = np.where(moves, np.minimum(*ends), -np.inf)[()], np.where(moves, np.maximum(*ends), np.inf)[()]
    return name, low, high
