"""A model with what is derived of it when it is first needed, and what evaluations take from that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import prod
from typing import Any

from substructures.array import Array
from substructures.errors import SOUGHT, Fault, InvalidArgument, TooLarge, meant
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED
from substructures.part.part import MAX_NODES, Part
from substructures.quantities.derivatives import SingularMetric
from substructures.quantities.formulas import CLOSED_DYNAMICS, DYNAMICS, kept
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.quantity import (
    CONDITION,
    DEPENDENT,
    DRIVEN,
    FORWARD,
    FRAMES,
    IGNORED,
    MODEL,
    OF_PARTS,
    POSITIONS,
    PROGRAMS,
    QUANTITIES,
    REACTIONS,
    TABLE,
    has_numbers,
    made_of,
    outputs_of,
)
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.document import TreeSpec, require_undriven
from substructures.tree.given.ties import require_untied
from substructures.tree.judge import Judge
from substructures.tree.model import Model

#: outputs that a large model does not have as formulas, in numbers from the parts of the tree
PARTS = "parts"
#: about what an element of them takes
PRODUCT = 30
_KNOWN = ", ".join(QUANTITIES)


def of_parts(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> Callable[[str], Any]:
    """What is derived of parts by name (:mod:`.of_parts`), each once, when it is first asked for.

    Raises InvalidDocument, TooLarge, VerificationFailed.
    """
    return cache(lambda source: PROGRAMS[source].function(spec, parts, max_nodes))


#: programs that have the accelerations of the motion in them
OF_MOTION = (FORWARD, "forward_dynamics_derivative", "canonical_equations", REACTIONS)


@dataclass(frozen=True)
class Sources:
    """A model and the programs that quantities come from, made when they are first needed.

    ``derive``: a program of :data:`substructures.quantities.quantity.DERIVED`; ``of_parts``: by name what is derived of
    the parts of the tree, where these are at hand; ``plausibility``: of values, from the definitions of these;
    ``numbers``: outputs of the model that it does not have as formulas, for (values, names, number of states);
    ``joints``: the rows of reactions that are wanted (default: all).
    """

    model: Model
    derive: Callable[[Model, str], Program] = kept
    of_parts: Callable[[str], Any] | None = None
    plausibility: Callable[[], Judge] | None = None
    numbers: Callable[[Mapping[str, Any], list[str], int], dict[str, Array]] | None = None
    joints: tuple[str, ...] | None = None

    @property
    def judge(self) -> Judge | None:
        """What says whether values are plausible; None of a model out of a store without its parts."""
        return self.model.plausibility if self.plausibility is None else self.plausibility()

    @cached_property
    def christoffel_rule(self) -> str:
        """The symmetry of the Christoffel symbols of the model, stored or not."""
        stored = self.model.program.outputs.get("christoffel")
        if stored is not None:
            return stored.symmetry
        has_relations = self.judge is not None and self.judge.has_relations
        return "connection" if self.model.balls or has_relations else "christoffel"

    @cached_property
    def defaults(self) -> Mapping[str, float]:
        """The default values of the model's parameters."""
        return default_numbers(self.model.parameters)

    def of(self, source: str) -> Any:
        """What is derived of the parts of the tree. Raises InvalidArgument where these are not at hand, TooLarge."""
        if self.of_parts is None:
            message = f"'{source}' needs the parts of the tree: give Sources(model, of_parts=of_parts(tree, parts))"
            raise InvalidArgument.at("/quantities", "needs-parts", message)
        found = self.of_parts(source)
        return found.of(self.joints) if source == REACTIONS else found

    def program(self, source: str) -> Program:
        """The program of this name. Raises TooLarge, and InvalidInput for closures, trees without their parts, and
        velocity constraints that it would ignore.
        """
        self.require_known_motion(source)
        if source == MODEL:
            return self.model.program
        return self.of(source).program if source in OF_PARTS else self.derive(self.model, source)

    def require_known_motion(self, source: str) -> None:
        """Raises InvalidDocument for what depends on the motion by itself, where the tree has velocity constraints."""
        if source in OF_MOTION:
            require_untied(self.model, source)

    def formulas(self, quantity: str) -> Program:
        """The program of a quantity, with what tells whether it could be computed. Raises TooLarge, InvalidDocument."""
        made, wanted = made_of(quantity), outputs_of(quantity)
        if made is None:
            whole = self.model.program
            return hoisted(whole.select([name for name in whole.outputs if name in wanted]))
        found = self.program(TABLE[quantity].source)
        own = [name for name in found.outputs if name in wanted or not made.of_parts]
        return found if len(own) == len(found.outputs) else found.select(own)

    def derived(self, quantities: Sequence[str]) -> list[Any]:
        """All that is derived of the parts for these quantities."""
        return [self.of(x) for x in dict.fromkeys(TABLE[name].source for name in quantities) if x in OF_PARTS]

    def parameters(self, quantities: Sequence[str]) -> Mapping[str, Mapping[str, Any]]:
        """The parameters that quantities may depend on."""
        more = {name: x for each in self.derived(quantities) for name, x in each.parameters.items()}
        return {**more, **self.model.parameters} if more else self.model.parameters

    def labels(self, quantities: Sequence[str]) -> dict[str, Any]:
        """The names of places by axis."""
        rows = [TABLE[name] for name in quantities]
        return {axis: self._labels(row.source, axis) for row in rows for axis in row.labelled}

    def _labels(self, source: str, axis: str) -> Any:
        if source in OF_PARTS:
            return self.of(source).labels[axis]
        if axis == FRAMES:
            return self.model.frames
        if axis == POSITIONS:
            return self.model.positions
        if axis == DEPENDENT:
            return self.model.dependent
        if axis in (DRIVEN, IGNORED):
            return self.model.driven if axis == DRIVEN else self.model.ignored
        return tuple(f"{closure.name}.{row}" for closure in self.model.closures for row in closure.rows)


