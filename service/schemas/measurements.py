"""States and measured motions as they are sent to analyses; SI units, angles in rad."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from service.schemas.logs import Logged
from service.schemas.measured import ACCELERATIONS, BY_NAME, COORDINATES, EFFORTS_OF_ACTUATORS, VELOCITIES
from substructures.analysis.identification.fit import ERROR_LIMIT
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC


class CurvatureRequest(DocumentPart):
    """States."""

    q: Annotated[Any, COORDINATES] = Field(description="(n,), (N, n) or columns by name; rad, m")
    parameters: Annotated[dict[str, Any], BY_NAME] = Field({}, description="in place of their defaults")


Drive = Literal["armature", "viscous", "coulomb", "offset"]


class ExcitationRequest(Logged):
    """A motion: how well does it show the base parameters?"""

    q: Annotated[Any, COORDINATES] = Field(None, description="(N, n) or columns by name; rad, m")
    qd: Annotated[Any, VELOCITIES] = Field(None, description="rad/s, m/s")
    qdd: Annotated[Any, ACCELERATIONS] = Field(None, description="rad/s^2, m/s^2")
    parameters: Annotated[dict[str, Any], BY_NAME] = Field({}, description="kinematic ones, in place of their defaults")
    drives: tuple[Drive, ...] = Field((), description="columns of drives that are taken along")


class IdentificationRequest(ExcitationRequest):
    """A measured motion."""

    tau: Annotated[Any, EFFORTS_OF_ACTUATORS] = Field(None, description="forces of the actuators, as q; N m, N")
    known: bool = Field(True, description="the tree's springs, dampers, loads and armatures act and are known")
    held_out: Annotated[float, Field(ge=0, lt=1), NUMERIC] = Field(
        0, description="part of the samples, the last, that is predicted and not fitted"
    )
    consistent: bool = Field(
        False, description="also inertia of every body that a mass distribution has, and new parts"
    )
    prior_deviation: Annotated[float, Field(gt=0, allow_inf_nan=False), NUMERIC] = Field(
        1,
        description="relative deviation of the inertia that the tree has, where consistent",
    )
    error_limit: Annotated[float, Field(gt=0, allow_inf_nan=False), NUMERIC] = Field(
        ERROR_LIMIT,
        description="part of the force of a joint that may be unexplained or uncertain in a right result",
    )
