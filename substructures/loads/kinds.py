"""All types of loads."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import ConfigDict, Field, RootModel

from substructures.documents.fields import BY_TYPE
from substructures.loads.bushing import Bushing, BushingLoad
from substructures.loads.cable import CableLoad, TreeCable
from substructures.loads.friction import FrictionLoad, TreeFriction
from substructures.loads.joint import JointLoad, TreeJointLoad
from substructures.loads.potential import PotentialLoad, TreePotential
from substructures.loads.spring import SpringLoad, TreeSpring
from substructures.loads.vectors import ForceOfPart, TorqueOfPart, TreeForce, TreeTorque


def _without_mapping(schema: dict[str, Any]) -> None:
    """OpenAPI has no discriminator that maps a word to two schemas."""
    schema.pop("discriminator", None)


LoadOfPart = Annotated[
    ForceOfPart | TorqueOfPart | SpringLoad | BushingLoad | CableLoad | JointLoad | PotentialLoad | FrictionLoad,
    Field(discriminator="type", json_schema_extra=_without_mapping),
    BY_TYPE,
]
LoadOfTree = Annotated[
    TreeSpring | Bushing | TreeCable | TreeForce | TreeTorque | TreeJointLoad | TreePotential | TreeFriction,
    Field(discriminator="type"),
    BY_TYPE,
]


class AnyTreeLoad(RootModel[Any]):
    """One load of a tree, by its type."""

    model_config = ConfigDict(defer_build=True)
    root: LoadOfTree


def acts_on(given: Mapping[str, Any]) -> list[str]:
    """What a load of a tree acts on, from its document: its frames one after the other, or a coordinate."""
    load = AnyTreeLoad.model_validate(given, context={"stored": True}).root
    return [end.frame for end in load.ends("")] or [given[name] for name in ("coordinate",) if name in given]
