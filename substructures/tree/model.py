"""The coupled model of a tree: one program of :mod:`substructures.tree.model_outputs`, and its certificate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from time import perf_counter
from typing import Any

from substructures.errors import Fault, InvalidDocument, TooLarge, VerificationFailed, listed
from substructures.expr.garbage import without_collections
from substructures.expr.hoist import hoisted
from substructures.expr.program import Formulas, Program, program
from substructures.expr.syntax import RESERVED
from substructures.part.certificate import not_judged, told_agreement
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part, recheck, told_operations
from substructures.part.topology import MOST_CHRISTOFFEL, entries_of, expected_operations
from substructures.tree.assembly import Assembly, assemble, division_by_zero, joint_parents
from substructures.tree.certificate import certified, seconds_of
from substructures.tree.closures import ClosureRows, Reduction, reduction_of
from substructures.tree.coupling import Coupled, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.grouping import every, numbers
from substructures.tree.load_potentials import found_potential
from substructures.tree.loads import load_formulas
from substructures.tree.model_outputs import model_outputs, rate_symbols
from substructures.tree.plausibility import Plausibility
from substructures.tree.shape import CertifiedProgram, KnownShapes, shape_digest
from substructures.tree.units import check_tree_units, tree_warnings
from substructures.tree.velocity_forces import least_forces

EFFORTS = {"R": "N m", "P": "N"}


@dataclass(frozen=True)
class Model:
    """A coupled tree. ``frames``: names of bodies and ports in the order of the kinematic outputs; ``closures``: what
    the rows of the closure outputs are, ``reduction``: in which coordinates it moves; ``parameters``, ``inputs`` (of
    loads): all that are declared and not bound, used or not; ``limited``: the coordinates that have limits;
    ``plausibility``: of values, unknown of a model out of a store."""

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    frames: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    certificate: Mapping[str, Any] = field(hash=False)
    closures: tuple[ClosureRows, ...] = ()
    inputs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, hash=False)
    limited: tuple[str, ...] = ()
    plausibility: Plausibility | None = field(default=None, compare=False, repr=False)
    reduction: Reduction = field(default=Reduction(), hash=False)

    def __repr__(self) -> str:
        """Two lines: what it is, and what its formulas take and how well they agree with the direct form."""
        loops = f"; closures {listed(rows.name for rows in self.closures)}" if self.closures else ""
        what = f"{self.dof} coordinates ({self.joints or 'none'}): {listed(self.coordinates) or 'none'}{loops}"
        return f"Model, {what}\n{told_operations(self.operations)}; {told_agreement(self.certificate)}"

    @cached_property
    def operations(self) -> dict[str, int]:
        """Arithmetic operations of every output alone; ``total``: of metric, christoffel and forces together."""
        together = [name for name in ("metric", "christoffel", "forces") if name in self.program.outputs]
        return self.program.totals() | {"total": self.program.count(together)["total"]}

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def units(self) -> dict[str, str]:
        """The SI units of parameters and inputs by name; empty where none was given."""
        efforts = {f"tau.{name}": EFFORTS[kind] for name, kind in zip(self.coordinates, self.joints, strict=True)}
        declared = {**self.parameters, **self.inputs}
        return {name: str(given.get("unit", "")) for name, given in declared.items()} | efforts

    @cached_property
    def state_units(self) -> dict[str, dict[str, str]]:
        """The SI units of coordinates, velocities and accelerations, by the fields q, qd, qdd and coordinate."""
        rates = {"q": ("rad", "m"), "qd": ("rad/s", "m/s"), "qdd": ("rad/s^2", "m/s^2")}
        pairs = [(name, kind == "P") for name, kind in zip(self.coordinates, self.joints, strict=True)]
        return {field: {name: units[is_slide] for name, is_slide in pairs} for field, units in rates.items()}

    @cached_property
    def effective(self) -> frozenset[str]:
        """The symbols that the formulas depend on."""
        return frozenset(s.name for s in self.program.symbols)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """All inputs: those in the formulas in the order of the program's symbols, then those without effect."""
        named = [s.name for s in self.program.symbols if s.kind == "input"]
        return tuple(dict.fromkeys([*named, *self.inputs, *(f"tau.{name}" for name in self.coordinates)]))

    def described(self) -> dict[str, Any]:
        """What the axes of the outputs are, as plain data."""
        closures: dict[str, Any] = {"closures": [rows.plain() for rows in self.closures]} if self.closures else {}
        closures |= {"reduction": self.reduction.plain()} if self.reduction else {}
        return closures | {
            "coordinates": list(self.coordinates),
            "joints": self.joints,
            "frames": list(self.frames),
            "limited": list(self.limited),
        }

    def summary(self) -> dict[str, Any]:
        """Plain data that is stored beside the program."""
        return self.described() | {
            "parameters": {name: dict(p) for name, p in self.parameters.items()},
            "inputs": {name: dict(given) for name, given in self.inputs.items()},
            "certificate": dict(self.certificate),
            "operations": self.operations,
        }

    @classmethod
    def load(cls, summary: Mapping[str, Any], program_bytes: bytes) -> Model:
        """A stored model. Raises InvalidProgram when the bytes are damaged."""
        names = (tuple(summary["coordinates"]), str(summary["joints"]), tuple(summary["frames"]))
        described = (summary["parameters"], summary["certificate"])
        closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
        inputs, limited = summary.get("inputs", {}), tuple(summary.get("limited", ()))
        program = Program.from_bytes(program_bytes).marked(not_judged(summary["certificate"]))
        reduction = Reduction.read(summary["reduction"]) if summary.get("reduction") else Reduction()
        return cls(program, *names, *described, closures, inputs, limited, reduction=reduction)


