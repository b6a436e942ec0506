"""What acts between two frames of one part, in the places that its bodies have in a tree. Parts store the generalised
forces of these alone, so that the laws are read again from their definitions.
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.expr.graph import Expr
from substructures.loads.document import LoadFormulas
from substructures.loads.names import End, Names
from substructures.loads.pairs import Acting, Place, Reach
from substructures.mechanics.linear3 import Vector
from substructures.part.forces.wrenches import acts_on_host
from substructures.tree.assembly import Assembly
from substructures.tree.forces.loads import LoadNames
from substructures.tree.mounted_part import PlacedPart, joint_position


def loads_of_parts(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Sequence[Acting]:
    """Of all parts; ``rates``: q'^a. What acts on bodies or on coordinates alone is not among them."""
    names, found = LoadNames(assembly, placed, rates), LoadFormulas(Reach({}), assembly.scope.graph.zero)
    for instance, here in zip(assembly.instances, placed, strict=True):
        inside = _Inside(names, here, instance.name)
        for load in here.part.definition.loads:
            # wrenches on bodies are stored (PlacedPart.applied_wrenches); faults were told when the part was derived
            law = None if acts_on_host(load) else load.law(inside, "")
            if law is not None:
                law.acts(inside, found)
    return found.forces.acting


class _Inside(Names):
    """The names of one part in a tree."""

    def __init__(self, names: LoadNames, here: PlacedPart, instance: str) -> None:
        self.names, self.here, self.instance = names, here, instance
        layout = here.part.topology
        self.coordinates = {layout.joints[c].coordinate: here.first + c for c in layout.movers}
        self.moved = {
            joint.coordinate: (layout.coordinates[layout.moved_by[c]], here.first + c)
            for c, joint in enumerate(layout.joints)
            if c not in layout.movers
        }
        super().__init__(names.scope)

    @property
    def rates(self) -> Sequence[Expr]:
        """q'^a of the tree."""
        return self.names.rates

    def plain(self, name: str) -> Expr | None:
        """What a name of the definition stands for in the tree."""
        joint = self.moved.get(name.removesuffix("'"))
        if joint is not None:
            return (
                self.rates[joint[1]]
                if name.endswith("'")
                else joint_position(self.graph, self.here.mounted, joint[1] - self.here.first)
            )
        return self.names.plain(name if name == "t" else f"{self.instance}.{name}")

    def constant(self, name: str) -> Expr | None:
        """A parameter of the definition."""
        return self.names.constant(f"{self.instance}.{name}")

    def anchor(self, end: End, point: Vector) -> Place:
        """A point of a body or port."""
        return self.here.place(self.here.part.frames.index(end.frame), point)

    def place(self, anchor: Place) -> Place:
        """The anchor itself."""
        return anchor
