"""Serial chains whose operation counts are published, or are not, by rows of the notation (notation.md, section 2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from benchmarks.chains import TENSOR
from substructures import Definition

Row = dict[str, Any]
UP, DOWN = {"theta": "pi/2"}, {"theta": "-pi/2"}


def _general(n: int) -> list[Row]:
    return [{"theta": f"al{i}", "d": f"a{i}", "tau": f"d{i}", "phi": f"ph{i}"} for i in range(1, n + 1)]


#: every body with ten independent parameters of inertia, gravity along -z but for planar chains (-y)
CHAINS: dict[str, list[Row]] = {
    # W. Khalil, E. Dombre, Modeling, Identification and Control of Robots, 2002: Staubli RX90
    "rx90": [{}, UP, {"d": "D3"}, DOWN | {"tau": "RL4"}, UP, DOWN],
    # Staubli TX90: offsets d2 and r3 beside those of RX90
    "tx90": [{}, DOWN | {"d": "d2"}, {"d": "d3", "tau": "r3"}, UP | {"tau": "r4"}, DOWN, UP],
    # Stanford arm
    "stanford": [{}, DOWN | {"tau": "r2"}, UP | {"type": "prismatic"}, {}, DOWN, UP],
    # Puma 560 with numbers
    "puma560": [
        {},
        DOWN | {"tau": "0.2435"},
        {"d": "0.4318", "tau": "-0.0934"},
        UP | {"d": "-0.0203", "tau": "0.4331"},
        DOWN,
        UP,
    ],
    # seven revolute joints with a spherical shoulder and wrist (KUKA LBR iiwa)
    "iiwa": [{}, DOWN, UP | {"tau": "r3"}, UP, DOWN | {"tau": "r5"}, DOWN, UP],
    # with inertias in any place
    "rrpr": [{}, {"d": "l1"}, {"type": "prismatic", "d": "l2"}, {}],
    "planar4": [{}, *({"d": f"l{i}"} for i in range(1, 4))],
    "planar8": [{}, *({"d": f"l{i}"} for i in range(1, 8))],
    # the same with mass centres on the link axes
    "planar4x": [{}, *({"d": f"l{i}"} for i in range(1, 4))],
    "planar8x": [{}, *({"d": f"l{i}"} for i in range(1, 8))],
    # M. Schappler, serroblib, S6RRRRRR10
    "6r14": [
        {"tau": "d1"},
        *({"theta": f"alpha{i}", "d": f"a{i}", "tau": f"d{i}"} for i in (2, 3, 4)),
        *(UP | {"d": f"a{i}", "tau": f"d{i}"} for i in (5, 6)),
    ],
    "6r": _general(6),
    "7r": _general(7),
}


@dataclass(frozen=True)
class Published:
    """A figure of others: additions and multiplications of formulas that they made or print."""

    chain: str
    quantity: str
    operations: int
    source: str


PUBLISHED = (
    Published(
        "6r14",
        "metric",
        1655,
        "M. Schappler, serroblib, S6RRRRRR10: generated code, 983 multiplications and 672 additions",
    ),
    Published("rx90", "inverse_dynamics_base", 513, "SYMORO: recursion with base parameters, in all"),
    Published(
        "rx90", "inverse_dynamics_base", 491, "W. Khalil, E. Dombre, 2002: recursion with base parameters, per state"
    ),
    Published(
        "puma560",
        "inverse_dynamics_abbreviated_1pct",
        305,
        "B. Armstrong, O. Khatib, J. Burdick, ICRA 1986: numbers, terms below 1 % of others left out, by inspection",
    ),
)


#: operations per state that no choice of frames removes, with base parameters
LOWER_ESTIMATES = {
    ("rx90", "metric"): 190,
    ("rx90", "metric_christoffel"): 450,
    ("iiwa", "metric"): 260,
    ("iiwa", "metric_christoffel"): 900,
    ("6r14", "metric"): 480,
    ("6r14", "metric_christoffel"): 1100,
    ("6r", "metric"): 600,
    ("6r", "metric_christoffel"): 1400,
}


def definition(name: str) -> Definition:
    """A chain as a document."""
    bodies, used = [], set[str]()
    for i, row in enumerate(CHAINS[name], 1):
        com: list[Any] = (
            [f"cx{i}", 0, 0] if name.endswith("x") and name.startswith("planar") else [f"c{x}{i}" for x in "xyz"]
        )
        tensor = {e: f"I{e}{i}" for e in TENSOR}
        joint = {"type": "revolute", "coordinate": f"q{i}", **row}
        used |= {f"m{i}", *(x for x in com if x), *tensor.values()}
        used |= {x for key, x in row.items() if key != "type" and x.isalnum() and not x[0].isdigit()}
        body = {"name": f"b{i}", "parent": f"b{i - 1}" if i > 1 else "base", "joint": joint}
        bodies.append(body | {"mass": f"m{i}", "com": com, "inertia": tensor | {"about": "origin"}})
    return Definition.read({"name": name, "parameters": {p: {} for p in sorted(used)}, "bodies": bodies})


def gravity(name: str) -> list[Any]:
    """Acceleration in the world."""
    return [0, "-g", 0] if name.startswith("planar") else [0, 0, "-g"]
