"""Random closures and velocity constraints, and the rows of the latter from poses, without the package."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from independent import value as read
from random_trees import Plain

from substructures.analysis.simulate import KnifeEdge, Linear, Rolling

from .compared import Case, angular_columns, frame
from .jets import slopes, space, value
from .plain_mechanics import Dynamics, cross

Array = Any
KINDS = (["ball"], ["rod"], ["rod", "rod"], ["planar"], ["universal"], ["pin"], ["slider"])


def random_closures(rng: Any, bodies: Sequence[str]) -> list[Plain]:
    """One or two, between the last bodies and the world or the first body, with placements."""
    found = []
    for k, kind in enumerate(KINDS[rng.integers(len(KINDS))]):
        place = {"position": numbers(rng, 0.4), "rpy": numbers(rng, 1)}
        closure: Plain = {"name": f"c{k}", "type": kind, "from": f"x.{bodies[-1 - k]}", "placement": place}
        closure["to"] = str(rng.choice(["world", f"x.{bodies[0]}"]))
        found.append(closure | ({"length": 0.8} if kind == "rod" else {}))
    return found


def numbers(rng: Any, size: float) -> list[float]:
    return [float(x) for x in np.round(rng.uniform(-size, size, 3), 3)]


SHAPES = ("1", "cos({})", "(2 + sin({}))", "({}/3 - 1)", "{}^2")


def random_linear(rng: Any, case: Case, shapes: Sequence[str] = SHAPES) -> str:
    """Linear in all velocities."""
    names = case.coordinates
    terms = (str(rng.choice(shapes)).format(rng.choice(names)) for _ in names)
    return " + ".join(f"{rng.uniform(0.5, 2):.2f}*{x}*{name}'" for x, name in zip(terms, names, strict=True))


def random_velocities(rng: Any, case: Case, count: int) -> dict[str, str]:
    return {f"v{i}": random_linear(rng, case, SHAPES[:3]) for i in range(count)}


def random_constraints(rng: Any, case: Case, kind: int) -> list[Any]:
    """By kind: one or two linear ones, an edge, a disc on the floor, a sphere on a slope; fewer for few coordinates."""
    definition = case.plain.definition
    ports = [p["name"] for p in definition["ports"] if p["body"] != "base"]
    last = definition["bodies"][-1]["name"]
    if kind == 2:
        return [KnifeEdge("edge", f"x.{rng.choice([last, *ports])}")]
    if kind > 2 and case.n > 4:
        more: Plain = {"normal": (0, 0, 1)} if kind == 3 else {"normal": (0.6, 0, 0.8), "shape": "sphere"}
        return [Rolling("roll", f"x.{last}", 0.25, **more)]
    return [Linear(f"l{k}", random_linear(rng, case)) for k in range(2 if kind and case.n > 3 else 1)]


def constraint_rows(case: Case, d: Dynamics, constraints: Sequence[Any]) -> tuple[Array, Any]:
    """B (m, n), and the gap of a rolling body; three rows of one that rolls, in the axes of the world."""
    rows: list[Array] = []
    gap = None
    for c in constraints:
        if isinstance(c, Linear):
            rows.append(_linear(case, c.expression))
            continue
        R, r = frame(case, d.poses, c.frame)
        u, w = [slopes(r, a) for a in range(case.n)], angular_columns(R, case.n)
        if isinstance(c, KnifeEdge):
            rows.append(np.array([R.T[1] @ x for x in u], dtype=object))
            continue
        normal = np.array(c.normal, dtype=float) / np.linalg.norm(np.array(c.normal, dtype=float))
        rho = -float(c.radius) * normal.astype(object)
        if c.shape == "disc":
            # the lowest point of the rim: down, less what is along the axis
            down = (normal @ R[:, 2]) * R[:, 2] - normal
            across = down @ down
            if value(across) < 1e-3:
                raise ValueError("the disc lies flat")
            rho = float(c.radius) * down / np.sqrt(across)
        columns = [x + cross(y, rho) for x, y in zip(u, w, strict=True)]
        rows += [np.array([x[i] for x in columns], dtype=object) for i in range(3)]
        gap = normal @ (r + rho)
    return np.array(rows, dtype=object), gap


def _linear(case: Case, text: str) -> Array:
    names = case.names | dict(zip(case.plain.coordinates, space(case.n, 3).variables(case.q), strict=True))
    units = ({f"{c}_dot": float(c == k) for c in case.plain.coordinates} for k in case.plain.coordinates)
    return np.array([read(text.replace("x.", ""), names | unit) for unit in units], dtype=object)
