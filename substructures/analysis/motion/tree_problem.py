"""A motion of a tree that is asked for, and what does not go together in it."""

from __future__ import annotations

from dataclasses import dataclass, field

from substructures.analysis.motion.integrators.compiled_steps import EXPLICIT
from substructures.analysis.motion.problems.kinds import TreeMotion
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.resets import acting
from substructures.errors import InvalidArgument

#: that begin anew, and come back to closed contacts, after any step
OF_CONTACTS = (*EXPLICIT, "Radau")
#: laws of friction that steps of a fixed size do not take
WHY_NOT = {
    "exact": "joints that stick exactly need steps of any size",
    "loaded": "friction by the load of joints is iterated",
}


@dataclass(frozen=True, kw_only=True)
class TreeProblem(MotionProblem):
    """A motion of a tree without closures, q'' = g^-1 (Q - Gamma q' q')."""

    kind: TreeMotion = field(default_factory=TreeMotion)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.kind.friction in WHY_NOT and self.integrator.fixed_step:
            message = f"{WHY_NOT[self.kind.friction]}: leave 'fixed_step' out"
            raise InvalidArgument.at("/friction", "not-supported", message)
        if self.kind.contacts and self.integrator.method not in OF_CONTACTS:
            words = ", ".join(f"'{method}'" for method in OF_CONTACTS)
            message = f"contacts are followed by single steps of any size: take one of {words}"
            place = "/method" if self.integrator.fixed_step is None else "/fixed_step"
            raise InvalidArgument.at(place, "not-supported", message)
        if self.kind.contacts and acting(self.events):
            i = next(i for i, event in enumerate(self.events) if event.reset)
            message = "events do not act beside contacts, which have impacts of their own: leave 'reset' out"
            raise InvalidArgument.at(f"/events/{i}/reset", "not-supported", message)
