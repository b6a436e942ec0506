"""The calling convention: which arguments the function of a quantity has, and what stands where in them.

The signature depends on the quantity and on whether the mechanism has a time, never on which symbols happen to occur
in a formula; of a tree with given motions all functions have the time and the inputs, too. Vectors are complete, in the
order of the tree; what was bound to a number is left out of ``p``.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import isnan
from typing import Any

from substructures.expr.program import Symbol
from substructures.quantities.quantity import signature as signature

#: arguments in their order; ``x``: what a quantity has beside states, inputs and parameters
ORDER = ("t", "q", "qd", "qdd", "u", "x", "p")
#: what the function ``prepare`` makes of parameters, behind all others, and that function
WORK, PREPARE = "w", "prepare"
MEANINGS = {
    "t": "time",
    "q": "coordinates",
    "qd": "velocities",
    "qdd": "accelerations",
    "u": "inputs",
    "x": "further symbols of this quantity",
    "p": "parameters",
    WORK: "what prepare makes of the parameters",
}
_KINDS = {
    "time": "t",
    "coordinate": "q",
    "velocity": "qd",
    "acceleration": "qdd",
    "input": "u",
    "inertia": "x",
    "parameter": "p",
}


@dataclass(frozen=True)
class Vector:
    """What stands where in an argument: names, SI units (empty where none was given), defaults (NaN: there is none; of
    inputs only where one has a default, 0 for the others; of q only with ball joints, 1 for w of quaternions).
    """

    symbol: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    defaults: tuple[float, ...] = ()

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def place(self) -> Mapping[str, int]:
        """Positions by name, from 0."""
        return {name: i for i, name in enumerate(self.names)}

    @property
    def with_default(self) -> list[str]:
        """The names of what has a default."""
        return [name for name, x in zip(self.names, self.defaults, strict=True) if not isnan(x)]

    def without(self, bound: Iterable[str]) -> Vector:
        """The vector without what was bound to numbers."""
        gone = frozenset(bound)
        kept = [i for i, name in enumerate(self.names) if name not in gone]
        defaults = tuple(self.defaults[i] for i in kept) if self.defaults else ()
        return Vector(self.symbol, tuple(self.names[i] for i in kept), tuple(self.units[i] for i in kept), defaults)

    def document(self) -> dict[str, Any]:
        """Plain data; null for a parameter without default."""
        told: dict[str, Any] = {"meaning": MEANINGS[self.symbol], "length": len(self)}
        told |= {"names": list(self.names), "units": list(self.units)}
        if self.defaults:
            told["defaults"] = [None if isnan(x) else x for x in self.defaults]
        return told


@dataclass(frozen=True)
class Interface:
    """All vectors of a tree or part by their symbols (``t`` has the length 1), and what it is that is exported:
    ``reference`` and ``digest``; ``frames``: names along the axes of frames; ``always``: arguments of all functions;
    ``has_time``: whether anything of it depends on the time, which no function has an argument for otherwise."""

    vectors: Mapping[str, Vector]
    reference: str = ""
    digest: str = ""
    frames: tuple[str, ...] = ()
    always: tuple[str, ...] = ()
    has_time: bool = True

    @classmethod
    def of_symbols(cls, symbols: Sequence[Symbol]) -> Interface:
        """The interface of a bare program, whose vectors are its symbols of each kind in their order."""
        found: dict[str, list[Symbol]] = {symbol: [] for symbol in ORDER if symbol not in ("t", "x")}
        for each in symbols:
            if _KINDS[each.kind] in found:
                found[_KINDS[each.kind]].append(each)
        vectors = {
            symbol: Vector(symbol, tuple(s.name for s in some), tuple(s.unit for s in some))
            for symbol, some in found.items()
        }
        p = vectors["p"]
        vectors |= {"t": TIME, "p": Vector("p", p.names, p.units, (float("nan"),) * len(p))}
        return cls(vectors, has_time=has_time(symbols))

    def bound(self, names: Iterable[str]) -> Interface:
        """The interface without parameters that were bound to numbers."""
        return replace(self, vectors={**self.vectors, "p": self.vectors["p"].without(names)})

    @cached_property
    def places(self) -> Mapping[str, tuple[str, int]]:
        """(vector, position) by name of symbols."""
        return {name: (v.symbol, i) for v in self.vectors.values() for name, i in v.place.items()}


def has_time(symbols: Iterable[Symbol]) -> bool:
    """Whether the time is among them."""
    return any(each.kind == "time" for each in symbols)


TIME = Vector("t", ("t",), ("s",))