def require_stored(program: Program, names: Iterable[str]) -> None:
    """Raises InvalidDocument (``not-stored``) for outputs that a model of many coordinates does not have."""
    missing = [name for name in names if name not in program.outputs]
    if missing:
        message = (
            f"of more than {MOST_CHRISTOFFEL:,} Christoffel symbols no formulas are stored, so there is no "
            f"{listed(missing)}, but in numbers by an evaluation of a stored tree; velocity forces are found without "
            "them (bias, inverse_dynamics, forward_dynamics)"
        )
        raise InvalidDocument.at("", "not-stored", message)


def require_open(closures: Sequence[ClosureRows], instead: str) -> None:
    """Raises InvalidDocument (``has-closures``) where closed loops would be ignored; ``instead``: what takes them."""
    if closures:
        names = ", ".join(f"'{rows.name}'" for rows in closures)
        message = (
            f"the closures {names} make the coordinates depend on each other, which is not taken into account here: "
            f"{instead}, or leave the closures out"
        )
        raise InvalidDocument.at("", "has-closures", message)


@without_collections
def couple(
    spec: TreeSpec | Mapping[str, Any],
    parts: Mapping[str, Part],
    max_nodes: int = MAX_NODES,
    admit: Callable[[int], None] | None = None,
    group: bool = False,
    known: KnownShapes | None = None,
) -> Model:
    """Couple stored parts (by instance name) to a model and verify it. ``spec``: the tree, or its document.

    >>> from substructures import couple, derive
    >>> tree = {"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
    >>> couple(tree, {"p": derive("simple-pendulum")}).coordinates
    ('p.q1',)

    ``group``: base parameters also of masses, lengths and inertias that are symbols, not only of numbers: fewer
    operations for each state, more for the parameters (:mod:`substructures.tree.grouping`).

    ``admit`` is told how many operations to expect before the work begins, and may raise instead. ``known``: shapes
    that were coupled and certified before; a tree of one of them has its program and certificate, and its own warnings.
    Raises InvalidDocument with pointers into the tree document, TooLarge for more than ``max_nodes`` operations, and
    VerificationFailed, which names the part whose stored formulas are wrong.
    """
    start = perf_counter()
    spec = spec if isinstance(spec, TreeSpec) else TreeSpec.read(spec)
    _require_free_names(spec)
    assembly = assemble(spec, parts)
    definitions = {name: part.definition for name, part in parts.items()}
    units = check_tree_units(spec, {name: part.parameters for name, part in parts.items()}, definitions)
    units.require()
    joints_of = joint_parents(assembly.mounted)
    entries = entries_of(joints_of)
    entries.require("the tree")
    if admit is not None:
        admit(expected_operations(joints_of))
    shape = "" if known is None else shape_digest(spec, parts, group)
    found = None if known is None else known.get(shape)
    christoffel = not entries.is_large
    result = _limited(found.program, max_nodes) if found else _formulas(spec, assembly, christoffel, group, max_nodes)
    seconds = perf_counter() - start
    plausibility = Plausibility(spec, definitions)
    model = _model(assembly, result, plausibility)
    is_shared, start = False, perf_counter()
    if found is None:
        try:
            certificate, is_shared = certified(spec, definitions, model.described(), result)
        except VerificationFailed as error:
            raise _blamed(parts, error) from None
        found = CertifiedProgram(result.marked(not_judged(certificate)), certificate, tuple(assembly.scope.notices))
    if known is not None and is_shared:
        known.put(shape, found)
    told = [*units.warnings, *found.notices, *tree_warnings(spec, parts, result, model.coordinates)]
    warnings = {"warnings": [*told, *plausibility.at_defaults], "converted": units.converted}
    taken = {"seconds": seconds_of(seconds, perf_counter() - start)}
    return replace(model, program=found.program, certificate={**found.certificate, **taken, **warnings})


