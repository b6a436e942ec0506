"""Equations of motion with velocity constraints."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from service.models.formulas.entry import Made
from service.models.requests import arguments, read_request
from service.models.source import Source
from service.schemas.analyses.velocity_constraints import VelocityConstraints
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.errors import TooLarge


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


#: formulas that follow from a model and a document: what checks its shape, and what makes them
WITH_DOCUMENT = {"velocity-equations": (read_constraints, velocity_equations_of)}
