"""All types of loads."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, RootModel

from substructures.documents.fields import BY_TYPE
from substructures.loads.bushing import Bushing, BushingLoad
from substructures.loads.friction import FrictionLoad, TreeFriction
from substructures.loads.joint import JointLoad, TreeJointLoad
from substructures.loads.potential import PotentialLoad, TreePotential
from substructures.loads.spring import SpringLoad, TreeSpring
from substructures.loads.vectors import ForceOfPart, TorqueOfPart, TreeForce, TreeTorque


def _without_mapping(schema: dict[str, Any]) -> None:
    """OpenAPI has no discriminator that maps a word to two schemas."""
    schema.pop("discriminator", None)


LoadOfPart = Annotated[
    ForceOfPart | TorqueOfPart | SpringLoad | BushingLoad | JointLoad | PotentialLoad | FrictionLoad,
    Field(discriminator="type", json_schema_extra=_without_mapping),
    BY_TYPE,
]
LoadOfTree = Annotated[
    TreeSpring | Bushing | TreeForce | TreeTorque | TreeJointLoad | TreePotential | TreeFriction,
    Field(discriminator="type"),
    BY_TYPE,
]


class AnyTreeLoad(RootModel[LoadOfTree]):
    """One load of a tree, by its type."""
