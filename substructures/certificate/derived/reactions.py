"""Reactions by virtual power: every joint is released in all six directions, in which what it exerts does work.

In the documents a massless body on a free joint is put before every joint, and before every instance. What its six
actuators have to do while it rests, g q'' + Gamma q' q' - Q - G^T lambda of its coordinates less what the forces of
contacts do there, is the force and the moment that is transmitted there (d'Alembert's principle with released
constraints), as of any other coordinate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb, arb_mat

from substructures.certificate.bodies import NONE, Bodies, Frame, coordinates_of, in_order
from substructures.certificate.by_coordinate import rates
from substructures.certificate.closures import ROWS, closure_outputs
from substructures.certificate.derived.model_at import solve
from substructures.certificate.described import closures_in, coordinates_in, hosts_first, is_dependent
from substructures.certificate.dynamics import motions, required
from substructures.certificate.linear import Ball, Matrix, column, cross, dot, vector, with_third_axis
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.tree_outputs import beside, built, tree_symbols
from substructures.errors import VerificationFailed

OUTPUTS = ("reaction_force", "reaction_moment", "reaction_force_world", "reaction_moment_world")
#: no name of a document has it
MARK = "~"
#: of a free joint: shifts along x, y, z, then turns about z, y, x
_FREE = ("x", "y", "z", "yaw", "pitch", "roll")


def reaction_outputs(
    tree: Plain, definitions: Mapping[str, Plain], rows: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """Forces and moments of all ``rows``: joints by coordinates, then seats. Raises VerificationFailed for others."""
    free_tree, free = _released(tree, definitions)
    # what is virtual is zero and rests
    at_rest = {name: arb(0) for name in tree_symbols(free_tree, free) if MARK in name} | dict(values)
    numbers, bodies, inside, acting = built(free_tree, free, at_rest)
    Q: dict[int, Ball] = {}
    for forces in (*(x for f in acting for x in (f.applied, f.wrenches)), beside(tree, free, bodies, numbers).applied):
        for a, x in forces.items():
            Q[a] = Q.get(a, arb(0)) + x
    speeds, second = (rates(bodies, at_rest, mark) for mark in ("'", "''"))
    needed = _required(bodies, speeds, second, numbers.vector(tree.get("gravity", NONE)) * -1)
    for a, x in _contacts(tree, bodies, numbers, values):
        Q[a] = Q.get(a, arb(0)) + x
    closed = closures_in(free_tree, free, numbers, inside)
    if closed:
        found = Outputs()
        closure_outputs(found, bodies, closed, speeds)
        G = found["closure.jacobian"].entries
        names = [f"lambda.{c['name']}.{row}" for c, _ in closed for row in ROWS[c["type"]]]
        # a row of no effect has no symbol in any formula
        forces = {k: values.get(name, arb(0)) for k, name in enumerate(names)}
        _add(Q, G, forces)
        rotors = [joint.armature * x for joint, x in zip(bodies.joints, second, strict=True)]
        rest = [x + rotor - Q.get(a, arb(0)) for a, (x, rotor) in enumerate(zip(needed, rotors, strict=True))]
        _add(Q, G, _of_loops(tree, definitions, bodies, (names, G), rest))
    exerted = {j.coordinate: needed[a] - Q.get(a, arb(0)) for a, j in enumerate(bodies.joints)}
    places = list(_places(tree, definitions, bodies))
    if [name for name, *_ in places] != list(rows):
        raise VerificationFailed(f"the joints are not those of the documents: {', '.join(rows)}")
    return _shown(places, exerted)


def _add(Q: dict[int, Ball], G: Mapping[tuple[int, ...], Ball], forces: Mapping[int, Ball]) -> None:
    """G^T lambda."""
    for (k, a), x in G.items():
        Q[a] = Q.get(a, arb(0)) + x * forces.get(k, arb(0))


def _of_loops(
    tree: Plain,
    definitions: Mapping[str, Plain],
    bodies: Bodies,
    closures: tuple[Sequence[str], Mapping[tuple[int, ...], Ball]],
    needed: Sequence[Ball],
) -> dict[int, Ball]:
    """The multipliers of least norm of each reduced instance, with which its dependent coordinates need no force;
    ``closures``: names of multipliers, and G.
    """
    (names, G), found = closures, dict[int, Ball]()
    for instance in tree.get("reduced", ()):
        own = ((f"lambda.{instance}.{c['name']}", ROWS[c["type"]]) for c in definitions[instance]["closures"])
        rows = [names.index(f"{name}.{row}") for name, some in own for row in some]
        every = coordinates_in({"instances": [{"name": instance}]}, definitions)
        z = [q for q in every if is_dependent(tree, definitions, q)]
        needs, columns = [arb(0)] * len(z), arb_mat(len(rows), len(z))
        for a, joint in enumerate(bodies.joints):
            if joint.mover in z:
                j = z.index(joint.mover)
                needs[j] += needed[a] * joint.slope
                for i, k in enumerate(rows):
                    columns[i, j] += G.get((k, a), arb(0)) * joint.slope
        # of G^T lambda = needs
        solved = solve(columns.transpose() * columns, needs)
        found |= dict(zip(rows, (columns * arb_mat(len(z), 1, solved)).entries(), strict=True))
    return found


def _contacts(tree: Plain, bodies: Bodies, numbers: Numbers, values: Mapping[str, Ball]) -> Iterator[tuple[int, Ball]]:
    """By joint the power of the forces of edges and rolling contacts at q' = 1: force . velocity of the point."""

    def along(label: str, direction: Matrix) -> Matrix:
        """The force of a multiplier."""
        return direction * values.get(f"lambda.{label}", arb(0))

    for given in tree.get("velocity_constraints", ()):
        if "frame" not in given:
            continue
        frame, name = bodies.frames[given["frame"]], given["name"]
        point, force = frame.p, along(name, column(frame.A, 1))
        if "radius" in given:
            plane = with_third_axis(numbers.vector(given.get("normal", (0, 0, 1))))
            ways = [along(f"{name}.{row}", column(plane, i)) for i, row in enumerate(("slip_1", "slip_2", "contact"))]
            force, down, axis = ways[0] + ways[1] + ways[2], column(plane, 2), column(frame.A, 2)
            if given.get("shape", "disc") == "disc":
                down = cross(axis, cross(down, axis))
            point = point - down * (numbers.read(given["radius"]) / dot(down, down).sqrt())
        for a in bodies.path(frame.carrier):
            yield a, dot(bodies.joints[a].v + cross(bodies.joints[a].w, point), force)


