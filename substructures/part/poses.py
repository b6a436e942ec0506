"""Poses of a definition: coordinates by name with constant values, for pictures and the first pose of pages."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.errors import among
from substructures.expr.graph import Graph
from substructures.loads.scope import Scope, no_names
from substructures.part.definition import Definition

#: the pose of pictures
HOME = "home"


def require_poses(definition: Definition, coordinates: Sequence[str]) -> None:
    """Raise InvalidDocument for coordinates that are not there, and for values that are no constants."""
    scope = Scope(Graph())
    for pose, given in definition.poses.items():
        for name, value in given.items():
            pointer = f"/poses/{pose}/{name}"
            if name not in coordinates:
                scope.fault(pointer, "unknown-coordinate", f"there is no coordinate '{name}'{among(name, coordinates)}")
            scope.read(value, pointer, no_names)
    scope.finish()
