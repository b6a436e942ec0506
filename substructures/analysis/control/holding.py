"""What holds the motions of optimal control: rows G of closures, or B of velocity constraints, and G' q'."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from substructures.analysis.equations.nonholonomic.constrained_formulas import (
    ConstrainedFormulas,
    rows_expected,
)
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.array import Array
from substructures.certificate.derived.adjoint import Held
from substructures.errors import InvalidDocument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.known import Known
from substructures.expr.program import Program, array, program
from substructures.quantities.numbers.memo import known_model
from substructures.tree.cuts import require_open
from substructures.tree.model import Model

#: G and c of closures
HOLDING = ("closure.jacobian", "closure.acceleration")


@dataclass(frozen=True)
class Ties:
    """Rows ``labels`` of what holds the motion, G and c of a ``program``: closures of the model, or its velocity
    constraints B q' = 0 with B for G and c = B' q'.
    """

    labels: tuple[str, ...]
    program: Program
    formulas: ConstrainedFormulas | None = None

    def expected(self, made: Program) -> Held | None:
        """What B has to be, and the program that has it."""
        rows = None if self.formulas is None else rows_expected(self.formulas, made)
        return None if rows is None else (rows, made)

    def rows(self, values: Mapping[str, Any], coordinates: tuple[str, ...], q: Array) -> Array:
        """G (K, k, n) at positions (K, n); ``values``: of all other symbols."""
        at = {**values, **dict(zip(coordinates, q.T, strict=True))}
        found = interpret_in_blocks(self.program, at, [HOLDING[0]], len(q))[HOLDING[0]]
        return np.broadcast_to(found, (len(q), len(self.labels), len(coordinates)))


@lru_cache(maxsize=16)
def _found(known: Known) -> Ties:
    model: Model = known.source
    constraints = constraints_of(model)
    if not constraints:
        labels = (f"{closure.name}.{row}" for closure in model.closures for row in closure.rows)
        return Ties(tuple(labels), model.program)
    require_open(model.closures, "take the tree without 'velocity_constraints'")
    f = ConstrainedFormulas(model)
    rows = f.velocity_rows
    if rows.given:
        message = f"the constraint '{next(iter(rows.given))}' moves by itself (B q' + b = 0): take simulations"
        raise InvalidDocument.at("", "has-velocity-constraints", message)
    # c = (B q')' at fixed q'
    held = [f.graph.sum(x * v for x, v in zip(row, f.rates, strict=True)) for row in rows.rows]
    rests, size = f.along_motion(held), (len(rows.rows), model.dof)
    outputs = {HOLDING[0]: array(size, lambda k, a: rows.rows[k][a]), HOLDING[1]: array(size[:1], rests.__getitem__)}
    return Ties(tuple(rows.labels), program(f.graph, outputs, f.symbols), f)


def ties_of(model: Model) -> Ties:
    """Raises InvalidInput for velocity constraints beside closures, and for those that move."""
    return _found(known_model(model))
