"""Formulas that follow from a model, as quantities of a tree with options: first integrals, perturbation, curvature.

Options are texts by name, as in a query: ``{"controls": ("tau.arm.q1",), "running": ("tau.arm.q1^2",)}``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import BaseModel

from service.analyses.requests import arguments, read_request
from service.analyses.source import Source
from service.cache import Cache
from service.schemas.velocity_constraints import VelocityConstraints
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.curvature import curvature
from substructures.analysis.equations.first_integrals import acting_inputs, first_integrals
from substructures.analysis.equations.formulas import inputs_of, multipliers_of
from substructures.analysis.equations.perturbation import perturbation, state_space
from substructures.analysis.equations.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.routh import routh
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.motion.parameter_sensitivity import QUANTITIES as VARIED
from substructures.analysis.motion.parameter_sensitivity import sensitivity_formulas
from substructures.errors import InvalidDocument, InvalidInput, TooLarge
from substructures.expr.program import Program

Options = Mapping[str, tuple[str, ...]]
OPTIONS = {
    "inputs": "inputs that may have any value (first_integrals; those with a default that is not 0 always have), "
    "columns of B and D (state_space; default all)",
    "zero": "parameters that are 0 (first_integrals)",
    "cyclic": "cyclic coordinates that are removed (routhian; default all)",
    "outputs": "expressions y in coordinates, velocities, inputs, parameters and t (state_space)",
    "parameters": "by which is differentiated (parameter_sensitivity; default all), also those of the cost (adjoint)",
    "quantities": "that are differentiated (parameter_sensitivity; default metric, christoffel, forces)",
    "controls": "inputs that are controlled (adjoint; default all)",
    "running": "cost per second, an expression in coordinates, velocities, inputs, parameters and t (adjoint)",
    "terminal": "cost at the end, an expression in coordinates, velocities, parameters and t (adjoint)",
    "joints": "coordinates of joints, and instance.base of seats (reactions; default all)",
    "drives": "armature, viscous, coulomb, offset: columns of drives (base_parameters, base_regressor)",
}


@dataclass(frozen=True)
class Made:
    """A program, and what there is to say about it beside the formulas."""

    program: Program
    members: Mapping[str, Any] = field(default_factory=dict)
    value: Any = None


@dataclass(frozen=True)
class _Quantity:
    """``outputs``: those of the program that are shown, default all; ``called``: what the science calls an option;
    ``needs_parts``: of the tree, beside its formulas.
    """

    make: Callable[[Source, Options], Made]
    options: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    called: Mapping[str, str] = field(default_factory=dict)
    needs_parts: bool = False

    def pointer(self, given: str) -> str:
        """The place in the query that a pointer of the science means."""
        first, *rest = given.removeprefix("/cost").split("/")[1:] or [""]
        option = next((name for name, called in self.called.items() if called == first), first)
        return "/".join(["/query", option, *rest]).rstrip("/")


_made: Cache[Made] = Cache(2_000_000, lambda made: len(made.program))


def made(source: Source, name: str, options: Options) -> Made:
    """A quantity of QUANTITIES; what was made before is kept.

    Raises InvalidDocument (with pointers into the query), also for an option that the quantity does not have; TooLarge.
    """
    quantity = _QUANTITIES[name]
    given = {key: texts for key, texts in options.items() if texts}
    check_options(name, given, quantity.options)
    found = _remembered(source, quantity, given)
    if not quantity.outputs:
        return found
    return Made(found.program.select(list(quantity.outputs)), found.members, found.value)


def check_options(name: str, given: Iterable[str], known: Sequence[str] = ()) -> None:
    """Raise InvalidDocument for an option that a quantity does not have."""
    for key in given:
        if key not in known:
            message = f"'{name[:80]}' has no option '{key}'; it has {', '.join(known) or 'none'}"
            raise InvalidDocument.at(f"/query/{key}", "unknown-option", message)


def _remembered(source: Source, quantity: _Quantity, options: Options) -> Made:
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


def velocity_equations_of(source: Source, body: Any) -> Made:
    """Voronets' and Boltzmann-Hamel equations of a model with velocity constraints.

    Raises InvalidInput with pointers into the body, TooLarge.
    """
    found = quasi_velocity_equations(source.model, **arguments(read_constraints(body)))
    names = {"velocities": found.velocities, "constraints": found.constraints, "gaps": found.gaps}
    members: dict[str, Any] = {name: list(value) for name, value in (names | {"dependent": found.dependent}).items()}
    if found.singular:
        called = ", ".join(found.velocities)
        message = f"the velocities {called} do not describe the motion where {found.singular} is zero, nor do formulas"
        advice = "give 'velocities' that always do, or 'independent' ones for where the motion is"
        members["warnings"] = [{"pointer": "", "code": "singular-velocities", "message": f"{message}: {advice}"}]
    size, limit = len(found.program), source.limits.program_nodes
    if size > limit:
        raise TooLarge("the formulas (in operations)", size, limit)
    return Made(found.program, members)


def read_constraints(body: Any) -> BaseModel:
    """A body of ``velocity-equations``. Raises InvalidDocument."""
    return read_request(VelocityConstraints, body)


def base_of(source: Source, drives: tuple[str, ...]) -> BaseParameters:
    """The base parameters of a tree, remembered. Raises InvalidDocument (``/drives/i``), TooLarge."""
    try:
        value = _remembered(source, _QUANTITIES["base_parameters"], {"drives": drives} if drives else {}).value
    except InvalidInput as error:
        raise error.moved(lambda pointer: pointer.removeprefix("/query")) from None
    if not isinstance(value, BaseParameters):
        raise TypeError("base parameters expected")
    return value


def curvature_of(source: Source) -> Program:
    """The formulas of the curvature, remembered."""
    return _remembered(source, _QUANTITIES["curvature"], {}).program


def _first_integrals(source: Source, options: Options) -> Made:
    named = dict.fromkeys((*options.get("inputs", ()), *acting_inputs(source.model)))
    found = first_integrals(source.model, named, options.get("zero", ()))
    return Made(found.program, found.summary())


def _routhian(source: Source, options: Options) -> Made:
    found = routh(source.model, options.get("cyclic"))
    names = {"coordinates": found.coordinates, "cyclic": found.cyclic, "momenta": found.momenta}
    return Made(found.program, {name: list(value) for name, value in names.items()})


def _perturbation(source: Source, _: Options) -> Made:
    members: dict[str, Any] = {"coordinates": list(source.model.coordinates), "inputs": inputs_of(source.model)}
    if source.model.closures:
        members["multipliers"] = multipliers_of(source.model)
    return Made(perturbation(source.model), members)


def _state_space(source: Source, options: Options) -> Made:
    model, outputs, inputs = source.model, options.get("outputs", ()), options.get("inputs")
    state = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    members = {"state": state, "inputs": list(inputs or inputs_of(model)), "expressions": list(outputs)}
    return Made(state_space(model, outputs, inputs), members)


def _sensitivity(source: Source, options: Options) -> Made:
    parameters = options.get("parameters", tuple(source.model.parameters))
    return Made(sensitivity_formulas(source.model, parameters, options.get("quantities", VARIED)))


def _curvature(source: Source, _: Options) -> Made:
    members = {"coordinates": list(source.model.coordinates), "symmetry_rule": RIEMANN}
    return Made(curvature(source.model, source.limits.program_nodes), members)


def _adjoint(source: Source, options: Options) -> Made:
    cost = Cost(**{name: ",".join(options[name]) for name in ("running", "terminal") if name in options})
    controls, varied = options.get("controls", tuple(inputs_of(source.model))), options.get("parameters", ())
    found = adjoint_equations(source.model, controls, cost, varied)
    names = {"coordinates": found.coordinates, "controls": found.controls, "parameters": found.varied}
    return Made(found.program, {name: list(value) for name, value in names.items()})


def _base_parameters(source: Source, options: Options) -> Made:
    found = base_parameters(source.regressor(), options.get("drives", ()))
    members: dict[str, Any] = {
        "standard": list(found.standard),
        "units": list(found.units),
        "base": list(found.names),
        "unseen": list(found.unseen),
        "drives": list(found.drives),
    }
    try:
        members["combinations"] = found.combinations()
    except TooLarge:
        members["combinations"] = None
    return Made(found.program, members, found)


#: of R_abcd, by which the independent elements that are given determine all others
RIEMANN = "R_abcd = -R_bacd = -R_abdc = R_cdab, R_abcd + R_acdb + R_adbc = 0"
_QUANTITIES = {
    "first_integrals": _Quantity(_first_integrals, ("inputs", "zero"), (), {"zero": "parameters"}),
    "routhian": _Quantity(_routhian, ("cyclic",), (), {"cyclic": "coordinates"}),
    "perturbation": _Quantity(_perturbation),
    "state_space": _Quantity(_state_space, ("inputs", "outputs")),
    "parameter_sensitivity": _Quantity(_sensitivity, ("parameters", "quantities")),
    "curvature": _Quantity(_curvature),
    "riemann": _Quantity(_curvature, (), ("riemann",)),
    "ricci": _Quantity(_curvature, (), ("ricci",)),
    "scalar_curvature": _Quantity(_curvature, (), ("scalar_curvature",)),
    "adjoint": _Quantity(_adjoint, ("controls", "running", "terminal", "parameters"), (), {"parameters": "varied"}),
    "base_parameters": _Quantity(_base_parameters, ("drives",), ("grouping", "base_parameters"), needs_parts=True),
    "base_regressor": _Quantity(_base_parameters, ("drives",), ("base_regressor",), needs_parts=True),
}
QUANTITIES = tuple(_QUANTITIES)
#: those that need the parts of the tree, beside its formulas
OF_PARTS = tuple(name for name, quantity in _QUANTITIES.items() if quantity.needs_parts)
#: formulas that follow from a model and a document: what checks its shape, and what makes them
WITH_DOCUMENT: dict[str, tuple[Callable[[Any], object], Callable[[Source, Any], Made]]] = {
    "velocity-equations": (read_constraints, velocity_equations_of)
}
