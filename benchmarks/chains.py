"""Chains of revolute joints with symbolic constants, whole or cut into parts: what the benchmarks measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures import Definition, TreeSpec

TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")

#: rows of the 6R arm with 14 free kinematic parameters a2..a6, alpha2..alpha4, d1..d6 (modified Denavit-Hartenberg);
#: its published generated code: M. Schappler, serroblib, S6RRRRRR10 (metric 672 additions + 983 multiplications)
ROWS_14: list[dict[str, Any]] = [
    {"tau": "d1"},
    *({"theta": f"alpha{i}", "d": f"a{i}", "tau": f"d{i}"} for i in (2, 3, 4)),
    *({"theta": "pi/2", "d": f"a{i}", "tau": f"d{i}"} for i in (5, 6)),
]


def general_rows(n: int) -> list[dict[str, Any]]:
    """Every constant of every joint symbolic: alpha, a, d and an offset of the angle."""
    return [{"theta": f"alpha{i}", "d": f"a{i}", "tau": f"d{i}", "phi": f"phi{i}"} for i in range(1, n + 1)]


def chain(name: str, rows: list[dict[str, Any]], first: int = 1, loads: Sequence[Mapping[str, Any]] = ()) -> Definition:
    """Bodies link1, link2, ... with symbolic mass, mass centre and inertia tensor, and a port ``tip`` on the last."""
    bodies = []
    parameters: set[str] = {"g"}
    for i, row in enumerate(rows, first):
        com = [f"c{x}{i}" for x in "xyz"]
        tensor = {e: f"I{e}{i}" for e in TENSOR}
        parameters |= {f"m{i}", *com, *tensor.values(), *(v for v in row.values() if v != "pi/2")}
        parent = f"link{i - 1}" if i > first else "base"
        joint = {"type": "revolute", "coordinate": f"q{i}", **row}
        bodies.append(
            {"name": f"link{i}", "parent": parent, "joint": joint, "mass": f"m{i}", "com": com, "inertia": tensor}
        )
    port = {"name": "tip", "body": bodies[-1]["name"]}
    document = {"name": name, "parameters": {p: {} for p in sorted(parameters)}, "bodies": bodies, "ports": [port]}
    return Definition.read(document | {"loads": list(loads)})


def pieces(rows: list[dict[str, Any]], sizes: list[int]) -> list[Definition]:
    """The chain cut into parts of the given sizes."""
    parts, start = [], 0
    for size in sizes:
        parts.append(chain(f"part{start}", rows[start : start + size], start + 1))
        start += size
    return parts


def row_of(parts: list[Definition]) -> TreeSpec:
    """The parts mounted on each other's tips, gravity along -z."""
    instances = [
        {"name": f"p{i}", "substructure": part.name, "at": "world" if i == 0 else f"p{i - 1}.tip"}
        for i, part in enumerate(parts)
    ]
    return TreeSpec.read(
        {"name": "row", "gravity": [0, 0, "-g"], "parameters": {"g": {"value": "9.81"}}, "instances": instances}
    )
