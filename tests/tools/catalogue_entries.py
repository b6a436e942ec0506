"""The shipped entries in tests: each is derived once in a process, and a few stand for all in the default tests.

A store of derived entries that all processes of a run share would not pay: to derive all 48 takes half a second of CPU,
to read and check their programs an eighth of one.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import pytest

from substructures import Definition, Part, catalogue, derive

#: the smallest of each topology (kinds of joints, with or without branches; test_catalogue.py looks that none is
#: missing), and of those whose size or laws matter: six joints in general, springs of a joint, rods, limits
QUICK = (
    *("camera", "simple-pendulum", "four-bar", "ball-pendulum", "cart-pendulum", "drill-spindle", "slider-crank"),
    *("linear-rail", "mobile-base", "parallel-gripper", "stewart-leg", "free-body", "satellite"),
    *("quadruped-trunk-floating", "satellite-wheels"),
    *("furuta-pendulum", "quarter-car", "spherical-wrist", "scara", "flyball-governor", "planar-hopper", "puma560"),
)

#: entries whose joints have coordinates
CHAINS = tuple(name for name in catalogue.names() if "velocities" not in str(catalogue.load(name)["bodies"]))

#: what entries with loops have
CLOSED = ("closures", "independent", "start", "ranges")


def all_entries() -> list[Any]:
    """Values of ``parametrize``: all names, those that are not in QUICK marked ``deep``."""
    deep = (pytest.param(name, marks=pytest.mark.deep) for name in catalogue.names() if name not in QUICK)
    return [*QUICK, *deep]


def open_entry(name: str) -> dict[str, Any]:
    """A shipped entry as plain data without its closures, of whose formulas there are fewer."""
    return {field: x for field, x in catalogue.load(name).items() if field not in CLOSED}


@cache
def shipped_part(name: str) -> Part:
    """A shipped entry with its formulas."""
    return derive(Definition.read(catalogue.load(name)))
