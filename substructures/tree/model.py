"""The coupled model of a tree: one program of :mod:`substructures.tree.model_outputs`, and its certificate."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, partial
from time import perf_counter
from typing import Any

from substructures.errors import VerificationFailed, listed
from substructures.expr.garbage import without_collections
from substructures.expr.hoist import hoisted
from substructures.expr.program import Formulas, Program, program
from substructures.mechanics.state_names import ball_rows, effort_units, positions_of, state_units
from substructures.part.certificate import not_judged, told_agreement
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part, told_operations
from substructures.part.topology import entries_of, expected_operations
from substructures.tree.assembly import Assembly, assemble, division_by_zero, joint_parents
from substructures.tree.certificate import blamed, certified, seconds_of
from substructures.tree.closures import ClosureRows, Reduction, reduction_of
from substructures.tree.coupling import Coupled, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.given.driven import all_coordinates, driven_inputs, driven_names, every_coordinate, put_in
from substructures.tree.given.ignored import ignore, ignored_names
from substructures.tree.given.reduced import instances_of
from substructures.tree.grouping import Admitted, every, numbers_and
from substructures.tree.load_potentials import found_potential
from substructures.tree.loads import load_formulas
from substructures.tree.model_outputs import model_outputs, rate_symbols
from substructures.tree.plausibility import Plausibility
from substructures.tree.shape import CertifiedProgram, KnownShapes, limited, of_shape, with_numbers
from substructures.tree.units import check_tree_units, tree_warnings
from substructures.tree.velocity_forces import least_forces

LISTED = ("driven", "ignored", "velocity_constraints", "contacts", "balls", "reduced")


@dataclass(frozen=True)
class Model:
    """A coupled tree. ``frames``: names of bodies and ports in the order of the kinematic outputs; ``closures``: what
    the rows of the closure outputs are, ``reduction``: in which coordinates it moves; ``parameters``, ``inputs`` (of
    loads): all that are declared and not bound, used or not; ``limited``: the coordinates that have limits;
    ``plausibility``: of values, unknown of a model out of a store; ``driven``: coordinates whose motion is given,
    ``ignored``: whose momentum is; ``velocity_constraints``, ``contacts``: of its motions, as plain data; the formulas
    are those without; ``balls``: joints whose rates are no derivatives of coordinates;
    ``reduced``: instances whose loops are in the formulas, with their coordinates; ``numbers``: in SI, still to be
    put in for symbols of the program (:meth:`with_numbers`)."""

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
    driven: tuple[str, ...] = ()
    velocity_constraints: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)
    numbers: Mapping[str, Fraction] = field(default_factory=dict, hash=False)
    ignored: tuple[str, ...] = ()
    contacts: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)
    balls: tuple[Mapping[str, Sequence[str]], ...] = field(default=(), hash=False)
    reduced: tuple[Mapping[str, Any], ...] = field(default=(), hash=False)

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

    def with_numbers(self) -> Model:
        """The model with its numbers in the formulas, exactly."""
        return replace(self, program=with_numbers(self.program, self.numbers), numbers={}) if self.numbers else self

    @property
    def given(self) -> tuple[str, ...]:
        """The coordinates that are driven or ignored."""
        return (*self.driven, *self.ignored)

    @property
    def dependent(self) -> tuple[str, ...]:
        """The coordinates that loops in the formulas make functions of others (reduced level)."""
        return tuple(name for level in self.reduced for name in level["dependent"])

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """What states q are: the coordinates, but of ball joints their place (x, y, z) and quaternion (w, x, y, z)."""
        return positions_of(self.coordinates, self.balls)

    @cached_property
    def units(self) -> dict[str, str]:
        """The SI units of parameters and inputs by name, actuators last; empty where none was given."""
        declared, own = {**self.parameters, **self.inputs}, effort_units(self.coordinates, self.joints)
        own |= {s.name: s.unit for s in self.program.symbols if s.name.removeprefix("tau.") in self.dependent}
        return {name: str(given.get("unit", "")) for name, given in declared.items()} | own

    @cached_property
    def state_units(self) -> dict[str, dict[str, str]]:
        """The SI units of coordinates, velocities and accelerations, by the fields q, qd, qdd and coordinate."""
        return state_units(self.coordinates, self.joints, self.balls)

    @cached_property
    def effective(self) -> frozenset[str]:
        """The symbols that the formulas depend on."""
        return frozenset(s.name for s in self.program.symbols)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """All inputs: those in the formulas in the order of the program's symbols, then those without effect."""
        named = [s.name for s in self.program.symbols if s.kind == "input"]
        return tuple(dict.fromkeys([*named, *self.inputs, *effort_units(self.coordinates, self.joints)]))

    def described(self) -> dict[str, Any]:
        """What the axes of the outputs are, as plain data."""
        closures: dict[str, Any] = {"closures": [rows.plain() for rows in self.closures]} if self.closures else {}
        closures |= {"reduction": self.reduction.plain()} if self.reduction else {}
        closures |= {name: list(getattr(self, name)) for name in LISTED if getattr(self, name)}
        named = {"coordinates": list(self.coordinates), "joints": self.joints, "frames": list(self.frames)}
        return closures | named | {"limited": list(self.limited)}

    def summary(self) -> dict[str, Any]:
        """Plain data that is stored beside the program."""
        found = self.described() | {
            "parameters": {name: dict(p) for name, p in self.parameters.items()},
            "inputs": {name: dict(given) for name, given in self.inputs.items()},
            "certificate": dict(self.certificate),
            "operations": self.operations,
        }
        return found | ({"numbers": {name: str(x) for name, x in self.numbers.items()}} if self.numbers else {})

    @classmethod
    def load(cls, summary: Mapping[str, Any], stored: bytes | Program) -> Model:
        """A stored model, with its numbers put in; ``stored``: its program, read or not. Raises InvalidProgram."""
        names = tuple(summary["coordinates"]), str(summary["joints"]), tuple(summary["frames"])
        described = summary["parameters"], summary["certificate"]
        closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
        read = Program.from_bytes(stored) if isinstance(stored, bytes) else stored
        program = read.marked(not_judged(summary["certificate"]))
        more: dict[str, Any] = {name: tuple(summary.get(name, ())) for name in ("limited", *LISTED)}
        more |= {"numbers": {name: Fraction(x) for name, x in summary.get("numbers", {}).items()}}
        more |= {"reduction": Reduction.read(summary["reduction"])} if summary.get("reduction") else {}
        return cls(program, *names, *described, closures, summary.get("inputs", {}), **more).with_numbers()


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
    return couple_shape(spec, parts, max_nodes, admit, group, known).with_numbers()


