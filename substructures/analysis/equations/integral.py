"""What a first integral is: its formula is an output of a program, and this is said about it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

from substructures.analysis.equations.energy import EnergyRule
from substructures.errors import listed
from substructures.expr.program import Program
from substructures.tree.with_numbers import with_numbers

IntegralKind = Literal[
    "energy",
    "subsystem",
    "cyclic",
    "symmetry",
    "linear_momentum",
    "angular_momentum",
    "impulse",
    "galilei",
    "spin",
    "linear",
    "quadratic",
]


@dataclass(frozen=True)
class Integral:
    """A quantity of the motion. ``name``: its output in the program.

    ``rule``: ``constant``; ``falling`` (energy with dampers); ``balance`` (energy changes by the power fed in).
    ``direction``: of a symmetry, c^a by coordinate, texts in the parameters: the integral is c^a p_a.
    ``coordinates``: of a subsystem, those whose energy it is. ``terms``: of one that was searched for; it is the sum of
    coefficients, texts in q, t and parameters, times momenta ``p.arm.q1`` or velocities ``arm.q1'``.
    """

    name: str
    kind: IntegralKind
    rule: EnergyRule
    unit: str
    reason: str
    direction: Mapping[str, str] = field(default_factory=dict, hash=False)
    coordinates: tuple[str, ...] = ()
    terms: tuple[tuple[str, tuple[str, ...]], ...] = ()


#: outputs of a model that the sizes of integrals are told from, by the names that they have beside integrals
SIZES = {f"size of {name}": name for name in ("metric", "linear_momentum", "angular_momentum", "potential_energy")}


@dataclass(frozen=True)
class FirstIntegrals:
    """``cyclic``: coordinates. ``degree``: in the momenta, of the integrals that were looked for; ``searched``: among
    which, or why not. ``along``: ``program`` with SIZES of the model, which share most of their operations;
    ``numbers``: what symbols of it are in the tree, where it is of all trees of its shape.
    """

    along: Program
    integrals: tuple[Integral, ...]
    cyclic: tuple[str, ...]
    degree: int
    searched: str
    numbers: Mapping[str, Fraction] = field(default_factory=dict, hash=False)

    @cached_property
    def program(self) -> Program:
        """An output without axes for every integral, and ``power``: H' [W]."""
        own = self.along.select([name for name in self.along.outputs if name not in SIZES])
        return with_numbers(own, self.numbers)

    def __repr__(self) -> str:
        names = listed(f"{integral.name} ({integral.rule})" for integral in self.integrals)
        cyclic = listed(self.cyclic) or "none"
        return f"FirstIntegrals: {names or 'none'}\ncyclic: {cyclic}; {len(self.program)} operations"

    def summary(self) -> dict[str, Any]:
        """Names, units and reasons as plain data; the formulas are in the program."""
        integrals = [
            {**vars(i), "terms": [{"coefficient": c, "of": list(w)} for c, w in i.terms]} for i in self.integrals
        ]
        return {"integrals": integrals, "cyclic": list(self.cyclic), "degree": self.degree, "searched": self.searched}
