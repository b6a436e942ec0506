"""Seeded random mechanisms as definitions, first all in numbers, then with parameters in the place of some of them.

Everything is plain data in the form of HTTP contract, section 1. The numeric definition is what the independent
computations of the tests read; the definition with parameters has the same values as defaults.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import copy
import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.part.topology import CHAINS

Plain = dict[str, Any]

SIMPLE = ("revolute", "revolute", "prismatic", "fixed")
COMPOUND = ("universal", "spherical", "cylindrical", "planar", "free")
MIXED = (*SIMPLE, *SIMPLE, *COMPOUND)
GRAVITY = (0.71, -2.3, -9.3)


@dataclass(frozen=True)
class Kind:
    """What a random mechanism may consist of. ``massive``: every moving body has mass and inertia."""

    bodies: int = 4
    chain: bool = False
    joints: tuple[str, ...] = MIXED
    massive: bool = False
    laws: bool = True
    loads: int = 3
    springs: int = 1
    depth: int = 9  #: most coordinates


def number(rng: np.random.Generator, low: float = -1.0, high: float = 1.0) -> float:
    """A random number of three decimals."""
    return round(float(rng.uniform(low, high)), 3)


def vector(rng: np.random.Generator, size: float = 1.0) -> list[float]:
    """Three of them; now and then with zeros."""
    return [number(rng, -size, size) if rng.random() < 0.8 else 0 for _ in range(3)]


def random_definition(rng: np.random.Generator, kind: Kind, name: str = "random") -> Plain:
    """A numeric definition: a tree (or chain) of bodies b1, b2, ... with coordinates q1, q2, ..., ports and loads."""
    bodies: list[Plain] = []
    dof = 0
    for i in range(1, kind.bodies + 1):
        before = i - 1 if kind.chain else int(rng.integers(max(0, i - 3), i))
        parent = f"b{before}" if before else "base"
        choices = [t for t in kind.joints if dof + len(CHAINS[t]) <= kind.depth]
        joint = random_joint(rng, str(rng.choice(choices)) if choices else "fixed", dof, kind.laws)
        dof += len(CHAINS[joint["type"]])
        bodies.append({"name": f"b{i}", "parent": parent, "joint": joint})
    for body in bodies:
        leaf = all(other["parent"] != body["name"] for other in bodies)
        add_inertia(rng, body, leaf or kind.massive)
    # the order of the bodies in the document is free
    shown = [bodies[i] for i in rng.permutation(len(bodies))] if rng.random() < 0.3 else bodies
    definition = {"name": name, "bodies": shown, "ports": random_ports(rng, bodies)}
    definition["inputs"] = {"u1": {}, "u2": {}}
    definition["loads"] = random_loads(rng, bodies, kind.loads) + random_springs(rng, bodies, kind.springs)
    return definition


def random_joint(rng: np.random.Generator, kind: str, dof: int, laws: bool) -> Plain:
    """A joint by row or by placement (with or without an axis), with spring, damper and rotor."""
    n = len(CHAINS[kind])
    joint: Plain = {"type": kind}
    if n:
        names = [f"q{dof + j + 1}" for j in range(n)]
        joint["coordinate"] = names[0] if n == 1 else names
    if rng.random() < 0.5:
        joint["placement"] = {"position": vector(rng), "rpy": vector(rng, 3)}
        if n == 1 and rng.random() < 0.6:
            joint["axis"] = random_axis(rng)
    else:
        angles = [0, "pi/2", "-pi/2", "pi", number(rng, -3, 3), number(rng, -3, 3), number(rng, -3, 3)]
        joint |= {x: angles[rng.integers(len(angles))] for x in ("psi", "theta") if rng.random() < 0.8}
        joint |= {x: number(rng) for x in ("d", "sigma") if rng.random() < 0.7}
    if n <= 1:
        joint |= {x: number(rng) for x in ("phi", "tau") if rng.random() < 0.5}
    if laws and n:
        for law in ("stiffness", "rest", "damping", "armature"):
            if rng.random() < 0.4:
                values = [number(rng, 0.1, 1) for _ in range(n)]
                joint[law] = values[0] if rng.random() < 0.5 else values
                joint[law] = values[0] if n == 1 else joint[law]
    return joint


def random_axis(rng: np.random.Generator) -> list[Any]:
    """Along an axis of the frame, in either direction, or oblique."""
    axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, -2.5], [0.6, 0, 0.8], [1, 1, 1]]
    axes += [["sqrt(3)/2", 0, "-1/2"], ["pi", 1, 0], [0, "-sqrt(2)", 0]]
    return list(axes[rng.integers(len(axes))]) if rng.random() < 0.6 else [number(rng), number(rng), 0.7]


def point_cloud(rng: np.random.Generator, points: int = 6) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, mass centre and inertia tensor about it of some mass points: physical by construction."""
    m, x = rng.uniform(0.1, 1.0, points), rng.uniform(-0.5, 0.5, (points, 3)) + rng.uniform(-0.3, 0.3, 3)
    centre = m @ x / m.sum()
    J = np.einsum("k,ki,kj->ij", m, x - centre, x - centre)
    return round(float(m.sum()), 3), np.round(centre, 3), np.round(np.trace(J) * np.eye(3) - J, 5)


