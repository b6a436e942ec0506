"""Constraints on velocities as they are sent; what they mean: substructures.analysis.equations.nonholonomic."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from service.schemas.measured import METRES
from service.schemas.parts import RequestPart
from substructures.analysis.equations.nonholonomic import velocity_constraints as science
from substructures.documents import DocumentPart
from substructures.documents.fields import BY_TYPE, Name, PlainNumber
from substructures.tree.given.ties import KnifeEdgeConstraint, LinearConstraint, RollingConstraint


class Linear(LinearConstraint, RequestPart):
    """An expression that is zero, affine in the velocities: B(q) q' + b(q, t), b what a table or a belt gives."""

    def value(self) -> science.Linear:
        """As the science takes it."""
        return science.Linear(self.name, self.expression)


class KnifeEdge(KnifeEdgeConstraint, RequestPart):
    """A skate: no velocity across the edge, which lies along the first axis of the frame."""

    def value(self) -> science.KnifeEdge:
        """As the science takes it."""
        return science.KnifeEdge(self.name, self.frame)


class Rolling(RollingConstraint, RequestPart):
    """A disc (axis: third axis of the frame) or a sphere that rolls on a plane without slip."""

    radius: Annotated[PlainNumber, METRES] = Field(description="m")

    def value(self) -> science.Rolling:
        """As the science takes it."""
        return science.Rolling(self.name, self.frame, self.radius, self.shape, self.normal)


class Closed(RequestPart):
    """A closure of the tree by its name, of a part by ``instance.closure``."""

    type: Literal["closure"]
    name: Annotated[str, Field(max_length=140)]

    def value(self) -> science.Closed:
        """As the science takes it."""
        return science.Closed(self.name)


Constraint = Annotated[Linear | KnifeEdge | Rolling | Closed, Field(discriminator="type"), BY_TYPE]


class VelocityConstraints(DocumentPart):
    """Constraints, and the quasi-velocities in which the motion is described.

    ``velocities``: as many as the constraints leave free, by name, each an expression linear in the velocities; or
    ``independent``: the coordinates whose velocities are used; default: chosen for short formulas.
    """

    constraints: tuple[Constraint, ...] = Field((), max_length=100)
    velocities: dict[Name, str] | None = Field(None, max_length=100)
    independent: tuple[str, ...] | None = Field(None, max_length=500)
