"""Forces and energies of the loads of a definition, by virtual power: F . (velocity of its point for q'^a = 1).

A new type of load is a function in :data:`LOADS`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from flint import arb, fmpq

from substructures.certificate.between import (
    Between,
    MeasuredNames,
    Slopes,
    bushing,
    cable,
    distance,
    force_changes,
    in_world,
    torque_changes,
)
from substructures.certificate.bodies import (
    NONE,
    Bodies,
    Frame,
    laws_of,
    limits_of,
    of_step,
)
from substructures.certificate.by_coordinate import gathered
from substructures.certificate.linear import Ball, Matrix, cross, dot, zeros
from substructures.certificate.linear import vector as triple
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.relations import mover, multiplier_text, position_text
from substructures.certificate.texts import Steps, difference, names_of, negative, product, slope
from substructures.expr.direct import steps_of
from substructures.expr.syntax import measured


class Forces:
    """Of one definition in a world of bodies.

    ``applied``: Q_a of joint laws, actuators, joint loads, springs and potentials; ``wrenches``: Q_a of forces and
    torques on bodies; ``places``: point and vector of every force and torque, as they are stored.
    ``potential``: V of springs, stops and potentials in closed form, ``slopes`` its -dV/dq^a; ``dead``, ``dead_slopes``
    the same of forces that are constant in the world.
    Of two kinds of forces potentials may have been found: ``given`` as formulas, by joint; ``bent``, of springs whose
    stiffness or length depends on coordinates, as far as they are gradients. ``steady``: the same of forces and torques
    on bodies that depend on coordinates and parameters alone.
    ``joints``: of the definition; ``prefix``: of its names; ``like``: the forces at a random state, where these are at
    one at which numbers may not change with coordinates that they depend on.
    """

    def __init__(
        self,
        bodies: Bodies,
        definition: Plain,
        numbers: Numbers,
        joints: range,
        prefix: str = "",
        like: Forces | None = None,
    ) -> None:
        self.bodies, self.joints, self.prefix = bodies, joints, prefix
        #: frames of the definition and measures of them, with which laws are read; ``constants``: numbers without them
        self.constants, self.between = numbers, _OwnFrames(self, numbers)
        self.numbers = self.between.numbers
        self.definition, self.somewhere = definition, like.constants.names if like else numbers.names
        self.applied: dict[int, Ball] = {}
        self.wrenches: dict[int, Ball] = {}
        self.potential = self.dead = arb(0)
        self.slopes: dict[int, Ball] = {}
        self.dead_slopes: dict[int, Ball] = {}
        self.given: dict[int, list[Steps]] = {}
        self.bent: list[dict[int, Ball]] = []
        self.steady: list[dict[int, Ball]] = []
        self.places: list[tuple[Matrix, Matrix]] = []
        self.index = {joint.coordinate: a for a, joint in enumerate(bodies.joints)}
        left = [a for a in joints if bodies.joints[a].coordinate == bodies.joints[a].mover]
        self.coordinates = {bodies.joints[a].coordinate.rpartition(".")[2]: a for a in left}

    def depends(self, *given: Any) -> bool:
        """Whether numbers depend on a coordinate or a velocity of the definition."""
        return any(
            not slope(x, self.somewhere, name).contains(0)
            for x in given
            for name in names_of(steps_of(x))
            if name.removesuffix("'") in self.coordinates
        )

    def rate(self, a: int) -> Ball:
        """q'^a."""
        return self.numbers.names[self.bodies.joints[a].coordinate.rpartition(".")[2] + "'"]

    def point(self, end: Plain) -> tuple[Frame, Matrix, dict[int, Matrix]]:
        """Of ``body`` and ``at``: the body's frame, the point in the world, its velocity for every q'^a = 1."""
        frame = self.bodies.frames[f"{self.prefix}{end['body']}"]
        x = frame.p + frame.A * self.numbers.vector(end.get("at", NONE))
        path = self.bodies.path(frame.carrier)
        return frame, x, {a: self.bodies.joints[a].v + cross(self.bodies.joints[a].w, x) for a in path}


