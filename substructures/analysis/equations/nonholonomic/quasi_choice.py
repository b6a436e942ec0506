"""Quasi-velocities that describe the motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from substructures.analysis.arguments import require_read
from substructures.analysis.equations.cofactors import MatrixRows, determinant
from substructures.analysis.equations.nonholonomic.velocity_constraints import (
    VelocityRows,
    linear_row,
    row_values,
)
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, Symbol, array, program
from substructures.quantities.numbers.workspace import Workspace

#: positions in which a determinant is looked at
PLACES = 64


def quasi_velocity_rows(
    f: Workspace,
    rows: VelocityRows,
    velocities: Mapping[str, str] | None,
    independent: Sequence[str] | None,
) -> tuple[list[str], MatrixRows]:
    """Names of the quasi-velocities and their rows (p, n); declares their symbols and those of their rates.

    Raises InvalidArgument (``/velocities``, ``/independent``).
    """
    p, coordinates = f.n - len(rows.rows), f.model.coordinates
    if velocities is not None:
        if independent is not None:
            f.scope.fault("/independent", "contradiction", "give 'velocities' or 'independent', not both")
        names = list(velocities)
        own = [linear_row(f, text, f"/velocities/{name}") for name, text in velocities.items()]
        for name in names:
            if name in f.symbols:
                f.scope.fault(f"/velocities/{name}", "duplicate-name", f"'{name}' is a symbol of the model")
        pointer = "/velocities"
    else:
        chosen = independent_coordinates(f, rows.rows, None) if independent is None else list(independent)
        for i, name in enumerate(chosen):
            if name not in coordinates:
                message = f"unknown coordinate '{name[:80]}'{among(name, coordinates, i)}"
                f.scope.fault(f"/independent/{i}", "unknown-coordinate", message)
        require_read(f.scope)
        # v_i = q'^a: rows of the unit matrix
        own = [[f.graph.one if a == b else f.graph.zero for a in range(f.n)] for b in map(coordinates.index, chosen)]
        names, pointer = [f"{name}'" for name in chosen], "/independent"
    require_read(f.scope)
    if len(names) != p:
        message = f"{f.n} coordinates with {len(rows.rows)} constraints need {p} velocities, {len(names)} given"
        raise InvalidArgument.at(pointer, "wrong-length", message)
    for name in names:
        f.symbols.setdefault(name, Symbol(name, "velocity"))
        unit = f.symbols[name].unit
        f.symbols[f"{name}'"] = Symbol(f"{name}'", "acceleration", f"{unit}^2" if unit else "")  # rad/s -> rad/s^2
    return names, own


def vanishing(f: Workspace, rows: MatrixRows) -> Program | None:
    """Of quasi-velocities and constraints (n, n) the ``determinant``, where it has both signs: between them it is
    zero, and the quasi-velocities do not describe the motion there. None where it has one.
    """
    if not rows:
        return None
    det = determinant(rows)
    source = program(f.graph, {"determinant": array((), lambda: det)}, f.symbols)
    rng = np.random.default_rng(3)
    values = {s.name: rng.uniform(0.3, 1.1, PLACES) for s in source.symbols}
    values |= {name: rng.uniform(-np.pi, np.pi, PLACES) for name in f.model.coordinates if name in values}
    if "t" in values:
        # slow and quick given motions
        values["t"] = 10 ** rng.uniform(-2, 4, PLACES)
    with np.errstate(all="ignore"):
        found = interpret(source, values)["determinant"]
    # what grows with the time may have no value at some of the places
    return source if (found < 0).any() and (found > 0).any() else None


def independent_coordinates(f: Workspace, rows: MatrixRows, near: Mapping[str, float] | None) -> list[str]:
    """Independent coordinates: the dependent ones are taken where the constraints have the simplest coefficients,
    if these are well conditioned.
    """
    if not rows:
        return list(f.model.coordinates)
    values = row_values(f, rows, near)
    least = _weakest(values)
    effort = [sum(2 if not x.is_number else 1 for row in rows if not (x := row[a]).is_zero) for a in range(f.n)]
    order = sorted(range(f.n), key=lambda a: (effort[a] or 99, a))
    dependent: list[int] = []
    for share in (0.2, 1e-9):
        for a in order:
            columns = [*dependent, a]
            if a in dependent or len(dependent) == len(rows):
                continue
            # sigma_min of the columns of the dependent coordinates, so that G_x x' = -G_y y' is well conditioned
            if _weakest(values[:, :, columns]) > share * least:
                dependent = columns
    return [name for a, name in enumerate(f.model.coordinates) if a not in dependent]


def _weakest(x: Any) -> float:
    """The smallest singular value over all states."""
    return float(np.linalg.svd(x, compute_uv=False).min())
