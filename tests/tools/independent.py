"""What the numbers of a definition mean, computed without the package (except where kinematics are handed in)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import ast
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.quantities.numbers.result import Evaluation

Plain = dict[str, Any]
Array = Any

OPERATORS: dict[type[ast.AST], Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
}
FUNCTIONS = {"sin": np.sin, "cos": np.cos, "tan": np.tan, "sqrt": np.sqrt}


def value(given: Any, names: Mapping[str, Any] | None = None) -> Any:
    """A number or an expression, by a walk over Python's syntax tree; velocities q' are looked up as q_dot."""
    if not isinstance(given, str):
        return float(given)
    known = {"pi": np.pi, **(names or {})}

    def walk(node: Any) -> Any:
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                return OPERATORS[type(op)](walk(left), walk(right))
            case ast.UnaryOp(op=op, operand=operand):
                return OPERATORS[type(op)](walk(operand))
            case ast.Call(func=ast.Name(id=function), args=[argument]):
                return FUNCTIONS[function](walk(argument))
            case ast.Name(id=name):
                return known[name]
        return float(node.value)

    return walk(ast.parse(given.replace("^", "**").replace("'", "_dot"), mode="eval").body)


def values(given: Any, names: Mapping[str, Any] | None = None) -> Array:
    """The same for lists; the batch of states comes first."""
    return np.stack(np.broadcast_arrays(*(np.asarray(value(x, names)) for x in given)), axis=-1)


def defaults(definition: Plain) -> dict[str, float]:
    """The default values of its parameters."""
    return {name: float(value(given["value"])) for name, given in definition["parameters"].items()}


def inertia_of(body: Plain) -> tuple[float, Array, Array]:
    """Mass, mass centre, inertia tensor about the mass centre."""
    m, c, given = float(body.get("mass", 0)), values(body.get("com", [0, 0, 0])), body.get("inertia", {})
    xx, yy, zz, xy, xz, yz = (float(given.get(e, 0)) for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
    theta = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if given.get("about") == "origin":
        theta = theta - m * (c @ c * np.eye(3) - np.outer(c, c))
    return m, c, theta


@dataclass
class Moving:
    """Kinematics of all frames (evaluated) with access by body name; velocities follow from U and Omega."""

    answer: Evaluation
    qd: Array

    def _at(self, body: str) -> tuple[Array, Array, Array, Array]:
        k = self.answer["kinematics"]
        names = [name.split(".")[1] for name in self.answer.frames or ()]
        f = names.index(body)
        return k["position"][:, f], k["rotation"][:, f], k["U"][:, f], k["Omega"][:, f]

    def point(self, body: str, at: Array) -> tuple[Array, Array]:
        """Position of a point of a body, and its partial velocities (N, n, 3), in the world."""
        r, R, U, Omega = self._at(body)
        u = U + np.cross(Omega, np.broadcast_to(at, (*U.shape[:2], 3)))
        return r + R @ at, np.einsum("nij,naj->nai", R, u)

    def turning(self, body: str) -> tuple[Array, Array]:
        """Rotation body -> world and partial angular velocities in the world."""
        _, R, _, Omega = self._at(body)
        return R, np.einsum("nij,naj->nai", R, Omega)


def kinetic_energy(definition: Plain, moving: Moving, rotors: Array) -> Array:
    """Sum over bodies of m v^2/2 + omega . Theta omega/2, and rotors."""
    T = 0.5 * np.einsum("a,na->n", rotors, moving.qd**2)
    for body in definition["bodies"]:
        m, c, theta = inertia_of(body)
        _, u = moving.point(body["name"], c)
        R, w = moving.turning(body["name"])
        v = np.einsum("nai,na->ni", u, moving.qd)
        omega = np.einsum("nai,na,nij->nj", w, moving.qd, R)
        T += 0.5 * m * (v**2).sum(axis=1) + 0.5 * np.einsum("ni,ij,nj->n", omega, theta, omega)
    return T


def by_coordinate(definition: Plain, law: str, coordinates: list[str]) -> Array:
    """Stiffness, rest, damping or armature in the order of the coordinates."""
    found = dict.fromkeys(coordinates, 0.0)
    for body in definition["bodies"]:
        names, given = body["joint"].get("coordinate", []), body["joint"].get(law, 0)
        names = [names] if isinstance(names, str) else names
        found |= {c: float(given[j] if isinstance(given, list) else given) for j, c in enumerate(names)}
    return np.array([found[c] for c in coordinates])


def gravity_energy(definition: Plain, moving: Moving, gravity: Array) -> Array:
    """-sum m g . x."""
    parts = [(inertia_of(b), b["name"]) for b in definition["bodies"]]
    return -sum(m * moving.point(name, c)[0] @ np.asarray(gravity) for (m, c, _), name in parts)


def springs_energy(definition: Plain, moving: Moving, q: Array, coordinates: list[str]) -> Array:
    """k (l - l0)^2/2 of the point-to-point springs, k (q - rest)^2/2 of the joints."""
    stiffness, rest = (by_coordinate(definition, law, coordinates) for law in ("stiffness", "rest"))
    V = 0.5 * ((q - rest) ** 2) @ stiffness
    for load in definition["loads"]:
        if load["type"] == "spring":
            (x, _), (y, _) = (moving.point(load[e]["body"], values(load[e]["at"])) for e in ("from", "to"))
            V = V + 0.5 * load["stiffness"] * (np.linalg.norm(y - x, axis=1) - load.get("length", 0)) ** 2
    return V


def dissipative_forces(definition: Plain, moving: Moving, coordinates: list[str]) -> Array:
    """-damping q', and dampers between points: -(c l') dl/dq."""
    Q = -by_coordinate(definition, "damping", coordinates) * moving.qd
    for load in definition["loads"]:
        if load["type"] == "spring":
            (x, u), (y, w) = (moving.point(load[e]["body"], values(load[e]["at"])) for e in ("from", "to"))
            e = (y - x) / np.linalg.norm(y - x, axis=1)[:, None]
            dl = np.einsum("ni,nai->na", e, w - u)
            Q = Q - load.get("damping", 0) * np.einsum("nb,nb->n", dl, moving.qd)[:, None] * dl
    return Q


def applied_forces(definition: Plain, moving: Moving, coordinates: list[str], names: Plain) -> Array:
    """Forces, torques and joint forces, by virtual power."""
    Q = np.zeros_like(moving.qd)
    for load in definition["loads"]:
        if load["type"] == "joint":
            Q[:, coordinates.index(load["coordinate"])] += value(load["force"], names)
        elif load["type"] in ("force", "torque"):
            R, w = moving.turning(load["body"])
            f = np.broadcast_to(values(load["vector"], names), (len(Q), 3))
            f = np.einsum("nij,nj->ni", R, f) if load["frame"] == "body" else f
            columns = w if load["type"] == "torque" else moving.point(load["body"], values(load["at"]))[1]
            Q += np.einsum("nai,ni->na", columns, f)
    return Q


def conservative_loads(definition: Plain, moving: Moving, q: Array, coordinates: list[str]) -> tuple[Array, Array]:
    """V and Q of the random loads that have a potential: constant forces in the world and constant joint forces, and
    -q^2 on q itself, V = q^3/3. What depends on velocities, inputs, the time or another coordinate has none.
    """
    V, Q = np.zeros(len(q)), np.zeros_like(q)
    for load in definition["loads"]:
        if load["type"] == "joint":
            a, force = coordinates.index(load["coordinate"]), load["force"]
            c = force if isinstance(force, float) else 0.0
            k = 1.0 if isinstance(force, str) and force.endswith(f"- {load['coordinate']}^2") else 0.0
            V = V - c * q[:, a] + k * q[:, a] ** 3 / 3
            Q[:, a] += c - k * q[:, a] ** 2
        elif (
            load["type"] == "force" and load["frame"] == "world" and not any(isinstance(x, str) for x in load["vector"])
        ):
            x, u = moving.point(load["body"], values(load["at"]))
            if np.abs(u).max(initial=0):
                V = V - x @ np.array(load["vector"])
                Q = Q + u @ np.array(load["vector"])
    return V, Q
