"""Limits and dry friction of the coordinates of a tree, from the joints of its definitions and from its loads."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from flint import arb

from substructures.certificate.bodies import Bodies, laws_of, limits_of, of_step
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.relations import is_still


def limits(
    result: Outputs,
    bodies: Bodies,
    definitions: Mapping[str, Plain],
    loads: list[tuple[str, Numbers, range]],
) -> None:
    """Lowest and highest value of coordinates that have limits; of trees in which one has some."""
    n = len(bodies.joints)
    for name, inside, joints in loads:
        for a, (joint, step) in zip(joints, laws_of(definitions[name]), strict=True):
            bounds = limits_of(joint, step)
            if bounds and not _is_still(bodies, definitions, a):
                _bounded(result.array("limits", (n, 2)), bodies, a, [inside.read(x) for x in bounds], inside)


def _is_still(bodies: Bodies, definitions: Mapping[str, Plain], a: int) -> bool:
    instance, _, name = bodies.joints[a].coordinate.partition(".")
    return is_still(definitions[instance], name)


def _bounded(found: dict[tuple[int, ...], Ball], bodies: Bodies, a: int, bounds: list[Ball], inside: Numbers) -> None:
    """What the limits of a joint leave of the range of the coordinate that moves it."""
    joint = bodies.joints[a]
    k = next(k for k, other in enumerate(bodies.joints) if other.coordinate == joint.mover)
    if k != a:
        at = (
            inside.names[joint.coordinate.rpartition(".")[2]]
            - joint.slope * inside.names[joint.mover.rpartition(".")[2]]
        )
        low, high = ((x - at) / joint.slope for x in bounds)
        bounds = [low.min(high), low.max(high)]
    known = found.get((k, 0)), found.get((k, 1))
    found[k, 0] = bounds[0] if known[0] is None else known[0].max(bounds[0])
    found[k, 1] = bounds[1] if known[1] is None else known[1].min(bounds[1])


def friction(
    result: Outputs,
    bodies: Bodies,
    tree: Plain,
    numbers: Numbers,
    definitions: Mapping[str, Plain],
    loads: list[tuple[str, Numbers, range]],
) -> None:
    """F_c, F_s, v_s (0: none) and v_0 of coordinates that have friction, of trees in which one has some."""
    n, index = len(bodies.joints), {joint.coordinate: a for a, joint in enumerate(bodies.joints)}
    laws = [(index[x["coordinate"]], x, numbers) for x in _frictions(tree)]
    for name, inside, joints in loads:
        laws += [(index[f"{name}.{x['coordinate']}"], x, inside) for x in _frictions(definitions[name])]
        given = zip(joints, laws_of(definitions[name]), strict=True)
        of_joints = [(a, of_step(joint.get("friction"), step), inside) for a, (joint, step) in given]
        laws += [each for each in of_joints if each[1] is not None]
    for a, law, inside in laws:
        row = {"stribeck": 0, **{field: x for field, x in law.items() if x is not None}}
        fields = [inside.read(row.get(x, row["coulomb"])) for x in ("coulomb", "static", "stribeck", "velocity")]
        # q' of the joint is its slope times that of the coordinate: forces add up, rates are those of the coordinate
        rate, k = abs(bodies.joints[a].slope), index[bodies.joints[a].mover]
        if not _is_still(bodies, definitions, a):
            found = result.array("friction", (n, 4))
            for i, x in enumerate(fields):
                found[k, i] = found.get((k, i), arb(0)) + x * rate if i < 2 else x / rate


def _frictions(document: Plain) -> Iterable[Plain]:
    """The loads of a definition or tree that are friction."""
    return (load for load in document.get("loads", ()) if load["type"] == "friction")


def friction_load(
    result: Outputs,
    bodies: Bodies,
    definitions: Mapping[str, Plain],
    loads: list[tuple[str, Numbers, range]],
) -> None:
    """mu r and mu r_a, of prismatic joints mu and 0, of trees in which a friction has a load."""
    n = len(bodies.joints)
    for name, inside, joints in loads:
        for a, (joint, step) in zip(joints, laws_of(definitions[name]), strict=True):
            law = (of_step(joint.get("friction"), step) or {}).get("load")
            if law is None:
                continue
            mu = inside.read(law["coefficient"])
            arm = arb(1) if bodies.joints[a].prismatic else inside.read(law["radius"])
            result.array("friction_load", (n, 2))[a, 0] = mu * arm
            along = law.get("axial_radius")
            result.array("friction_load", (n, 2))[a, 1] = arb(0) if along is None else mu * inside.read(along)
