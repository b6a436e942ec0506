"""What equations with velocity constraints have to be, from the texts of these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.analysis.arguments import exact
from substructures.analysis.equations.nonholonomic.velocity_constraints import Constraint, VelocityRows
from substructures.certificate.derived.quasi import Quasi
from substructures.expr.program import Program
from substructures.tree.model import Model


def quasi_expected(
    model: Model, result: Program, velocities: Mapping[str, str], rows: VelocityRows, constraints: Sequence[Constraint]
) -> Quasi:
    """Of a program, with its quasi-velocities by name."""
    plain = {c.name: {key: _exact(x) for key, x in vars(c).items()} for c in constraints}
    closed = [f"{each.name}.{row}" for each in model.closures for row in each.rows]
    return Quasi(result, velocities, rows.labels, list(rows.gaps), plain, model.frames, closed)


def _exact(given: Any) -> Any:
    """Numbers and texts of a constraint without rounding."""
    return [exact(x, "") for x in given] if isinstance(given, (list, tuple)) else exact(given, "")
