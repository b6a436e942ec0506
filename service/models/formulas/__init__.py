"""Formulas that follow from a model, as quantities of a tree with options: first integrals, perturbation, curvature.

Options are texts by name, as in a query: ``{"controls": ("tau.arm.q1",), "running": ("tau.arm.q1^2",)}``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from service.content.cache import Cache
from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.errors import InvalidDocument, InvalidInput, TooLarge
from substructures.expr.program import Program
from substructures.late import Table
from substructures.quantities.quantity import VELOCITY_DYNAMICS
from substructures.tree.given.ties import require_untied

if TYPE_CHECKING:
    from substructures.analysis.identification.base_parameters import BaseParameters

OPTIONS = {
    "inputs": "inputs that may have any value (first_integrals; those with a default that is not 0 always have), "
    "columns of B and D (state_space; default all)",
    "zero": "parameters that are 0 (first_integrals)",
    "degree": "1 or 2: of integrals in the momenta that are searched (first_integrals; default 2 where it is small)",
    "cyclic": "cyclic coordinates that are removed (routhian; default all)",
    "outputs": "expressions y in coordinates, velocities, inputs, parameters and t (state_space)",
    "parameters": "by which is differentiated (parameter_sensitivity; default all), also those of the cost (adjoint)",
    "quantities": "that are differentiated (parameter_sensitivity; default metric, christoffel, forces)",
    "controls": "inputs that are controlled (adjoint; default all)",
    "running": "cost per second, an expression in coordinates, velocities, inputs, parameters and t (adjoint)",
    "terminal": "cost at the end, an expression in coordinates, velocities, parameters and t (adjoint)",
    "joints": "coordinates of joints, and instance.base of seats (reactions; default all)",
    "independent": "coordinates whose velocities describe the motion (velocity_dynamics, and state_space with velocity"
    " constraints; default chosen)",
    "drives": "armature, viscous, coulomb, offset: columns of drives (base_parameters, base_regressor)",
}


_made: Cache[Made] = Cache(300_000, lambda made: len(made.program))


def made(source: Source, name: str, options: Options) -> Made:
    """A quantity of QUANTITIES; what was made before is kept.

    Raises InvalidDocument (with pointers into the query), also for an option that the quantity does not have; TooLarge.
    """
    require_untied(source.model, name)
    quantity = _QUANTITIES[name]
    given = {key: texts for key, texts in options.items() if texts}
    check_options(name, given, quantity.options)
    found = _remembered(source, quantity, given)
    if not quantity.outputs:
        return found
    return Made(found.program.select(list(quantity.outputs)), found.members, found.value)


def makers(source: Source, independent: Sequence[str] = ()) -> dict[str, Callable[[], Program]]:
    """By name what makes the formulas of QUANTITIES, with the default of every option but ``independent``."""
    return {name: partial(_program, source, name, tuple(independent)) for name in QUANTITIES}


def _program(source: Source, name: str, independent: tuple[str, ...]) -> Program:
    if name != VELOCITY_DYNAMICS:
        return made(source, name, {}).program
    try:
        return made(source, name, {"independent": independent}).program
    except InvalidInput as error:
        raise error.moved(lambda pointer: pointer.removeprefix("/query")) from None


def check_options(name: str, given: Iterable[str], known: Sequence[str] = ()) -> None:
    """Raise InvalidDocument for an option that a quantity does not have."""
    for key in given:
        if key not in known:
            message = f"'{name[:80]}' has no option '{key}'; it has {', '.join(known) or 'none'}"
            raise InvalidDocument.at(f"/query/{key}", "unknown-option", message)


def _remembered(source: Source, quantity: Quantity, options: Options) -> Made:
    programs = (source.model.program.digest, *([source.regressor().program.digest] if quantity.needs_parts else []))
    key = source.digest, programs, source.limits.program_nodes, quantity.make, tuple(sorted(options.items()))
    found = _made.get(key)
    if found is None:
        try:
            found = quantity.make(source, options)
        except InvalidInput as error:
            raise error.moved(quantity.pointer) from None
        size, limit = len(found.program), source.limits.program_nodes
        if size > limit:
            raise TooLarge("the formulas (in operations)", size, limit)
        _made.put(key, found)
    return found


def base_of(source: Source, drives: tuple[str, ...]) -> BaseParameters:
    """The base parameters of a tree, remembered. Raises InvalidDocument (``/drives/i``), TooLarge."""
    try:
        value: BaseParameters = _remembered(
            source, _QUANTITIES["base_parameters"], {"drives": drives} if drives else {}
        ).value
    except InvalidInput as error:
        raise error.moved(lambda pointer: pointer.removeprefix("/query")) from None
    return value


def curvature_of(source: Source) -> Program:
    """The formulas of the curvature, remembered."""
    return _remembered(source, _QUANTITIES["curvature"], {}).program


_SYMMETRIES, _PERTURBATIONS, _GEOMETRY, _CONTROL, _INERTIAL, _CONSTRAINTS = (
    f"{__name__}.{module}"
    for module in ("symmetries", "perturbations", "geometry", "control", "inertial", "constraints")
)
#: those that need the parts of the tree, beside its formulas
OF_PARTS = ("base_parameters", "base_regressor")
_QUANTITIES: Table[Quantity] = Table(
    "QUANTITIES",
    {
        **dict.fromkeys(("first_integrals", "routhian"), _SYMMETRIES),
        **dict.fromkeys(("perturbation", "state_space", "parameter_sensitivity"), _PERTURBATIONS),
        **dict.fromkeys(("curvature", "riemann", "ricci", "scalar_curvature"), _GEOMETRY),
        "adjoint": _CONTROL,
        **dict.fromkeys(OF_PARTS, _INERTIAL),
        VELOCITY_DYNAMICS: _CONSTRAINTS,
    },
)
QUANTITIES = tuple(_QUANTITIES)
#: formulas that follow from a model and a document: what checks its shape, and what makes them
WITH_DOCUMENT: Table[tuple[Callable[[Any], object], Callable[[Source, Any], Made]]] = Table(
    "WITH_DOCUMENT", {"velocity-equations": _CONSTRAINTS}
)