@without_collections
def couple_shape(
    spec: TreeSpec | Mapping[str, Any],
    parts: Mapping[str, Part],
    max_nodes: int = MAX_NODES,
    admit: Callable[[int], None] | None = None,
    group: bool = False,
    known: KnownShapes | None = None,
) -> Model:
    """The model of :func:`couple`, ``numbers`` of whose parameters are still to be put in: program and certificate are
    those of its shape (:mod:`substructures.tree.shape`). Raises as :func:`couple`.
    """
    start, verifying = perf_counter(), [0.0]
    spec = spec if isinstance(spec, TreeSpec) else TreeSpec.read(spec)
    spec.require_free_names()
    assembly = assemble(spec, parts)
    definitions = {name: part.definition for name, part in parts.items()}
    units = check_tree_units(spec, {name: part.parameters for name, part in parts.items()}, definitions)
    units.require()
    joints_of = joint_parents(assembly.mounted)
    entries = entries_of(joints_of)
    entries.require("the tree")
    if admit is not None:
        admit(expected_operations(joints_of))
    plausibility = Plausibility(spec, definitions)

    def made(free: TreeSpec, constants: Collection[str]) -> tuple[CertifiedProgram, bool]:
        """A tree in which numbers are symbols, and whether its certificate is that of its shape."""
        mine = assembly if free is spec else assemble(free, parts)
        admitted = every if group else numbers_and(constants)
        result = limited(_formulas(mine, not entries.is_large, admitted, None), max_nodes)
        described, begun = _model(mine, result, plausibility).described(), perf_counter()
        try:
            certificate, is_shared = certified(free, definitions, described, result)
        except VerificationFailed as error:
            raise blamed(parts, error) from None
        verifying[0] += perf_counter() - begun
        judged = result.marked(not_judged(certificate))
        return CertifiedProgram(judged, certificate, tuple(mine.scope.notices)), is_shared

    found, values = of_shape(spec, parts, group, known, made)
    model = replace(_model(assembly, limited(found.program, max_nodes), plausibility), numbers=values)
    told = [*units.warnings, *found.notices, *tree_warnings(spec, parts, found.program, model.coordinates)]
    warnings = {"warnings": [*told, *plausibility.at_defaults], "converted": units.converted}
    seconds = seconds_of(perf_counter() - start - verifying[0], verifying[0])
    return replace(model, certificate={**found.certificate, "seconds": seconds, **warnings})


