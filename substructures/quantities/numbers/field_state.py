"""A model at random states of a prime field: what is constant there, or depends on others, is told without formulas.

What has different values at two states is no constant; what is zero at a random one is the zero function, as surely as
by its fingerprint, in an open tree whose formulas the field tells all of
(:class:`substructures.expr.rings.modular.FieldValues`).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from functools import cached_property
from typing import Literal

from flint import fmpz_mod_ctx, fmpz_mod_mat

from substructures.expr.rings.modular import Field, FieldValues, NoSquareRoot
from substructures.tree.model import Model, require_stored

MOMENTA = ("linear_momentum", "angular_momentum")
NEEDED = ("metric", "christoffel", "bias", "forces", *MOMENTA)
#: fields that are tried
FIELDS = 4


class FieldState:
    """A model at a random state where parameters have ``fixed`` values, and symbols ``zero`` are 0. What is asked
    raises NoSquareRoot and ZeroDivisionError.
    """

    def __init__(self, model: Model, zero: Collection[str], field: Field, fixed: Mapping[str, int]) -> None:
        self.model, self.zero, self.field, self.fixed = model, zero, field, fixed
        self.velocities = [f"{name}'" for name in model.coordinates]
        names = dict.fromkeys([*(s.name for s in model.program.symbols), *self.velocities])
        self.at = {name: 0 if name in zero else field.draw() for name in names} | dict(fixed)

    def another(self) -> FieldState:
        """Another state with the same parameters."""
        return FieldState(self.model, self.zero, self.field, self.fixed)

    @cached_property
    def inertia(self) -> FieldValues:
        """g_ab, Gamma_abc q'^b q'^c and the momenta of unit velocities."""
        return self._values("metric", "bias", *MOMENTA)

    @cached_property
    def bending(self) -> FieldValues:
        """Gamma_abc."""
        return self._values("christoffel")

    @cached_property
    def acting(self) -> FieldValues:
        """Q_a."""
        return self._values("forces")

    @property
    def is_exact(self) -> bool:
        """Whether values tell all of the formulas."""
        return self.inertia.is_exact and self.bending.is_exact and self.acting.is_exact

    @cached_property
    def slopes(self) -> dict[tuple[int, int, int], int]:
        """d_c g_ab = Gamma_abc + Gamma_bac at (a, b, c), a <= b, where it is not zero."""
        found: dict[tuple[int, int, int], int] = {}
        for (a, b, c), x in self.bending.elements("christoffel").items():
            index = (a, b, c) if a < b else (b, a, c)
            found[index] = found.get(index, 0) + (x if a != b else 2 * x)
        return {index: x for index, x in found.items() if x % self.field.prime}

    @cached_property
    def forces(self) -> dict[int, int]:
        """Q_a where it is not zero."""
        return {a: x for (a,), x in self.acting.output("forces").items() if x}

    @cached_property
    def told_rates(self) -> list[Literal["zero", "varies"] | None]:
        """Of the derivatives along the motion of the linear momentum of the whole, and of the angular one, by axis:
        whether they are zero, or vary with the state; None where they may be constant."""
        pairs = zip(self._momentum_rates(), self._resting_rates(), strict=True)
        return ["zero" if not x else "varies" if x != y else None for x, y in pairs]

    def _momentum_rates(self) -> list[int]:
        """(n_ai q'^a)' along the motion."""
        rates = [self.at[name] for name in self.velocities]
        along = dict(zip(self.model.coordinates, rates, strict=True)) | {"t": 1}
        bias = self.inertia.output("bias")
        pushed = self._pushed([self.forces.get(a, 0) - bias.get((a,), 0) for a in range(self.model.dof)])
        carried = self._summed(self.inertia.changes(MOMENTA, along), rates)
        return [(x + y) % self.field.prime for x, y in zip(pushed, carried, strict=True)]

    def _resting_rates(self) -> list[int]:
        """The same at rest in this position."""
        at = self.at | dict.fromkeys(self.velocities, 0)
        forces = FieldValues(self.field, self.model.program, at, ["forces"]).output("forces")
        return self._pushed([forces.get((a,), 0) for a in range(self.model.dof)])

    def _pushed(self, forces: Sequence[int]) -> list[int]:
        """n_ai q''^a with g q'' = forces."""
        g, n, ring = self.inertia.elements("metric"), range(self.model.dof), fmpz_mod_ctx(self.field.prime)
        matrix = fmpz_mod_mat([[g.get((a, b), 0) for b in n] for a in n], ring)
        accelerations = [int(x) for x in matrix.solve(fmpz_mod_mat([[x] for x in forces], ring)).entries()]
        return self._summed([self.inertia.output(name) for name in MOMENTA], accelerations)

    def _summed(self, columns: Sequence[Mapping[tuple[int, ...], int]], by: Sequence[int]) -> list[int]:
        """n_ai x^a of each of the momenta."""
        found = [0] * 3 * len(columns)
        for k, some in enumerate(columns):
            for (a, i), x in some.items():
                found[3 * k + i] += x * by[a]
        return [x % self.field.prime for x in found]

    def _values(self, *names: str) -> FieldValues:
        return FieldValues(self.field, self.model.program, self.at, names)


def field_state(model: Model, zero: Collection[str]) -> FieldState | None:
    """A random one; None for a model of which a field does not tell all."""
    if model.balls or model.given or model.closures or model.velocity_constraints:
        return None
    require_stored(model.program, NEEDED)
    constants = [s.name for s in model.program.symbols if s.kind == "parameter"]
    for _ in range(FIELDS):
        field = Field([model.program])
        fixed = {name: 0 if name in zero else field.draw() for name in constants}
        state = FieldState(model, zero, field, fixed)
        # what divides by zero is refused where its formula is made
        with suppress(NoSquareRoot, ZeroDivisionError):
            return state if state.is_exact and state.told_rates else None
    return None
