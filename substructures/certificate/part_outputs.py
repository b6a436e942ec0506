"""What every stored output of a part has to be at one state, from its definition alone (notation.md, section 6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from flint import arb

from substructures.certificate.bodies import (
    GROUND,
    Bodies,
    Frame,
    Moments,
    coordinates_of,
    in_order,
    inertia_names,
    inertia_of_symbols,
    massless,
)
from substructures.certificate.by_coordinate import along, of_coordinates
from substructures.certificate.dynamics import Carried, carried_by_joints, halved, kappa
from substructures.certificate.linear import Ball, Matrix, dot, identity, side_by_side, skew, zeros
from substructures.certificate.loads.part_loads import forces
from substructures.certificate.loads.potentials import gradient_instead, is_found, ways_of
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs, Values, images_of
from substructures.certificate.relations import Related, is_ball, mover, positions_of, written
from substructures.certificate.slopes import at_start, without
from substructures.expr.operations import Output

#: with more Christoffel symbols than this a part or tree is stored without them (notation.md, section 6)
MOST_CHRISTOFFEL = 23_000
#: older versions stored them up to here
ONCE_CHRISTOFFEL = 100_000


def part_symbols(definition: Plain) -> dict[str, str]:
    """Every symbol that a stored program of the part may have: its kind by its name."""
    kinds = dict.fromkeys(definition.get("parameters", ()), "parameter")
    kinds |= dict.fromkeys(definition.get("inputs", ()), "input") | {"t": "time"}
    for body in definition.get("bodies", ()):
        for q in (q for q in coordinates_of(body) if mover(definition, q) == q):
            kinds |= {f"{q}'": "velocity", f"tau.{q}": "input"} | ({} if is_ball(body) else {q: "coordinate"})
        kinds |= dict.fromkeys(positions_of(body), "coordinate")
        kinds |= dict.fromkeys(inertia_names(body["name"]), "inertia")
    return kinds


def part_outputs(definition: Plain, values: Mapping[str, Ball], stored: Mapping[str, Output]) -> Outputs:
    """All outputs; ``values``: of all symbols. The inertia symbols stand for what every carrier has to carry.

    ``stored``: which of the factors of a rotation E are stored is the derivation's choice, what they have to be is not;
    and whether it has the Christoffel symbols of a part that is large today, and was not when it was stored.
    """
    definition = written(definition)
    numbers, bodies = Numbers(Related(definition, values)), Bodies()
    bodies.add(definition, numbers, Frame(GROUND, identity(), zeros(3, 1)))
    masses = {GROUND: bodies.own[GROUND]}
    for k in range(len(bodies.joints)):
        name = bodies.named.get(k)
        masses[k] = inertia_of_symbols(name, values).outwards(*bodies.carrier(k)) if name else massless()
    carried, result = carried_by_joints(bodies, masses), Outputs()
    _joints(result, bodies, masses, carried)
    _factors(result, len(bodies.joints), stored)
    _interface(result, bodies, carried, is_large(bodies, stored))
    equations(result, bodies, carried, stored)
    _frames(result, bodies, definition)
    _loads(result, bodies, definition, values)
    lengths = [x for frame in bodies.frames.values() for x in frame.p.entries()]
    extent = sum((abs(x) for joint in bodies.joints for x in joint.O.entries()), sum(map(abs, lengths), arb(0)))
    for name in ("frame.position", "load.at"):
        result[name].scale = extent.abs_lower()
    if definition.get("relations"):
        _relations(result, bodies, definition, numbers)
    return of_coordinates(result, bodies)


def _loads(result: Outputs, bodies: Bodies, definition: Plain, values: Mapping[str, Ball]) -> None:
    """Forces, potential and wrenches; ``values``: of all symbols."""
    numbers = Numbers(Related(definition, values))
    load = forces(bodies, definition, numbers, range(len(bodies.joints)))
    n, wrenches = len(bodies.joints), len(load.places)
    result.array("applied", (n,)).update({(a,): Q for a, Q in load.applied.items()})
    if is_found([load]):
        # V of the others where all coordinates are zero
        ways = ways_of(definition.get("bodies", ()), values)
        start, rest = Bodies(), at_start(values, without(part_symbols(definition), ways))
        numbers = Numbers(Related(definition, rest))
        start.add(definition, numbers, Frame(GROUND, identity(), zeros(3, 1)))
        known = forces(start, definition, numbers, load.joints, like=load).potential
        gradient_instead(result, "potential", [load], load.slopes, known, ways)
    else:
        result.scalar("potential", load.potential)
    result.array("load.at", (wrenches, 3))
    result.array("load.vector", (wrenches, 3))
    for i, (at, vector) in enumerate(load.places):
        result.matrix("load.at", (wrenches, 3), (i,), at)
        result.matrix("load.vector", (wrenches, 3), (i,), vector)


def _relations(result: Outputs, bodies: Bodies, definition: Plain, numbers: Numbers) -> None:
    """dq / d mover of all joints, and where they are while the coordinates are zero."""
    shape = (len(bodies.joints),)
    still = {q: arb(0) for joint in bodies.joints for q in (joint.coordinate,) if q == joint.mover}
    rest = Related(definition, {**dict(numbers.names), **still})
    result.array("multiplier", shape).update({(a,): joint.slope for a, joint in enumerate(bodies.joints)})
    result.array("offset", shape).update({(a,): rest[joint.coordinate] for a, joint in enumerate(bodies.joints)})


def metric_alone(definition: Plain, values: Mapping[str, Ball]) -> list[list[Ball]]:
    """The metric of the part with nothing mounted on it; ``values``: of parameters and coordinates."""
    bodies = Bodies()
    bodies.add(definition, Numbers(values), Frame(GROUND, identity(), zeros(3, 1)))
    found = Outputs()
    n = len(bodies.joints)
    found.array("metric", (n, n), "symmetric").update(_metric(bodies, carried_by_joints(bodies, bodies.own)))
    found = of_coordinates(found, bodies)
    g, n = found["metric"].entries, len(along(bodies))
    return [[g.get((min(a, b), max(a, b)), 0) for b in range(n)] for a in range(n)]


def _joints(result: Outputs, bodies: Bodies, masses: dict[int, Moments], carried: list[Carried]) -> None:
    """Joint rows and poses, base functions, inertias."""
    n = len(bodies.joints)
    for name, shape in (("E", (n, 3, 3)), ("R", (n, 3, 3)), ("Z", (n, 3)), ("r", (n, 3)), ("tau", (n,))):
        result.array(name, shape)
    for name in ("U", "Omega"):
        result.array(name, (n, n, 3))
    result.array("armature", (n,))
    for prefix in ("subtree", "inertia"):
        _inertia(result, prefix, (n,), [])
    for c, joint in enumerate(bodies.joints):
        back = joint.A.transpose()
        A, _ = bodies.carrier(joint.parent)
        O = zeros(3, 1) if joint.parent == GROUND else bodies.joints[joint.parent].O  # noqa: E741 -- symbol of the notation
        # E_c: frame L(c) -> frame c;   Z_c = O_c - O_L(c) in frame L(c)
        result.matrix("E", (n, 3, 3), (c,), back * A)
        result.matrix("Z", (n, 3), (c,), A.transpose() * (joint.O - O))
        result.matrix("R", (n, 3, 3), (c,), back)
        result.matrix("r", (n, 3), (c,), joint.O)
        result["tau"].entries[(c,)] = joint.tau
        result["armature"].entries[(c,)] = joint.armature
        # O_c as a point of what carries joint c; joint c itself does not move it
        before = bodies.path(joint.parent)
        W, V = (side_by_side(getattr(bodies.joints[a], name) for a in before) for name in "wv")
        result.columns("U", (n, n, 3), [(c, a) for a in before], back * (V - skew(joint.O) * W))
        result.columns("Omega", (n, n, 3), [(c, a) for a in [*before, c]], back * carried[c].W)
        _inertia(result, "subtree", (n,), [(c, carried[c].moments.inwards(joint.A, joint.O))])
        _inertia(result, "inertia", (n,), [(c, bodies.own[c].inwards(*bodies.carrier(c)))])
    _inertia(result, "base", (), [(0, bodies.own[GROUND])])
    _inertia(result, "composite", (), [(0, sum(masses.values(), massless()))])


def _factors(result: Outputs, n: int, stored: Mapping[str, Output]) -> None:
    """E = (turn about e3) (tilt about e1), each by cosine and sine and left out where it is none; or E in full."""
    E = result["E"].entries
    # one that is missing, or no array, is refused where its shape is looked at
    places = {name: stored[f"E.{name}"].index if f"E.{name}" in stored else () for name in ("tilt", "turn", "full")}
    kept = {name: {index[0] for index in some if index} for name, some in places.items()}
    turn, tilt, full = (result.array(f"E.{x}", (n, *s)) for x, s in (("turn", (2,)), ("tilt", (2,)), ("full", (3, 3))))
    for name in kept:
        result[f"E.{name}"].scale = arb(1)
    for c in range(n):
        if c in kept["full"]:
            full.update({(c, i, j): E[c, i, j] for i in range(3) for j in range(3)})
            continue
        # E = [cos, sin cos', sin sin'; -sin, cos cos', cos sin'; 0, -sin', cos']; without a factor it is 1, 0
        turn |= {(c, 0): E[c, 0, 0] - int(c not in kept["turn"]), (c, 1): -E[c, 1, 0]}
        tilt |= {(c, 0): E[c, 2, 2] - int(c not in kept["tilt"]), (c, 1): -E[c, 2, 1]}


def _inertia(result: Outputs, prefix: str, shape: tuple[int, ...], some: list[tuple[int, Moments]]) -> None:
    """m, s and J by joint, or of the whole."""
    names = f"{prefix}.m", f"{prefix}.s", f"{prefix}.J"
    for name, size in zip(names, ((), (3,), (3, 3)), strict=True):
        result.array(name, (*shape, *size))
    for k, x in some:
        lead = (k,) if shape else ()
        result[names[0]].entries[lead] = x.m
        result.matrix(names[1], (*shape, 3), lead, x.s)
        result.matrix(names[2], (*shape, 3, 3), lead, x.J)


def _interface(result: Outputs, bodies: Bodies, carried: list[Carried], large: bool) -> None:
    """What couples the part to any host, in the interface frame about its origin."""
    n = len(carried)
    for name, shape in (("f", (n, 3)), ("n", (n, 3)), ("K", (n, 3, 3))):
        result.array(name, shape)
    for name in () if large else ("kappa", "F", "N"):
        result.array(name, (n, n, 3))
    for c, some in enumerate(carried):
        result.matrix("f", (n, 3), (c,), some.f)
        result.matrix("n", (n, 3), (c,), some.n)
        result.matrix("K", (n, 3, 3), (c,), some.K)
        if large:
            continue
        F, N = some.forces()
        at = [(b, c) for b in some.path]
        result.columns("F", (n, n, 3), at, F)
        result.columns("N", (n, n, 3), at, N)
        for b in (b for b in bodies.joints[c].group if b < c):
            force, moment = halved(some.moments, bodies.joints[b], bodies.joints[c])
            result.matrix("F", (n, n, 3), (b, c), force)
            result.matrix("N", (n, n, 3), (b, c), moment)
        result.columns("kappa", (n, n, 3), at, kappa(some))
        for i in range(3):  # u_c x u_c = 0
            del result["kappa"].entries[c, c, i]


def equations(result: Outputs, bodies: Bodies, carried: list[Carried], stored: Mapping[str, Output]) -> None:
    """Metric, and the independent Christoffel symbols: a < c, b <= c; of a large system without these."""
    n = len(carried)
    result.array("metric", (n, n), "symmetric").update(_metric(bodies, carried))
    if is_large(bodies, stored):
        return
    gamma = result.array("christoffel", (n, n, n), "christoffel")
    for c, some in enumerate(carried):
        block = some.christoffel()
        for i, a in enumerate(some.path[:-1]):
            gamma.update({(a, b, c): block[i, j] for j, b in enumerate(some.path)})
    if any(joint.group for joint in bodies.joints):
        found = {image: x * sign for at, x in gamma.items() for image, sign in images_of(at, "christoffel")}
        for c, joint in enumerate(bodies.joints):
            for b in (b for b in joint.group if b <= c):
                found |= {(a, b, c): x for a, x in _as_one(bodies, carried, b, c)}
        whole = {at: x for at, x in found.items() if at[1] <= at[2]}
        result["christoffel"] = Values((n, n, n), "connection", entries=whole)


def _as_one(bodies: Bodies, carried: list[Carried], b: int, c: int) -> Iterator[tuple[int, Ball]]:
    """Gamma_abc of joints b, c of one group, by a on a path with them: of the mass that both a and the group move."""
    group = bodies.joints[c].group
    for a, joint in enumerate(bodies.joints):
        if a in carried[group[-1]].path or group[-1] in carried[a].path:
            mass = carried[max(a, group[-1])].moments
            force, moment = halved(mass, bodies.joints[b], bodies.joints[c])
            yield a, dot(joint.v, force) + dot(joint.w, moment)


def _metric(bodies: Bodies, carried: list[Carried]) -> dict[tuple[int, ...], Ball]:
    """g_ac for a <= c, with the rotors of the joints."""
    g: dict[tuple[int, ...], Ball] = {}
    for c, some in enumerate(carried):
        row = some.metric()
        g |= {(a, c): row[0, i] for i, a in enumerate(some.path)}
        g[c, c] += bodies.joints[c].armature
    return g


def is_large(bodies: Bodies, stored: Mapping[str, Output]) -> bool:
    """Whether formulas of the Christoffel symbols, and of products of columns, are more than are stored."""
    most = ONCE_CHRISTOFFEL if "christoffel" in stored else MOST_CHRISTOFFEL
    paths = [bodies.path(c) for c in range(len(bodies.joints))]
    turning = [sum(not bodies.joints[b].prismatic for b in path) for path in paths]
    return sum(len(path) * b for path, b in zip(paths, turning, strict=True)) > most


def _frames(result: Outputs, bodies: Bodies, definition: Plain) -> None:
    """Bodies and ports in their carriers; ports against the interface."""
    names = ["base", *(body["name"] for body in in_order(definition))]
    ports = [port["name"] for port in definition.get("ports", ())]
    frames, n, p = [*names, *ports], len(bodies.joints), len(ports)
    for k, name in enumerate(frames):
        frame = bodies.frames[name]
        A, origin = bodies.carrier(frame.carrier)
        # components in the carrier's body frame -> components in the frame
        result.matrix("frame.E", (len(frames), 3, 3), (k,), frame.A.transpose() * A)
        result.matrix("frame.position", (len(frames), 3), (k,), A.transpose() * (frame.p - origin))
    for shape, name in (((p, 3, 3), "R"), ((p, 3), "r"), ((p, n, 3), "U"), ((p, n, 3), "Omega")):
        result.array(f"port.{name}", shape)
    for k, name in enumerate(ports):
        frame = bodies.frames[name]
        result.matrix("port.R", (p, 3, 3), (k,), frame.A.transpose())
        result.matrix("port.r", (p, 3), (k,), frame.p)
        path = bodies.path(frame.carrier)
        U, Omega = frame_columns(bodies, frame)
        result.columns("port.U", (p, n, 3), [(k, a) for a in path], U)
        result.columns("port.Omega", (p, n, 3), [(k, a) for a in path], Omega)


def frame_columns(bodies: Bodies, frame: Frame) -> tuple[Matrix, Matrix]:
    """Velocity of the origin and angular velocity of a frame, in its axes, for the joints of its path, as columns."""
    path, back = bodies.path(frame.carrier), frame.A.transpose()
    W, V = (side_by_side(getattr(bodies.joints[a], name) for a in path) for name in "wv")
    return back * (V - skew(frame.p) * W), back * W
