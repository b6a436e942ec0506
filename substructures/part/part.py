"""A substructure with its derived formulas: what the library stores and what coupling works from."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cached_property
from time import perf_counter
from typing import Any

from substructures.catalogue import load, names
from substructures.documents import write_json
from substructures.errors import InvalidArgument, InvalidDocument, TooLarge, among, listed
from substructures.expr.garbage import without_collections
from substructures.expr.operations import Output
from substructures.expr.program import Formulas, Program, program
from substructures.expr.units.unit_check import UnitCheck
from substructures.part.applied_forces import read_loads
from substructures.part.certificate import certify_part, not_judged, require_no_less, told_agreement
from substructures.part.definition import Definition
from substructures.part.formulas import Coupled, formulas
from substructures.part.inertia_symbols import inertia_names
from substructures.part.mechanism import Mechanism, mechanism
from substructures.part.parameters import described, uncounted, without_effect
from substructures.part.poses import require_closures, require_poses, require_reduction
from substructures.part.relations import (
    MULTIPLIER,
    OF_COORDINATES,
    OFFSET,
    left_out_warnings,
    require_relations,
    weightless_warnings,
)
from substructures.part.shape import shape_of
from substructures.part.topology import BASE, Entries, Topology, entries_of, expected_operations, topology
from substructures.part.units import check_units
from substructures.part.wrenches import dead_loads, steady_loads, wrench_places

#: outputs that are bookkeeping for coupling rather than formulas to read
INTERNAL = frozenset(("E.tilt", "E.turn", "E.full", "frame.E", "frame.position", "load.at", "load.vector"))

#: most operations of a program by default
MAX_NODES = 1_000_000
PROGRAM = "the program of the substructure (in operations)"


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
        figures = f"{told_operations(self.operations)}; {told_agreement(self.certificate)}"
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


@without_collections
def derive(
    definition: Definition | Mapping[str, Any] | str,
    max_nodes: int = MAX_NODES,
    admit: Callable[[int], None] | None = None,
    coupled: Callable[[Mechanism, bool], Coupled] | None = None,
    is_stored: bool = False,
) -> Part:
    """Derive, verify and certify the formulas of a substructure.

    ``definition``: what it is, as a document that was read or one of plain data, or the name of an entry of the shipped
    catalogue.

    >>> from substructures import derive
    >>> derive("simple-pendulum").coordinates
    ('q1',)

    ``admit`` is told how many operations to expect before the work begins, and may raise instead. ``coupled``: what is
    known of a part that was coupled of others, given how it is read and whether it is large. ``is_stored``: the
    definition was accepted once, so that contradictions of its units, which were texts in older versions, are warnings.
    Raises InvalidDocument (faults with pointers), or TooLarge for more than ``max_nodes`` operations.
    """
    start = perf_counter()
    definition = _read(definition)
    m, units, result = _derived(definition, max_nodes, admit, coupled, is_stored)
    certificate = _certificate(m, result, units, perf_counter() - start)
    # after the certificate, which adds formulas of masses; the program holds operations, no nodes
    m.graph.release()
    return Part(definition, result.marked(not_judged(certificate)), certificate)


def _read(given: Definition | Mapping[str, Any] | str) -> Definition:
    """The definition. Raises InvalidInput, also for an entry that the catalogue does not have."""
    if isinstance(given, Definition):
        return given
    if isinstance(given, str):
        if given not in names():
            message = f"no catalogue entry '{given[:80]}'{among(given, names())}"
            raise InvalidArgument.at("/definition", "unknown-entry", message)
        given = load(given)
    return Definition.read(given)


@without_collections
def draft(definition: Definition, max_nodes: int = MAX_NODES, admit: Callable[[int], None] | None = None) -> Part:
    """The formulas of a substructure to look at, not to keep: nothing of them is verified. Raises as :func:`derive`."""
    return Part(definition, _derived(definition, max_nodes, admit)[2], {})


def _derived(
    definition: Definition,
    max_nodes: int,
    admit: Callable[[int], None] | None,
    coupled: Callable[[Mechanism, bool], Coupled] | None = None,
    is_stored: bool = False,
) -> tuple[Mechanism, UnitCheck, Program]:
    m, units, entries = _opened(definition, is_stored)
    if admit is not None:
        # before anything is derived, so that who admits can refuse in time
        admit(expected_operations([(j.parent, j.s) for j in m.topology.joints]))
    known = None if coupled is None else lambda: coupled(m, entries.is_large)
    outputs = _formulas(m, entries.is_large, known)
    result = program(m.graph, outputs, m.scope.symbols)
    if len(result) > max_nodes:
        raise TooLarge(PROGRAM, len(result), max_nodes)
    return m, units, result


def _opened(definition: Definition, is_stored: bool) -> tuple[Mechanism, UnitCheck, Entries]:
    m = mechanism(definition)
    require_relations(definition, m.topology.coordinates)
    require_poses(definition, m.topology)
    require_closures(definition, m.scope, [*m.bodies, *m.ports])
    require_reduction(definition, m.topology.coordinates)
    units = check_units(definition, m.topology)
    if not is_stored:
        units.require()
    # a definition of 500 bodies may have millions: refused before any work is done
    entries = entries_of([(j.parent, j.s) for j in m.topology.joints])
    entries.require("the mechanism")
    return m, units, entries


def _formulas(m: Mechanism, large: bool, coupled: Callable[[], Coupled] | None = None) -> dict[str, Formulas]:
    loads = read_loads(m)
    try:
        return formulas(m, loads, large, None if coupled is None else coupled())
    except ZeroDivisionError:
        raise InvalidDocument.at("", "division-by-zero", "a formula divides by zero") from None


def _certificate(m: Mechanism, result: Program, units: UnitCheck, seconds: float) -> dict[str, Any]:
    """What was checked, with all warnings about the definition and what of it was converted to SI."""
    certificate = certify_part(m, result, seconds)
    unused = without_effect(m.definition, {symbol.name for symbol in result.symbols})
    # contradictions in what was stored when units were texts; new definitions were refused
    old = [asdict(fault) for fault in units.faults]
    warnings = [*certificate["warnings"], *units.warnings, *old, *unused, *m.scope.notices]
    warnings += [*left_out_warnings(m.definition), *weightless_warnings(result, m.topology.coordinates)]
    return certificate | {"warnings": warnings, "converted": units.converted}


def recheck(part: Part) -> dict[str, Any]:
    """The certificate of a stored part made anew, of the program as it is stored.

    Raises VerificationFailed when the program disagrees with the definition, or when less can be said of it than the
    stored certificate says, InvalidDocument as :func:`derive`.
    """
    m = mechanism(part.definition)
    m.scope.symbols.update({symbol.name: symbol for symbol in part.program.symbols})
    certificate = _certificate(m, part.program, check_units(m.definition, m.topology), 0.0)
    require_no_less(part.certificate, certificate)
    return certificate | {"warnings": [*certificate["warnings"], *uncounted(part.parameters)]}


def told_operations(operations: Mapping[str, int]) -> str:
    """How much metric and Christoffel symbols take, in words."""
    counts = (f"{name} {operations.get(name, 'not stored')}" for name in ("metric", "christoffel"))
    return f"operations: {', '.join(counts)}"
