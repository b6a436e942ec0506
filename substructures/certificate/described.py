"""What the axes of the outputs of a tree are called, from its document and the definitions of its parts."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from typing import Any

from substructures.certificate.bodies import CHAINS, coordinates_of, in_order, limits_of
from substructures.certificate.closures import ROWS
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.relations import is_ball, is_still, mover, positions_of, rates_of

#: fields of a tree that take coordinates out of its equations
GIVEN = ("driven", "ignored")


def described(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, Any]:
    """What the axes of the outputs are: coordinates, kinds of joints, frames, rows of closures; which have limits, and
    whose motion or momentum is given; velocity constraints.
    """
    kinds = free_coordinates(tree, definitions)
    given = {name: [q for q in kinds if q in tree.get(name, ())] for name in GIVEN}
    free = [q for q in kinds if not any(q in some for some in given.values())]
    frames: list[str] = []
    bound: set[str] = set()
    for instance in hosts_first(tree):
        name, definition = instance["name"], definitions[instance["name"]]
        bound |= set(_bound(name, definition))
        ports = definition.get("ports", ())
        frames += [f"{name}.{frame}" for frame in ("base", *(x["name"] for x in (*in_order(definition), *ports)))]
    level = tree.get("reduced", ())
    closures = [_rows_of(closure) for closure, owner in closures_of(tree, definitions) if owner not in level]
    joints, limited = "".join(kinds[q] for q in free), [q for q in free if q in bound]
    found = {"coordinates": free, "joints": joints, "frames": frames, "closures": closures, "limited": limited}
    reduction = reduced(tree, definitions)
    more = {"reduction": reduction if any(reduction.values()) else {}, **ties_in(tree)}
    more["reduced"] = [_level(name, definitions[name]) for name in level]
    more["balls"] = list(_balls_in(tree, definitions))
    return found | {name: x for name, x in (given | more).items() if x}


def _bound(instance: str, definition: Plain) -> Iterable[str]:
    """Coordinates that limits of joints bound; of joints that move with one without moving it, none."""
    for joint, step, q in _joints_of(definition):
        if limits_of(joint, step) and not is_still(definition, q):
            yield f"{instance}.{mover(definition, q)}"


def _balls_in(tree: Plain, definitions: Mapping[str, Plain]) -> Iterable[dict[str, list[str]]]:
    """What states have in place of the rates of ball and floating joints."""
    for instance in hosts_first(tree):
        prefix = f"{instance['name']}."
        for body in filter(is_ball, in_order(definitions[instance["name"]])):
            kinds = {"positions": positions_of(body), "velocities": rates_of(body)}
            yield {kind: [prefix + name for name in names] for kind, names in kinds.items()}


def _rows_of(closure: Plain) -> dict[str, Any]:
    """What the rows of a closure are."""
    ends = {name: closure[name] for name in ("name", "type", "from")}
    return {**ends, "to": closure.get("to", "world"), "rows": [*ROWS[closure["type"]]]}


def ties_in(tree: Plain) -> dict[str, list[dict[str, Any]]]:
    """The velocity constraints and contacts as they are given, numbers as texts."""
    return {kind: [_as_text(each) for each in tree.get(kind, ())] for kind in ("velocity_constraints", "contacts")}


def _as_text(given: Plain) -> dict[str, Any]:
    return {name: [*map(_text, x)] if isinstance(x, (list, tuple)) else _text(x) for name, x in given.items()}


def _text(given: object) -> str:
    return format(given, "f") if isinstance(given, Decimal) else str(given)


def coordinates_in(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, str]:
    """All coordinates, driven ones among them, with the kinds of their joints."""
    order = [(i["name"], definitions[i["name"]]) for i in hosts_first(tree)]
    return {
        f"{name}.{c}": "P" if CHAINS[joint["type"]][step][0] else "R"
        for name, d in order
        for joint, step, c in _joints_of(d)
        if mover(d, c) == c
    }


def positions_in(tree: Plain, definitions: Mapping[str, Plain]) -> Iterable[str]:
    """What a state q consists of, dependent coordinates among it."""
    for instance in hosts_first(tree):
        definition = definitions[instance["name"]]
        for body in in_order(definition):
            own = positions_of(body) or [q for q in coordinates_of(body) if mover(definition, q) == q]
            yield from (f"{instance['name']}.{name}" for name in own)


def is_dependent(tree: Plain, definitions: Mapping[str, Plain], name: str) -> bool:
    """Whether a coordinate is a function of others: of an instance of ``tree["reduced"]``, not independent."""
    instance, _, own = name.partition(".")
    return instance in tree.get("reduced", ()) and own not in definitions[instance].get("independent", ())


def free_coordinates(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, str]:
    """Those that do not depend on others, driven and ignored ones among them, with the kinds of their joints."""
    every = coordinates_in(tree, definitions)
    return {name: kind for name, kind in every.items() if not is_dependent(tree, definitions, name)}


def _level(name: str, definition: Plain) -> dict[str, Any]:
    """What is said of a reduced instance."""
    own = [c for _, _, c in _joints_of(definition) if mover(definition, c) == c]
    known = definition.get("independent", ())
    return {
        "instance": name,
        "independent": [f"{name}.{c}" for c in own if c in known],
        "dependent": [f"{name}.{c}" for c in own if c not in known],
        "closures": [f"{name}.{closure['name']}" for closure in definition["closures"]],
    }


def reduced(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, Any]:
    """Independent coordinates of the tree, where its closed parts name all of theirs, their starts and ranges."""
    if tree.get("driven") or tree.get("ignored"):
        return {"independent": [], "start": {}, "ranges": {}}
    names = [i["name"] for i in hosts_first(tree)]
    closed = [name for name in names if definitions[name].get("closures") and name not in tree.get("reduced", ())]
    every = free_coordinates(tree, definitions)
    start: dict[str, str] = {}
    ranges: dict[str, list[str]] = {}
    for name in names:
        start |= {f"{name}.{c}": str(x) for c, x in definitions[name].get("start", {}).items()}
        ranges |= {f"{name}.{c}": [str(x) for x in ends] for c, ends in definitions[name].get("ranges", {}).items()}
    start = {q: x for q, x in start.items() if q in every}
    is_said = closed and all(definitions[name].get("independent") for name in closed) and not tree.get("closures")
    independent = [q for q in every if _moves_by_itself(closed, definitions, q)] if is_said else []
    return {"independent": independent, "start": start, "ranges": ranges}


def _moves_by_itself(closed: Sequence[str], definitions: Mapping[str, Plain], name: str) -> bool:
    """Whether a coordinate is independent; ``closed``: instances with closures."""
    instance, _, own = name.partition(".")
    return instance not in closed or own in definitions[instance].get("independent", ())


def closures_of(tree: Plain, definitions: Mapping[str, Plain]) -> Iterable[tuple[Plain, str]]:
    """The closures of the tree, then those of its parts with the names of the tree; the instance that has them."""
    yield from ((closure, "") for closure in tree.get("closures", ()))
    for instance in hosts_first(tree):
        name = instance["name"]
        for closure in definitions[name].get("closures", ()):
            ends = {"name": closure["name"], "from": closure["from"], "to": closure.get("to", "base")}
            yield {**closure, **{field: f"{name}.{x}" for field, x in ends.items()}}, name


def closures_in(
    tree: Plain, definitions: Mapping[str, Plain], numbers: Numbers, inside: Sequence[tuple[str, Numbers, range]]
) -> list[tuple[Plain, Numbers]]:
    """All closures with the numbers of the tree, or of the instance that has them."""
    known = {"": numbers} | {name: own for name, own, _ in inside}
    return [(closure, known[name]) for closure, name in closures_of(tree, definitions)]


def _joints_of(definition: Plain) -> Iterable[tuple[Plain, int, str]]:
    """The joint of every coordinate, its place in the joint, its name."""
    for body in in_order(definition):
        for step, name in enumerate(coordinates_of(body)):
            yield body["joint"], step, name


def hosts_first(tree: Plain) -> list[Plain]:
    """The instances in the order of the model: hosts first, otherwise as given."""
    instances = list(tree.get("instances", ()))
    ready = [i for i, instance in enumerate(instances) if instance.get("at", "world") == "world"]
    order = []
    while ready:
        i = heapq.heappop(ready)
        order.append(instances[i])
        for k, other in enumerate(instances):
            if other.get("at", "world").partition(".")[0] == instances[i]["name"]:
                heapq.heappush(ready, k)
    return order
