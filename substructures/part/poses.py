"""Poses of a definition: coordinates by name with constant values, for pictures and the first pose of pages. And its
closures, of which trees make equations (:mod:`substructures.tree.closures`), with the coordinates in which it moves.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from substructures.errors import among
from substructures.expr.graph import Graph
from substructures.loads.scope import Scope, no_names
from substructures.part.definition import Definition
from substructures.part.frames import constant, cut_frames
from substructures.part.topology import Topology

#: the pose of pictures
HOME = "home"


def posed(topology: Topology) -> tuple[str, ...]:
    """What poses give values to: coordinates that are no rates, and the places of floating joints."""
    places = (name for ball in topology.balls for name in ball.place)
    return (*(joint.coordinate for joint in topology.moving if not joint.is_rate), *places)


def require_poses(definition: Definition, topology: Topology) -> None:
    """Raise InvalidDocument for coordinates that are not there, and for values that are no constants."""
    scope, coordinates = Scope(Graph()), posed(topology)
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


def require_reduction(definition: Definition, coordinates: Sequence[str]) -> None:
    """Raise InvalidDocument for independent coordinates, starts and ranges that do not fit the closures."""
    scope, known = Scope(Graph()), definition.independent
    for field in ("independent", "start", "ranges"):
        if getattr(definition, field) and not definition.closures:
            scope.fault(f"/{field}", "no-closures", f"'{field}' goes with 'closures': nothing else moves a coordinate")
    _coordinate_faults(scope, definition, coordinates)
    if known and not set(coordinates) - set(known):
        scope.fault("/independent", "none-dependent", "of the coordinates of a loop some depend on the others")
    for name, value in definition.start.items():
        scope.read(value, f"/start/{name}", no_names)
    for name, ends in definition.ranges.items():
        low, high = (scope.read(x, f"/ranges/{name}/{i}", no_names) for i, x in enumerate(ends))
        if not scope.faults and not constant(low) < constant(high):
            scope.fault(f"/ranges/{name}", "empty-range", "the lowest value of a range comes first")
    scope.finish()


def _coordinate_faults(scope: Scope, definition: Definition, coordinates: Sequence[str]) -> None:
    known = definition.independent
    named = [(f"/independent/{i}", name) for i, name in enumerate(known)]
    named += [(f"/{x}/{name}", name) for x in ("start", "ranges") for name in getattr(definition, x)]
    for pointer, name in named:
        if name not in coordinates:
            scope.fault(pointer, "unknown-coordinate", f"there is no coordinate '{name}'{among(name, coordinates)}")
        elif pointer.startswith("/ranges") and name not in known:
            scope.fault(pointer, "not-independent", f"'{name}' is not among the independent coordinates")
    for i, name in enumerate(known):
        if name in known[:i]:
            scope.fault(f"/independent/{i}", "duplicate-name", f"'{name}' is named twice")
