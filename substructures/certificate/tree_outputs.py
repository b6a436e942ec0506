"""What every stored output of a tree has to be at one state, from its document and the definitions of its parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from flint import arb

from substructures.certificate.bodies import (
    GROUND,
    NONE,
    Bodies,
    Frame,
    coordinates_of,
    massless,
)
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.closures import closure_outputs
from substructures.certificate.described import (
    closures_in,
    coordinates_in,
    free_coordinates,
    hosts_first,
    is_dependent,
    positions_in,
)
from substructures.certificate.dynamics import Carried, carried_by_joints, velocity_forces
from substructures.certificate.given.driven import driven_outputs, driven_symbols, of_free, with_driven
from substructures.certificate.given.ignored import ignored_outputs, ignored_symbols, with_ignored
from substructures.certificate.given.loops import Reduced
from substructures.certificate.given.reduced import (
    all_free,
    driven_level,
    reduced_at,
    reduced_outputs,
    reduced_symbols,
)
from substructures.certificate.joint_rows import friction, friction_load, limits
from substructures.certificate.linear import Ball, Matrix, dot, identity, roll_pitch_yaw, zeros
from substructures.certificate.loads.forces import Forces
from substructures.certificate.loads.part_loads import forces
from substructures.certificate.loads.potentials import UNKNOWN, gradient_instead, integrated, is_found, ways_of
from substructures.certificate.loads.tree_loads import TreeForces
from substructures.certificate.numbers import Bindings, Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.part_outputs import equations, frame_columns
from substructures.certificate.relations import Related, is_ball, mover, positions_of, written
from substructures.certificate.slopes import at_start, without
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
                kinds |= {f"{q}'": "velocity", f"{q}''": "acceleration", f"tau.{q}": "input"}
                kinds |= {} if is_ball(body) else {q: "coordinate"}
            kinds |= {f"{name}.{p}": "coordinate" for p in positions_of(body)}
    return ignored_symbols(tree, driven_symbols(tree, reduced_symbols(tree, definitions, kinds)))


def tree_outputs(
    tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball], stored: Mapping[str, Output]
) -> Outputs:
    """All outputs of the model; ``values``: of all symbols; ``stored``: see
    :func:`substructures.certificate.part_outputs.part_outputs`."""
    if tree.get("ignored"):
        every, outputs = list(free_coordinates(tree, definitions)), partial(_at_level, tree, definitions, stored)
        return ignored_outputs(tree, every, values, outputs)
    return _at_level(tree, definitions, stored, values)


def _at_level(
    tree: Plain, definitions: Mapping[str, Plain], stored: Mapping[str, Output], values: Mapping[str, Ball]
) -> Outputs:
    """The outputs of the coordinates that neither depend on others nor are driven."""
    if not tree.get("reduced"):
        return _outputs(tree, definitions, stored, values)
    found = level_at(tree, definitions, with_driven(tree, values))
    outputs = reduced_outputs(tree, definitions, found, _outputs(all_free(tree), definitions, stored, found.values))
    z = [q for q in coordinates_in(tree, definitions) if is_dependent(tree, definitions, q)]
    outputs.array("dependent", (len(z),)).update({(k,): found.values[q] for k, q in enumerate(z)})
    driven, free = tree.get("driven", ()), list(free_coordinates(tree, definitions))
    more = driven_level(outputs, free, found.values, driven) if driven else {}
    outputs.update(more)
    return of_free(outputs, free, driven)


def with_given(tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]) -> Mapping[str, Ball]:
    """The values of all symbols but those that depend on others; ``values``: without driven and ignored ones."""
    if not tree.get("ignored"):
        return with_driven(tree, values)
    every, outputs = list(free_coordinates(tree, definitions)), partial(_at_level, tree, definitions, {})
    return with_ignored(tree, every, values, outputs)


def level_at(tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]) -> Reduced:
    """The values of all symbols, those of coordinates that depend on others among them; ``values``: of the others."""
    return reduced_at(tree, definitions, values, _placed)


def _outputs(
    tree: Plain, definitions: Mapping[str, Plain], stored: Mapping[str, Output], values: Mapping[str, Ball]
) -> Outputs:
    """The outputs of all coordinates that are not driven."""
    result, given, driven = Outputs(), values, tree.get("driven", ())
    values = with_driven(tree, given)
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
        ways = _ways(tree, definitions, given)
        begin_at = with_driven(tree, at_start(given, without(tree_symbols(tree, definitions), ways)))
        some, start, _, there = built(tree, definitions, begin_at, acting)
        begin = _potential_energy(start, gravity, there) + beside(tree, definitions, start, some).potential
        # of a coordinate that need not be zero there
        is_known = not any(bodies.joints[a].mover in driven for forces in acting for a in integrated(forces))
        gradient_instead(result, "potential_energy", acting, known, begin if is_known else UNKNOWN, ways)
    else:
        result.scalar("potential_energy", _potential_energy(bodies, gravity, acting) + others.potential)
    if any(joint.group for joint in bodies.joints):
        _position_rates(result, tree, definitions, values)
    limits(result, bodies, definitions, loads)
    friction(result, bodies, tree, numbers, definitions, loads)
    friction_load(result, bodies, definitions, loads)
    _kinematics(result, bodies)
    closed = closures_in(tree, definitions, numbers, loads)
    if closed:
        closure_outputs(result, bodies, closed, moving)
    more = driven_outputs(result, bodies, values, driven) if driven else {}
    result = of_coordinates(result, bodies)
    result.update(more)
    return of_free(result, list(coordinates_in(tree, definitions)), driven)


def _position_rates(result: Outputs, tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]) -> None:
    """The changes of what a state consists of: q', and what the rates of ball joints do."""
    found = dict[str, Ball]()
    for rate, way in _ways(tree, definitions, values).items():
        for name, x in way.items():
            found[name] = found.get(name, arb(0)) + x * values[f"{rate}'"]
    order = list(positions_in(tree, definitions))
    rates = [found[name] if name in found else values[f"{name}'"] for name in order]
    result.array("position_rates", (len(order),)).update({(i,): x for i, x in enumerate(rates)})


