"""Poses of a definition: coordinates by name with constant values, for pictures and the first pose of pages. And its
closures, of which trees make equations (:mod:`substructures.tree.closures`).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from substructures.errors import among
from substructures.expr.graph import Graph
from substructures.loads.scope import Scope, no_names
from substructures.part.definition import Definition
from substructures.part.frames import cut_frames

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


def require_closures(definition: Definition, scope: Scope, frames: Collection[str]) -> None:
    """Raise InvalidDocument for closures of frames that are not there, or with numbers that are not constant.

    ``frames``: names of bodies, ``base`` among them, and of ports.
    """
    names = [closure.name for closure in definition.closures]
    for i, closure in enumerate(definition.closures):
        pointer = f"/closures/{i}"
        if closure.name in names[:i]:
            scope.fault(f"{pointer}/name", "duplicate-name", f"duplicate closure '{closure.name}'")
        for field, frame in (("from", closure.from_), ("to", closure.to)):
            if frame not in frames:
                message = f"there is no body or port '{frame}'{among(frame, frames)}"
                scope.fault(f"{pointer}/{field}", "unknown-frame", message)
        cut_frames(scope, closure, pointer)
    scope.finish()