def add_inertia(rng: np.random.Generator, body: Plain, full: bool) -> None:
    """Nothing, a mass point, or a cloud of points; inertia about the mass centre or the origin of the body frame."""
    choice = rng.integers(0, 4)
    if not full and choice < 2:
        if choice:
            body |= {"mass": number(rng, 0.5, 3), "com": vector(rng)}
        return
    m, c, theta = point_cloud(rng)
    about = "origin" if choice == 3 else "com"
    if about == "origin":
        theta = np.round(theta + m * (c @ c * np.eye(3) - np.outer(c, c)), 6)
    body |= {"mass": m, "com": [float(x) for x in c]}
    entries = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    body["inertia"] = {name: float(theta[i]) for name, i in entries.items()} | {"about": about}


def random_ports(rng: np.random.Generator, bodies: list[Plain]) -> list[Plain]:
    """A port on every second body, and one on the base."""
    chosen = ["base", *(b["name"] for b in bodies if rng.random() < 0.5)]
    return [
        {"name": f"port_{name}", "body": name, "position": vector(rng), "rotation": {"rpy": vector(rng, 3)}}
        for name in chosen
    ]


def coordinates_of(body: Plain) -> list[str]:
    """Coordinate names of a body's joint."""
    names = body["joint"].get("coordinate", [])
    return [names] if isinstance(names, str) else list(names)


def random_loads(rng: np.random.Generator, bodies: list[Plain], count: int) -> list[Plain]:
    """Forces and torques in body and world axes and joint forces, with states, time and inputs in the formulas."""
    loads: list[Plain] = []
    for _ in range(count):
        body = bodies[rng.integers(len(bodies))]
        names = coordinates_of(body)
        terms = [number(rng), "u1", "2*u2 - t", "sin(t)^2"]
        terms += [f"0.3*{q}' - {q}^2" for q in names] + [f"cos({q})*{q}'" for q in names]
        some = [terms[rng.integers(len(terms))] for _ in range(3)]
        frame = str(rng.choice(["body", "world"]))
        kinds: list[Plain] = [
            {"type": "force", "body": body["name"], "at": vector(rng), "vector": some, "frame": frame},
            {"type": "torque", "body": body["name"], "vector": some, "frame": frame},
        ]
        if names:
            kinds.append({"type": "joint", "coordinate": str(rng.choice(names)), "force": some[0]})
        loads.append(kinds[rng.integers(len(kinds))])
    return loads


def random_springs(rng: np.random.Generator, bodies: list[Plain], count: int) -> list[Plain]:
    """Springs between a body and its parent, so that every cut keeps both ends in one part."""
    loads = []
    for _ in range(count):
        body = bodies[rng.integers(len(bodies))]
        ends: Plain = {
            "from": {"body": body["parent"], "at": [number(rng, 1, 2), number(rng), number(rng)]},
            "to": {"body": body["name"], "at": [number(rng), number(rng, 1, 2), number(rng)]},
        }
        law = {"stiffness": number(rng, 0.5, 2), "damping": number(rng, 0, 1), "length": number(rng, 0.1, 1)}
        loads.append(
            {"type": "spring"} | ends | {k: v for k, v in law.items() if k == "stiffness" or rng.random() < 0.7}
        )
    return loads