def _like(name: object, number: int) -> str:
    """What may have been meant, or else all there are."""
    return (meant(str(name), TABLE) if number < SOUGHT else "") or f"; there are {_KNOWN}"


def read_quantities(quantities: str | Sequence[str]) -> list[str]:
    """The names of quantities, each once. Raises InvalidArgument (``/quantities/i``) for unknown ones, and for none."""
    names = [quantities] if isinstance(quantities, str) else quantities
    if not isinstance(names, (list, tuple)) or not names:
        raise InvalidArgument.at("/quantities", "missing", "a list of quantities is needed")
    faults = [
        Fault(f"/quantities/{i}", "unknown-quantity", f"unknown quantity {str(name)[:80]!r}{_like(name, i)}")
        for i, name in enumerate(names)
        if not has_numbers(name)
    ]
    if faults:
        raise InvalidArgument(faults)
    return list(dict.fromkeys(names))


def cost(sources: Sources, quantities: Sequence[str]) -> tuple[int, int]:
    """Operations and numbers of the answer for one state. Raises as :func:`evaluate`."""
    operations = numbers = 0
    n = sources.model.dof
    for source, program, names in steps(sources, quantities):
        if source == PARTS:
            numbers += len(names) * n**3
            operations += PRODUCT * len(names) * n**3
            continue
        # without a program the answer is one row of NaN by coordinate; a condition number is one number
        shapes = {} if program is None else {name: program.outputs[name].shape for name in names}
        shapes[CONDITION] = ()
        chosen = [q for q in dict.fromkeys(quantities) if TABLE[q].source == source]
        numbers += sum(prod(shapes.get(name, (n,))) for q in chosen for name in TABLE[q].outputs)
        operations += 0 if program is None else len(program.reachable(names))
    return operations, numbers


def numbers_per_state(quantities: Sequence[str], dof: int, frames: int) -> int:
    """At most so many numbers of the answer for one state; known without the formulas."""
    n = max(1, dof)
    # ten parameters a link; rows of joints and seats; powers of gravity, joints, actuators, and of loads, of which a
    # tree may have a thousand beside those of its parts; rows of closures, six at most between two frames
    sizes = {"coordinates": n, "frames": frames, "axes": 3, "links": frames, "columns": 10 * frames}
    sizes |= {"joints": n + frames, "loads": 2 * n + 2000, "rows": 6 * (n + frames), "rates": 6 + n}
    sizes |= dict.fromkeys((DRIVEN, IGNORED, DEPENDENT), n + frames) | {POSITIONS: 2 * n}
    return sum(TABLE[name].size(sizes) for name in quantities)


def steps(sources: Sources, quantities: Sequence[str]) -> Iterator[tuple[str, Program | None, list[str]]]:
    """(source, program, its outputs); no program: no state has a result, or numbers come from PARTS.

    Forward dynamics of a tree with closures, or of one of which no Christoffel symbols are stored, or too large for
    formulas of it, and condition numbers come from outputs of the model. Raises InvalidArgument for what a tree has
    none of.
    """
    wanted = _wanted(sources.model, quantities)
    yield from _numbers(sources, wanted)
    if REACTIONS in wanted:
        # of the motion that the state has by itself, last
        forward = TABLE[FORWARD]
        wanted.setdefault(FORWARD, set()).update(forward.outputs + forward.pivots)
        wanted[REACTIONS] = wanted.pop(REACTIONS)
    for source, names in wanted.items():
        sources.require_known_motion(source)
        if source == CONDITION:
            yield source, sources.program(MODEL), ["metric"]
            continue
        if source == FORWARD and sources.model.closures:
            require_undriven(sources.model.driven, "take loop states, which have accelerations and multipliers")
            yield source, sources.program(CLOSED_DYNAMICS), [*DYNAMICS, *CLOSED]
            continue
        if source == FORWARD and "christoffel" not in sources.model.program.outputs:
            yield source, sources.model.program, list(DYNAMICS)
            continue
        try:
            program = sources.program(source)
            require_stored(program, sorted(names))
            yield source, program, sorted(names)
        except SingularMetric:
            yield source, None, sorted(names)
        except TooLarge:
            if source != FORWARD:
                raise
            yield source, sources.model.program, list(DYNAMICS)


def require_there(model: Model, quantities: Sequence[str]) -> None:
    """Raises InvalidArgument (``not-of-tree``) for a quantity that only other trees have."""
    for i, name in enumerate(quantities):
        if TABLE[name].only and name not in model.program.outputs:
            raise InvalidArgument.at(f"/quantities/{i}", "not-of-tree", f"there is no '{name}': {TABLE[name].only}")


def _wanted(model: Model, quantities: Sequence[str]) -> dict[str, set[str]]:
    """Outputs by source. Raises InvalidArgument."""
    require_there(model, quantities)
    wanted: dict[str, set[str]] = {}
    for quantity in (TABLE[name] for name in quantities):
        wanted.setdefault(quantity.source, set()).update(quantity.outputs + quantity.pivots)
    return wanted


def _numbers(sources: Sources, wanted: dict[str, set[str]]) -> Iterator[tuple[str, None, list[str]]]:
    """What comes from the parts, which is wanted of the model then no longer."""
    absent = wanted.get(MODEL, set()) - sources.model.program.outputs.keys()
    if absent and sources.numbers is not None:
        yield PARTS, None, sorted(absent)
        wanted[MODEL] -= absent
        if not wanted[MODEL]:
            del wanted[MODEL]
