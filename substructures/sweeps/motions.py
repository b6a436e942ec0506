"""What rows of a sweep do: columns of motions, integrated for many parameter sets at once and judged one by one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.problem import Integrator
from substructures.array import Array
from substructures.ensembles.ensemble import simulate_ensemble
from substructures.ensembles.motion_column import MotionColumn
from substructures.errors import InvalidInput
from substructures.quantities.numbers.states import read_states
from substructures.sweeps.document import SimulationColumn
from substructures.sweeps.grouped import alike, check_fields, inside
from substructures.sweeps.shapes import Shape

STATE = ("q", "qd", "inputs")


def simulation_columns(
    shape: Shape, columns: Mapping[str, SimulationColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """Numbers (rows,) of motions, NaN where one fails or violates its conditions. Raises InvalidInput, MissingValue."""
    found: dict[str, Array] = {}
    for same in alike({name: column.model_dump(include=set(MOTION)) for name, column in columns.items()}):
        found |= _moved(shape, {name: columns[name] for name in same}, parameters, rows)
    return found


#: what columns of one motion have in common
MOTION = ("at", "span", "count", "relative_tolerance", "absolute_tolerance")


def _moved(
    shape: Shape, columns: Mapping[str, SimulationColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    first, how = next(iter(columns.items()))
    with inside(f"/columns/{first}/at"):
        check_fields(how.at, STATE)
        read_states(shape.model, how.at, 1)
    wanted = {
        name: MotionColumn(expression=c.expression, quantity=c.quantity, of=c.of, take=c.take)
        for name, c in columns.items()
    }
    relative, absolute = how.relative_tolerance, how.absolute_tolerance
    try:
        found = simulate_ensemble(
            shape.sources,
            how.at.get("q"),
            how.span,
            qd=how.at.get("qd"),
            inputs=how.at.get("inputs") or {},
            parameters=parameters,
            columns=wanted,
            grid=OutputGrid(count=how.count),
            integrator=Integrator(
                relative_tolerance=relative, absolute_tolerance=relative / 100 if absolute is None else absolute
            ),
        )
    except InvalidInput as error:
        raise error.moved(lambda pointer: _place(pointer, f"/columns/{first}")) from None
    right = ~(found.violation > 1)
    return {name: np.broadcast_to(np.where(right, x, np.nan), (rows,)) for name, x in found.columns.items()}


def _place(pointer: str, column: str) -> str:
    """Where in a sweep an argument of an ensemble is, whose parameters are those of the row."""
    field = pointer.split("/")[1] if pointer else ""
    if field in ("columns", "parameters"):
        return pointer
    return f"{column}/at{pointer}" if field in STATE else f"{column}{pointer}"


ANALYSES = {"simulation": simulation_columns}