class _OwnFrames(Between):
    """Between two bodies or ports of one definition: a host moves both like one body."""

    def __init__(self, forces: Forces, numbers: Numbers) -> None:
        self.forces, self.bodies = forces, forces.bodies
        self.numbers = Numbers(MeasuredNames(self, numbers.names))

    def frame(self, at: str) -> Frame:
        """A body or port."""
        return self.bodies.frames[f"{self.forces.prefix}{at}"]

    def ends(self, load: Plain) -> tuple[Frame, Frame]:
        """Both bodies or ports."""
        return self.frame(load.get("from", "base")), self.frame(load["to"])

    def rate(self, changes: Slopes) -> Ball:
        """By the joints of the definition."""
        return sum((x * self.forces.rate(a) for a, x in changes.items() if a in self.forces.joints), arb(0))

    def add(self, law: Ball, changes: Slopes) -> None:
        """To what is applied."""
        _add(self.forces.applied, {a: law * x for a, x in changes.items() if a in self.forces.joints})

    def keep(self, energy: Ball, law: Ball, changes: Slopes) -> None:
        """To the potential."""
        self.forces.potential += energy
        _add(self.forces.slopes, {a: law * x for a, x in changes.items() if a in self.forces.joints})

    def stretch(self, load: Plain, length: Ball, changes: Slopes) -> None:
        """A host moves all frames like one body, so that a is a joint of the definition itself."""
        found, (k, c, l0) = self.forces, self.law(load)
        reach = {a: changes.get(a, arb(0)) for a in found.joints}
        # l' = dl/dq^a q'^a
        tension = k * (length - l0) + c * self.rate(reach)
        _add(found.applied, {a: -tension * w for a, w in reach.items()})
        pulls = {a: -k * (length - l0) * w for a, w in reach.items()}
        if _measures(load.get("stiffness", 0), load.get("length", 0)):
            return
        if found.depends(load.get("stiffness", 0), load.get("length", 0)):
            if not any(self.bodies.joints[a].group for a in found.joints) and _is_gradient(
                found, load, (k, length - l0), gathered(self.bodies, reach)
            ):
                found.bent.append(gathered(self.bodies, pulls))
        else:
            found.potential += k * (length - l0) * (length - l0) * arb(fmpq(1, 2))
            _add(found.slopes, pulls)

    def is_steady(self, *given: Any) -> bool:
        """Whether numbers name no measures, coordinates and velocities."""
        names = {name for x in given for name in names_of(steps_of(x))}
        return not any(measured(name) or name.removesuffix("'") in self.forces.coordinates for name in names)


def forces(
    bodies: Bodies, definition: Plain, numbers: Numbers, joints: range, prefix: str = "", like: Forces | None = None
) -> Forces:
    """All loads of a definition; ``joints``: its own. Raises LookupError for a type of load that is not known here."""
    found = Forces(bodies, definition, numbers, joints, prefix, like)
    for a, (joint, step) in zip(joints, laws_of(definition), strict=True):
        joint_law(found, a, joint, step)
    for load in definition.get("loads", ()):
        LOADS[load["type"]](found, load)
    return found


def _add(sums: dict[int, Ball], terms: Mapping[int, Any]) -> None:
    for a, term in terms.items():
        sums[a] = sums.get(a, arb(0)) + term


