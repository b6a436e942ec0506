"""Lagrange's equations of a definition from poses alone, by exact derivatives of polynomials, without the package.

Everything comes from the words of the contract: frames of joint rows and placements, energies, virtual power.
"""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from independent import value as read
from pinocchio_trees import CHAINS

from .jets import Jet, gradient, slopes, values

Plain = dict[str, Any]
Array = Any


def turn(axis: Any, angle: Any) -> Array:
    """Rotation matrix about a unit vector (Rodrigues)."""
    x, y, z = (float(e) for e in axis)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    s, c = np.sin(angle), np.cos(angle)
    return np.array(
        [[(i == j) + K[i, j] * s + (K @ K)[i, j] * (1 - c) for j in range(3)] for i in range(3)], dtype=object
    )


def cross(a: Any, b: Any) -> Array:
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], dtype=object)


@dataclass
class Dynamics:
    """g (n, n), Gamma (n, n, n), Q (n,), V, and poses R, r of all bodies by name; elements may be polynomials."""

    g: Array
    gamma: Array
    Q: Array
    V: Any
    poses: dict[str, tuple[Array, Array]]
    qd: Array

    @property
    def bias(self) -> Array:
        return np.array([self.qd @ G @ self.qd for G in self.gamma], dtype=object)

    @property
    def force(self) -> Array:
        """Q - Gamma q' q'."""
        return self.Q - self.bias

    def acceleration(self) -> Array:
        """q'' in numbers."""
        return np.linalg.solve(values(self.g), values(self.force))


@dataclass
class Mechanism:
    """A definition with coordinates in the order of the first variables of the polynomials, without instance names."""

    definition: Plain
    coordinates: Sequence[str]
    gravity: Any

    def poses(self, names: Mapping[str, Any]) -> dict[str, tuple[Array, Array]]:
        """Rotation to the world and origin of every body, also ``base``."""
        found = {"base": (np.eye(3, dtype=object), np.zeros(3, dtype=object))}
        waiting = list(self.definition["bodies"])
        while waiting:
            body = waiting.pop(0)
            if body["parent"] in found:
                found[body["name"]] = self._placed(*found[body["parent"]], body["joint"], names)
            else:
                waiting.append(body)
        return found

    def _placed(self, R: Array, r: Array, joint: Plain, names: Mapping[str, Any]) -> tuple[Array, Array]:
        X, Y, Z = np.eye(3)

        def number(key: str) -> Any:
            return read(joint.get(key, 0), names)

        if "placement" in joint:
            place = joint["placement"]
            r = r + R @ np.array([read(x, names) for x in place.get("position", [0, 0, 0])], dtype=object)
            roll, pitch, yaw = (read(x, names) for x in place.get("rpy", [0, 0, 0]))
            R = R @ turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll)
        else:
            # Rz(psi) Tz(sigma) Rx(theta) Tx(d)
            r = r + R @ (Z * number("sigma"))
            R = R @ turn(Z, number("psi")) @ turn(X, number("theta"))
            r = r + R @ (X * number("d"))
        given = joint.get("coordinate", [])
        moving = [given] if isinstance(given, str) else list(given)
        # offsets of the joint row, then what moves
        axis = np.array([read(x, names) for x in joint["axis"]], dtype=float) if "axis" in joint else Z
        axis = axis / np.linalg.norm(axis)
        r = r + R @ (axis * number("tau"))
        R = R @ turn(axis, number("phi"))
        for (kind, letter), name in zip(CHAINS[joint["type"]], moving, strict=True):
            along = axis if len(moving) == 1 else np.eye(3)["xyz".index(letter)]
            if kind == "P":
                r = r + R @ (along * names[name])
            else:
                R = R @ turn(along, names[name])
        return R, r

    def dynamics(self, q: Sequence[Any], qd: Sequence[Any], names: Mapping[str, Any]) -> Dynamics:
        """``q``: the first variables of polynomials, of degree 2 or more; ``names``: t, inputs, parameters."""
        n = len(self.coordinates)
        known = dict(names) | dict(zip(self.coordinates, q, strict=True))
        known |= {f"{c}_dot": x for c, x in zip(self.coordinates, qd, strict=True)}
        poses = self.poses(known)
        g = np.diag(np.array([self._law("armature", c, known) for c in self.coordinates], dtype=object))
        V: Any = 0.0
        for body in self.definition["bodies"]:
            m, c, theta = self._inertia(body, known)
            R, r = poses[body["name"]]
            centre = r + R @ c
            u = [slopes(centre, a) for a in range(n)]
            w = [angular(R, a) for a in range(n)]
            L = [R @ (theta @ (R.T @ x)) for x in w]
            g = g + np.array([[m * (u[a] @ u[b]) + w[a] @ L[b] for b in range(n)] for a in range(n)], dtype=object)
            V = V - m * (np.asarray(self.gravity, dtype=float) @ centre)
        dg = [slopes(g, c) for c in range(n)]
        gamma = np.array(
            [[[(dg[b][a, c] + dg[c][a, b] - dg[a][b, c]) / 2 for c in range(n)] for b in range(n)] for a in range(n)],
            dtype=object,
        )
        V = V + self._springs(q, poses, known)
        Q = np.array([-_slope(V, a) for a in range(n)], dtype=object) + self._applied(np.array(qd), poses, known)
        return Dynamics(g, gamma, Q, V + self._found(q, poses, known), poses, np.array(qd, dtype=object))

    def _inertia(self, body: Plain, names: Mapping[str, Any]) -> tuple[Any, Array, Array]:
        """Mass, mass centre, inertia tensor about it."""
        m = read(body.get("mass", 0), names)
        c = np.array([read(x, names) for x in body.get("com", [0, 0, 0])], dtype=object)
        given = body.get("inertia", {})
        xx, yy, zz, xy, xz, yz = (read(given.get(e, 0), names) for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
        theta = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=object)
        if given.get("about") == "origin":
            theta = theta - m * ((c @ c) * np.eye(3) - np.outer(c, c))
        return m, c, theta

    def _law(self, law: str, coordinate: str, names: Mapping[str, Any]) -> Any:
        for body in self.definition["bodies"]:
            given = body["joint"].get("coordinate", [])
            some = [given] if isinstance(given, str) else given
            if coordinate in some and law in body["joint"]:
                x = body["joint"][law]
                return read(x[some.index(coordinate)] if isinstance(x, list) else x, names)
        return 0.0

    def _springs(self, q: Sequence[Any], poses: Plain, names: Mapping[str, Any]) -> Any:
        V: Any = 0.0
        for x, c in zip(q, self.coordinates, strict=True):
            V = V + self._law("stiffness", c, names) * (x - self._law("rest", c, names)) ** 2 / 2
        for load in self.definition.get("loads", []):
            if load["type"] == "spring":
                d = self._spring(load, poses, names)
                V = V + read(load["stiffness"], names) * (np.sqrt(d @ d) - read(load.get("length", 0), names)) ** 2 / 2
        return V

    def _found(self, q: Sequence[Any], poses: Plain, names: Mapping[str, Any]) -> Any:
        """V of the loads that have one, by hand: constant ones, and -x^2 beside a damper on the coordinate x itself."""
        V: Any = 0.0
        for load in self.definition.get("loads", []):
            in_world = load["type"] == "force" and load.get("frame", "body") == "world"
            if in_world and all(map(_is_constant, load["vector"])):
                where = self._point(load["body"], load.get("at", [0, 0, 0]), poses, names)
                V = V - where @ np.array([read(x, names) for x in load["vector"]], dtype=object)
            elif load["type"] == "joint":
                c = load["coordinate"]
                x = q[list(self.coordinates).index(c)]
                if _is_constant(load["force"]):
                    V = V - read(load["force"], names) * x
                elif str(load["force"]).endswith(f"{c}' - {c}^2"):
                    V = V + x * x * x / 3
        return V

    def _spring(self, load: Plain, poses: Plain, names: Mapping[str, Any]) -> Array:
        start, end = (self._point(load[e]["body"], load[e]["at"], poses, names) for e in ("from", "to"))
        return end - start

    def _point(self, body: str, at: Any, poses: Plain, names: Mapping[str, Any]) -> Array:
        R, r = poses[body]
        return r + R @ np.array([read(x, names) for x in at], dtype=object)

    def _applied(self, qd: Array, poses: Plain, names: Mapping[str, Any]) -> Array:
        """Dampers and loads by virtual power; actuators are inputs ``tau.<coordinate>``."""
        n = len(self.coordinates)
        pairs = zip(self.coordinates, qd, strict=True)
        Q = np.array([names.get(f"tau.{c}", 0.0) - self._law("damping", c, names) * v for c, v in pairs], dtype=object)
        for load in self.definition.get("loads", []):
            if load["type"] == "joint":
                Q[list(self.coordinates).index(load["coordinate"])] += read(load["force"], names)
            elif load["type"] == "spring":
                d = self._spring(load, poses, names)
                length = np.sqrt(d @ d)
                dl = [_slope(length, a) for a in range(n)]
                rate = sum(x * v for x, v in zip(dl, qd, strict=True))
                Q = Q - np.array([read(load.get("damping", 0), names) * rate * x for x in dl], dtype=object)
            else:
                R, _ = poses[load["body"]]
                f = np.array([read(x, names) for x in load["vector"]], dtype=object)
                f = R @ f if load.get("frame", "body") == "body" else f
                where = self._point(load["body"], load.get("at", [0, 0, 0]), poses, names)
                columns = [angular(R, a) if load["type"] == "torque" else slopes(where, a) for a in range(n)]
                Q = Q + np.array([u @ f for u in columns], dtype=object)
        return Q


