"""Rows of velocity constraints that are independent, in general position."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from substructures.analysis.equations.nonholonomic.velocity_constraints import (
    Constraint,
    VelocityRows,
    closing,
    constraints_of,
    row_values,
    velocity_rows,
)
from substructures.errors import InvalidArgument, InvalidInput
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.document import require_undriven
from substructures.tree.model import Model


def _rank(x: Any) -> int:
    return int(np.linalg.matrix_rank(x, rtol=1e-9).min()) if x.size else 0


def _without_dependent(f: Workspace, given: VelocityRows) -> tuple[VelocityRows, list[str]]:
    """The rows without those that follow from earlier ones (in general position), and the names of these. Raises
    InvalidArgument for a row that contradicts earlier ones.
    """
    result, dependent = VelocityRows(gaps=given.gaps), []
    # (B, b), so that rows which follow from others have to do so with what is given
    whole = [[*row, given.given.get(label, f.graph.zero)] for label, row in zip(given.labels, given.rows, strict=True)]
    values = row_values(f, whole) if whole else np.zeros((3, 0, f.n + 1))
    kept: list[int] = []
    for k, label in enumerate(given.labels):
        # rank of the rows kept and this one, at states in general position
        if _rank(values[:, [*kept, k], :-1]) > len(kept):
            kept.append(k)
            result.add(label, given.rows[k], given.given.get(label))
        elif _rank(values[:, [*kept, k]]) > len(kept):
            message = f"'{label}' contradicts the constraints before it: it gives other velocities to the same"
            raise InvalidArgument.at("/constraints", "contradiction", message)
        else:
            dependent.append(label)
    return result, dependent


def check_constraints(model: Model) -> None:
    """Raises InvalidInput (``/velocity_constraints/i/...``) for velocity constraints of a tree that are none."""
    if model.velocity_constraints:
        given = [name for name in model.driven if name in model.inputs]
        require_undriven(given, "give their motions as formulas in t, or the tree without 'velocity_constraints'")
        independent_rows(Workspace(model), constraints_of(model))


def independent_rows(f: Workspace, constraints: Sequence[Constraint]) -> tuple[VelocityRows, list[str]]:
    """Rows that do not follow from others, and the names of the others; faults where the constraints stand."""
    try:
        return _without_dependent(f, velocity_rows(f, constraints))
    except InvalidInput as error:
        if not f.model.velocity_constraints:
            raise
        raise error.moved(lambda pointer: pointer.replace("/constraints", "/velocity_constraints", 1)) from None


def place_of_zero(model: Model) -> dict[str, float] | None:
    """All coordinates at 0 and parameters at their defaults, where the constraints are independent; else None."""
    f = Workspace(model)
    rows = independent_rows(f, closing(model))[0].rows
    place = dict.fromkeys(model.coordinates, 0.0)
    given = {name: parameter.get("value") for name, parameter in model.parameters.items()}
    place |= {name: float(x) for name, x in given.items() if x is not None}
    values = row_values(f, rows, place) if rows else np.zeros((1, 0, f.n))
    return place if np.isfinite(values).all() and _rank(values) == len(rows) else None
