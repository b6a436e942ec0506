"""A cable or belt over pulleys: a spring and damper along the sum of the distances of consecutive points.

    L = sum l_i,   l_i = |d_i| = |p_{i+1} - p_i|,   dL/dq^a = sum d_i . (u_{i+1,a} - u_{i,a}) / l_i,
    Q_a = -T dL/dq^a,   T = k (L - L0) + c L',   V = k/2 (L - L0)^2

It slides without friction through all points but its ends. One that can be slack pulls only: T = k p, V = k/2 p^2 with
p = max(0, L - L0) = (x + |x|)/2, x = L - L0 and |x| = sqrt(x^2), as end stops do.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import ClassVar, Literal

from pydantic import Field

from substructures.documents.fields import DocumentPart, Name, NumberVector
from substructures.loads.document import NONE, ElasticLoad, FrameOfTree, LoadFormulas, OfTree
from substructures.loads.names import Elastic, End, Names
from substructures.loads.pairs import Reach, rate, scaled

MOST = 100
_ALONG = "from end to end: frames, or points of frames"


class PointOfPart(DocumentPart):
    """A point of a body or port."""

    frame: Name
    at: NumberVector = Field(NONE, description="m")


class PointOfTree(PointOfPart):
    """A point of a frame of a tree."""

    frame: FrameOfTree


class CableLoad(ElasticLoad):
    """A cable, belt or tendon along bodies and ports: its tension is k (L - length) + c L' of its whole length L."""

    frames: ClassVar[tuple[str, ...]] = ("along",)

    type: Literal["cable"]
    along: tuple[Name | PointOfPart, ...] = Field(min_length=2, max_length=MOST, description=_ALONG)
    slack: bool = Field(False, description="whether it pulls only, and is slack where it is shorter; without damping")

    def ends(self, pointer: str) -> tuple[End, ...]:
        """All points."""
        return tuple(_end(point, f"{pointer}/along/{i}") for i, point in enumerate(self.along))

    def law(self, names: Names, pointer: str) -> CableLaw | None:
        """Its points and numbers."""
        found = self.read(names, pointer)
        if self.slack and found is not None and not found.damping.is_zero:
            message = f"the {self.called} can be slack: its force would jump with damping, which it has none of"
            names.scope.fault(f"{pointer}/damping", "damping-of-slack", message)
        return None if found is None else CableLaw(found, self.slack, self.called)


class TreeCable(OfTree, CableLoad):
    """A cable, belt or tendon along frames of a tree: its tension is k (L - length) + c L' of its whole length L."""

    along: tuple[FrameOfTree | PointOfTree, ...] = Field(min_length=2, max_length=MOST, description=_ALONG)


def _end(given: str | PointOfPart, pointer: str) -> End:
    if isinstance(given, str):
        return End(given, pointer)
    return End(given.frame, f"{pointer}/frame", given.at, f"{pointer}/at")


@dataclass(frozen=True)
class CableLaw:
    """Its points and numbers, whether it pulls only, and what messages call it."""

    given: Elastic
    slack: bool
    called: str

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Force and potential."""
        whole = self._whole(names)
        if whole is None:
            return
        k, c, reach = self.given.stiffness, self.given.damping, whole.forces
        stretch = whole.potential - self.given.length
        if self.slack:
            stretch = (stretch + names.graph.sqrt(stretch * stretch)) * Fraction(1, 2)
        pull = k * stretch
        energy = names.elastic(self.given, pull * stretch, lambda: scaled(reach, -pull))
        tension = pull if c.is_zero else pull + c * rate(names.graph, reach, names.rates)
        found.add(reach, -tension)
        found.keep(energy * Fraction(1, 2))

    def _whole(self, names: Names) -> LoadFormulas | None:
        """Its length, as the potential of a tension of 1, and dL/dq^a; None after a fault."""
        whole = LoadFormulas(Reach({}), names.graph.zero)
        for i, ends in enumerate(pairwise(self.given.ends)):
            reach, length2 = names.stretch(ends)
            if length2.is_zero:
                message = f"the points {i + 1} and {i + 2} of the {self.called} are one and the same point"
                names.scope.fault(f"{self.given.pointer}/along/{i + 1}", "coincident-ends", message)
                return None
            length = names.graph.sqrt(length2)
            whole.add(reach, 1 / length)
            whole.keep(length)
        return whole