def joint_law(found: Forces, a: int, joint: Plain, step: int) -> None:
    """Q = tau - k (q - rest) - c q',   V = k (q - rest)^2 / 2 where k and rest are no functions of the state."""
    numbers = found.numbers
    name = found.bodies.joints[a].coordinate.rpartition(".")[2]
    given = [of_step(joint.get(x, 0), step) for x in ("stiffness", "rest", "damping")]
    k, rest, c = map(numbers.read, given)
    if found.bodies.joints[a].group:  # of rates there are no positions
        _add(found.applied, {a: numbers.names[f"tau.{name}"] - c * found.rate(a)})
        return
    stretch = numbers.names[name] - rest
    effort = numbers.names[f"tau.{name}"] if name in found.coordinates else arb(0)
    _add(found.applied, {a: effort - k * stretch - c * found.rate(a)})
    if found.depends(*given[:2]):
        place = steps_of(position_text(found.definition, name))
        law = product(steps_of(given[0]), difference(place, steps_of(given[1])))
        if name not in found.coordinates:
            law = product(steps_of(multiplier_text(found.definition, name)), law)
        moved_by = found.coordinates[mover(found.definition, name)]
        found.given.setdefault(moved_by, []).append(negative(law))
    else:
        found.potential += k * stretch * stretch * arb(fmpq(1, 2))
        _add(found.slopes, {a: -k * stretch})
    _friction(found, a, of_step(joint.get("friction"), step))
    _stops(found, a, numbers.names[name], of_step(joint.get("limits_act"), step), limits_of(joint, step))


def _friction(found: Forces, a: int, law: Plain | None) -> None:
    """Of a joint."""
    if law is not None:
        _add(found.applied, {a: -friction_force(found.numbers, law, found.rate(a))})


def friction_force(numbers: Numbers, law: Plain, rate: Ball) -> Ball:
    """(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0)."""
    F = numbers.read(law["coulomb"])
    if law.get("stribeck") is not None:
        ratio, static = rate / numbers.read(law["stribeck"]), law.get("static")
        F += (numbers.read(law["coulomb"] if static is None else static) - F) * (-ratio * ratio).exp()
    return F * (rate / numbers.read(law["velocity"])).tanh()


def _friction_load(found: Forces, load: Plain) -> None:
    _friction(found, found.index[found.prefix + load["coordinate"]], load)


def _stops(found: Forces, a: int, q: Ball, stop: Plain | None, limits: Sequence[Any] | None) -> None:
    """(k + c p') p against q at the depth p beyond a limit, nothing within; V = k p^2 / 2."""
    if stop is None or limits is None:
        return
    low, high = map(found.numbers.read, limits)
    k, c = (found.numbers.read(stop.get(x, 0)) for x in ("stiffness", "damping"))
    for side, beyond in ((1, q - high), (-1, low - q)):
        p = beyond.max(arb(0))
        # p' = q' beyond the upper limit, -q' beyond the lower one
        _add(found.applied, {a: -side * (k + c * side * found.rate(a)) * p})
        _add(found.slopes, {a: -side * k * p})
        found.potential += k * p * p * arb(fmpq(1, 2))


def _joint_load(found: Forces, load: Plain) -> None:
    a = found.index[found.prefix + load["coordinate"]]
    _add(found.applied, {a: found.numbers.read(load["force"])})
    if not _measures(load["force"]) and not found.bodies.joints[a].group:
        found.given.setdefault(a, []).append(steps_of(load["force"]))


def _measures(*given: Any) -> list[str]:
    """The measures of frames that numbers name; what depends on them is a force without potential."""
    return sorted({name for x in given for name in names_of(steps_of(x)) if measured(name)})


def _potential(found: Forces, load: Plain) -> None:
    """Q_a = -dV/dq^a."""
    found.potential += found.numbers.read(load["potential"])
    for name in sorted(names_of(steps_of(load["potential"])) & found.coordinates.keys()):
        a = found.coordinates[name]
        Q = -slope(load["potential"], found.numbers.names, name)
        _add(found.applied, {a: Q})
        _add(found.slopes, {a: Q})
    for name in _measures(load["potential"]):
        # -dV/ds ds/dq^a
        law, changes = -slope(load["potential"], found.numbers.names, name), found.between.measure(name)[1]
        found.between.add(law, changes)
        found.between.keep(arb(0), law, changes)


