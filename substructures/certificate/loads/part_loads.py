"""Forces and energies of the loads of a definition, by virtual power: F . (velocity of its point for q'^a = 1).

A new type of load is a function in :data:`LOADS`.
"""

from __future__ import annotations

from collections.abc import Callable

from flint import arb

from substructures.certificate.bodies import Bodies, laws_of
from substructures.certificate.loads.between import bushing, cable, distance
from substructures.certificate.loads.forces import Forces, add_to, measures_in
from substructures.certificate.loads.joint_laws import joint_friction, joint_law
from substructures.certificate.loads.wrenches import force, torque
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.texts import names_of, slope
from substructures.expr.direct import steps_of


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


def _friction_load(found: Forces, load: Plain) -> None:
    joint_friction(found, found.index[found.prefix + load["coordinate"]], load)


def _joint_load(found: Forces, load: Plain) -> None:
    a = found.index[found.prefix + load["coordinate"]]
    add_to(found.applied, {a: found.numbers.read(load["force"])})
    if not measures_in(load["force"]) and not found.bodies.joints[a].group:
        found.given.setdefault(a, []).append(steps_of(load["force"]))


def _potential(found: Forces, load: Plain) -> None:
    """Q_a = -dV/dq^a."""
    found.potential += found.numbers.read(load["potential"])
    for name in sorted(names_of(steps_of(load["potential"])) & found.coordinates.keys()):
        a = found.coordinates[name]
        Q = -slope(load["potential"], found.numbers.names, name)
        add_to(found.applied, {a: Q})
        add_to(found.slopes, {a: Q})
    for name in measures_in(load["potential"]):
        # -dV/ds ds/dq^a
        law, changes = -slope(load["potential"], found.numbers.names, name), found.between.measure(name)[1]
        found.between.add(law, changes)
        found.between.keep(arb(0), law, changes)


def _spring(found: Forces, load: Plain) -> None:
    """Between two points of bodies."""
    (A, x, _), (B, y, _) = found.point(load["from"]), found.point(load["to"])
    found.between.stretch(load, *distance(found.between, A, x, B, y))


#: what the loads of each type add to the forces
LOADS: dict[str, Callable[[Forces, Plain], None]] = {
    "joint": _joint_load,
    "force": force,
    "torque": torque,
    "spring": _spring,
    "bushing": lambda found, load: bushing(found.between, load),
    "cable": lambda found, load: cable(found.between, load),
    "potential": _potential,
    "friction": _friction_load,
}