def _free_body(name: str, parent: str, called: str) -> Plain:
    coordinates = [f"{MARK}{called}{MARK}{way}" for way in _FREE]
    return {"name": name, "parent": parent, "joint": {"type": "free", "coordinate": coordinates}}


def _released(tree: Plain, definitions: Mapping[str, Plain]) -> tuple[Plain, dict[str, Plain]]:
    """The documents with free massless bodies before all joints and instances."""
    free = {name: _released_definition(definition) for name, definition in definitions.items()}
    instances = []
    for instance in tree.get("instances", ()):
        seat = f"{MARK}{instance['name']}"
        free[seat] = {"name": seat, "bodies": [_free_body("seat", "base", "seat")]}
        bound = {key: x for key, x in instance.items() if key not in ("at", "placement")}
        instances.append({key: x for key, x in instance.items() if key in ("at", "placement")} | {"name": seat})
        instances.append(bound | {"at": f"{seat}.seat"})
    return {**tree, "instances": instances, "reduced": ()}, free


def _released_definition(definition: Plain) -> Plain:
    bodies = []
    for body in definition.get("bodies", ()):
        if body["joint"]["type"] != "fixed":
            name = f"{MARK}{body['name']}"
            bodies.append(_free_body(name, body["parent"], body["name"]))
            body = {**body, "parent": name}
        bodies.append(body)
    return {**definition, "bodies": bodies}


def _required(bodies: Bodies, rates: Sequence[Ball], second: Sequence[Ball], world: Matrix) -> list[Ball]:
    """What inertia and weight need along every coordinate; the world is accelerated against gravity."""
    moving = motions(bodies, rates, second, world)
    loads = {k: required(moving[k], mass) for k, mass in bodies.own.items()}
    result = [arb(0)] * len(bodies.joints)
    for k in reversed(range(len(bodies.joints))):
        joint, (force, moment) = bodies.joints[k], loads[k]
        result[k] = dot(joint.v, force) + dot(joint.w, moment)
        F, N = loads[joint.parent]
        loads[joint.parent] = F + force, N + moment
    return result


_Place = tuple[str, str, Matrix, Matrix, Frame]


def _places(tree: Plain, definitions: Mapping[str, Plain], bodies: Bodies) -> Iterator[_Place]:
    """(row, prefix of its virtual coordinates, axes, origin, frame of the virtual body) of joints, then of seats."""
    names = [instance["name"] for instance in hosts_first(tree)]
    at = {joint.coordinate: joint for joint in bodies.joints}
    for name in names:
        for body in in_order(definitions[name]):
            for coordinate in coordinates_of(body):
                joint, bearing = at[f"{name}.{coordinate}"], f"{name}.{MARK}{body['name']}"
                yield joint.coordinate, bearing, joint.A, joint.body, bodies.frames[bearing]
    for name in names:
        seat = bodies.frames[f"{name}.base"]
        yield f"{name}.base", f"{MARK}{name}.{MARK}seat", seat.A, seat.p, bodies.frames[f"{MARK}{name}.seat"]


def _shown(places: Sequence[_Place], exerted: Mapping[str, Ball]) -> Outputs:
    """About the origins of the frames, in their axes and in those of the world."""
    result, shape = Outputs(), (len(places), 3)
    for name in OUTPUTS:
        result.array(name, shape)
    for k, (_, prefix, axes, origin, virtual) in enumerate(places):
        x, y, z, yaw, pitch, roll = (exerted[f"{prefix}{MARK}{way}"] for way in _FREE)
        force = virtual.A * vector(x, y, z)
        moment = virtual.A * vector(roll, pitch, yaw) + cross(virtual.p - origin, force)
        back = axes.transpose()
        for name, each in zip(OUTPUTS, (back * force, back * moment, force, moment), strict=True):
            result.matrix(name, shape, (k,), each)
    return result
