"""What is left of the equations for small changes: of the motion, and of parameters."""

from __future__ import annotations

from typing import Any

from service.models.formulas.constraints import members_of, motion_equations
from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.analysis.equations.formulas import inputs_of, multipliers_of
from substructures.analysis.equations.nonholonomic.linearised import linearised
from substructures.analysis.equations.nonholonomic.solved import state_space as constrained_state_space
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.analysis.equations.perturbation import perturbation, state_space
from substructures.analysis.motion.parameter_sensitivity import QUANTITIES as VARIED
from substructures.analysis.motion.parameter_sensitivity import sensitivity_formulas
from substructures.errors import InvalidDocument


def _perturbation(source: Source, _: Options) -> Made:
    members: dict[str, Any] = {"coordinates": list(source.model.coordinates), "inputs": inputs_of(source.model)}
    if source.model.velocity_constraints:
        # in the velocities that are chosen for short formulas
        equations, matrices = linearised(source.model, constraints_of(source.model), (None, None, None))
        names = {"velocities": equations.velocities, "constraints": equations.constraints, "gaps": equations.gaps}
        return Made(matrices, members | {name: list(some) for name, some in names.items()})
    if source.model.closures:
        members["multipliers"] = multipliers_of(source.model)
    return Made(perturbation(source.model), members)


def _state_space(source: Source, options: Options) -> Made:
    model, outputs, inputs = source.model, options.get("outputs", ()), options.get("inputs")
    state = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    members = {"state": state, "inputs": list(inputs or inputs_of(model)), "expressions": list(outputs)}
    members |= {"positions": list(model.positions)} if model.balls else {}
    if model.velocity_constraints or model.closures:
        equations = motion_equations(source, options)
        members["state"] = [*model.coordinates, *equations.velocities]
        return Made(constrained_state_space(equations, outputs, inputs), members | members_of(equations))
    if "independent" in options:
        message = "without closures and velocity constraints all coordinates have velocities of their own"
        raise InvalidDocument.at("/independent", "not-supported", message)
    return Made(state_space(model, outputs, inputs), members)


def _sensitivity(source: Source, options: Options) -> Made:
    parameters = options.get("parameters", tuple(source.model.parameters))
    return Made(sensitivity_formulas(source.model, parameters, options.get("quantities", VARIED)))


QUANTITIES = {
    "perturbation": Quantity(_perturbation),
    "state_space": Quantity(_state_space, ("inputs", "outputs", "independent")),
    "parameter_sensitivity": Quantity(_sensitivity, ("parameters", "quantities")),
}
