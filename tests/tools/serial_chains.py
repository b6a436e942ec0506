"""Chains of revolute joints by rows of the modified Denavit-Hartenberg convention, with sources."""

from __future__ import annotations

import re

from random_trees import Plain

from substructures import Definition

#: rows of the modified Denavit-Hartenberg convention: W. Khalil and E. Dombre, Modeling, Identification and Control of
#: Robots, 2002 (Staubli RX90); KUKA iiwa with a spherical shoulder and wrist; M. Schappler, serroblib, S6RRRRRR10
HALF = ("pi/2", "-pi/2")
RX90 = [{}, {"theta": HALF[0]}, {"d": "d3"}, {"theta": HALF[1], "tau": "r4"}, {"theta": HALF[0]}, {"theta": HALF[1]}]
IIWA = [{}, {"theta": HALF[1]}, {"theta": HALF[0], "tau": "r3"}, {"theta": HALF[0]}]
IIWA += [{"theta": HALF[1], "tau": "r5"}, {"theta": HALF[1]}, {"theta": HALF[0]}]
SIX14: list[Plain] = [{"tau": "d1"}, *({"theta": f"al{i}", "d": f"a{i}", "tau": f"d{i}"} for i in (2, 3, 4))]
SIX14 += [{"theta": "pi/2", "d": f"a{i}", "tau": f"d{i}"} for i in (5, 6)]
SIX: list[Plain] = [{"theta": f"al{i}", "d": f"a{i}", "tau": f"d{i}", "phi": f"ph{i}"} for i in range(1, 7)]


def revolute(rows: list[Plain]) -> Definition:
    """A chain with ten parameters of inertia for every body."""
    names = {x for row in rows for x in row.values() if re.fullmatch(r"[a-z]+\d", x)}
    bodies = []
    for k, row in enumerate(rows):
        com, tensor = [f"c{x}{k}" for x in "xyz"], {x: f"I{x}{k}" for x in ("xx", "yy", "zz", "xy", "xz", "yz")}
        names |= {f"m{k}", *com, *tensor.values()}
        body = {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": {"type": "revolute", **row}}
        bodies.append(body | {"mass": f"m{k}", "com": com, "inertia": tensor | {"about": "origin"}})
    return Definition.read({"name": "chain", "parameters": {x: {} for x in sorted(names)}, "bodies": bodies})
