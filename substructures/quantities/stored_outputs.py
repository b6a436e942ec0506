"""Which outputs a model has as formulas."""

from __future__ import annotations

from collections.abc import Iterable

from substructures.errors import InvalidDocument, listed
from substructures.expr.program import Program
from substructures.mechanics.formula_size import MOST_CHRISTOFFEL


def require_stored(program: Program, names: Iterable[str]) -> None:
    """Raises InvalidDocument (``not-stored``) for outputs that a model of many coordinates does not have."""
    missing = [name for name in names if name not in program.outputs]
    if missing:
        message = (
            f"of more than {MOST_CHRISTOFFEL:,} Christoffel symbols no formulas are stored, so there is no "
            f"{listed(missing)}, but in numbers by an evaluation of a stored tree; velocity forces are found without "
            "them (bias, inverse_dynamics, forward_dynamics)"
        )
        raise InvalidDocument.at("", "not-stored", message)
