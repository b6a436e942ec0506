"""The generalised forces of a part one by one: of every joint's own law, and of every load of its definition.

A stored part has their sum alone (output ``applied``), so that they are formed again from the definition: each load is
read as if it were the only one. Forces and torques on bodies do work with a host, too; they are the wrenches that are
stored one by one (``load.at``, ``load.vector``), and not among these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from substructures.expr.graph import Expr
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.loads.document import Load
from substructures.loads.friction import FrictionLoad
from substructures.mechanics.kinematics import base_functions, links
from substructures.part.definition import Definition
from substructures.part.forces.applied_forces import applied_forces, read_loads
from substructures.part.forces.joint_laws import JointLaw
from substructures.part.forces.wrenches import wrench_places
from substructures.part.kinematics import Kinematics, kinematics
from substructures.part.mechanism import Mechanism, mechanism


def load_forces(definition: Definition) -> Program:
    """Q_a [N m, N] of a definition that is known to be right, by joint: outputs ``joint`` (n,), of the joints' own laws
    without their actuators, and ``load`` (loads, n).
    """
    m = mechanism(definition)
    chain = links(m.joints)
    k = kinematics(chain, base_functions(chain))
    zero = m.graph.zero
    still = tuple(JointLaw(zero, zero, zero, law.armature, (0, 0)) for law in m.laws)
    # friction that is a load is in the laws of the joints
    rubbed = {load.coordinate for load in definition.loads if isinstance(load, FrictionLoad)}
    names = [joint.coordinate for joint in m.topology.joints]
    own = [replace(law, friction=None) if name in rubbed else law for name, law in zip(names, m.laws, strict=True)]
    joints = _forces(replace(_with_loads(m, ()), laws=tuple(own)), k)

    def laws(load: Load) -> tuple[JointLaw, ...]:
        """Those with a load alone."""
        if not isinstance(load, FrictionLoad):
            return still
        # in the sum it is a law of its joint, which alone has one here
        of = names.index(load.coordinate)
        return (*still[:of], replace(still[of], friction=m.laws[of].friction), *still[of + 1 :])

    loads = [_forces(replace(_with_loads(m, (load,)), laws=laws(load)), k) for load in definition.loads]
    n = len(m.joints)
    outputs = {
        "joint": array((n,), lambda a: joints[a]),
        "load": array((len(loads), n), lambda i, a: loads[i][a]),
    }
    found = program(m.graph, outputs, m.scope.symbols)
    return _without_actuators(m, found)


def wrench_counts(definition: Definition, carrier: dict[str, int]) -> Iterator[int]:
    """How many of the stored wrenches belong to each load; ``carrier``: of the bodies by name."""
    for load in definition.loads:
        yield len(wrench_places(definition.model_copy(update={"loads": (load,)}), carrier))


def _with_loads(m: Mechanism, loads: tuple[object, ...]) -> Mechanism:
    return replace(m, definition=m.definition.model_copy(update={"loads": loads}))


def _forces(m: Mechanism, k: Kinematics) -> list[Expr]:
    return applied_forces(m, read_loads(m), k)[0]


def _without_actuators(m: Mechanism, found: Program) -> Program:
    """The same with no effort of the actuators, which are added to all."""
    still = {f"tau.{name}": m.graph.zero for name in m.topology.coordinates}
    return program(m.graph, replay(found, m.graph, still), m.scope.symbols)
