"""The workspace of analyses with the velocity constraints of a tree: reactions are B^T lambda with any lambda."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.nonholonomic.expected import quasi_expected
from substructures.analysis.equations.nonholonomic.independent_rows import independent_rows
from substructures.analysis.equations.nonholonomic.velocity_constraints import Constraint, VelocityRows, constraints_of
from substructures.certificate.derived.integrals import Rows
from substructures.expr.graph import Expr
from substructures.expr.program import Program
from substructures.tree.model import Model

Constraints = tuple[Constraint, ...]


class ConstrainedFormulas(ModelFormulas):
    """As :class:`.formulas.ModelFormulas`; closures are among the rows."""

    @cached_property
    def velocity_rows(self) -> VelocityRows:
        """Those that do not follow from others. Raises InvalidInput."""
        return independent_rows(self, constraints_of(self.model))[0]

    @cached_property
    def multipliers(self) -> tuple[str, ...]:
        """Row by row."""
        return tuple(f"lambda.{label}" for label in self.velocity_rows.labels)

    @cached_property
    def constraint_rows(self) -> Mapping[tuple[int, ...], Expr]:
        """B."""
        rows = enumerate(self.velocity_rows.rows)
        return {(k, a): x for k, row in rows for a, x in enumerate(row) if not x.is_zero}

    @cached_property
    def is_scleronomic(self) -> bool:
        """Whether b is zero in B q' + b = 0, so that the constraints do no work."""
        return not self.velocity_rows.given


def formulas_of(model: Model, constraints: Constraints, zero: Iterable[str]) -> ModelFormulas:
    """With its velocity constraints, where a tree has some."""
    return ConstrainedFormulas(model, zero) if constraints else ModelFormulas(model, zero)


def rows_expected(f: ModelFormulas, source: Program) -> Rows | None:
    """B, b from the texts of the constraints, for the certificate of a program ``source``; None without them."""
    if not isinstance(f, ConstrainedFormulas):
        return None
    return quasi_expected(f.model, source, {}, f.velocity_rows, constraints_of(f.model)).held
