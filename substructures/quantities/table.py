"""Which programs the quantities of an evaluation come from, and what they cost."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

from substructures.array import Array
from substructures.errors import SOUGHT, Fault, InvalidArgument, TooLarge, meant
from substructures.expr.program import Program
from substructures.mechanics.accelerations import CLOSED
from substructures.quantities.canonical import PIVOTS
from substructures.quantities.derivatives import FD, SingularMetric
from substructures.quantities.formulas import CLOSED_DYNAMICS, DYNAMICS, kept
from substructures.quantities.powers import PowerModel
from substructures.quantities.reactions import FIELDS as REACTION_FIELDS
from substructures.quantities.reactions import OUTPUTS as REACTION_OUTPUTS
from substructures.quantities.reactions import ReactionModel
from substructures.quantities.regressor import RegressorModel
from substructures.quantities.states import default_numbers
from substructures.tree.model import Model, require_stored
from substructures.tree.model_outputs import KINEMATICS
from substructures.tree.plausibility import Plausibility

MODEL, REGRESSOR, CONDITION, REACTIONS, POWERS = "model", "regressor", "condition", "reactions", "powers"
#: outputs that a large model does not have as formulas, in numbers from the parts of the tree
PARTS = "parts"
#: about what an element of them takes
PRODUCT = 30


@dataclass(frozen=True)
class Quantity:
    """A quantity: outputs of the program ``source``, one array or several by ``fields``."""

    source: str
    outputs: tuple[str, ...]
    fields: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()  #: arguments that it needs
    pivots: tuple[str, ...] = ()  #: the outputs that tell whether the metric could be inverted

    def of(self, found: Mapping[str, Array]) -> Any:
        """Its arrays among the outputs of its program: one, or several by field."""
        if self.fields:
            return {field: found[name] for field, name in zip(self.fields, self.outputs, strict=True)}
        return found[self.outputs[0]]


def _outputs(source: str, *names: str, requires: tuple[str, ...] = ()) -> dict[str, Quantity]:
    return {name: Quantity(source, (name,), requires=requires) for name in names}


def _forward(name: str, requires: tuple[str, ...] = ()) -> dict[str, Quantity]:
    return {name: Quantity(name, (name,), requires=requires, pivots=("pivots", "inertias"))}


def _by_inverse(name: str, *fields: str) -> dict[str, Quantity]:
    return {name: Quantity(name, fields or (name,), fields, pivots=(PIVOTS,))}


QUANTITIES: dict[str, Quantity] = {
    **_outputs(MODEL, "metric", "christoffel", "forces", "gravity", "bias", "potential_energy"),
    "condition": Quantity(CONDITION, ("condition",)),
    **_outputs("coriolis", "coriolis"),
    **_outputs("inverse_dynamics", "inverse_dynamics", requires=("qdd",)),
    **_forward("forward_dynamics"),
    **_outputs("kinetic_energy", "kinetic_energy"),
    **_outputs("lagrangian", "lagrangian"),
    **_outputs("generalised_momenta", "generalised_momenta"),
    **_outputs("power", "power"),
    **_by_inverse("inverse_metric"),
    **_by_inverse("christoffel_second_kind"),
    **_by_inverse("hamiltonian"),
    **_by_inverse("canonical_equations", "coordinate_rates", "momentum_rates"),
    "kinematics": Quantity(MODEL, KINEMATICS, KINEMATICS),
    "momentum": Quantity("total_momentum", ("linear", "angular"), ("linear", "angular")),
    **_outputs("inverse_dynamics_derivative", "inverse_dynamics_derivative", requires=("qdd", "along")),
    **_forward("forward_dynamics_derivative", requires=("along",)),
    **_outputs(REGRESSOR, "regressor", requires=("qdd",)),
    **_outputs(REGRESSOR, "inertial_parameters"),
    "reactions": Quantity(REACTIONS, REACTION_OUTPUTS, REACTION_FIELDS),
    **_outputs(POWERS, "powers"),
}
#: axes of n of what has no result in any state, where that is not one
AXES = {"hamiltonian": 0, "inverse_metric": 2, "christoffel_second_kind": 3}
_KNOWN = ", ".join(QUANTITIES)


@dataclass(frozen=True)
class Sources:
    """The programs that quantities come from, made when they are first needed.

    ``derive``: a program of :data:`substructures.quantities.formulas.DERIVED`; ``regressor``: for the quantities
    ``regressor`` and ``inertial_parameters``, which need the parts of the tree; ``plausibility``: of values, from the
    definitions of these; ``numbers``: outputs of the model that it does not have as formulas, for (values, names,
    number of states); ``reactions``: for the quantity of this name, which needs the parts, too; ``joints``: the rows of
    it that are wanted (default: all); ``powers``: as ``reactions``.
    """

    model: Model
    derive: Callable[[Model, str], Program] = kept
    regressor: Callable[[], RegressorModel] | None = None
    plausibility: Callable[[], Plausibility] | None = None
    numbers: Callable[[Mapping[str, Any], list[str], int], dict[str, Array]] | None = None
    reactions: Callable[[], ReactionModel] | None = None
    joints: tuple[str, ...] | None = None
    powers: Callable[[], PowerModel] | None = None

    @property
    def judge(self) -> Plausibility | None:
        """What says whether values are plausible; None of a model out of a store without its parts."""
        return self.model.plausibility if self.plausibility is None else self.plausibility()

    @cached_property
    def defaults(self) -> Mapping[str, float]:
        """The default values of the model's parameters."""
        return default_numbers(self.model.parameters)

    def program(self, source: str) -> Program:
        """The program of this name. Raises TooLarge, and InvalidInput for closures and trees without their parts."""
        if source == MODEL:
            return self.model.program
        if source == REACTIONS:
            return self.transmitted().program
        if source == POWERS:
            return self.by_load().program
        return self.columns().program if source == REGRESSOR else self.derive(self.model, source)

    def columns(self) -> RegressorModel:
        """The regressor with the names of its columns."""
        if self.regressor is None:
            raise InvalidArgument.at("/quantities", "needs-parts", "the regressor needs the parts of the tree")
        return self.regressor()

    def transmitted(self) -> ReactionModel:
        """The reactions of the joints that are wanted. Raises InvalidArgument."""
        if self.reactions is None:
            raise InvalidArgument.at("/quantities", "needs-parts", "reactions need the parts of the tree")
        return self.reactions().of(self.joints)

    def by_load(self) -> PowerModel:
        """The powers of loads and joints. Raises InvalidArgument."""
        if self.powers is None:
            raise InvalidArgument.at("/quantities", "needs-parts", "powers need the parts of the tree")
        return self.powers()

    def parameters(self, names: Sequence[str]) -> Mapping[str, Mapping[str, Any]]:
        """The parameters that quantities may depend on."""
        if REGRESSOR in {QUANTITIES[name].source for name in names}:
            return {**self.columns().parameters, **self.model.parameters}
        return self.model.parameters