def _ways(tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]) -> dict[str, dict[str, Ball]]:
    """How places and quaternions change with the rates of ball joints."""
    names = [instance["name"] for instance in tree.get("instances", ())]
    found = (ways_of(definitions[name].get("bodies", ()), values, f"{name}.") for name in names)
    return {rate: way for some in found for rate, way in some.items()}


def built(
    tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball], like: Sequence[Forces] = ()
) -> tuple[Numbers, Bodies, list[tuple[str, Numbers, range]], list[Forces]]:
    """The numbers of the tree, its bodies in the world, and what acts on them, by instance."""
    numbers, bodies, loads = _placed(tree, definitions, values)
    before = {each.prefix: each for each in like}
    acting = [
        forces(bodies, written(definitions[name]), inside, joints, f"{name}.", before.get(f"{name}."))
        for name, inside, joints in loads
    ]
    return numbers, bodies, loads, acting


def _placed(
    tree: Plain, definitions: Mapping[str, Plain], values: Mapping[str, Ball]
) -> tuple[Numbers, Bodies, list[tuple[str, Numbers, range]]]:
    """The numbers of the tree, its bodies in the world, and the joints and numbers of instances."""
    bound = {f"{i['name']}.{p}": x for i in tree.get("instances", ()) for p, x in i.get("parameters", {}).items()}
    numbers, bodies = Numbers(Bindings(values, bound)), Bodies()
    loads = []
    for instance in hosts_first(tree):
        name, first = instance["name"], len(bodies.joints)
        inside = Numbers(Related(definitions[name], _names(name, definitions[name], numbers.names, values)))
        bodies.add(definitions[name], inside, _seat(bodies, instance, numbers), f"{name}.")
        loads.append((name, inside, range(first, len(bodies.joints))))
    return numbers, bodies, loads


def beside(tree: Plain, definitions: Mapping[str, Plain], bodies: Bodies, numbers: Numbers) -> TreeForces:
    """What the loads of the tree do beside those of its parts."""
    inside = (f"{name}.{p}" for name, definition in definitions.items() for p in definition.get("parameters", ()))
    return TreeForces(tree, bodies, numbers, frozenset((*tree.get("parameters", ()), *inside)))


def _names(instance: str, definition: Plain, names: Mapping[str, Ball], values: Mapping[str, Ball]) -> dict[str, Ball]:
    """The names inside of a definition: its own, and the time."""
    known = {"t": values["t"]}
    known |= {p: names[f"{instance}.{p}"] for p in definition.get("parameters", ())}
    known |= {i: values[f"{instance}.{i}"] for i in definition.get("inputs", ())}
    for body in definition.get("bodies", ()):
        for c in (c for c in coordinates_of(body) if mover(definition, c) == c):
            q = f"{instance}.{c}"
            known |= {f"{c}'": values[f"{q}'"], f"tau.{c}": values[f"tau.{q}"]}
            known |= {} if is_ball(body) else {c: values[q]}
        known |= {p: values[f"{instance}.{p}"] for p in positions_of(body)}
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
