"""The loads of a part, read: wrenches on bodies, and laws between its frames and on its coordinates (the contract,
section 1).

Springs, bushings and what else acts between parts of the substructure do no work in a motion of the interface: their
generalised forces are complete without a host (:mod:`substructures.part.applied_forces`). Forces and torques act on the
host, too: kept as wrenches (:mod:`substructures.part.wrenches`), as are those between two frames in the axes of the
world.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from substructures.loads.document import Law
from substructures.loads.joint import JointForce
from substructures.part.mechanism import Mechanism
from substructures.part.own_names import OwnNames
from substructures.part.wrenches import AppliedWrench, acts_on_host, read_wrenches


@dataclass
class Loads:
    """All applied loads, read: wrenches, forces on coordinates and all other laws, each in order."""

    wrenches: list[AppliedWrench] = field(default_factory=list)
    joints: list[JointForce] = field(default_factory=list)
    laws: list[Law] = field(default_factory=list)


def read_loads(m: Mechanism) -> Loads:
    """Read the loads; expressions may name parameters, coordinates, velocities (q'), inputs, the time t and measures of
    frames. Friction is a law of the joint (:mod:`substructures.part.mechanism`).
    """
    names, found = OwnNames(m), Loads()
    for i, load in enumerate(m.definition.loads):
        if acts_on_host(load):
            found.wrenches += read_wrenches(names, load, f"/loads/{i}")
            continue
        law = load.law(names, f"/loads/{i}")
        if isinstance(law, JointForce):
            found.joints.append(law)
        elif law is not None:
            found.laws.append(law)
    m.scope.finish()
    return found
