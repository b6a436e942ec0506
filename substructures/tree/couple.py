"""Parts to the model of a tree: its formulas, made or those of its shape, and their certificate."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from time import perf_counter
from typing import Any

from substructures.certificate.agreement import not_judged
from substructures.documents.fields import in_si
from substructures.errors import TooLarge, VerificationFailed
from substructures.expr.garbage import without_collections
from substructures.expr.hoist import hoisted
from substructures.expr.program import Formulas, Program, program
from substructures.expr.units.unit_check import UnitCheck
from substructures.mechanics.formula_size import entries_of, expected_operations
from substructures.mechanics.state_names import ball_rows
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.tree.assembly import Assembly, assemble, declared, division_by_zero, joint_parents
from substructures.tree.certificate import blamed, certified, seconds_of
from substructures.tree.coupling import Coupled, couple_parts
from substructures.tree.cuts import Reduction
from substructures.tree.document import TreeSpec
from substructures.tree.forces.load_potentials import found_potential
from substructures.tree.forces.loads import load_formulas
from substructures.tree.forces.velocity_forces import least_forces
from substructures.tree.given.driven import all_coordinates, driven_inputs, driven_names, every_coordinate, put_in
from substructures.tree.given.ignored import ignore, ignored_names
from substructures.tree.given.reduced import instances_of
from substructures.tree.grouping import Admitted, every, numbers_and
from substructures.tree.model import AXES, LISTED, Model
from substructures.tree.model_outputs import model_outputs, rate_symbols
from substructures.tree.plausibility import Plausibility
from substructures.tree.shape import CertifiedProgram, KnownShapes, of_shape
from substructures.tree.units import check_tree_units, tree_warnings


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
    start = perf_counter()
    spec = spec if isinstance(spec, TreeSpec) else TreeSpec.read(spec)
    spec.require_free_names()
    definitions = {name: part.definition for name, part in parts.items()}
    units = check_tree_units(spec, {name: part.parameters for name, part in parts.items()}, definitions)
    plausibility = Plausibility(spec, definitions)
    new = _NewShape(spec, parts, max_nodes, admit, group, units, plausibility)
    if units.faults:
        new.require()
    found, values = of_shape(spec, parts, group, known, new.made, new.require)
    program, kept = _limited(found.program, max_nodes), found.axes
    if kept is None:
        model = _model(new.assembly, program, plausibility)
    else:
        model = Model(program, **kept, **declared(spec, parts), certificate={}, plausibility=plausibility)
    told = [*units.warnings, *found.notices, *tree_warnings(spec, parts, found.program, model.coordinates)]
    warnings = {"warnings": [*told, *plausibility.at_defaults], "converted": units.converted}
    seconds = seconds_of(perf_counter() - start - new.verifying, new.verifying)
    return replace(model, numbers=values, certificate={**found.certificate, "seconds": seconds, **warnings})


@dataclass
class _NewShape:
    """What is made where the shape of a tree is not known; ``verifying``: seconds that this took of it."""

    spec: TreeSpec
    parts: Mapping[str, Part]
    max_nodes: int
    admit: Callable[[int], None] | None
    group: bool
    units: UnitCheck
    plausibility: Plausibility
    verifying: float = 0.0

    @cached_property
    def assembly(self) -> Assembly:
        """Raises InvalidDocument."""
        return assemble(self.spec, self.parts)

    def require(self) -> None:
        """Raises InvalidDocument for what is wrong with the tree, TooLarge, and what ``admit`` raises."""
        joints_of = joint_parents(self.assembly.mounted)
        self.units.require()
        entries_of(joints_of).require("the tree")
        if self.admit is not None:
            self.admit(expected_operations(joints_of))

    def made(self, free: TreeSpec, constants: Collection[str]) -> tuple[CertifiedProgram, bool]:
        """A tree in which numbers are symbols, and whether its certificate is that of its shape."""
        self.require()
        mine = self.assembly if free is self.spec else assemble(free, self.parts)
        is_large = entries_of(joint_parents(mine.mounted)).is_large
        admitted = every if self.group else numbers_and(constants)
        result = _limited(tree_formulas(mine, not is_large, admitted, None), self.max_nodes)
        begun = perf_counter()
        model = _model(mine, result, self.plausibility)
        try:
            certificate, is_shared = certified(free, self.plausibility.definitions, model.described(), result)
        except VerificationFailed as error:
            raise blamed(self.parts, error) from None
        self.verifying += perf_counter() - begun
        judged = result.marked(not_judged(certificate))
        has_more = model.closures or model.reduction or any(getattr(model, name) for name in LISTED)
        axes = None if has_more else {name: getattr(model, name) for name in AXES}
        return CertifiedProgram(judged, certificate, tuple(mine.scope.notices), axes=axes), is_shared


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
    result = _limited(tree_formulas(assembly, christoffel and not entries.is_large, every, wanted), max_nodes)
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
    order = [(each.name, m.part) for each, m in zip(assembly.instances, assembly.mounted, strict=True)]
    told = _reduction_of(order, bool(spec.closures), assembly.reduced)
    tied, touching = (tuple(each.plain() for each in some) for some in (spec.velocity_constraints, spec.contacts))
    axes, inputs = (tuple(free), "".join(free.values()), frames), assembly.inputs | driven_inputs(assembly)
    reduction = Reduction() if any(given.values()) else told
    more: dict[str, Any] = {**given, "reduction": reduction, "velocity_constraints": tied, "contacts": touching}
    levels = {i.name: m.part for i, m in pairs if i.name in assembly.reduced}
    more |= {"balls": ball_rows(assembly.balls, moving), "reduced": tuple(instances_of(assembly.dependent, levels))}
    return Model(result, *axes, assembly.parameters, {}, rows, inputs, limited, plausibility, **more)


def tree_formulas(assembly: Assembly, christoffel: bool, admitted: Admitted, wanted: frozenset[str] | None) -> Program:
    """Outputs of a tree, all or those that are ``wanted``; ``admitted``: inertias that are grouped."""
    graph, names = assembly.scope.graph, tuple(every_coordinate(assembly))
    try:
        coupled = couple_parts(over_formulas(graph), assembly.mounted, assembly.gravity, christoffel, group=admitted)
        coupled = replace(coupled, potential=coupled.potential + found_potential(graph, coupled.placed, names))
        # the order of operations in stored programs is that of nodes: these are made before those of loads
        left = tuple(all_coordinates(assembly))
        # loops, then motions, then momenta: cyclic is what is so in all that the others leave
        loaded = put_in(assembly, loaded_outputs(assembly, coupled, wanted))
        outputs = ignore(assembly, left, loaded)
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


def _reduction_of(order: Sequence[tuple[str, Part]], is_closed: bool, reduced: Collection[str]) -> Reduction:
    """Of the instances of a tree by name, hosts first; ``is_closed``: by closures of its own; ``reduced``: those whose
    formulas are of independent coordinates alone.

    Independent are the coordinates that closed parts name, and all those of open ones.
    """
    closed = [part.definition for name, part in order if part.definition.closures and name not in reduced]
    independent: list[str] = []
    start: dict[str, str] = {}
    ranges: dict[str, tuple[str, str]] = {}
    for name, part in order:
        own = part.definition.independent if part.definition.closures else part.coordinates
        independent += [f"{name}.{c}" for c in part.coordinates if c in own]
        given = part.definition.start.items()
        start |= {f"{name}.{c}": str(in_si(x)) for c, x in given if c in own or name not in reduced}
        for c, (low, high) in part.definition.ranges.items():
            ranges[f"{name}.{c}"] = str(in_si(low)), str(in_si(high))
    # a closure of the tree may bind coordinates of any part, of which no part can say which are independent then
    is_said = closed and all(definition.independent for definition in closed) and not is_closed
    return Reduction(tuple(independent) if is_said else (), start, ranges)


def _limited(result: Program, max_nodes: int) -> Program:
    """The program. Raises TooLarge for more than so many operations."""
    if len(result) > max_nodes:
        raise TooLarge("the program of the tree (in operations)", len(result), max_nodes)
    return result
