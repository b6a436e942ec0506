"""What a page shows of a part or a tree: its coordinates, its formulas, and their numbers where no script runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isfinite, pi
from typing import Any

from service.pages.model.chart import Chart
from substructures.array import Array
from substructures.errors import MissingValue
from substructures.export import Interface
from substructures.expr.interpret import interpret
from substructures.expr.operations import Output
from substructures.expr.program import Program
from substructures.quantities.quantity import outputs_of

#: tabs of the formulas, and what they show where it is there
TABS = ("metric", "christoffel", "forces", "gravity", "position", "rotation")
INTEGRALS = "first_integrals"  # of trees, the last tab
LETTERS = {
    "metric": "M",
    "christoffel": "Γ",
    "forces": "Q",
    "gravity": "Q",
    "position": "r",
    "rotation": "R",
    INTEGRALS: "I",
}
TITLES = {
    "metric": "M",
    "christoffel": "Γ",
    "forces": "Q",
    "gravity": "Q of gravity",
    "position": "positions",
    "rotation": "rotations",
    INTEGRALS: "first integrals",
}


@dataclass(frozen=True)
class Shown:
    """``kind``: ``trees`` or ``substructures``; ``digests``: of what it is and of its formulas; ``outputs``: of its
    program by name; ``program``: makes the one that is evaluated; ``chart``: what its sliders are of states; ``pose``:
    the state of ``?pose=``, empty where none was given.
    """

    kind: str
    reference: str
    digests: tuple[str, str]
    joints: str
    interface: Interface
    outputs: Mapping[str, Output]
    program: Callable[[Sequence[str]], Program]
    chart: Chart
    pose: tuple[float, ...] = ()

    @property
    def path(self) -> str:
        """The address of the page."""
        return f"/{self.kind}/{self.reference}"

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Their names."""
        return self.chart.coordinates

    @property
    def tabs(self) -> tuple[str, ...]:
        """The quantities that there are."""
        found = [name for name in TABS if all(output in self.outputs for output in outputs_of(name))]
        found = [name for name in found if name != "gravity" or "forces" not in found]
        return (*found, *([INTEGRALS] if self.kind == "trees" else []))

    @cached_property
    def values(self) -> dict[str, float]:
        """Values of all symbols: the pose, zeros, defaults; parameters without default are left out."""
        vectors = self.interface.vectors
        found = dict(zip(self.chart.positions, self.pose or self.chart.rest, strict=True))
        found |= dict.fromkeys([*vectors["qd"].names, *vectors["qdd"].names, "t"], 0.0)
        for symbol in ("u", "p"):
            vector = vectors[symbol]
            defaults = vector.defaults or (0.0,) * len(vector)
            found |= {n: float(x) for n, x in zip(vector.names, defaults, strict=True) if isfinite(x)}
        return found

    def numbers(self, output: str) -> Array | None:
        """An array in the pose, None where a parameter has no value."""
        return self.evaluated(self.program([output]), output)

    def evaluated(self, program: Program, output: str) -> Array | None:
        """The same of another program."""
        try:
            return interpret(program, self.values, [output])[output]
        except MissingValue:
            return None

    @cached_property
    def ranges(self) -> list[tuple[float, float]]:
        """Limits of every coordinate; where there are none, a turn, or a metre to both sides."""
        found = self.numbers("limits") if "limits" in self.outputs else None
        free = [(-1.0, 1.0) if kind == "P" else (-pi, pi) for kind in self.joints]
        if found is None:
            return free
        pairs = ((float(low), float(high)) for low, high in found)
        both = zip(pairs, free, strict=True)
        return [p if isfinite(p[0]) and isfinite(p[1]) and p[0] < p[1] else other for p, other in both]

    def unit(self, quantity: str, index: Sequence[int]) -> str:
        """The SI unit of an entry."""
        turns = sum(self.joints[a] == "R" for a in index) if quantity not in ("position", "rotation") else 0
        if quantity in ("metric", "christoffel"):
            power = turns - (quantity == "christoffel")
            return "kg" + {0: "", 1: " m", -1: "/m"}.get(power, f" m{_raised(power)}")
        return {"position": "m", "rotation": ""}.get(quantity, "N m" if turns else "N")

    def labels(self, quantity: str) -> tuple[Sequence[str], ...]:
        """What stands along the axes of a quantity."""
        frames, axes = self.interface.frames, ("x", "y", "z")
        if quantity in ("position", "rotation"):
            return (frames, axes) if quantity == "position" else (frames, axes, axes)
        return (self.coordinates,) * len(self.outputs[quantity].shape)


def _raised(power: int) -> str:
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def read_entry(text: str) -> tuple[str, tuple[int, ...]] | None:
    """``metric,0,1`` as quantity and index; None for what is none."""
    quantity, *fields = text.split(",")
    if not fields or not all(f.isascii() and f.isdigit() and len(f) < 6 for f in fields):
        return None
    return quantity, tuple(map(int, fields))


def described(shown: Shown) -> dict[str, Any]:
    """What the scripts of the page begin with."""
    low_high = [[low, high] for low, high in shown.ranges]
    told = {"kind": shown.kind, "reference": shown.reference, "ranges": low_high, "joints": shown.joints}
    return told | {"names": shown.chart.labels, "turns": shown.chart.turns}
