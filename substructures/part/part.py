"""A substructure with its derived formulas: what the library stores and what coupling works from."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from substructures.certificate.agreement import not_judged, told_figures
from substructures.documents import write_json
from substructures.errors import listed
from substructures.expr.operations import Output
from substructures.expr.program import Program
from substructures.mechanics.state_names import inertia_names
from substructures.part.definition import Definition
from substructures.part.forces.wrenches import dead_loads, steady_loads, wrench_places
from substructures.part.parameters import described
from substructures.part.relations import MULTIPLIER, OF_COORDINATES, OFFSET
from substructures.part.shape import shape_of
from substructures.part.topology import BASE, Topology, topology

#: outputs that are bookkeeping for coupling rather than formulas to read
INTERNAL = frozenset(("E.tilt", "E.turn", "E.full", "frame.E", "frame.position", "load.at", "load.vector"))

#: most operations of a program by default
MAX_NODES = 1_000_000


@dataclass(frozen=True)
class Formula:
    """An addressable formula of the store: one vector, tensor or scalar of a quantity."""

    quantity: str
    output: str
    body: str | None
    coordinate: str | None
    index: tuple[int, ...]
    shape: tuple[int, ...]
    symmetry: str
    operations: int


@dataclass(frozen=True)
class Part:
    """A definition, the program of its formulas (see :mod:`substructures.part.formulas`) and the certificate."""

    definition: Definition
    program: Program
    certificate: Mapping[str, Any] = field(hash=False)

    def __repr__(self) -> str:
        """Two lines: what it is, and what its formulas take and how well they agree with the direct form."""
        what = f"{self.dof} coordinates ({self.joints or 'none'}): {listed(self.coordinates) or 'none'}"
        places = f"bodies {listed(self.bodies) or 'none'}; ports {listed(self.ports) or 'none'}"
        figures = told_figures(self.operations, self.certificate)
        return f"Part '{self.name}', {what}; {places}\n{figures}"

    @classmethod
    def load(cls, definition: Definition, program_bytes: bytes, certificate: Mapping[str, Any]) -> Part:
        """A stored part. Raises InvalidProgram when the bytes are damaged."""
        return cls(definition, Program.from_bytes(program_bytes).marked(not_judged(certificate)), certificate)

    @cached_property
    def topology(self) -> Topology:
        """Names and topology."""
        return topology(self.definition)

    @cached_property
    def shape(self) -> str:
        """The digest of all that formulas of trees take of it: its shape (:mod:`substructures.part.shape`), its program
        and which of its outputs could not be judged.
        """
        given = [shape_of(self.definition), self.program.digest, sorted(self.program.not_judged)]
        return hashlib.sha256(write_json(given)).hexdigest()

    @property
    def name(self) -> str:
        """Name in the library."""
        return self.definition.name

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.topology.movers)

    @property
    def joint_count(self) -> int:
        """Number of joints of one degree of freedom, those among them that relations move."""
        return len(self.topology.joints)

    @property
    def has_christoffel(self) -> bool:
        """Whether formulas of its Christoffel symbols are stored; not of a large part."""
        return "christoffel" in self.program.outputs

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinate names."""
        return self.topology.coordinates

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies, the interface frame ``base`` not included."""
        return tuple(name for name in self.topology.carrier if name != BASE)

    @property
    def joints(self) -> str:
        """'R' or 'P' for every coordinate."""
        return self.topology.kinds

    @property
    def ports(self) -> tuple[str, ...]:
        """Names of the ports."""
        return tuple(port.name for port in self.definition.ports)

    @property
    def frames(self) -> tuple[str, ...]:
        """All frames something can be mounted on, in the order of the outputs ``frame.*``: bodies, then ports."""
        return (*self.topology.carrier, *self.ports)

    @cached_property
    def frame_carriers(self) -> tuple[int, ...]:
        """The carrier of every frame."""
        carrier = self.topology.carrier
        return (*carrier.values(), *(carrier[port.body] for port in self.definition.ports))

    @cached_property
    def wrenches(self) -> tuple[tuple[int, bool, bool], ...]:
        """(carrier, is a moment, in world axes) of every force and torque load."""
        return wrench_places(self.definition, self.topology.carrier)

    @cached_property
    def steady_loads(self) -> tuple[bool, ...]:
        """Of every force and torque, whether it may have a potential that is to be found."""
        return steady_loads(self.definition, [joint.coordinate for joint in self.topology.joints])

    @cached_property
    def dead_loads(self) -> tuple[bool, ...]:
        """Whether each of them is a force that is constant in the world, which has a potential."""
        return dead_loads(self.definition)

    @cached_property
    def inertia_symbols(self) -> dict[int, tuple[str, ...]]:
        """The ten inertia symbols of every carrier that has them."""
        names = self.topology.body_of.items()
        return {k: tuple(symbol for symbol, _ in inertia_names(body)) for k, body in names}

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """Parameters with default value and unit in SI, description, and what was ``given`` in another unit."""
        return described(self.definition.parameters)

    @cached_property
    def operations(self) -> dict[str, int]:
        """Additions, multiplications and divisions of every quantity, and of the whole program."""
        counts = {name: n for name, n in self.program.totals().items() if name not in INTERNAL}
        return counts | {"total": self.program.count()["total"]}

    def formulas(self) -> list[Formula]:
        """The index of the store: every formula with its place, shape and operation count."""
        groups = {
            (name, lead): entries
            for name, output in self.program.outputs.items()
            if name not in INTERNAL
            for lead, entries in _grouped(output, len(self.axes_of(name))).items()
        }
        counts = self.program.totals_of(list(groups.values()))
        return [self._formula(*place, count) for place, count in zip(groups, counts, strict=True)]

    def labels(self, axis: str) -> tuple[str, ...]:
        """What the indices along an axis of :meth:`axes_of` mean: bodies that joints carry, ports, coordinates."""
        return self._labels.get(axis, ())

    @cached_property
    def _labels(self) -> dict[str, tuple[str, ...]]:
        movers = tuple(self._joint_bodies[a] for a in self.topology.movers)
        return {"joint": self._joint_bodies, "mover": movers, "port": self.ports, "coordinate": self.coordinates}

    def axes_of(self, name: str) -> tuple[str, ...]:
        """What the leading axes of an output are; ``mover``: joints that have a coordinate, where others move along."""
        axes, of = LEADING.get(name, ()), OF_COORDINATES.get(name, ()) if self.topology.is_related else ()
        return tuple("mover" if axis == "joint" and i in of else axis for i, axis in enumerate(axes))

    def _formula(self, name: str, lead: tuple[int, ...], count: int) -> Formula:
        """Leading axes are joints, coordinates or ports; a formula is what remains for one such index."""
        output, axes = self.program.outputs[name], self.axes_of(name)
        found = {axis: self.labels(axis)[k] for axis, k in zip(axes, lead, strict=True) if self.labels(axis)}
        body = next((found[axis] for axis in ("joint", "mover", "port") if axis in found), None)
        coordinate = found.get("coordinate")
        shape = output.shape[len(axes) :]
        return Formula(name.split(".")[0], name, body, coordinate, lead, shape, output.symmetry, count)

    @cached_property
    def _joint_bodies(self) -> tuple[str, ...]:
        """For every joint the body it carries (the next named one for the links inside a compound joint)."""
        return tuple(self.definition.bodies[j.body].name for j in self.topology.joints)


#: what the leading axes of an output mean; the remaining axes are components (or coordinate indices) of one formula
LEADING: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("E", "Z", "tau", "R", "r", "f", "n", "K", "applied", "armature"), ("joint",)),
    **dict.fromkeys((MULTIPLIER, OFFSET), ("joint",)),
    **dict.fromkeys(("subtree.m", "subtree.s", "subtree.J", "inertia.m", "inertia.s", "inertia.J"), ("joint",)),
    **dict.fromkeys(("U", "Omega"), ("joint", "coordinate")),
    **dict.fromkeys(("kappa", "F", "N"), ("coordinate", "joint")),
    **dict.fromkeys(("port.R", "port.r"), ("port",)),
    **dict.fromkeys(("port.U", "port.Omega"), ("port", "coordinate")),
    "metric": ("coordinate", "b"),
    "christoffel": ("coordinate", "b", "c"),
}
#: those of all frames, of which each has an output of its own
OF_FRAMES = dict.fromkeys(("frame.E", "frame.position"), ("frame",))


def _grouped(output: Output, axes: int) -> dict[tuple[int, ...], list[int]]:
    """The entries of an output by their index along the leading axes."""
    groups: dict[tuple[int, ...], list[int]] = {}
    for index, entry in zip(output.index, output.entries, strict=True):
        groups.setdefault(index[:axes], []).append(entry)
    return groups
