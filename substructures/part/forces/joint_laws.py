"""What joints do by themselves: springs, dampers, rotors, stops and dry friction, as they are read of a definition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.documents.fields import in_si
from substructures.expr.graph import Expr
from substructures.loads.friction import Friction, FrictionLaw, FrictionLoad, read_friction
from substructures.loads.scope import Lookup, Scope
from substructures.part.definition import BearingFriction, Body, Definition, JointFriction
from substructures.part.topology import JointEntry


@dataclass(frozen=True)
class Stops:
    """End stops of a coordinate: -(k + c p') p against the depth p beyond ``low`` or ``high`` [rad or m].

    ``stiffness``: k [N m/rad or N/m]; ``damping``: c [N m s/rad^2 or N s/m^2]; expressions in parameters.
    """

    low: Expr
    high: Expr
    stiffness: Expr
    damping: Expr


@dataclass(frozen=True)
class JointLaw:
    """Q_a = -k (q - rest) - c q', less stops and friction, of a joint, and its rotor in g_aa; expressions.

    ``stiffness``: k [N m/rad or N/m]; ``rest`` [rad or m]; ``damping``: c [N m s/rad or N s/m]; ``armature`` [kg m^2 or
    kg]; ``given``: stiffness and rest as written.
    """

    stiffness: Expr
    rest: Expr
    damping: Expr
    armature: Expr
    given: tuple[Any, Any]
    stops: Stops | None = None
    friction: Friction | None = None


def friction_of(definition: Definition, entry: JointEntry) -> FrictionLaw | None:
    """The friction of a coordinate as it is given, by its joint or by a load."""
    given = definition.bodies[entry.body].joint.friction
    if isinstance(given, tuple):
        given = given[entry.step]
    loads = (x for x in definition.loads if isinstance(x, FrictionLoad) and x.coordinate == entry.coordinate)
    return given or next(loads, None)


class JointLaws:
    """Reads them with the ``names`` of loads; ``entries``: the coordinates of every joint, by body."""

    def __init__(
        self, definition: Definition, entries: Mapping[int, Sequence[JointEntry]], scope: Scope, names: Lookup
    ) -> None:
        self.definition, self.entries, self.scope, self.names = definition, entries, scope, names

    def law(self, entry: JointEntry, body: Body, pointer: str) -> JointLaw:
        """Of one coordinate of the joint at a pointer."""
        limits = self._limits(entry, body, pointer)
        values, givens = {}, {}
        for name in ("stiffness", "rest", "damping", "armature"):
            given, place = self._of_step(entry, getattr(body.joint, name), f"{pointer}/{name}", "number", 0)
            givens[name] = in_si(given)
            # a spring or damper may depend on the state, as a load; a rotor is a constant
            values[name] = self.scope.read(given, place, None if name == "armature" else self.names)
        given = givens["stiffness"], givens["rest"]
        stops, friction = self._stops(entry, body, limits, pointer), self._friction(entry, body, pointer)
        return JointLaw(**values, given=given, stops=stops, friction=friction)

    def _of_step(self, entry: JointEntry, given: Any, place: str, what: str, rest: Any) -> tuple[Any, str]:
        """What is given for one coordinate of a joint, for all of them or in a list, with its place."""
        if not isinstance(given, tuple):
            return given, place
        if len(given) != len(self.entries[entry.body]):
            self.scope.fault(place, "wrong-length", f"one {what} for each of the joint's coordinates expected")
            return rest, place
        return given[entry.step], f"{place}/{entry.step}"

    def _limits(self, entry: JointEntry, body: Body, pointer: str) -> tuple[Expr, Expr] | None:
        """Lowest and highest value of a coordinate."""
        given, place = body.joint.limits, f"{pointer}/limits"
        if given and isinstance(given[0], tuple):
            if entry.step >= len(given):
                self.scope.fault(
                    place, "wrong-length", "one pair of limits for each of the joint's coordinates expected"
                )
                return None
            given, place = given[entry.step], f"{place}/{entry.step}"
        read = [self.scope.read(value, f"{place}/{i}") for i, value in enumerate(given or ())]
        return (read[0], read[1]) if read else None

    def _stops(self, entry: JointEntry, body: Body, limits: tuple[Expr, Expr] | None, pointer: str) -> Stops | None:
        """The end stops of a coordinate, where they are asked for."""
        place = f"{pointer}/limits_act"
        given, place = self._of_step(entry, body.joint.limits_act, place, "stop", None)
        if given is None:
            return None
        if limits is None:
            self.scope.fault(
                place, "stops-without-limits", "'limits_act' goes with 'limits': where do the stops begin?"
            )
            return None
        return Stops(*limits, *(self.scope.read(getattr(given, x), f"{place}/{x}") for x in ("stiffness", "damping")))

    def _friction(self, entry: JointEntry, body: Body, pointer: str) -> Friction | None:
        """The dry friction of a coordinate, if it has some."""
        given, place = self._of_step(entry, body.joint.friction, f"{pointer}/friction", "friction", None)
        for i, load in enumerate(self.definition.loads):
            if isinstance(load, FrictionLoad) and load.coordinate == entry.coordinate:
                if given is not None:
                    message = f"'{entry.coordinate}' has friction already, at {place}: a coordinate has one law of it"
                    self.scope.fault(f"/loads/{i}/coordinate", "several-frictions", message)
                given, place = load, f"/loads/{i}"
        if isinstance(given, JointFriction) and given.load is not None:
            self._bearing(entry, given.load, f"{place}/load")
        return None if given is None else read_friction(self.scope, given, place)

    def _bearing(self, entry: JointEntry, given: BearingFriction, place: str) -> None:
        """Check what reactions add to friction: simulations take it, formulas do without."""
        if entry.coordinate in (each.coordinate for each in self.definition.relations):
            message = f"'{entry.coordinate}' moves with another joint: friction by its load is not known here"
            self.scope.fault(place, "bad-friction", message)
        needed = ("radius",) if not entry.s else ()
        for name in ("coefficient", "radius", "axial_radius"):
            value = getattr(given, name)
            if value is None:
                if name in needed:
                    self.scope.fault(f"{place}/{name}", "missing", "the friction of a revolute joint has a 'radius'")
            elif entry.s and name != "coefficient":
                message = f"a prismatic joint has no '{name}': its friction is mu |R beside its axis|"
                self.scope.fault(f"{place}/{name}", "bad-friction", message)
            else:
                x = self.scope.read(value, f"{place}/{name}")
                if x.is_number and x.negative and not self.scope.faults:
                    self.scope.fault(f"{place}/{name}", "bad-friction", f"{name} of friction is not negative")
