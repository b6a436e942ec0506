"""The mass centre of a tree, and its momentum about it: of all that moves, without what is fixed to the ground.

    m = sum of m_k        r = (sum of m_k r_k + R_k^T s_k) / m        r' = p_a q'^a / m

over the carriers k, whose masses the definitions put where they are (m_k, s_k about the body frame origin r_k, in its
axes), with the linear momenta p_a of unit velocities, in the axes of the world. The centroidal momentum matrix A has
the columns (p_a, L_a - r x p_a), L_a about the world's origin, so that A q' is the momentum and the moment of momentum
about the mass centre.

Source: D. E. Orin, A. Goswami, S.-H. Lee, Centroidal dynamics of a humanoid robot, Autonomous Robots 35, 2013.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import reduce

from substructures.certificate.derived.centroidal import centroidal_outputs
from substructures.errors import InvalidArgument
from substructures.expr.program import Formulas, array
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import ZERO, Scalar, Vector, add, apply, cross, exactly, scale, sub, transpose
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.of_parts import formed
from substructures.quantities.part_models import OfParts
from substructures.tree.assembly import Assembly
from substructures.tree.coupling import OWN, Coupled, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.model_outputs import MOMENTUM, model_outputs, rate_symbols


def centroidal(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> OfParts:
    """The mass centre of a tree of stored parts (by instance name): outputs ``mass_centre_position`` (3,) [m] and
    ``mass_centre_velocity`` (3,) [m/s] in the world, and ``centroidal_momentum_matrix`` (6, n): three rows of momentum,
    then three of moment of momentum; functions of q, q' and free parameters.

    Raises as :func:`.of_parts.formed`, and InvalidArgument where nothing that moves has mass.
    """
    return OfParts(*formed("mass centre", spec, parts, _outputs, centroidal_outputs, max_nodes))


def _outputs(assembly: Assembly) -> tuple[dict[str, Formulas], tuple[str, ...]]:
    coupled = couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity, christoffel=False)
    rates, accelerations = rate_symbols(assembly)
    momenta = model_outputs(assembly, coupled, rates, accelerations, frozenset(MOMENTUM))
    masses = list(_masses(assembly, coupled))
    m: Scalar = sum(m_k for m_k, _ in masses)
    moment = reduce(add, (moment_k for _, moment_k in masses), ZERO)
    if exactly(m, 0):
        raise InvalidArgument.at("/quantities", "no-mass", "nothing that moves has mass: there is no mass centre")
    lift = assembly.scope.graph.lift
    n, own = coupled.ratios.count, [rates[a] for a in coupled.ratios.movers]
    p = [_row(momenta["linear_momentum"], a) for a in range(n)]
    total: list[Scalar] = [sum(p_a[i] * rate for p_a, rate in zip(p, own, strict=True)) for i in range(3)]
    x, y, z = (lift(s) / lift(m) for s in moment)
    r = x, y, z
    columns = dict[tuple[int, ...], Scalar]()
    for a in range(n):
        p_a, L_a = (_row(momenta[name], a) for name in MOMENTUM)
        columns |= {(i, a): x for i, x in enumerate((*p_a, *sub(L_a, cross(r, p_a))))}
    outputs = {
        "centroidal_momentum_matrix": Formulas((6, n), columns),
        "mass_centre_position": array((3,), lambda i: r[i]),
        "mass_centre_velocity": array((3,), lambda i: lift(total[i]) / lift(m)),
    }
    return outputs, ()


def _row(momenta: Formulas, a: int) -> Vector:
    x, y, z = (momenta.entries.get((a, i), 0) for i in range(3))
    return x, y, z


def _masses(assembly: Assembly, coupled: Coupled) -> Iterator[tuple[Scalar, Vector]]:
    """m_k and m_k r_k + R_k^T s_k of every carrier that moves, about the world's origin."""
    run = over_formulas(assembly.scope.graph)
    for m, here in zip(assembly.mounted, coupled.placed, strict=True):
        own = run(m.part, m.bindings, OWN)
        for carrier in (*range(m.part.joint_count), *([INTERFACE] if here.columns[INTERFACE] else [])):
            # about the origin of the joint frame, z = tau e3, and out of its axes
            tau = 0 if carrier == INTERFACE else here.outputs.scalar("tau", carrier)
            mass, pose = own.own_inertia(carrier).shifted((0, 0, tau)), here.pose(carrier)
            yield mass.m, add(scale(mass.m, pose.r), apply(transpose(pose.R), mass.s))
