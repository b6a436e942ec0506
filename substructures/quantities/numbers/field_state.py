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
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.model import Model

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
        for (a, b, c), x in self.bending.elements("christoffel"):
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
        now, at_rest = self._accelerations()
        columns, rates = [self.inertia.output(name) for name in MOMENTA], [self.at[name] for name in self.velocities]
        along = dict(zip(self.model.coordinates, rates, strict=True)) | {"t": 1}
        # (n_ai q'^a)', at rest n_ai q''^a
        carried = self._summed(self.inertia.changes(MOMENTA, along), rates)
        moving = [(x + y) % self.field.prime for x, y in zip(self._summed(columns, now), carried, strict=True)]
        pairs = zip(moving, self._summed(columns, at_rest), strict=True)
        return ["zero" if not x else "varies" if x != y else None for x, y in pairs]

    def _accelerations(self) -> tuple[list[int], list[int]]:
        """q''^a with g q'' + Gamma q' q' = Q, and at rest in this position."""
        at = self.at | dict.fromkeys(self.velocities, 0)
        resting = FieldValues(self.field, self.model.program, at, ["forces"]).output("forces")
        g, bias, n = dict(self.inertia.elements("metric")), self.inertia.output("bias"), range(self.model.dof)
        right = [[self.forces.get(a, 0) - bias.get((a,), 0), resting.get((a,), 0)] for a in n]
        matrix, ring = [[g.get((a, b), 0) for b in n] for a in n], fmpz_mod_ctx(self.field.prime)
        found = [int(x) for x in fmpz_mod_mat(matrix, ring).solve(fmpz_mod_mat(right, ring)).entries()]
        return found[::2], found[1::2]

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
