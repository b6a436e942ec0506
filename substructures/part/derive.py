"""From a definition to its formulas: derived, verified and certified."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from time import perf_counter
from typing import Any

from substructures.catalogue import load, names
from substructures.certificate.agreement import not_judged, require_no_less
from substructures.errors import InvalidArgument, InvalidDocument, TooLarge, among
from substructures.expr.garbage import without_collections
from substructures.expr.program import Formulas, Program, program
from substructures.expr.units.unit_check import UnitCheck
from substructures.mechanics.formula_size import Entries, entries_of, expected_operations
from substructures.part.certificate import certify_part
from substructures.part.definition import Definition
from substructures.part.forces.applied_forces import read_loads
from substructures.part.formulas import Coupled, formulas
from substructures.part.mechanism import Mechanism, mechanism
from substructures.part.parameters import uncounted, without_effect
from substructures.part.part import MAX_NODES, Part
from substructures.part.poses import require_closures, require_poses, require_reduction
from substructures.part.relations import left_out_warnings, require_relations, weightless_warnings
from substructures.part.units import check_units

PROGRAM = "the program of the substructure (in operations)"


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
