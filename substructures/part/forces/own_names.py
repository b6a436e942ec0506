"""The names of a part where its loads are read and act: its own coordinates, bodies and ports."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

from substructures.errors import among, meant
from substructures.expr.graph import Expr
from substructures.loads.names import LEFT_OUT, Elastic, End, Names
from substructures.loads.pairs import Place, Reach
from substructures.mechanics.kinematics import base_functions, links
from substructures.mechanics.linear3 import IDENTITY, ZERO, Vector, dot, sub
from substructures.part.forces.load_names import depends_on_state
from substructures.part.forces.potentials import spring_potential
from substructures.part.frames import Frame
from substructures.part.kinematics import Kinematics, kinematics, own_place, point_kinematics
from substructures.part.mechanism import Mechanism


class OwnNames(Names):
    """Of a part; its kinematics ``k`` are formed where a measure needs them, if they are not given."""

    def __init__(self, m: Mechanism, k: Kinematics | None = None) -> None:
        self.m, self._k = m, k
        self.coordinates = {m.topology.joints[a].coordinate: a for a in m.topology.movers}
        self.joints = {joint.coordinate: a for a, joint in enumerate(m.topology.joints)}
        of = m.topology.moved_by
        self.moved = {
            name: (m.topology.coordinates[of[a]], a) for name, a in self.joints.items() if name not in self.coordinates
        }
        super().__init__(m.scope)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Poses and columns."""
        if self._k is not None:
            return self._k
        chain = links(self.m.joints)
        return kinematics(chain, base_functions(chain))

    @cached_property
    def rates(self) -> Sequence[Expr]:
        """q'^a of all joints."""
        return [rate for name in self.joints if (rate := self.m.names(f"{name}'")) is not None]

    def plain(self, name: str) -> Expr | None:
        """Parameters, the time, inputs, coordinates and velocities."""
        return self.m.names(name)

    def constant(self, name: str) -> Expr | None:
        """A parameter."""
        return self.scope.names.get(name)

    def is_world(self, frame: str) -> bool:
        """A part has frames of its own alone."""
        del frame
        return False

    def anchor(self, end: End, point: Vector) -> Frame | None:
        """A point of a body or port."""
        frames = self.m.bodies if end.is_body else {**self.m.bodies, **self.m.ports}
        if end.frame in frames:
            return frames[end.frame].placed(IDENTITY, point)
        if end.is_body:
            like = among(end.frame, frames, len(self.scope.faults))
            self.scope.fault(end.pointer, "unknown-body", f"unknown body '{end.frame}'{like}")
        else:
            message = f"no body or port '{end.frame}'; there are {', '.join(frames)}{meant(end.frame, frames)}"
            self.scope.fault(end.pointer, "unknown-frame", message)
        return None

    def place(self, anchor: Frame) -> Place:
        """In the interface frame."""
        return own_place(self.kinematics, anchor)

    def stretch(self, ends: Sequence[Frame]) -> tuple[Reach, Expr]:
        """By the velocities of the points, which take the fewest operations in the interface frame."""
        start, end = (point_kinematics(self.kinematics, frame.carrier, frame.position) for frame in ends)
        x, both = sub(end.position, start.position), {**start.u, **end.u}
        reach = {a: self.graph.lift(dot(x, sub(end.u.get(a, ZERO), start.u.get(a, ZERO)))) for a in both}
        return Reach(reach), self.graph.lift(dot(x, x))

    def elastic(self, spring: Elastic, energy: Expr, pulls: Callable[[], Mapping[int, Expr]]) -> Expr:
        """Where the spring depends on the state, 2 V of what is found of its force."""
        if self.measures_in(*spring.given):
            return self.kept(energy, False, spring.pointer)
        if not depends_on_state(self.m.topology.coordinates, spring.stiffness, spring.length):
            return energy
        if self.m.topology.balls:
            self.without_potential(
                f"with ball joints no potential of this spring is looked for: {LEFT_OUT}", spring.pointer
            )
            return self.graph.zero
        # then k (l - l0)^2 / 2 is no potential of the force k (l - l0)
        forces = self.m.ratios.reduced({(a,): Q for a, Q in pulls().items()}, (0,))
        on = {i: self.graph.lift(Q) for (i,), Q in forces.items()}
        # energies of springs come doubled: their laws halve them
        return 2 * spring_potential(self.scope, self.m.topology.coordinates, on, spring.pointer)

    def formula(self, value: Any, pointer: str) -> tuple[Expr, list[Expr]]:
        """What measures frames is a force without potential."""
        lookup = self.lookup(pointer)
        force = self.scope.read(value, pointer, lookup)
        if not self.measures_in(value):
            return force, self.scope.terms(value, pointer, lookup)
        self.without_potential(f"this force measures frames, and no potential of it is looked for: {LEFT_OUT}", pointer)
        return force, []
