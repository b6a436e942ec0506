"""Random loads of trees of every type, and what they do by hand: Jacobians of frames of an independent engine."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from independent import value, values
from pinocchio_trees import Engine, engine_of
from random_trees import GRAVITY, Kind, Plain, number, random_definition, vector

Array = Any
NAMES = ("a", "b")
KINDS = ("spring", "bushing", "force", "torque", "joint", "potential", "cable")


def two_definitions(rng: np.random.Generator) -> dict[str, Plain]:
    """Two mechanisms that move, with one port at least."""
    found: dict[str, Plain] = {}
    for name in NAMES:
        while name not in found or not any(b["joint"]["type"] != "fixed" for b in found[name]["bodies"]):
            kind = Kind(int(rng.integers(1, 5)), bool(rng.integers(2)), loads=0, springs=0, depth=5, laws=False)
            found[name] = random_definition(rng, kind, name)
    return found


def frames_of(name: str, definition: Plain) -> list[str]:
    return [f"{name}.{x['name']}" for x in (*definition["bodies"], *definition["ports"])]


def random_tree(rng: np.random.Generator, definitions: dict[str, Plain], count: int = 7) -> Plain:
    """Both instances, on the world or on each other, with one load of every type and some more."""
    hosts = [x for x in frames_of("a", definitions["a"]) if "port" not in x]
    at = str(rng.choice(hosts)) if rng.random() < 0.5 else "world"
    placement = {"position": [1.5, number(rng), number(rng)], "rpy": vector(rng, 2)}
    instances = [{"name": "a", "definition": definitions["a"]}]
    instances.append({"name": "b", "definition": definitions["b"], "at": at, "placement": placement})
    loads = [random_load(rng, definitions, KINDS[k % len(KINDS)], f"l{k}") for k in range(count)]
    return {
        "name": "tree", "gravity": list(GRAVITY), "parameters": {"k": {"value": 1.7}}, "inputs": {"u": {}},
        "instances": instances, "loads": loads,
    }  # fmt: skip


def random_load(rng: np.random.Generator, definitions: dict[str, Plain], kind: str, name: str) -> Plain:
    start, end = (str(rng.choice(frames_of(n, definitions[n]))) for n in rng.permutation(NAMES))
    if rng.random() < 0.2:
        start = "world"
    q = str(rng.choice(coordinates_of(definitions)))
    terms = [
        number(rng),
        "k",
        "2*u - t",
        f"sin({q})*{q}'",
        f"distance({start}, {end})",
        f"0.3*distance'({start}, {end})",
    ]
    some = [terms[i] for i in rng.integers(0, len(terms), 3)]
    ends: Plain = {"name": name, "type": kind, "from": start, "to": end}
    if kind == "spring":
        points = {"from_at": [number(rng, 1, 2), number(rng), number(rng)], "to_at": vector(rng)}
        return {**ends, **points, "stiffness": "2*k", "damping": number(rng, 0, 1), "length": number(rng, 0, 1)}
    if kind == "bushing":
        fields = ("stiffness", "damping", "angular_stiffness", "angular_damping")
        return ends | {field: [abs(x) for x in vector(rng, 2)] for field in fields}
    if kind == "cable":
        middle = str(rng.choice([f"{n}.base" for n in NAMES]))
        points = [
            start,
            {"frame": middle, "at": [number(rng, 1, 2), number(rng), 0]},
            {"frame": end, "at": vector(rng)},
        ]
        law = {"stiffness": "2*k", "damping": number(rng, 0, 1), "length": number(rng, 0, 1)}
        return {"name": name, "type": kind, "along": points, **law}
    if kind in ("force", "torque"):
        axes = str(rng.choice(["to", "from", "world"]))
        return {**ends, "vector": some, "axes": axes} | ({"at": vector(rng)} if kind == "force" else {})
    if kind == "joint":
        return {"name": name, "type": kind, "coordinate": q, "force": f"{some[0]} - 0.2*{q}"}
    V = f"k*(distance({start}, {end}) - 0.4)^2*(1 + 0.2*sin({q})) + u*{q}^2"
    return {"name": name, "type": kind, "potential": V}


def coordinates_of(definitions: dict[str, Plain]) -> list[str]:
    found = []
    for name in NAMES:
        for body in definitions[name]["bodies"]:
            given = body["joint"].get("coordinate", [])
            found += [f"{name}.{q}" for q in ([given] if isinstance(given, str) else given)]
    return found


def one_definition(tree: Plain) -> Plain:
    """The tree as one mechanism, with names a_b1, a_q1, ...; the engine knows nothing of parts."""
    bodies: list[Plain] = []
    ports: list[Plain] = []
    for instance in tree["instances"]:
        name, at = instance["name"], instance.get("at", "world")
        seat = {"type": "fixed", "placement": instance.get("placement", {"position": [0, 0, 0], "rpy": [0, 0, 0]})}
        parent = "base" if at == "world" else at.replace(".", "_")
        bodies.append({"name": f"{name}_base", "parent": parent, "joint": seat})
        for body in instance["definition"]["bodies"]:
            joint = dict(body["joint"])
            if "coordinate" in joint:
                given = joint["coordinate"]
                joint["coordinate"] = [f"{name}_{q}" for q in ([given] if isinstance(given, str) else given)]
            names = {"name": f"{name}_{body['name']}", "parent": f"{name}_{body['parent']}"}
            bodies.append({**body, **names, "joint": joint})
        ports += [
            {**port, "name": f"{name}_{port['name']}", "body": f"{name}_{port['body']}"}
            for port in instance["definition"]["ports"]
        ]
    return {"name": "whole", "bodies": bodies, "ports": ports}


class ByHand:
    """The tree in Pinocchio at one state; ``names``: values of parameters, inputs and the time."""

    def __init__(self, tree: Plain, coordinates: list[str], q: Array, qd: Array, names: Plain) -> None:
        self.engine: Engine = engine_of(one_definition(tree), tree["gravity"])
        self.order = [self.engine.index[c.replace(".", "_")] for c in coordinates]
        self.coordinates, self.given, self.qd, self.n = coordinates, names, qd, len(coordinates)
        self.names = {**names, **{c: q[i] for i, c in enumerate(coordinates)}}
        self.names |= {f"{c}'": qd[i] for i, c in enumerate(coordinates)}
        self.q, self.v = np.zeros(self.n), np.zeros(self.n)
        self.q[self.order], self.v[self.order] = q, qd
        self.data = self.engine.model.createData()
        pin.computeJointJacobians(self.engine.model, self.data, self.q)

    def frame(self, at: str) -> tuple[Array, Array, Array]:
        """Rotation to the world, origin, and the Jacobian (6, n) at the world's origin in its axes."""
        if at == "world":
            return np.eye(3), np.zeros(3), np.zeros((6, self.n))
        joint, where = self.engine.frames[at.replace(".", "_")]
        pose = self.data.oMi[joint] * where
        J = pin.getJointJacobian(self.engine.model, self.data, joint, pin.ReferenceFrame.WORLD)
        return pose.rotation, pose.translation, J[:, self.order]

    def moving(self, J: Array, x: Array) -> Array:
        """The velocities (3, n) of a point."""
        return J[:3] + np.cross(J[3:], x, axis=0)

    def read(self, given: Any) -> float:
        """A number, or an expression; measures are put in as numbers."""
        if not isinstance(given, str):
            return float(given)
        found = dict(self.names)
        for name in measures_of(given):
            kind, start, end = name.replace("(", ",").replace(")", "").split(",")
            found[name] = self.distance(start.strip(), end.strip())[kind.endswith("'")]
        text, known = given, dict(self.names)
        for k, name in enumerate(sorted(found, key=len, reverse=True)):
            if len(name) > 1:
                text, known[f"m{k}"] = text.replace(name, f"m{k}"), found[name]
        return float(value(text, known))

    def distance(self, start: str, end: str) -> tuple[float, float, Array]:
        """The distance of two origins, its rate and its derivatives by the coordinates."""
        (_, p, J), (_, r, K) = self.frame(start), self.frame(end)
        d = r - p
        slopes = d @ (self.moving(K, r) - self.moving(J, p)) / np.linalg.norm(d)
        return float(np.linalg.norm(d)), float(slopes @ self.qd), slopes

    def force(self, load: Plain) -> Array:
        """Q_a (n,) of a load."""
        if load["type"] == "joint":
            return np.eye(self.n)[self.coordinates.index(load["coordinate"])] * self.read(load["force"])
        if load["type"] == "potential":
            return self.potential(load)
        if load["type"] == "cable":
            return self.cable(load)
        (R, p, J), (S, r, K) = self.frame(load["from"]), self.frame(load["to"])
        if load["type"] == "spring":
            p, r = p + R @ values(load["from_at"]), r + S @ values(load["to_at"])
            k, c, l0 = (self.read(load[x]) for x in ("stiffness", "damping", "length"))
            d = r - p
            reach = d @ (self.moving(K, r) - self.moving(J, p)) / np.linalg.norm(d)
            return -reach * (k * (np.linalg.norm(d) - l0) + c * reach @ self.qd)
        if load["type"] == "bushing":
            return self.bushing(load, (R, p, J), (S, r, K))
        axes = {"world": np.eye(3), "from": R, "to": S}[load["axes"]]
        F = axes @ np.array([self.read(x) for x in load["vector"]])
        if load["type"] == "torque":
            return F @ (K[3:] - J[3:])
        x = r + S @ values(load["at"])
        return F @ (self.moving(K, x) - self.moving(J, x))

    def cable(self, load: Plain) -> Array:
        """The tension, as a force on every point along both of its legs."""
        given = [{"frame": x, "at": [0, 0, 0]} if isinstance(x, str) else x for x in load["along"]]
        frames = [self.frame(x["frame"]) for x in given]
        points = [p + R @ values(x["at"]) for x, (R, p, _) in zip(given, frames, strict=True)]
        moving = [self.moving(J, x) for x, (_, _, J) in zip(points, frames, strict=True)]
        legs = np.diff(points, axis=0)
        lengths = np.linalg.norm(legs, axis=1)
        units = legs / lengths[:, None]
        rate = sum(e @ (y - x) @ self.qd for e, x, y in zip(units, moving, moving[1:], strict=False))
        k, c, l0 = (self.read(load[x]) for x in ("stiffness", "damping", "length"))
        tension = k * (lengths.sum() - l0) + c * rate
        # along the leg that leaves a point, and against the one that comes to it
        pulls = [tension * e for e in units]
        forces = [x - y for x, y in zip([*pulls, np.zeros(3)], [np.zeros(3), *pulls], strict=True)]
        return sum(F @ u for F, u in zip(forces, moving, strict=True))

    def bushing(self, load: Plain, A: Any, B: Any) -> Array:
        (R, p, J), (S, r, K) = A, B
        k, c, ka, ca = (values(load[x]) for x in ("stiffness", "damping", "angular_stiffness", "angular_damping"))
        # velocity of B's origin against the body of A, and angular velocity, in the axes of A
        along, about = R.T @ (self.moving(K, r) - self.moving(J, r)), R.T @ (K[3:] - J[3:])
        h, M = ka.sum() / 2 - ka, R.T @ S
        moment = sum(h[j] * np.cross(M[:, j], np.eye(3)[j]) for j in range(3))
        F = -k * (R.T @ (r - p)) - c * (along @ self.qd)
        return F @ along + (moment - ca * (about @ self.qd)) @ about

    def potential(self, load: Plain) -> Array:
        """V = k (l - 0.4)^2 (1 + 0.2 sin q) + u q^2, as random_load writes it."""
        (name,) = measures_of(load["potential"])
        start, end = name.removeprefix("distance(").removesuffix(")").split(", ")
        q = load["potential"].partition("sin(")[2].partition(")")[0]
        l, _, slopes = self.distance(start, end)  # noqa: E741 -- a length
        k, u, x = self.names["k"], self.names["u"], self.names[q]
        own = k * (l - 0.4) ** 2 * 0.2 * np.cos(x) + 2 * u * x
        return -2 * k * (l - 0.4) * (1 + 0.2 * np.sin(x)) * slopes - np.eye(self.n)[self.coordinates.index(q)] * own


def measures_of(text: str) -> list[str]:
    """The measures in an expression as they are written."""
    return sorted({"distance" + part[: part.index(")") + 1] for part in text.split("distance")[1:]})
