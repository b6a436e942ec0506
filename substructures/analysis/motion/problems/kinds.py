"""Kinds of motion: which equations are integrated, and what is to be said of each. One of them goes with a motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

from substructures.analysis.arguments import by_name, one_of, values_of
from substructures.analysis.equations.nonholonomic.velocity_constraints import Constraint, closing
from substructures.analysis.motion.problems.contacts import Contact
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import StateVector
from substructures.errors import InvalidArgument
from substructures.quantities.part_models import ReactionModel
from substructures.tree.model import Model


@dataclass(frozen=True)
class TreeMotion:
    """A tree without closures: q'' = g^-1 (Q - Gamma q' q').

    ``friction`` of joints that have some: by the smooth law of the formulas; ``exact``, set-valued at rest, with joints
    that stick; or ``loaded``, with what the reactions of joints add: ``bearings``, all reactions of the tree.
    ``contacts``: points that do not pass through planes.
    """

    friction: Literal["regularised", "exact", "loaded"] = "regularised"
    bearings: ReactionModel | None = None
    contacts: Sequence[Contact] = ()

    def __post_init__(self) -> None:
        one_of(self.friction, "friction", ("regularised", "exact", "loaded"))
        values_of(self.contacts, "contacts", Contact)
        if self.friction == "loaded" and self.bearings is None:
            message = "friction by the load of joints needs the reactions of the tree, 'bearings'"
            raise InvalidArgument.at("/friction", "needs-parts", message)
        if self.friction != "loaded" and self.bearings is not None:
            message = f"'bearings' go with 'loaded' friction, found '{self.friction}': leave them out"
            raise InvalidArgument.at("/bearings", "not-supported", message)
        if self.friction != "regularised" and self.contacts:
            message = f"contacts go with the smooth friction of joints, found '{self.friction}': leave 'friction' out"
            raise InvalidArgument.at("/friction", "not-supported", message)


@dataclass(frozen=True)
class ClosedMotion:
    """On closures or with coordinates whose motion is given: phi(q, t) = 0, with multipliers.

    ``prescribed`` coordinates move as given [rad, m]; ``fixed`` ones keep their values while the loops are closed at
    the start; ``reduction``: the state is projected onto the closures after every step, or independent coordinates are
    integrated. ``friction``: see TreeMotion; that of prescribed coordinates stays smooth.
    """

    prescribed: Mapping[str, Signal] = field(default_factory=dict)
    fixed: Sequence[str] = ()
    reduction: Literal["projection", "partitioning"] = "projection"
    friction: Literal["regularised", "exact"] = "regularised"

    def __post_init__(self) -> None:
        object.__setattr__(self, "prescribed", by_name(self.prescribed, "prescribed"))
        one_of(self.reduction, "reduction", ("projection", "partitioning"))
        one_of(self.friction, "friction", ("regularised", "exact"))


@dataclass(frozen=True)
class ConstrainedMotion:
    """With ``constraints`` on the velocities (Linear, KnifeEdge, Rolling, Closed), B q' = 0, in quasi-velocities.

    ``v``: these at the start, (p,) or by name, in place of velocities of the coordinates (default: 0). ``velocities``,
    ``independent``: see quasi_velocity_equations; where neither is given velocities of coordinates are chosen, and
    others on the way where these fail. ``form`` of the equations of motion.
    """

    constraints: Sequence[Constraint]
    velocities: Mapping[str, str] | None = None
    independent: Sequence[str] | None = None
    v: StateVector | None = None
    form: Literal["voronets", "boltzmann-hamel"] = "voronets"

    def __post_init__(self) -> None:
        if not self.constraints:
            raise InvalidArgument.at("/constraints", "too-short", "at least one constraint is needed, found none")
        values_of(self.constraints, "constraints", *get_args(Constraint))
        one_of(self.form, "form", ("voronets", "boltzmann-hamel"))


def usual_kind(model: Model, kind: ConstrainedMotion | None) -> ConstrainedMotion | None:
    """The motion in quasi-velocities: the one that is given, that of the tree with its velocity constraints and all its
    closures, or of these alone; None where it has none.
    """
    require_constrained(kind)
    constraints = closing(model) if kind is None else ()
    return ConstrainedMotion(constraints) if constraints else kind


def require_constrained(kind: object) -> None:
    """Raises InvalidArgument (``/kind``) for what is neither None nor a ConstrainedMotion."""
    if kind is not None and not isinstance(kind, ConstrainedMotion):
        message = f"a ConstrainedMotion(...) or None is needed, found {repr(kind)[:80]}"
        raise InvalidArgument.at("/kind", "wrong-type", message)


@dataclass(frozen=True)
class Geodesic:
    """A tree on which no force acts: q''^a + Gamma^a_bc q'^b q'^c = 0."""


MotionKind = TreeMotion | ClosedMotion | ConstrainedMotion | Geodesic
