"""What is derived of the parts of a tree beside its model: formed, bounded, and certified from the documents."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from substructures.errors import TooLarge
from substructures.expr.program import Formulas, Program, program
from substructures.mechanics.linear3 import Scalar
from substructures.part.outputs import PartOutputs, Run, over_formulas
from substructures.part.part import Part
from substructures.quantities.quantity import COORDINATES, OUTPUTS
from substructures.tree.assembly import Assembly, assemble, division_by_zero
from substructures.tree.certificate import RowsExpected, certify_rows
from substructures.tree.couple import loaded_outputs
from substructures.tree.coupling import OWN, couple_parts
from substructures.tree.document import TreeSpec, require_unignored
from substructures.tree.given.driven import all_coordinates, put_in
from substructures.tree.given.ignored import at_momenta

#: what trees with ignored coordinates have, too, and what tells whether these are cyclic
REDUCED, OF_EQUATIONS = ("reactions", "powers"), frozenset(("metric", "bias", "forces", "potential_energy", "friction"))
#: outputs, and the names of their rows
Rows = tuple[Mapping[str, Formulas], Sequence[str]]
#: outputs that do not take part in kinematics; emptied before coupling
DYNAMIC = (
    *("metric", "christoffel", "composite.m", "composite.s", "composite.J", "applied", "potential"),
    *("subtree.m", "subtree.s", "subtree.J", "load.at", "load.vector", *OWN),
)


def _at_momenta(assembly: Assembly, outputs: Mapping[str, Formulas]) -> Mapping[str, Formulas]:
    """Outputs without axes of coordinates at the velocities and accelerations that given momenta make."""
    coupled = couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity, christoffel=False)
    whole = put_in(assembly, loaded_outputs(assembly, coupled, OF_EQUATIONS))
    return at_momenta(assembly, list(all_coordinates(assembly)), outputs, whole)


def _axes(name: str) -> list[int]:
    """Those of coordinates."""
    return [i for i, axis in enumerate(OUTPUTS[name].axes) if axis == COORDINATES]


def formed(
    what: str,
    spec: TreeSpec,
    parts: Mapping[str, Part],
    make: Callable[[Assembly], Rows],
    expected: RowsExpected,
    max_nodes: int,
) -> tuple[Program, tuple[str, ...], Mapping[str, Mapping[str, Any]]]:
    """The program of what ``make`` gives for the parts of a tree, its rows, and the parameters of the tree.

    Raises InvalidDocument with pointers into the tree document, TooLarge for more than ``max_nodes`` operations, and
    VerificationFailed unless every element is what ``expected`` makes of the documents.
    """
    require_unignored(() if what in REDUCED else spec.ignored)
    assembly = assemble(spec, parts)
    try:
        outputs, rows = make(assembly)
        outputs = put_in(assembly, outputs, {name: _axes(name) for name in outputs})
        outputs = _at_momenta(assembly, outputs) if spec.ignored else outputs
    except ZeroDivisionError:
        raise division_by_zero(spec, assembly) from None
    result = program(assembly.scope.graph, outputs, assembly.scope.symbols)
    assembly.scope.graph.release()
    if len(result) > max_nodes:
        raise TooLarge(f"the {what} (in operations)", len(result), max_nodes)
    multipliers = {symbol.name: symbol.kind for symbol in result.symbols if symbol.name.startswith("lambda.")}
    definitions = {name: part.definition for name, part in parts.items()}
    level = [instance.name for instance in assembly.instances if instance.name in assembly.reduced]
    result = certify_rows(what, spec, definitions, result, rows, expected, multipliers, level)
    return result, tuple(rows), assembly.parameters


def bare(run: Run, left_out: Sequence[str] = DYNAMIC) -> Run:
    """Parts without these outputs: without masses and loads coupling gives the kinematics, the rest is zero at once."""

    def massless(part: Part, bindings: Mapping[str, Scalar], names: Sequence[str]) -> PartOutputs:
        """Outputs of a part, those of its masses empty."""
        found = run(part, bindings, [name for name in names if name not in left_out])
        return PartOutputs({**found.formulas, **{name: Formulas((), {}) for name in names if name in left_out}})

    return massless