# --- parameters in the place of numbers

PLACES = re.compile(
    r"bodies/\d+/(mass|com/\d|inertia/[xyz]{2}|joint/(psi|theta|d|sigma|phi|tau|stiffness|rest|damping|armature)(/\d)?"
    r"|joint/placement/(position|rpy)/\d)|ports/\d+/(position|rotation/rpy)/\d"
    r"|loads/\d+/(at/\d|vector/\d|force|stiffness|damping|length|(from|to)/at/\d)"
)


def with_parameters(rng: np.random.Generator, definition: Plain, share: float, odd: bool = False) -> Plain:
    """Replaces a share of the numbers by parameters p1, p2, ... or expressions in them, with the same values.

    ``odd``: also by roots, squares and functions of parameters, as they come about by substitution.
    """
    result = copy.deepcopy(definition)
    parameters: Plain = {}

    def walk(data: Any, path: str) -> Any:
        if isinstance(data, dict):
            return {key: walk(value, f"{path}/{key}" if path else key) for key, value in data.items()}
        if isinstance(data, list):
            return [walk(value, f"{path}/{i}") for i, value in enumerate(data)]
        if isinstance(data, str) or not PLACES.fullmatch(path) or rng.random() >= share:
            return data
        value = Decimal(repr(data))
        return (_odd_expression if odd else _expression)(rng, value, parameters)

    result = walk(result, "")
    result["parameters"] = parameters
    return dict(result)


def _expression(rng: np.random.Generator, value: Decimal, parameters: Plain) -> str:
    name = f"p{len(parameters) + 1}"
    text, given = [
        (name, value),
        (f"-{name}", -value),
        (f"{name}/4 + 1/8", (value - Decimal("0.125")) * 4),
        (f"2*({name} - 0.5)", value / 2 + Decimal("0.5")),
    ][int(rng.choice(4, p=[0.7, 0.1, 0.1, 0.1]))]
    parameters[name] = {"value": given}
    return text


def _odd_expression(rng: np.random.Generator, value: Decimal, parameters: Plain) -> str:
    name, other = f"p{len(parameters) + 1}", f"p{len(parameters) + 2}"
    sign = "-" if value < 0 else ""
    text, given, more = [
        (f"{sign}sqrt({name})", value * value, None),
        (f"{name} + 0.01*sin({other})^2/2", value, Decimal("0.1")),
        (f"{name}*{other}", value * 4, Decimal("0.25")),
        (f"{sign}{name}^2", Decimal(repr(round(float(abs(value)) ** 0.5, 4))), None),
        (f"{name}*cos(0.3)/{other}", value, Decimal(1)),
    ][int(rng.integers(5))]
    parameters[name] = {"value": given}
    if more is not None:
        parameters[other] = {"value": more}
    return text


# --- models


def tree_of(definition: Plain, gravity: Any = GRAVITY, instance: str = "x") -> TreeSpec:
    """A tree with this one part at the world; the part's parameters become parameters of the tree."""
    parameters = definition.get("parameters", {})
    one = {"name": instance, "definition": definition, "parameters": {name: name for name in parameters}}
    return TreeSpec.read({"name": "tree", "gravity": list(gravity), "parameters": parameters, "instances": [one]})


def model_of(definition: Plain, gravity: Any = GRAVITY) -> Model:
    """The model of a definition alone at the world."""
    return couple(tree_of(definition, gravity), {"x": derive(Definition.read(definition))})


def random_states(rng: np.random.Generator, n: int, dof: int) -> Plain:
    """q, qd and qdd; angles of the size that keeps spherical joints away from their singularity."""
    return {name: rng.uniform(-1.2, 1.2, (n, dof)) for name in ("q", "qd", "qdd")}
