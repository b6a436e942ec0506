"""Requests of analyses that the science has no document for; units are SI, angles in rad."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, RootModel

from substructures.analysis.motion.requests import ClosedRequest, RollingRequest, SimulationRequest
from substructures.documents import DocumentPart


class AnySimulationRequest(RootModel[SimulationRequest | ClosedRequest | RollingRequest]):
    """With ``constraints``: velocity constraints; else of a tree with closures, or with ``prescribed`` coordinates;
    else of an open tree.
    """


class SensitivityRequest(SimulationRequest):
    """A simulation, and the parameters by which its motion is differentiated."""

    by: tuple[str, ...] = Field((), description="parameters")
    of_start: bool = Field(False, description="also by coordinates and velocities at the start")


class CurvatureRequest(DocumentPart):
    """States."""

    q: Any = Field(description="(n,), (N, n) or columns by name; rad, m")
    parameters: dict[str, Any] = Field({}, description="in place of their defaults")


Drive = Literal["armature", "viscous", "coulomb", "offset"]


class ExcitationRequest(DocumentPart):
    """A motion: how well does it show the base parameters?"""

    q: Any = Field(description="(N, n) or columns by name; rad, m")
    qd: Any = Field(None, description="rad/s, m/s")
    qdd: Any = Field(description="rad/s^2, m/s^2")
    parameters: dict[str, Any] = Field({}, description="kinematic ones, in place of their defaults")
    drives: tuple[Drive, ...] = Field((), description="columns of drives that are taken along")


class IdentificationRequest(ExcitationRequest):
    """A measured motion."""

    tau: Any = Field(description="forces of the actuators, as q; N m, N")
    known: bool = Field(True, description="the tree's springs, dampers, loads and armatures act and are known")