def _like(name: object, number: int) -> str:
    """What may have been meant, or else all there are."""
    return (meant(str(name), QUANTITIES) if number < SOUGHT else "") or f"; there are {_KNOWN}"


def read_quantities(quantities: str | Sequence[str]) -> list[str]:
    """The names of quantities, each once. Raises InvalidArgument (``/quantities/i``) for unknown ones, and for none."""
    names = [quantities] if isinstance(quantities, str) else quantities
    if not isinstance(names, (list, tuple)) or not names:
        raise InvalidArgument.at("/quantities", "missing", "a list of quantities is needed")
    faults = [
        Fault(f"/quantities/{i}", "unknown-quantity", f"unknown quantity {str(name)[:80]!r}{_like(name, i)}")
        for i, name in enumerate(names)
        if not isinstance(name, str) or name not in QUANTITIES
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
        shapes["condition"] = ()
        chosen = [q for q in dict.fromkeys(quantities) if QUANTITIES[q].source == source]
        numbers += sum(prod(shapes.get(name, (n,))) for q in chosen for name in QUANTITIES[q].outputs)
        operations += 0 if program is None else len(program.reachable(names))
    return operations, numbers


def numbers_per_state(quantities: Sequence[str], dof: int, frames: int) -> int:
    """At most so many numbers of the answer for one state; known without the formulas."""
    n, columns = max(1, dof), 10 * frames
    # position 3 and rotation 9 of every frame, U and Omega 3 each for every frame and coordinate; ten parameters a link
    several = {"kinematics": frames * (12 + 6 * n), "christoffel": n**3, "metric": n * n, "coriolis": n * n}
    several |= {"regressor": n * columns, "inertial_parameters": columns, "momentum": 6, "condition": 1}
    several |= {"reactions": 12 * (n + frames), "canonical_equations": 2 * n}
    # gravity, two rows for each coordinate, and loads, of which a tree may have a thousand beside those of its parts
    several |= {"powers": 2 * n + 2000}
    several |= {"inverse_metric": n * n, "christoffel_second_kind": n**3}
    return sum(several.get(name, n) for name in quantities)


def steps(sources: Sources, quantities: Sequence[str]) -> Iterator[tuple[str, Program | None, list[str]]]:
    """(source, program, its outputs); no program: no state has a result, or numbers come from PARTS.

    Forward dynamics of a tree with closures, or of one of which no Christoffel symbols are stored, or too large for
    formulas of it, and condition numbers come from outputs of the model.
    """
    wanted: dict[str, set[str]] = {}
    for name in quantities:
        quantity = QUANTITIES[name]
        wanted.setdefault(quantity.source, set()).update(quantity.outputs + quantity.pivots)
    yield from _numbers(sources, wanted)
    if REACTIONS in wanted:
        # of the motion that the state has by itself, last
        forward = QUANTITIES[FD]
        wanted.setdefault(FD, set()).update(forward.outputs + forward.pivots)
        wanted[REACTIONS] = wanted.pop(REACTIONS)
    for source, names in wanted.items():
        if source == CONDITION:
            yield source, sources.program(MODEL), ["metric"]
            continue
        if source == FD and sources.model.closures:
            yield source, sources.program(CLOSED_DYNAMICS), [*DYNAMICS, *CLOSED]
            continue
        if source == FD and "christoffel" not in sources.model.program.outputs:
            yield source, sources.model.program, list(DYNAMICS)
            continue
        try:
            program = sources.program(source)
            require_stored(program, sorted(names))
            yield source, program, sorted(names)
        except SingularMetric:
            yield source, None, sorted(names)
        except TooLarge:
            if source != FD:
                raise
            yield source, sources.model.program, list(DYNAMICS)


def _numbers(sources: Sources, wanted: dict[str, set[str]]) -> Iterator[tuple[str, None, list[str]]]:
    """What comes from the parts, which is wanted of the model then no longer."""
    absent = wanted.get(MODEL, set()) - sources.model.program.outputs.keys()
    if absent and sources.numbers is not None:
        yield PARTS, None, sorted(absent)
        wanted[MODEL] -= absent
        if not wanted[MODEL]:
            del wanted[MODEL]
