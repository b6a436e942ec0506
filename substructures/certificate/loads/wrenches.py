"""Forces and torques on bodies of a definition: Q_a = F . u_a, M . w_a."""

from __future__ import annotations

from collections.abc import Mapping

from flint import arb

from substructures.certificate.bodies import NONE, Frame
from substructures.certificate.by_coordinate import gathered
from substructures.certificate.linear import Ball, Matrix, cross, dot, zeros
from substructures.certificate.linear import vector as triple
from substructures.certificate.loads.between import force_changes, in_world, torque_changes
from substructures.certificate.loads.forces import Forces, add_to
from substructures.certificate.numbers import Plain
from substructures.certificate.texts import names_of, slope
from substructures.expr.direct import steps_of


def _pair(found: Forces, load: Plain) -> None:
    """What acts on two bodies of the definition; with a vector in the axes of the world it is kept for both."""
    frames, is_torque = found.between, load["type"] == "torque"
    A, B = frames.ends(load)
    x, F = B.p + B.A * found.constants.vector(load.get("at", NONE)), in_world(frames, load)
    changes = torque_changes(frames, load, F) if is_torque else force_changes(frames, load, F, x)
    if load.get("axes", "to") != "world":
        frames.add(arb(1), changes)
        return
    add_to(found.wrenches, changes)
    for frame, vector in ((B, F), (A, -F)):
        back, origin = found.bodies.carrier(frame.carrier)
        found.places.append((zeros(3, 1) if is_torque else back.transpose() * (x - origin), vector))


def force(found: Forces, load: Plain) -> None:
    """Q_a = F . u_a."""
    if "to" in load:
        _pair(found, load)
        return
    frame, x, u = found.point(load)
    given = found.numbers.vector(load["vector"])
    F = given if load.get("frame") == "world" else frame.A * given
    Q = {a: dot(F, u_a) for a, u_a in u.items()}
    add_to(found.wrenches, Q)
    constants = found.definition.get("parameters", {}).keys()
    if u and load.get("frame") == "world" and all(names_of(steps_of(F_i)) <= constants for F_i in load["vector"]):
        # V = -F . x
        found.dead -= dot(F, x)
        add_to(found.dead_slopes, Q)
    else:
        # d_b Q_a - d_a Q_b = d_b F . u_a - d_a F . u_b, as d_b u_a = d_b d_a x
        changes = _changes(found, load, frame, F)
        _steady(found, load, Q, {(a, b): dot(changes[b], u_a) for a, u_a in u.items() for b in changes})
    _keep(found, frame, x, load, given)


def torque(found: Forces, load: Plain) -> None:
    """Q_a = M . w_a."""
    if "to" in load:
        _pair(found, load)
        return
    frame = found.bodies.frames[found.prefix + load["body"]]
    given = found.numbers.vector(load["vector"])
    M = given if load.get("frame") == "world" else frame.A * given
    w = {a: found.bodies.joints[a].w for a in found.bodies.path(frame.carrier)}
    Q = {a: dot(M, w_a) for a, w_a in w.items()}
    add_to(found.wrenches, Q)
    # d_b Q_a = d_b M . w_a + M . (w_b x w_a), the last where the axis a is carried by the joint b
    changes = _changes(found, load, frame, M)
    turned = {(a, b): dot(M, cross(w[b], w_a)) for a, w_a in w.items() for b in w if b < a}
    rates = {(a, b): dot(changes[b], w_a) + turned.get((a, b), arb(0)) for a, w_a in w.items() for b in changes}
    _steady(found, load, Q, rates)
    _keep(found, frame, None, load, given)


def _changes(found: Forces, load: Plain, frame: Frame, vector: Matrix) -> dict[int, Matrix]:
    """d_b F in the world by joint: of the numbers with the coordinates, and of axes that turn with the body."""
    is_world = load.get("frame") == "world"
    changes: dict[int, Matrix] = {}
    for a in {*found.bodies.path(frame.carrier), *found.joints}:
        name = found.bodies.joints[a].coordinate.rpartition(".")[2] if a in found.joints else ""
        slopes = triple(*(slope(x, found.numbers.names, name) for x in load["vector"]))
        changes[a] = slopes if is_world else frame.A * slopes
    if not is_world:
        for a in found.bodies.path(frame.carrier):
            changes[a] = changes[a] + cross(found.bodies.joints[a].w, vector)
    return changes


def _steady(found: Forces, load: Plain, Q: Mapping[int, Ball], rates: Mapping[tuple[int, int], Ball]) -> None:
    """Notes a load of coordinates and parameters alone whose curl d_b Q_a - d_a Q_b is zero; ``rates``: d_b Q_a."""
    known = found.definition.get("parameters", {}).keys() | found.coordinates.keys()
    if not Q or any(found.bodies.joints[a].group for a in Q):
        return  # what turns a ball joint is not looked at
    rates = _gathered_twice(found, rates)
    curl = (rate - rates.get((b, a), arb(0)) for (a, b), rate in rates.items())
    if all(names_of(steps_of(x)) <= known for x in load["vector"]) and all(x.contains(0) for x in curl):
        found.steady.append(gathered(found.bodies, Q))


def _gathered_twice(found: Forces, rates: Mapping[tuple[int, int], Ball]) -> dict[tuple[int, int], Ball]:
    """N_ai N_bj d_b Q_a."""
    rows: dict[int, dict[int, Ball]] = {}
    for (a, b), x in rates.items():
        rows.setdefault(a, {})[b] = x
    columns: dict[int, dict[int, Ball]] = {}
    for a, row in rows.items():
        for b, x in gathered(found.bodies, row).items():
            columns.setdefault(b, {})[a] = x
    return {(a, b): x for b, column in columns.items() for a, x in gathered(found.bodies, column).items()}


def _keep(found: Forces, frame: Frame, x: Matrix | None, load: Plain, given: Matrix) -> None:
    """The point in the carrier's body frame; the vector in its axes, or in those of the world."""
    A, origin = found.bodies.carrier(frame.carrier)
    back = A.transpose()
    at = zeros(3, 1) if x is None else back * (x - origin)
    found.places.append((at, given if load.get("frame") == "world" else back * frame.A * given))
