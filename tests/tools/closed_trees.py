"""Closed mechanisms of the tests: catalogue entries and small parts with closures."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from made_once import coupled_once, derived_once
from random_trees import Plain

from substructures import Model, Part, TreeSpec, catalogue

SQUEEZER = ("beta", "Theta", "gamma", "Phi", "delta", "Omega", "epsilon")


def tree_parts(document: Plain, definitions: Plain) -> tuple[TreeSpec, dict[str, Part]]:
    """``definitions``: by the reference that instances give."""
    parts = {name: derived_once(data) for name, data in definitions.items()}
    full = {"name": "loop"} | document
    return TreeSpec.read(full), {i["name"]: parts[i["substructure"]] for i in full["instances"]}


def tree_model(document: Plain, definitions: Plain) -> Model:
    """``definitions``: by the reference that instances give."""
    return coupled_once({"name": "loop"} | document, definitions)


def closed_entry(name: str, closures: list[Plain], gravity: Any = (0, 0, 0), **parameters: Any) -> Model:
    """One catalogue entry, called x."""
    instance = {"name": "x", "substructure": name, "parameters": parameters}
    document = {"gravity": list(gravity), "instances": [instance], "closures": closures}
    return tree_model(document, {name: catalogue.load(name)})


def slider_crank(gravity: Any = (0, 0, 0), kind: str = "pin") -> Model:
    return closed_entry("slider-crank", [{"name": "wrist", "type": kind, "from": "x.rod_end", "to": "x.pin"}], gravity)


def four_bar(gravity: Any = (0, 0, 0)) -> Model:
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    return closed_entry("four-bar", [pin], gravity)


def governor() -> Model:
    """The links as rods; the springs that stand for them in the entry have no stiffness."""
    rods = [
        {"name": side, "type": "rod", "from": f"x.{side}_pin", "to": f"x.sleeve_{side}", "length": "x.ll"}
        for side in ("right", "left")
    ]
    return closed_entry("flyball-governor", rods, (0, 0, -9.81), kl=0)


def bricard(gravity: Any = (0, -9.81, 0), size: float = 1) -> Model:
    """Six equal links of ``size`` with axes at right angles, all hinges of one part; the sixth link is the world."""
    links = {}
    for sign in ("pi/2", "-pi/2"):
        body = {"name": "rod", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}}
        own = "1/12" if size == 1 else size**2 / 12
        body |= {"mass": 1, "com": [size / 2, 0, 0], "inertia": {"yy": own, "zz": own}}
        end = {"name": "end", "body": "rod", "position": [size, 0, 0], "rotation": {"rpy": [sign, 0, 0]}}
        links[sign] = {"name": "link", "bodies": [body], "ports": [end]}
    instances = [
        {"name": f"l{k}", "substructure": ("pi/2", "-pi/2")[k % 2], "at": f"l{k - 1}.end" if k else "world"}
        for k in range(5)
    ]
    # the frame of the last hinge, from which Tx(size) Rx(-pi/2) leads to the first one
    last = {"position": [-size, 0, 0], "rpy": ["pi/2", 0, 0]}
    closure = {"name": "hinge", "type": "revolute", "from": "l4.end", "to": "world", "placement": last}
    references = {"pi/2": "plus", "-pi/2": "minus"}
    named = {references[sign]: link for sign, link in links.items()}
    for instance in instances:
        instance["substructure"] = references[instance["substructure"]]
    return tree_model({"gravity": list(gravity), "instances": instances, "closures": [closure]}, named)


def slides() -> Model:
    """A mass of 1 kg that slides along x and y on a rod of 1 m about the origin."""
    first = {"type": "prismatic", "coordinate": "x", "psi": "pi/2", "theta": "pi/2"}
    second = {"type": "prismatic", "coordinate": "y", "theta": "pi/2"}
    bodies = [
        {"name": "a", "parent": "base", "joint": first},
        {"name": "b", "parent": "a", "joint": second, "mass": 1},
    ]
    rod = {"name": "rod", "type": "rod", "from": "x.b", "to": "world", "length": 1}
    document = {"instances": [{"name": "x", "substructure": "slides"}], "closures": [rod]}
    return tree_model(document, {"slides": {"name": "slides", "bodies": bodies}})


def parallelogram() -> Model:
    """Two cranks of 0.2 m, 0.3 m apart, with a coupler of 0.3 m that is a rod."""
    inertia = {"xx": 0.01, "yy": 0.01, "zz": 0.01}
    bodies: list[Plain] = []
    for name, place in (("a", 0), ("b", 0.3)):
        joint = {"type": "revolute", "coordinate": name, "placement": {"position": [place, 0, 0]}}
        bodies.append({"name": name, "parent": "base", "joint": joint, "mass": 1, "inertia": inertia})
    ports = [{"name": f"end_{name}", "body": name, "position": [0.2, 0, 0]} for name in ("a", "b")]
    rod = {"name": "rod", "type": "rod", "from": "x.end_a", "to": "x.end_b", "length": 0.3}
    document = {"instances": [{"name": "x", "substructure": "cranks"}], "closures": [rod]}
    return tree_model(document, {"cranks": {"name": "cranks", "bodies": bodies, "ports": ports}})


def held_bar(joints: Collection[str] = ("q1",), velocity: float = 0.001) -> Model:
    """A four-bar some of whose joints are held by 5 N m each."""

    def joint(name: str, **place: Any) -> Plain:
        """A revolute joint that may rub."""
        law = {"friction": {"coulomb": 5, "velocity": velocity}} if name in joints else {}
        return {"type": "revolute", "coordinate": name, **place, **law}

    rocker = joint("q3", placement={"position": [0.45, 0, 0]})
    bodies = [
        {"name": "crank", "parent": "base", "joint": joint("q1"), "mass": 1, "com": [0.1, 0, 0]},
        {"name": "coupler", "parent": "crank", "joint": joint("q2", d=0.2), "mass": 1, "com": [0.25, 0, 0]},
        {"name": "rocker", "parent": "base", "joint": rocker, "mass": 1, "com": [0.2, 0, 0]},
    ]
    ports = [
        {"name": "e", "body": "coupler", "position": [0.5, 0, 0]},
        {"name": "r", "body": "rocker", "position": [0.4, 0, 0]},
    ]
    pin = {"name": "pin", "type": "pin", "from": "f.e", "to": "f.r"}
    document = {"gravity": [0, 0, 0], "instances": [{"name": "f", "substructure": "bar"}], "closures": [pin]}
    return tree_model(document, {"bar": {"name": "bar", "bodies": bodies, "ports": ports}})


def at(model: Model, **values: float) -> np.ndarray:
    """A state by coordinate names without the instance."""
    return np.array([values.get(name.partition(".")[2], 0.0) for name in model.coordinates])


#: where the legs of the Stewart platform stand, and where they carry it (angles in rad, radii in m)
STEWART = [(1.0, 0.2 + k * np.pi / 3 + 0.25 * (-1) ** k, 0.6, 0.2 + k * np.pi / 3 - 0.25 * (-1) ** k) for k in range(6)]


def stewart_points() -> tuple[np.ndarray, np.ndarray]:
    """Feet in the world and joints in the platform, (6, 3) each, in millimetres exactly."""
    feet = [[r * np.cos(a), r * np.sin(a), 0] for r, a, _, _ in STEWART]
    joints = [[r * np.cos(a), r * np.sin(a), 0] for _, _, r, a in STEWART]
    return np.round(feet, 3), np.round(joints, 3)


def stewart() -> Model:
    """Six legs of the catalogue and a platform that is free, tied by six balls."""
    feet, joints = stewart_points()
    free = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}
    body = {"name": "plate", "parent": "base", "joint": free, "mass": 80, "inertia": {"xx": 8, "yy": 8, "zz": 15}}
    ports = [{"name": f"p{k}", "body": "plate", "position": [float(x) for x in p]} for k, p in enumerate(joints)]
    plate = {"name": "plate", "bodies": [body], "ports": ports}
    instances: list[Plain] = [{"name": "top", "substructure": "plate"}]
    for k, foot in enumerate(feet):
        place = {"position": [float(x) for x in foot]}
        instances.append({"name": f"leg{k}", "substructure": "stewart-leg", "placement": place})
    closures = [{"name": f"ball{k}", "type": "ball", "from": f"leg{k}.joint", "to": f"top.p{k}"} for k in range(6)]
    document = {"gravity": [0, 0, -9.81], "instances": instances, "closures": closures}
    return tree_model(document, {"plate": plate, "stewart-leg": catalogue.load("stewart-leg")})


def angles(rotation: np.ndarray) -> list[float]:
    """Yaw, pitch and roll of a rotation Rz Ry Rx."""
    x, y, z = rotation
    return [np.arctan2(y[0], x[0]), -np.arcsin(z[0]), np.arctan2(z[1], z[2])]


def lift(angle: float) -> tuple[float, float, float]:
    """Lift of the sleeve over the angle of the arms, and two derivatives: rods of length 0.25 at 0.15 m on the arms."""
    a, length, h = 0.15, 0.25, 0.4
    s = np.sqrt(length**2 - (a * np.sin(angle)) ** 2)
    ds = -(a**2) * np.sin(angle) * np.cos(angle) / s
    dds = -(a**2) * np.cos(2 * angle) / s - ds**2 / s
    return h - a * np.cos(angle) - s, a * np.sin(angle) - ds, a * np.cos(angle) - dds


def governor_accelerations(angle: float, rate: float, spin: float) -> tuple[float, float]:
    """Of the arms and of the spindle, from T = (I(a) W^2 + M(a) a'^2) / 2 and V(a)."""
    r, length, ball, sleeve, k, g = 0.03, 0.3, 1.0, 0.8, 500.0, 9.81
    z, dz, ddz = lift(angle)
    reach, dreach = r + length * np.sin(angle), length * np.cos(angle)
    inertia, dinertia = 0.011 + 2 * ball * reach**2, 4 * ball * reach * dreach
    mass, half = 2 * ball * length**2 + sleeve * dz**2, sleeve * dz * ddz
    slope = 2 * ball * g * length * np.sin(angle) + (sleeve * g + k * z) * dz
    return (0.5 * dinertia * spin**2 - half * rate**2 - slope) / mass, -dinertia * rate * spin / inertia


def resized(model: Model, size: float, **others: float) -> dict[str, float]:
    """Parameters of a model with all lengths ``size`` times as long, and all moments of inertia to match."""
    powers = {"m": 1, "kg*m^2": 2}
    known = {name: (float(p["value"]), p["unit"]) for name, p in model.parameters.items()}
    return {name: x * size ** powers[unit] for name, (x, unit) in known.items() if unit in powers} | others
