"""Forces and torques: on a body of a part (with the host, too: kept as wrenches, see
:mod:`substructures.part.forces.wrenches`), or between two frames A (``from``) and B (``to``).

A force F: Q_a = F . (u_Ba - u_Aa) at the place of the point of B, and V = -F . x where it is constant in the world and
from there. A torque M: Q_a = M . (Omega_Ba - Omega_Aa).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from substructures.documents.fields import Name, NumberVector
from substructures.documents.units import Dimension
from substructures.loads.document import NONE, EndsOfPart, EndsOfTree, Load, LoadFormulas
from substructures.loads.names import End, Names
from substructures.loads.pairs import axes_in_world
from substructures.loads.scope import ExprVector
from substructures.loads.units import FORCE, TORQUE
from substructures.mechanics.linear3 import dot

_AXES = "in whose axes the vector is"


class _Vector(Load):
    vector: NumberVector


class _Force(_Vector):
    dimensions: ClassVar[Mapping[str, Dimension]] = {"vector": FORCE}

    type: Literal["force"]
    vector: NumberVector = Field(description="N")


class _Torque(_Vector):
    dimensions: ClassVar[Mapping[str, Dimension]] = {"vector": TORQUE}

    type: Literal["torque"]
    vector: NumberVector = Field(description="N m")


class _OnBody(_Vector):
    body: Name
    frame: Literal["body", "world"] = "body"


class ForceLoad(_Force, _OnBody):
    """A force at a point of a body."""

    at: NumberVector = Field(NONE, description="m")

    def ends(self, pointer: str) -> tuple[End, ...]:
        """Its point."""
        return (End(self.body, f"{pointer}/body", self.at, f"{pointer}/at", is_body=True),)


class TorqueLoad(_Torque, _OnBody):
    """A free moment on a body."""

    def ends(self, pointer: str) -> tuple[End, ...]:
        """Its body."""
        return (End(self.body, f"{pointer}/body", is_body=True),)


class _Opposite(_Vector):
    """A vector on B and the opposite one on A."""

    axes: Literal["to", "from", "world"] = Field("to", description=_AXES)

    def law(self, names: Names, pointer: str) -> VectorLaw | None:
        """Its ends and vector."""
        ends = [names.end(end) for end in self.ends(pointer)]
        vector = names.vector(self.vector, f"{pointer}/vector")
        return None if None in ends else VectorLaw(self, ends, vector)


class _Point(_Force):
    points: ClassVar[Mapping[str, str]] = {"to": "at"}

    at: NumberVector = Field(NONE, description="m; the point in the frame 'to'")


class ForceBetween(_Point, _Opposite, EndsOfPart):
    """A force on the frame ``to`` at a point; the opposite force acts on ``from`` at the same place."""


class TorqueBetween(_Torque, _Opposite, EndsOfPart):
    """A free moment on the frame ``to``; the opposite one acts on ``from``."""


class _BetweenOfTree(_Opposite, EndsOfTree):
    def of_part(self, fields: dict[str, Any]) -> dict[str, Any]:
        """What acts from the world acts on a body of the part, from outside."""
        if self.from_ != "world":
            return fields
        axes, _ = fields.pop("axes"), fields.pop("from")
        return fields | {"body": fields.pop("to"), "frame": "body" if axes == "to" else "world"}


class TreeForce(_Point, _BetweenOfTree):
    """A force on ``to`` at a point; the opposite force acts on ``from`` at the same place."""


class TreeTorque(_Torque, _BetweenOfTree):
    """A free moment on ``to``; the opposite one acts on ``from``."""


@dataclass(frozen=True)
class VectorLaw:
    """Its ends and vector."""

    load: _Opposite
    ends: list[Any]
    vector: ExprVector

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Force and potential."""
        pair, axes = names.pair(self.ends), self.load.axes
        vector = self.vector if axes == "world" else axes_in_world(pair.A if axes == "from" else pair.B, self.vector)
        if isinstance(self.load, _Torque):
            found.add(pair.reach(N=vector))
            return
        found.add(pair.reach(F=vector))
        start, _ = self.load.ends("")
        if names.is_world(start.frame) and axes != "to" and pair.B.path and names.is_constant(*self.load.vector):
            # V = -F . x of a force that is constant in the world
            found.keep(-names.graph.lift(dot(vector, pair.B.pose.r)))


def _one_or_two(data: Any) -> str:
    """Whether a force or torque acts on one body, or between two frames."""
    named = data if isinstance(data, Mapping) else type(data).model_fields
    return "between" if {"from", "from_", "to"} & set(named) else "on"


#: of parts: a force or torque on a body, or between two frames
ForceOfPart = Annotated[
    Annotated[ForceLoad, Tag("on")] | Annotated[ForceBetween, Tag("between")], Discriminator(_one_or_two)
]
TorqueOfPart = Annotated[
    Annotated[TorqueLoad, Tag("on")] | Annotated[TorqueBetween, Tag("between")], Discriminator(_one_or_two)
]
