"""Equations of motion with velocity constraints, and solved for the accelerations."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from service.models.formulas.entry import Made, Options, Quantity
from service.models.requests import arguments, read_request
from service.models.source import Source
from service.schemas.analyses.velocity_constraints import VelocityConstraints
from substructures.analysis.equations.nonholonomic.independent_rows import place_of_zero
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import dynamics
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.errors import TooLarge


def velocity_equations_of(source: Source, body: Any) -> Made:
    """Voronets' and Boltzmann-Hamel equations of a model with velocity constraints.

    Raises InvalidInput with pointers into the body, TooLarge.
    """
    found = quasi_velocity_equations(source.model, **arguments(read_constraints(body)))
    members = members_of(found)
    size, limit = len(found.program), source.limits.program_nodes
    if size > limit:
        raise TooLarge("the formulas (in operations)", size, limit)
    return Made(found.program, members)


def members_of(found: QuasiVelocities) -> dict[str, Any]:
    """What the axes of formulas in quasi-velocities are, with a warning where these do not describe the motion."""
    names = {"velocities": found.velocities, "constraints": found.constraints, "gaps": found.gaps}
    members: dict[str, Any] = {name: list(value) for name, value in (names | {"dependent": found.dependent}).items()}
    if found.determinant is not None:
        called = ", ".join(found.velocities)
        message = f"the velocities {called} do not describe the motion where {found.singular} is zero, nor do formulas"
        advice = "give 'velocities' that always do, or 'independent' ones for where the motion is"
        members["warnings"] = [{"pointer": "", "code": "singular-velocities", "message": f"{message}: {advice}"}]
    return members


def motion_equations(source: Source, options: Options) -> QuasiVelocities:
    """In velocities of coordinates, by default those that describe the motion well where all coordinates are 0."""
    model, independent = source.model, options.get("independent")
    near = None if independent else place_of_zero(model)
    if independent and {*independent} <= {*model.coordinates}:
        independent = tuple(sorted(independent, key=model.coordinates.index))
    return quasi_velocity_equations(model, closing(model), independent=independent, near=near)


def _velocity_dynamics(source: Source, options: Options) -> Made:
    found = motion_equations(source, options)
    return Made(dynamics(found), members_of(found))


def read_constraints(body: Any) -> BaseModel:
    """A body of ``velocity-equations``. Raises InvalidDocument."""
    return read_request(VelocityConstraints, body)


#: formulas that follow from a model and a document: what checks its shape, and what makes them
WITH_DOCUMENT = {"velocity-equations": (read_constraints, velocity_equations_of)}
QUANTITIES = {"velocity_dynamics": Quantity(_velocity_dynamics, ("independent",))}