def _pair(found: Forces, load: Plain) -> None:
    """What acts on two bodies of the definition; with a vector in the axes of the world it is kept for both."""
    frames, is_torque = found.between, load["type"] == "torque"
    A, B = frames.ends(load)
    x, F = B.p + B.A * found.constants.vector(load.get("at", NONE)), in_world(frames, load)
    changes = torque_changes(frames, load, F) if is_torque else force_changes(frames, load, F, x)
    if load.get("axes", "to") != "world":
        frames.add(arb(1), changes)
        return
    _add(found.wrenches, changes)
    for frame, vector in ((B, F), (A, -F)):
        back, origin = found.bodies.carrier(frame.carrier)
        found.places.append((zeros(3, 1) if is_torque else back.transpose() * (x - origin), vector))


def _force(found: Forces, load: Plain) -> None:
    """Q_a = F . u_a."""
    if "to" in load:
        _pair(found, load)
        return
    frame, x, u = found.point(load)
    given = found.numbers.vector(load["vector"])
    F = given if load.get("frame") == "world" else frame.A * given
    Q = {a: dot(F, u_a) for a, u_a in u.items()}
    _add(found.wrenches, Q)
    constants = found.definition.get("parameters", {}).keys()
    if u and load.get("frame") == "world" and all(names_of(steps_of(F_i)) <= constants for F_i in load["vector"]):
        # V = -F . x
        found.dead -= dot(F, x)
        _add(found.dead_slopes, Q)
    else:
        # d_b Q_a - d_a Q_b = d_b F . u_a - d_a F . u_b, as d_b u_a = d_b d_a x
        changes = _changes(found, load, frame, F)
        _steady(found, load, Q, {(a, b): dot(changes[b], u_a) for a, u_a in u.items() for b in changes})
    _keep(found, frame, x, load, given)


def _torque(found: Forces, load: Plain) -> None:
    """Q_a = M . w_a."""
    if "to" in load:
        _pair(found, load)
        return
    frame = found.bodies.frames[found.prefix + load["body"]]
    given = found.numbers.vector(load["vector"])
    M = given if load.get("frame") == "world" else frame.A * given
    w = {a: found.bodies.joints[a].w for a in found.bodies.path(frame.carrier)}
    Q = {a: dot(M, w_a) for a, w_a in w.items()}
    _add(found.wrenches, Q)
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
    if any(found.bodies.joints[a].group for a in Q):
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


def _spring(found: Forces, load: Plain) -> None:
    """Between two points of bodies."""
    (A, x, _), (B, y, _) = found.point(load["from"]), found.point(load["to"])
    found.between.stretch(load, *distance(found.between, A, x, B, y))


def _is_gradient(found: Forces, load: Plain, law: tuple[Ball, Ball], reach: Mapping[int, Ball]) -> bool:
    """Whether Q_a = f dl/dq^a with f = -k (l - l0) has a potential where k and l0 depend on coordinates q, and on no
    velocity: df/dq^b dl/dq^a = df/dq^a dl/dq^b, of the derivatives of f at fixed l. ``law``: k and l - l0.
    """
    k, stretch = law
    names, given = found.numbers.names, (load.get("stiffness", 0), load.get("length", 0))

    def by(name: str) -> Ball:
        """df by a name at fixed l."""
        return k * slope(given[1], names, name) - stretch * slope(given[0], names, name)

    if not all(by(f"{name}'").contains(0) for name in found.coordinates):
        return False
    pairs = [(by(name), reach.get(a, arb(0))) for name, a in found.coordinates.items()]
    return all((f * v - g * w).contains(0) for f, w in pairs for g, v in pairs)


#: what the loads of each type add to the forces
LOADS: dict[str, Callable[[Forces, Plain], None]] = {
    "joint": _joint_load,
    "force": _force,
    "torque": _torque,
    "spring": _spring,
    "bushing": lambda found, load: bushing(found.between, load),
    "cable": lambda found, load: cable(found.between, load),
    "potential": _potential,
    "friction": _friction_load,
}