def couple_formulas(
    spec: TreeSpec,
    parts: Mapping[str, Part],
    max_nodes: int = MAX_NODES,
    christoffel: bool = True,
    names: frozenset[str] | None = None,
) -> Model:
    """The model of :func:`couple` with the fewest operations for each state, and without a certificate: for numbers of
    many parameter sets, some of which are compared with those of models that have one. ``names``: outputs that are
    enough, of a tree without closures and given motions. Raises as :func:`couple`.
    """
    assembly = assemble(spec, parts)
    entries = entries_of(joint_parents(assembly.mounted))
    entries.require("the tree")
    wanted = None if assembly.cuts or assembly.reduced or spec.driven or spec.ignored else names
    result = limited(_formulas(assembly, christoffel and not entries.is_large, every, wanted), max_nodes)
    return _model(assembly, result, Plausibility(spec, {name: part.definition for name, part in parts.items()}))


def _model(assembly: Assembly, result: Program, plausibility: Plausibility) -> Model:
    """The model of an assembly, without a certificate."""
    kinds = all_coordinates(assembly)
    given = {"driven": driven_names(assembly), "ignored": ignored_names(assembly, kinds)}
    free = {name: kind for name, kind in kinds.items() if not any(name in some for some in given.values())}
    rows = tuple(cut.rows for cut in assembly.cuts)
    pairs = list(zip(assembly.instances, assembly.mounted, strict=True))
    moving = [f"{i.name}.{x.coordinate}" for i, m in pairs for x in m.part.topology.joints]
    frames = tuple(f"{i.name}.{frame}" for i, m in pairs for frame in m.part.frames)
    limited = tuple(moving[a] for a in sorted(assembly.limits) if moving[a] in free)
    spec = assembly.reading.spec
    told = reduction_of(assembly.instances, assembly.mounted, bool(spec.closures), assembly.reduced)
    tied, touching = (tuple(each.plain() for each in some) for some in (spec.velocity_constraints, spec.contacts))
    axes, inputs = (tuple(free), "".join(free.values()), frames), assembly.inputs | driven_inputs(assembly)
    reduction = Reduction() if any(given.values()) else told
    more: dict[str, Any] = {**given, "reduction": reduction, "velocity_constraints": tied, "contacts": touching}
    levels = {i.name: m.part for i, m in pairs if i.name in assembly.reduced}
    more |= {"balls": ball_rows(assembly.balls, moving), "reduced": tuple(instances_of(assembly.dependent, levels))}
    return Model(result, *axes, assembly.parameters, {}, rows, inputs, limited, plausibility, **more)


def _formulas(assembly: Assembly, christoffel: bool, admitted: Admitted, wanted: frozenset[str] | None) -> Program:
    """Outputs of a tree, all or those that are ``wanted``; ``admitted``: inertias that are grouped."""
    graph, names = assembly.scope.graph, tuple(every_coordinate(assembly))
    try:
        coupled = couple_parts(over_formulas(graph), assembly.mounted, assembly.gravity, christoffel, group=admitted)
        coupled = replace(coupled, potential=coupled.potential + found_potential(graph, coupled.placed, names))
        # loops, then motions, then momenta: cyclic is what is so in all that the others leave
        loaded = put_in(assembly, loaded_outputs(assembly, coupled, wanted))
        outputs = ignore(assembly, tuple(all_coordinates(assembly)), loaded)
        outputs = {name: x for name, x in outputs.items() if wanted is None or name in wanted}
        found = hoisted(program(graph, outputs, assembly.scope.symbols))
        graph.release()
        return found
    except ZeroDivisionError:
        raise division_by_zero(assembly.reading.spec, assembly) from None


def loaded_outputs(assembly: Assembly, coupled: Coupled, names: frozenset[str] | None = None) -> dict[str, Formulas]:
    """The outputs of coupled parts on which the loads of the tree act; ``names``: those that are wanted, and more."""
    rates, accelerations = rate_symbols(assembly)
    if assembly.reading.spec.loads:
        acting = load_formulas(assembly, coupled.placed, rates)
        coupled = coupled.with_loads(acting.forces, acting.potential)
    least = partial(least_forces, assembly.scope, coupled, rates)
    return model_outputs(assembly, coupled, rates, accelerations, names, least)
