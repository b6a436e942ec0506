"""Joints that relations move, q^d = mu q^i + delta: what documents say of them, in the coordinates that are left.

Where an expression names such a joint the position of the joint is put in its place, so that nothing else names it. And
joints that have no coordinates, but quaternions and rates: what these are called.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from flint import arb

from substructures.certificate.linear import Ball, Matrix, turn_of, vector
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.states import draws
from substructures.certificate.texts import Steps, names_of, product
from substructures.expr.direct import steps_of
from substructures.expr.steps import Step

#: fields of loads that are names
_NAMES = frozenset(("type", "name", "coordinate", "body", "from", "to", "frame", "axes", "along", "title"))
#: of joints whose axes move with the body that they carry, how many numbers say where it is: the place (x, y, z) of a
#: floating one, and a quaternion (w, x, y, z)
POSITIONS = {"ball": 4, "floating": 7}
_XYZ = ("x", "y", "z")


def moved(definition: Plain) -> dict[str, Plain]:
    """The relations by the coordinate that depends on another."""
    return {each["coordinate"]: each for each in definition.get("relations", ())}


def mover(definition: Plain, name: str) -> str:
    """The coordinate that moves a joint."""
    relations = moved(definition)
    while name in relations:
        name = relations[name]["of"]
    return name


class Related(Mapping[str, Ball]):
    """The names of a definition, positions and velocities of joints that relations move among them."""

    def __init__(self, definition: Plain, names: Mapping[str, Ball]) -> None:
        self.relations, self.names = moved(definition), names

    def __getitem__(self, name: str) -> Ball:
        relation = self.relations.get(name.rstrip("'"))
        if relation is None:
            return self.names[name]
        marks = name[len(relation["coordinate"]) :]
        read = Numbers(self.names).read
        shift = arb(0) if marks else read(relation.get("offset", 0))
        return read(relation.get("multiplier", 1)) * self[relation["of"] + marks] + shift

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self.names or (isinstance(name, str) and name.rstrip("'") in self.relations)


def slope_of(definition: Plain, name: str, numbers: Numbers) -> Ball:
    """N_ai = dq^a / dq^i of a joint."""
    relations, result = moved(definition), arb(1)
    while name in relations:
        result = result * numbers.read(relations[name].get("multiplier", 1))
        name = relations[name]["of"]
    return result


def is_still(definition: Plain, name: str) -> bool:
    """Whether relations hold a joint at rest whatever the parameters are: a multiplier is zero."""
    (state,) = next(draws(dict.fromkeys(definition.get("parameters", ()), "parameter"), {}, 1))
    slope = slope_of(definition, name, Numbers({p: arb(x) for p, x in state.items()}))
    return bool(slope.is_finite() and slope.contains(0))


def position_steps(definition: Plain, name: str) -> Steps:
    """The position of a joint, or with the mark of a rate its velocity, in the coordinate that moves it."""
    relations, mark, way = moved(definition), "'" if name.endswith("'") else "", list[Plain]()
    name = name.removesuffix("'")
    while name in relations:
        way.append(relations[name])
        name = relations[name]["of"]
    result: Steps = (Step("name", name + mark, 1),)
    for relation in reversed(way):
        result = product(steps_of(relation.get("multiplier", 1)), result)
        if not mark:
            result = (*result, *steps_of(relation.get("offset", 0)), Step("add", None, 1))
    return result


def multiplier_steps(definition: Plain, name: str) -> Steps:
    """N_ai of a joint."""
    relations, result = moved(definition), steps_of(1)
    while name in relations:
        result = product(result, steps_of(relations[name].get("multiplier", 1)))
        name = relations[name]["of"]
    return result


def _with_positions(definition: Plain, text: str) -> str | Steps:
    """An expression as it is, or its steps, with the positions of joints that relations move."""
    relations, steps = moved(definition), steps_of(text)
    if relations.keys().isdisjoint(name.removesuffix("'") for name in names_of(steps)):
        return text
    parts = (position_steps(definition, str(x.value)) if x.op == "name" else (x,) for x in steps)
    return tuple(step for part in parts for step in part)


def written(definition: Plain) -> Plain:
    """The definition with the coordinates that are left in the texts of its laws and loads."""
    relations = moved(definition)
    if not relations:
        return definition

    def shown(given: Any) -> Any:
        """With other names."""
        if isinstance(given, str):
            return _with_positions(definition, given)
        if isinstance(given, Mapping):
            return {key: x if key in _NAMES else shown(x) for key, x in given.items()}
        return [shown(x) for x in given] if isinstance(given, (list, tuple)) else given

    bodies = [
        {**body, "joint": {key: shown(x) if key in ("stiffness", "rest", "damping") else x for key, x in joint.items()}}
        for body in definition.get("bodies", ())
        for joint in (body["joint"],)
    ]
    loads = [shown(load) for load in definition.get("loads", ())]
    for load in loads:
        if load["type"] == "joint" and load["coordinate"] in relations:
            # the work of a force on a joint is that of mu times the force on what moves it
            force = product(multiplier_steps(definition, load["coordinate"]), steps_of(load["force"]))
            load |= {"coordinate": mover(definition, load["coordinate"]), "force": force}
    return {**definition, "bodies": bodies, "loads": loads}


def is_ball(body: Plain) -> bool:
    """Whether the axes of the body's joint move with it."""
    return body["joint"]["type"] in POSITIONS


def positions_of(body: Plain) -> list[str]:
    """The names of place and quaternion of such a joint; none of others."""
    if not is_ball(body):
        return []
    place = [f"r_{body['name']}_{axis}" for axis in _XYZ if body["joint"]["type"] == "floating"]
    return list(body["joint"].get("coordinate") or [*place, *(f"q_{body['name']}_{axis}" for axis in ("w", *_XYZ))])


def rates_of(body: Plain) -> list[str]:
    """The names of the rates of such a joint."""
    sliding = [f"v_{body['name']}_{axis}" for axis in _XYZ if body["joint"]["type"] == "floating"]
    return list(body["joint"].get("velocities") or [*sliding, *(f"w_{body['name']}_{axis}" for axis in _XYZ)])


def place_of(body: Plain, names: Mapping[str, Ball]) -> tuple[Matrix, Matrix]:
    """Axes as columns and origin of the body, seen from where its joint is."""
    values = [names[name] for name in positions_of(body)]
    p = values[:-4] or [arb(0)] * 3
    return turn_of(values[-4:]), vector(p[0], p[1], p[2])