def angular(R: Array, a: int) -> Array:
    """Partial angular velocity in the world: the axial vector of dR/dq_a R^T."""
    W = slopes(R, a) @ R.T
    return np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]], dtype=object) / 2


def _slope(x: Any, a: int) -> Any:
    return x.slope(a) if isinstance(x, Jet) else 0.0


def riemann(d: Dynamics) -> Array:
    """R_abcd from its definition by R^a_bcd = d_c Gamma^a_bd - d_d Gamma^a_bc + ..., in numbers."""
    n = len(d.g)
    g, first, inverse = values(d.g), values(d.gamma), np.linalg.inv(values(d.g))
    # Gamma^a_bc = g^ae Gamma_ebc, d_f g^ae = -g^ax d_f g_xy g^ye
    dg, dfirst = gradient(d.g, range(n)), gradient(d.gamma, range(n))
    second = np.einsum("ae,ebc->abc", inverse, first)
    dinverse = -np.einsum("ax,xyf,ye->aef", inverse, dg, inverse)
    dsecond = np.einsum("aef,ebc->abcf", dinverse, first) + np.einsum("ae,ebcf->abcf", inverse, dfirst)
    R = np.einsum("abdc->abcd", dsecond) - np.einsum("abcd->abcd", dsecond)
    R = R + np.einsum("ace,ebd->abcd", second, second) - np.einsum("ade,ebc->abcd", second, second)
    return np.einsum("ax,xbcd->abcd", g, R)


def _is_constant(given: Any) -> bool:
    """A number: none of the names of coordinates, inputs and time that random loads have."""
    return not isinstance(given, str) or not re.search(r"[qut]", given)