def couple_formulas(
    spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES, christoffel: bool = True
) -> Model:
    """The model of :func:`couple` with the fewest operations for each state, and without a certificate: for numbers of
    many parameter sets, some of which are compared with those of models that have one. Raises as :func:`couple`.
    """
    assembly = assemble(spec, parts)
    entries = entries_of(joint_parents(assembly.mounted))
    entries.require("the tree")
    result = _formulas(spec, assembly, christoffel and not entries.is_large, True, max_nodes)
    return _model(assembly, result, Plausibility(spec, {name: part.definition for name, part in parts.items()}))


def _model(assembly: Assembly, result: Program, plausibility: Plausibility) -> Model:
    """The model of an assembly, without a certificate."""
    names, joints = _coordinate_names(assembly), "".join(m.part.joints for m in assembly.mounted)
    rows = tuple(cut.rows for cut in assembly.cuts)
    moving = [
        f"{i.name}.{x.coordinate}"
        for i, m in zip(assembly.instances, assembly.mounted, strict=True)
        for x in m.part.topology.joints
    ]
    limited = tuple(moving[a] for a in sorted(assembly.limits))
    names_of = (names, joints, _frame_names(assembly))
    reduction = reduction_of(assembly.instances, assembly.mounted, bool(assembly.reading.spec.closures))
    parameters, inputs = assembly.parameters, assembly.inputs
    return Model(result, *names_of, parameters, {}, rows, inputs, limited, plausibility, reduction)


def _formulas(spec: TreeSpec, assembly: Assembly, christoffel: bool, group: bool, max_nodes: int) -> Program:
    """All outputs of a tree; ``christoffel``: with the Christoffel symbols."""
    graph, names = assembly.scope.graph, _coordinate_names(assembly)
    admitted = every if group else numbers
    try:
        coupled = couple_parts(over_formulas(graph), assembly.mounted, assembly.gravity, christoffel, group=admitted)
        coupled = replace(coupled, potential=coupled.potential + found_potential(graph, coupled.placed, names))
        result = hoisted(program(graph, loaded_outputs(assembly, coupled), assembly.scope.symbols))
    except ZeroDivisionError:
        raise division_by_zero(spec, assembly) from None
    return _limited(result, max_nodes)


def _limited(result: Program, max_nodes: int) -> Program:
    """The program. Raises TooLarge for more than so many operations."""
    if len(result) > max_nodes:
        raise TooLarge("the program of the tree (in operations)", len(result), max_nodes)
    return result


def loaded_outputs(assembly: Assembly, coupled: Coupled, names: frozenset[str] | None = None) -> dict[str, Formulas]:
    """The outputs of coupled parts on which the loads of the tree act; ``names``: those that are wanted, and more."""
    rates, accelerations = rate_symbols(assembly)
    if assembly.reading.spec.loads:
        acting = load_formulas(assembly, coupled.placed, rates)
        coupled = coupled.with_loads(acting.forces, acting.potential)
    least = partial(least_forces, assembly.scope, coupled, rates)
    return model_outputs(assembly, coupled, rates, accelerations, names, least)


def _blamed(parts: Mapping[str, Part], error: VerificationFailed) -> VerificationFailed:
    """The failure of a part whose stored formulas are wrong, by name; that of the tree where all parts are right."""
    for instance, part in parts.items():
        try:
            recheck(part)
        except VerificationFailed as fault:
            what = f"the stored formulas of '{part.name}' ({part.program.digest}, instance '{instance}') are wrong"
            return VerificationFailed(f"{what}: {fault}")
    return error


def _require_free_names(spec: TreeSpec) -> None:
    """Raises InvalidDocument for parameters whose name means something else: t is the time, pi a number."""
    faults = [
        Fault(f"/parameters/{name}", "reserved-name", f"'{name}' has a fixed meaning in expressions")
        for name in spec.parameters
        if name in RESERVED
    ]
    if faults:
        raise InvalidDocument(faults)


def _coordinate_names(assembly: Assembly) -> tuple[str, ...]:
    pairs = zip(assembly.instances, assembly.mounted, strict=True)
    return tuple(f"{instance.name}.{coordinate}" for instance, m in pairs for coordinate in m.part.coordinates)


def _frame_names(assembly: Assembly) -> tuple[str, ...]:
    pairs = zip(assembly.instances, assembly.mounted, strict=True)
    return tuple(f"{instance.name}.{frame}" for instance, m in pairs for frame in m.part.frames)
