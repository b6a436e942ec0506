"""The mass centre of what moves and the momentum about it, from the masses that documents put on every carrier."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb

from substructures.certificate.bodies import GROUND, massless
from substructures.certificate.by_coordinate import of_coordinates, rates
from substructures.certificate.dynamics import carried_by_joints, motions
from substructures.certificate.linear import Ball, cross, zeros
from substructures.certificate.numbers import Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.tree_outputs import built


def centroidal_outputs(
    tree: Plain, definitions: Mapping[str, Plain], _: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """Position r = s / m, and velocity: the momentum of all bodies, int v dm, over their mass; momentum matrix: columns
    int u_a dm and int (x - r) x u_a dm of all that joint a carries.
    """
    bodies = built(tree, definitions, values)[1]
    moving, total, momentum = motions(bodies, rates(bodies, values, "'")), massless(), zeros(3, 1)
    for carrier, mass in bodies.own.items():
        if carrier != GROUND:
            motion = moving[carrier]
            # int (v + w x x) dm = m v + w x s
            total, momentum = total + mass, momentum + motion.v * mass.m + cross(motion.w, mass.s)
    result = Outputs()
    result.matrix("mass_centre_position", (3,), (), total.s * (arb(1) / total.m))
    result.matrix("mass_centre_velocity", (3,), (), momentum * (arb(1) / total.m))
    n, r = len(bodies.joints), total.s * (arb(1) / total.m)
    for a, each in enumerate(carried_by_joints(bodies, bodies.own)):
        # int (x - r) x u dm = int x x u dm - r x int u dm
        column = [*each.f.entries(), *(each.n - cross(r, each.f)).entries()]
        result.array("centroidal_momentum_matrix", (6, n)).update({(i, a): x for i, x in enumerate(column)})
    return of_coordinates(result, bodies)
