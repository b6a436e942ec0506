"""What every stored output of a tree has to be at one state, from its document and the definitions of its parts."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from flint import arb

from substructures.certificate.bodies import (
    CHAINS,
    GROUND,
    NONE,
    Bodies,
    Frame,
    coordinates_of,
    in_order,
    limits_of,
    massless,
)
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.closures import ROWS, closure_outputs
from substructures.certificate.dynamics import Carried, carried_by_joints, velocity_forces
from substructures.certificate.joint_rows import friction, friction_load, limits
from substructures.certificate.linear import Ball, Matrix, dot, identity, roll_pitch_yaw, zeros
from substructures.certificate.loads import Forces, forces
from substructures.certificate.numbers import Bindings, Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.part_outputs import equations, frame_columns
from substructures.certificate.potentials import gradient_instead, is_found
from substructures.certificate.relations import Related, moved, mover, written
from substructures.certificate.slopes import at_start
from substructures.certificate.tree_loads import TreeForces
from substructures.expr.operations import Output


def tree_symbols(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, str]:
    """Every symbol that the program of the tree may have: its kind by its name. ``definitions``: by instance."""
    kinds = dict.fromkeys(tree.get("parameters", ()), "parameter") | {"t": "time"}
    kinds |= dict.fromkeys(tree.get("inputs", ()), "input")
    for instance in tree.get("instances", ()):
        name, bound = instance["name"], instance.get("parameters", {})
        definition = definitions[name]
        kinds |= {f"{name}.{p}": "parameter" for p in definition.get("parameters", ()) if p not in bound}
        kinds |= {f"{name}.{i}": "input" for i in definition.get("inputs", ())}
        for body in definition.get("bodies", ()):
            for c in (c for c in coordinates_of(body) if mover(definition, c) == c):
                q = f"{name}.{c}"
                kinds |= {q: "coordinate", f"{q}'": "velocity", f"{q}''": "acceleration", f"tau.{q}": "input"}
    return kinds


def tree_outputs(
    tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball], stored: Mapping[str, Output]
) -> Outputs:
    """All outputs of the model; ``values``: of all symbols; ``stored``: see
    :func:`substructures.certificate.part_outputs.part_outputs`."""
    result = Outputs()
    numbers, bodies, loads, acting = built(tree, definitions, values)
    moving, second = (rates(bodies, values, mark) for mark in ("'", "''"))
    gravity, others = numbers.vector(tree.get("gravity", NONE)), beside(tree, definitions, bodies, numbers)
    carried = carried_by_joints(bodies, bodies.own)
    equations(result, bodies, carried, stored)
    forces_of = [*(x for f in acting for x in (f.applied, f.wrenches)), others.applied]
    _forces(result, bodies, carried, gravity, _sums(forces_of), moving, second)
    for each in acting:
        each.bent += each.steady
    if is_found(acting):
        weight = {a: result["gravity"].entries[a,] for a in range(len(bodies.joints))}
        known = _sums([weight, *(x for f in acting for x in (f.slopes, f.dead_slopes)), others.slopes])
        some, start, _, there = built(tree, definitions, at_start(values, tree_symbols(tree, definitions)), acting)
        begin = _potential_energy(start, gravity, there) + beside(tree, definitions, start, some).potential
        gradient_instead(result, "potential_energy", acting, known, begin)
    else:
        result.scalar("potential_energy", _potential_energy(bodies, gravity, acting) + others.potential)
    limits(result, bodies, definitions, loads)
    friction(result, bodies, tree, numbers, definitions, loads)
    friction_load(result, bodies, definitions, loads)
    _kinematics(result, bodies)
    closed = closures_in(tree, definitions, numbers, loads)
    if closed:
        closure_outputs(result, bodies, closed, moving)
    return of_coordinates(result, bodies)


def built(
    tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball], like: Sequence[Forces] = ()
) -> tuple[Numbers, Bodies, list[tuple[str, Numbers, range]], list[Forces]]:
    """The numbers of the tree, its bodies in the world, and what acts on them, by instance."""
    bound = {f"{i['name']}.{p}": x for i in tree.get("instances", ()) for p, x in i.get("parameters", {}).items()}
    numbers, bodies = Numbers(Bindings(values, bound)), Bodies()
    loads = []
    for instance in hosts_first(tree):
        name, first = instance["name"], len(bodies.joints)
        inside = Numbers(Related(definitions[name], _names(name, definitions[name], numbers.names, values)))
        bodies.add(definitions[name], inside, _seat(bodies, instance, numbers), f"{name}.")
        loads.append((name, inside, range(first, len(bodies.joints))))
    before = {forces.prefix: forces for forces in like}
    acting = [
        forces(bodies, written(definitions[name]), inside, joints, f"{name}.", before.get(f"{name}."))
        for name, inside, joints in loads
    ]
    return numbers, bodies, loads, acting


def beside(tree: Plain, definitions: Mapping[str, Plain], bodies: Bodies, numbers: Numbers) -> TreeForces:
    """What the loads of the tree do beside those of its parts."""
    inside = (f"{name}.{p}" for name, definition in definitions.items() for p in definition.get("parameters", ()))
    return TreeForces(tree, bodies, numbers, frozenset((*tree.get("parameters", ()), *inside)))


def described(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, Any]:
    """What the axes of the outputs are: coordinates, kinds of joints, frames, rows of closures; which have limits."""
    coordinates: list[str] = []
    frames: list[str] = []
    limited: list[str] = []
    kinds = ""
    for instance in hosts_first(tree):
        name, definition, first = instance["name"], definitions[instance["name"]], len(coordinates)
        bodies = in_order(definition)
        for body in bodies:
            own = coordinates_of(body)
            left = [(step, c) for step, c in enumerate(own) if mover(definition, c) == c]
            coordinates += [f"{name}.{c}" for _, c in left]
            chain = CHAINS[body["joint"]["type"]]
            kinds += "".join("P" if chain[step][0] else "R" for step, _ in left)
        # of joints that move with a coordinate without moving it, none
        bound = [
            q for joint, step, q in _joints_of(definition) if limits_of(joint, step) and not _is_still(definition, q)
        ]
        known = {mover(definition, q) for q in bound}
        limited += [q for q in coordinates[first:] if q.rpartition(".")[2] in known]
        ports = definition.get("ports", ())
        frames += [f"{name}.{frame}" for frame in ("base", *(x["name"] for x in (*bodies, *ports)))]
    closures = [
        {**{x: c[x] for x in ("name", "type", "from")}, "to": c.get("to", "world"), "rows": [*ROWS[c["type"]]]}
        for c, _ in closures_of(tree, definitions)
    ]
    found = {"coordinates": coordinates, "joints": kinds, "frames": frames, "closures": closures, "limited": limited}
    reduction = reduced(tree, definitions)
    return found | ({"reduction": reduction} if any(reduction.values()) else {})


def reduced(tree: Plain, definitions: Mapping[str, Plain]) -> dict[str, Any]:
    """Independent coordinates of the tree, where its closed parts name all of theirs, their starts and ranges."""
    order = [(i["name"], definitions[i["name"]]) for i in hosts_first(tree)]
    closed = [definition for _, definition in order if definition.get("closures")]
    independent: list[str] = []
    start: dict[str, str] = {}
    ranges: dict[str, list[str]] = {}
    for name, d in order:
        own = [
            c
            for _, _, c in _joints_of(d)
            if mover(d, c) == c and (not d.get("closures") or c in d.get("independent", ()))
        ]
        independent += [f"{name}.{c}" for c in own]
        start |= {f"{name}.{c}": str(x) for c, x in d.get("start", {}).items()}
        ranges |= {f"{name}.{c}": [str(x) for x in ends] for c, ends in d.get("ranges", {}).items()}
    is_said = closed and all(d.get("independent") for d in closed) and not tree.get("closures")
    return {"independent": independent if is_said else [], "start": start, "ranges": ranges}


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


def _is_still(definition: Plain, name: str) -> bool:
    """Whether a relation holds a joint at rest: its multiplier is the number 0."""
    relations = moved(definition)
    while name in relations:
        if relations[name].get("multiplier", 1) == 0:
            return True
        name = relations[name]["of"]
    return False


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


def _names(instance: str, definition: Plain, names: Mapping[str, Ball], values: Mapping[str, Ball]) -> dict[str, Ball]:
    """The names inside of a definition: its own, and the time."""
    known = {"t": values["t"]}
    known |= {p: names[f"{instance}.{p}"] for p in definition.get("parameters", ())}
    known |= {i: values[f"{instance}.{i}"] for i in definition.get("inputs", ())}
    for body in definition.get("bodies", ()):
        for c in (c for c in coordinates_of(body) if mover(definition, c) == c):
            q = f"{instance}.{c}"
            known |= {c: values[q], f"{c}'": values[f"{q}'"], f"tau.{c}": values[f"tau.{q}"]}
    return known


def _seat(bodies: Bodies, instance: Plain, numbers: Numbers) -> Frame:
    """The interface frame of an instance."""
    at, placement = instance.get("at", "world"), instance.get("placement", {})
    host = Frame(GROUND, identity(), zeros(3, 1)) if at == "world" else bodies.frames[at]
    A = roll_pitch_yaw(numbers.vector(placement.get("rpy", NONE)))
    return host.placed(A, numbers.vector(placement.get("position", NONE)))


def _forces(
    result: Outputs,
    bodies: Bodies,
    carried: list[Carried],
    gravity: Ball,
    Q: Mapping[int, Ball],
    rates: list[Ball],
    second: list[Ball],
) -> None:
    """Forces and momenta."""
    n, bias = len(bodies.joints), velocity_forces(bodies, bodies.own, rates)
    weight = [dot(gravity, some.f) for some in carried]
    total = [w + Q.get(a, arb(0)) for a, w in enumerate(weight)]
    inertia = [arb(0)] * n
    for (a, c), g in result["metric"].entries.items():
        inertia[a] += g * second[c]
        if a != c:
            inertia[c] += g * second[a]
    # g q'' + Gamma q' q' - Q
    needed = [i + b - q for i, b, q in zip(inertia, bias, total, strict=True)]
    effects = [b - w for b, w in zip(bias, weight, strict=True)]
    named = {"gravity": weight, "forces": total, "bias": bias, "nonlinear_effects": effects, "inverse_dynamics": needed}
    for name, some in named.items():
        result.array(name, (n,)).update({(a,): x for a, x in enumerate(some)})
    for name in ("linear_momentum", "angular_momentum"):
        result.array(name, (n, 3))
    for a, each in enumerate(carried):
        result.matrix("linear_momentum", (n, 3), (a,), each.f)
        result.matrix("angular_momentum", (n, 3), (a,), each.n)


def _sums(some: Iterable[Mapping[int, Ball]]) -> dict[int, Ball]:
    """Forces added by joint."""
    result: dict[int, Ball] = {}
    for terms in some:
        result |= {a: result.get(a, arb(0)) + x for a, x in terms.items()}
    return result


def _potential_energy(bodies: Bodies, gravity: Matrix, acting: list[Forces]) -> Ball:
    """V = -gamma . s of the whole, -F . x of dead forces, springs, stops, potentials: all but what is found."""
    whole = sum(bodies.own.values(), massless())
    return sum((f.potential + f.dead for f in acting), -dot(gravity, whole.s))


def _kinematics(result: Outputs, bodies: Bodies) -> None:
    """Pose and columns of every frame, in the order of the instances: bodies, then ports."""
    n, f = len(bodies.joints), len(bodies.frames)
    for name, shape in (("position", (f, 3)), ("rotation", (f, 3, 3)), ("U", (f, n, 3)), ("Omega", (f, n, 3))):
        result.array(name, shape)
    for k, frame in enumerate(bodies.frames.values()):
        result.matrix("position", (f, 3), (k,), frame.p)
        result.matrix("rotation", (f, 3, 3), (k,), frame.A)
        path = bodies.path(frame.carrier)
        U, Omega = frame_columns(bodies, frame)
        result.columns("U", (f, n, 3), [(k, a) for a in path], U)
        result.columns("Omega", (f, n, 3), [(k, a) for a in path], Omega)
