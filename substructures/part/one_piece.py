"""A definition derived in one piece on a fixed base: the yardstick for coupling, and the shortest way to formulas."""

from __future__ import annotations

from typing import Any

from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.composite_form import christoffel_block, composites, joint_momentum, metric_column
from substructures.mechanics.kinematics import INTERFACE, base_functions, links
from substructures.mechanics.linear3 import Vector, dot
from substructures.part.definition import Definition
from substructures.part.mechanism import Mechanism, mechanism


def derive_in_one_piece(definition: Definition, gravity: tuple[Any, Any, Any] = (0, 0, 0)) -> Program:
    """Metric, Christoffel symbols and gravity forces of a definition whose base is at rest (notation.md, section 5).

    ``gravity``: acceleration in base axes; numbers or expressions in the definition's parameters.
    Raises InvalidDocument.
    """
    m = mechanism(definition)
    acceleration = m.scope.vector(gravity, "/gravity")
    m.scope.finish()
    return program(m.graph, equations(m, acceleration), m.scope.symbols)


def equations(m: Mechanism, gravity: Vector) -> dict[str, Formulas]:
    """The outputs metric, christoffel and gravity."""
    chain = links(m.joints)
    columns = base_functions(chain)
    carried = composites(m.joints, m.own)
    g: dict[tuple[int, ...], Any] = {}
    gamma: dict[tuple[int, ...], Any] = {}
    gamma_k = {INTERFACE: gravity}
    Q = []
    for c, link in enumerate(chain):
        momentum = joint_momentum(link.s, carried[c])
        g |= {(a, c): x for a, x in metric_column(c, columns[c], momentum).items()}
        # the rotor of joint c turns with q'^c alone
        g[c, c] = g[c, c] + m.laws[c].armature
        gamma |= {(a, b, c): x for (a, b), x in christoffel_block(c, columns[c], momentum).items()}
        # gamma_c = E_c gamma_p,   Q_c = gamma_c . p
        gamma_k[c] = link.rotation.forward(gamma_k[link.parent])
        Q.append(dot(gamma_k[c], momentum.p))
    n = len(chain)
    return {
        "metric": Formulas((n, n), g, "symmetric"),
        "christoffel": Formulas((n, n, n), gamma, "christoffel"),
        "gravity": array((n,), lambda c: Q[c]),
    }
