"""A definition derived in one piece on a fixed base: the yardstick for coupling, and the shortest way to formulas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.composite_form import JointMomentum, composites, joint_momentum
from substructures.mechanics.kinematics import INTERFACE, Link, base_functions, links
from substructures.mechanics.linear3 import Vector
from substructures.mechanics.parallel_axes import ByAngles, absolute
from substructures.part.definition import Definition
from substructures.part.formulas import own_dynamics, parallel_axes
from substructures.part.mechanism import Mechanism, mechanism
from substructures.part.relations import of_coordinates


def derive_in_one_piece(definition: Definition, gravity: tuple[Any, Any, Any] = (0, 0, 0)) -> Program:
    """Metric, Christoffel symbols and gravity forces of a definition whose base is at rest (notation.md, section 5).

    ``gravity``: acceleration in base axes; numbers or expressions in the definition's parameters.
    Raises InvalidDocument.
    """
    m = mechanism(definition)
    acceleration = m.scope.vector(gravity, "/gravity")
    m.scope.finish()
    return program(m.graph, equations(m, acceleration), m.scope.symbols)


def metric_in_one_piece(definition: Definition) -> Program:
    """The output metric alone, of a definition without relations whose base is at rest. Raises InvalidDocument."""
    m = mechanism(definition)
    chain = links(m.joints)
    outputs = own_dynamics(m, chain, base_functions(chain), _momenta(m, chain), ByAngles(), large=True)
    return program(m.graph, outputs, m.scope.symbols)


def equations(m: Mechanism, gravity: Vector) -> dict[str, Formulas]:
    """The outputs metric, christoffel and gravity; ``gravity``: acceleration in base axes, expressions."""
    chain = links(m.joints)
    # every joint hangs on the one base, in whose axes gravity is given
    before = dict.fromkeys(range(len(chain)), gravity)
    by_angles = parallel_axes(chain, m.own).by_angles(absolute(chain), True, before)
    momenta = _momenta(m, chain)
    outputs = own_dynamics(m, chain, base_functions(chain), momenta, by_angles)
    gamma = {INTERFACE: gravity}
    for c, link in enumerate(chain):
        gamma[c] = link.rotation.forward(gamma[link.parent])
    Q = by_angles.gravity([gamma[c] for c in range(len(chain))], momenta)
    return of_coordinates(outputs | {"gravity": array((len(chain),), lambda c: Q[c])}, m.ratios)


def _momenta(m: Mechanism, chain: Sequence[Link]) -> list[JointMomentum]:
    carried = composites(m.joints, m.own)
    return [joint_momentum(link.s, carried[c]) for c, link in enumerate(chain)]
