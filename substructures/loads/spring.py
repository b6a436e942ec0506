"""A spring and damper between two points: Q_a = -(k (1 - l0/l) + c l'/l) d . (u_Ba - u_Aa), V = k/2 (l - l0)^2.

d, l = |d|: from the point of A (``from``) to that of B (``to``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any, ClassVar, Literal

from pydantic import Field

from substructures.documents.fields import DocumentPart, Name, NumberVector
from substructures.loads.document import NONE, ElasticLoad, EndsOfTree, LoadFormulas
from substructures.loads.names import Elastic, End, Names
from substructures.loads.pairs import rate, scaled


class _Spring(ElasticLoad):
    type: Literal["spring"]

    def law(self, names: Names, pointer: str) -> SpringLaw | None:
        """Its ends and numbers."""
        found = self.read(names, pointer)
        return None if found is None else SpringLaw(found, self.called)


class Point(DocumentPart):
    """A point fixed in a body."""

    body: Name
    at: NumberVector = Field(NONE, description="m")


class SpringLoad(_Spring):
    """A spring and damper between two points; its stiffness may depend on the state: force k (l - length) + c l'."""

    from_: Point = Field(alias="from")
    to: Point

    def ends(self, pointer: str) -> tuple[End, ...]:
        """Points of bodies."""
        return tuple(
            End(point.body, f"{pointer}/{end}/body", point.at, f"{pointer}/{end}/at", is_body=True)
            for end, point in (("from", self.from_), ("to", self.to))
        )


class TreeSpring(EndsOfTree, _Spring):
    """A spring and damper between a point of one frame and a point of another: force k (l - length) + c l'."""

    points: ClassVar[Mapping[str, str]] = {"from": "from_at", "to": "to_at"}

    from_at: NumberVector = Field(NONE, description="m; the point in the frame 'from'")
    to_at: NumberVector = Field(NONE, description="m; the point in the frame 'to'")

    def of_part(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Between points of bodies."""
        return fields | {end: {"body": fields[end], "at": fields.pop(at)} for end, at in self.points.items()}


@dataclass(frozen=True)
class SpringLaw:
    """Its ends and numbers, and what messages call it."""

    given: Elastic
    called: str

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Force and potential."""
        graph, k, c, l0 = names.graph, self.given.stiffness, self.given.damping, self.given.length
        # w_a = d . (u_Ba - u_Aa),   l l' = w_a q'^a
        reach, length2 = names.stretch(self.given.ends)
        if length2.is_zero:
            message = f"the ends of the {self.called} are one and the same point"
            names.scope.fault(self.given.pointer, "coincident-ends", message)
            return
        # of a spring without rest length: k, and 2 V = k l^2
        factor, energy = k, k * length2
        if not l0.is_zero:
            # k (1 - l0/l) in place of k, and 2 V = k (l - l0)^2
            length = graph.sqrt(length2)
            factor, energy = k - k * l0 / length, k * (length - l0) ** 2
        energy = names.elastic(self.given, energy, partial(scaled, reach, -factor))
        if not c.is_zero:
            # c l'/l = c (l l') / l^2
            factor = factor + c * rate(graph, reach, names.rates) / length2
        found.add(reach, -factor)
        found.keep(energy * Fraction(1, 2))
