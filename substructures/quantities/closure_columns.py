"""How long the rows of closures may be: the columns of their Jacobians before they are projected onto an axis.

For a closure of the frames A and B, with partial velocities U_a, Omega_a of their origins and r their positions,

    |u_a| <= |U_Aa| + |U_Ba| + (|Omega_Aa| + |Omega_Ba|) |r_B - r_A|        |w_a| <= |Omega_Aa| + |Omega_Ba|

bound the columns of its rows of places and of directions: a row that is rounding beside them is no row, whatever is
left of it. A placement in the frame ``to`` is as long as r_B - r_A where the closure is closed.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.known import Known
from substructures.expr.program import Output, Program
from substructures.mechanics.closure_rows import RowBounds
from substructures.mechanics.cut_joints import TURNS
from substructures.quantities.numbers.memo import known_model
from substructures.tree.model import Model

OUTPUTS = ("U", "Omega", "position")


def row_bounds(model: Model, values: Mapping[str, Any], count: int) -> RowBounds:
    """The bounds of all rows of closures, in their order, at states whose ``values`` are numbers or (count,)."""
    names = _ends(model)
    source = _kinematics(known_model(model), names)
    # a parameter without value takes no part in what the closures say
    known = {s.name: values.get(s.name, 0.0) for s in source.symbols}
    found = interpret_in_blocks(source, known, OUTPUTS, count)
    U, Omega = (np.linalg.norm(found[name], axis=-1) for name in OUTPUTS[:2])
    rest = np.zeros((count, model.dof)), np.zeros((count, model.dof)), np.zeros((count, 3))
    ends = {name: (U[:, f], Omega[:, f], found["position"][:, f]) for f, name in enumerate(names)}
    columns, spans = [], []
    for closure in model.closures:
        (U_A, W_A, r_A), (U_B, W_B, r_B) = (ends.get(name, rest) for name in (closure.start, closure.end))
        turns = W_A + W_B
        moves = U_A + U_B + turns * np.linalg.norm(r_B - r_A, axis=1)[:, None]
        far = np.linalg.norm(r_A, axis=1) + np.linalg.norm(r_B, axis=1)
        for row in closure.rows:
            columns.append(turns if row in TURNS else moves)
            spans.append(np.ones(count) if row in TURNS else far)
    return RowBounds(np.stack(columns, axis=1), np.stack(spans, axis=1))


def _ends(model: Model) -> tuple[str, ...]:
    """The frames that closures tie; the world is none."""
    names = (name for closure in model.closures for name in (closure.start, closure.end))
    return tuple(name for name in dict.fromkeys(names) if name in model.frames)


@lru_cache(maxsize=32)
def _kinematics(known: Known, names: tuple[str, ...]) -> Program:
    """The kinematic outputs of these frames alone."""
    program, frames = known.source.program, [known.source.frames.index(name) for name in names]
    place = {f: k for k, f in enumerate(frames)}
    outputs = {}
    for name in OUTPUTS:
        whole = program.outputs[name]
        kept = [(index, entry) for index, entry in zip(whole.index, whole.entries, strict=True) if index[0] in place]
        index = tuple((place[f], *rest) for (f, *rest), _ in kept)
        outputs[name] = Output((len(frames), *whole.shape[1:]), index, tuple(entry for _, entry in kept))
    return Program(program.symbols, program.operations, outputs).select(OUTPUTS)
