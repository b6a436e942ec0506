"""What expressions of the loads of a part may name: what those of joints may, and measures of its own frames."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from substructures.errors import meant
from substructures.expr.graph import Expr
from substructures.expr.syntax import measured
from substructures.part.frames import Frame
from substructures.part.kinematics import Kinematics, own_kinematics, own_place
from substructures.part.load_names import load_names, names_in, state
from substructures.part.mechanism import Mechanism
from substructures.part.pair_laws import Measures
from substructures.part.pairs import Place
from substructures.part.scope import Lookup


class OwnNames:
    """The names of a part at their places; its kinematics are formed where a measure needs them."""

    def __init__(self, m: Mechanism) -> None:
        self.m = m
        self.plain = load_names(m.scope, m.definition, m.topology)
        self.measures = Measures(m.scope, self._place, self.plain, self._rates)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Poses and columns."""
        return own_kinematics(self.m)

    def at(self, pointer: str) -> Lookup:
        """The lookup of names of the expression at a pointer."""
        return self.measures.at(pointer)

    def is_steady(self, *values: Any) -> bool:
        """Whether numbers or expressions name parameters, inputs and the time alone, nothing that moves."""
        moving = state(self.m.topology)
        return not self.measures_in(*values) and all(names_in(value).isdisjoint(moving) for value in values)

    def measures_in(self, *values: Any) -> bool:
        """Whether they name measures of frames."""
        return any(measured(name) is not None for value in values for name in names_in(value))

    def frame(self, name: str, pointer: str) -> Frame | None:
        """A body or port; a fault, and None, where there is none."""
        frames = {**self.m.bodies, **self.m.ports}
        if name not in frames:
            message = f"no body or port '{name}'; there are {', '.join(frames)}{meant(name, frames)}"
            self.m.scope.fault(pointer, "unknown-frame", message)
        return frames.get(name)

    def _place(self, name: str, pointer: str) -> Place | None:
        frame = self.frame(name, pointer)
        return None if frame is None else own_place(self.kinematics, frame)

    def _rates(self) -> Sequence[Expr]:
        rates = (self.plain(f"{name}'") for name in self.m.topology.coordinates)
        return [rate for rate in rates if rate is not None]
