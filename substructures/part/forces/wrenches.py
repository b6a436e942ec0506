"""Forces and torques that act on the host, too: one row of the outputs ``load.at`` and ``load.vector`` for each body.

A force or torque on a body is one row. One between two frames with a vector in the axes of the world is two, on ``to``
and opposite on ``from``: how the interface stands in the world is known to the tree alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeGuard

from substructures.loads.names import Names, names_in
from substructures.loads.vectors import ForceBetween, ForceLoad, TorqueBetween, TorqueLoad
from substructures.mechanics.linear3 import ZERO, Vector, apply, cross, sub, transpose
from substructures.mechanics.wrench import Wrench
from substructures.part.definition import Definition

WrenchLoad = ForceLoad | TorqueLoad | ForceBetween | TorqueBetween


@dataclass(frozen=True)
class AppliedWrench:
    """A force at a point, or a moment: ``at`` [m] in the carrier's body frame, vector in its axes or in the world's.

    ``point_of``: the carrier in whose body frame ``at`` is given, if it is another one.
    """

    carrier: int
    moment: bool
    world: bool
    at: Vector
    vector: Vector
    point_of: int | None = None


@dataclass(frozen=True)
class WrenchRow:
    """``frame``: a body or port; ``alone``: whether nothing acts against it within the part."""

    load: WrenchLoad
    frame: str
    world: bool
    alone: bool

    @property
    def moment(self) -> bool:
        """Whether it is a torque."""
        return self.load.type == "torque"


def acts_on_host(load: object) -> TypeGuard[WrenchLoad]:
    """Whether it is kept as wrenches: on a body, or between two frames with a vector in the axes of the world."""
    between = isinstance(load, ForceBetween | TorqueBetween) and load.axes == "world"
    return between or isinstance(load, ForceLoad | TorqueLoad)


def wrench_rows(definition: Definition) -> Iterator[WrenchRow]:
    """All rows, in the order of the loads."""
    for load in definition.loads:
        if isinstance(load, ForceLoad | TorqueLoad):
            yield WrenchRow(load, load.body, load.frame == "world", True)
        elif acts_on_host(load):
            # `to` first: these rows, the wrenches below and what is stored have one order
            yield from (WrenchRow(load, end.frame, True, False) for end in reversed(load.ends("")))


def read_wrenches(names: Names, load: WrenchLoad, pointer: str) -> list[AppliedWrench]:
    """The wrenches of a load; none after a fault."""
    vector: Vector = names.vector(load.vector, f"{pointer}/vector")
    ends = [names.end(end) for end in load.ends(pointer)]
    if None in ends:
        return []
    moment, last = load.type == "torque", ends[-1]
    at = ZERO if moment else last.position
    if isinstance(load, ForceLoad | TorqueLoad):
        is_world = load.frame == "world"
        # from the axes of the body to those of its carrier: E^T v
        own = vector if is_world else apply(transpose(last.E), vector)
        return [AppliedWrench(last.carrier, moment, is_world, at, own)]
    # the opposite force acts where the first one does, at a point of `to`, past which `from` moves
    point_of = None if moment or ends[0].carrier == last.carrier else last.carrier
    on = AppliedWrench(last.carrier, moment, True, at, vector)
    return [on, AppliedWrench(ends[0].carrier, moment, True, at, sub(ZERO, vector), point_of)]


def wrench_places(definition: Definition, carrier: Mapping[str, int]) -> tuple[tuple[int, bool, bool], ...]:
    """(carrier, moment, world) of every row: what coupling has to know beside the formulas; ``carrier``: of bodies."""
    frames = {**carrier, **{port.name: carrier[port.body] for port in definition.ports}}
    return tuple((frames[row.frame], row.moment, row.world) for row in wrench_rows(definition))


def dead_loads(definition: Definition) -> tuple[bool, ...]:
    """Of every row, whether it is a force that is constant in the world: V = -F . x."""
    return tuple(
        row.alone
        and row.world
        and not row.moment
        and all(names_in(x) <= definition.parameters.keys() for x in row.load.vector)
        for row in wrench_rows(definition)
    )


def steady_loads(definition: Definition, coordinates: Iterable[str]) -> tuple[bool, ...]:
    """Of every row, whether its vector depends on coordinates and parameters alone, but for those with a potential in
    closed form (:func:`dead_loads`) and for pairs, which are not tried.
    """
    known = definition.parameters.keys() | set(coordinates)
    return tuple(
        row.alone and not is_dead and all(names_in(x) <= known for x in row.load.vector)
        for row, is_dead in zip(wrench_rows(definition), dead_loads(definition), strict=True)
    )


def wrench_about_origin(at: Vector, vector: Vector, moment: bool) -> Wrench:
    """(F, x cross F) of a force F [N] at a point x [m], or (0, M) of a moment M [N m]: the wrench about the carrier's
    body frame origin.
    """
    return Wrench(ZERO, vector) if moment else Wrench(vector, cross(at, vector))
