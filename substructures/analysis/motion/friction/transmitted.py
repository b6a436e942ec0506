"""Reactions along a motion: what every joint transmits at the times of a trajectory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.analysis.equations.kernels import evaluated
from substructures.analysis.equations.nonholonomic.independent_rows import independent_rows
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.expr.program import array, program
from substructures.mechanics.accelerations import definite_solve
from substructures.quantities.formulas import DYNAMICS
from substructures.quantities.numbers.workspace import Workspace
from substructures.quantities.part_models import OUTPUTS, ReactionModel
from substructures.tree.model import Model


def with_reactions(model: Model, transmitted: ReactionModel, motion: Trajectory, start: Start) -> Trajectory:
    """The trajectory with the series ``reaction_force`` [N], ``reaction_moment`` [N m] (K, rows, 3) in the frames of
    the joints, ``..._world`` in the axes of the world; ``joints`` names the rows.

    ``start``: what the motion began with. Accelerations and multipliers are those of the motion: of closures the series
    ``qdd`` and ``multipliers``, of velocity constraints of the tree q'' = g^-1 (Q - Gamma q' q' + B^T lambda) with this
    series, else q'' = g^-1 (Q - Gamma q' q').
    """
    if has_not_begun(model, motion):
        return motion
    span = float(motion.t[0]), float(motion.t[-1])
    conditions = read_conditions(model, start, span, ())
    values: dict[str, Any] = {**conditions.values, **state_values(model, motion)}
    values |= conditions.inputs_at(motion.t, np.concatenate([motion.q, motion.qd], axis=1))
    rows = [f"{closure.name}.{row}" for closure in model.closures for row in closure.rows]
    forces: Array | float = 0.0
    if model.velocity_constraints:
        rows, forces = _constrained(model, motion, values)
    seconds = accelerations(model, motion, values, forces)
    values |= {f"{name}''": seconds[:, a] for a, name in enumerate(model.coordinates)}
    # a row that follows from others has no multiplier
    values |= {s.name: 0.0 for s in transmitted.program.symbols if s.name.startswith("lambda.")}
    values |= {f"lambda.{row}": motion.series["multipliers"][:, k] for k, row in enumerate(rows)}
    found = evaluated(transmitted.program, values, list(OUTPUTS), len(motion.t))
    return replace(motion, series={**motion.series, **found}, joints=transmitted.rows)


def _constrained(model: Model, motion: Trajectory, values: Mapping[str, Any]) -> tuple[list[str], Array]:
    """The rows of the velocity constraints of a tree, and B^T lambda (K, n)."""
    f = Workspace(model)
    rows, _ = independent_rows(f, constraints_of(model))
    m, n = len(rows.rows), model.dof
    B = program(f.graph, {"B": array((m, n), lambda k, a: rows.rows[k][a])}, f.symbols)
    found = evaluated(B, values, ["B"], len(motion.t))["B"]
    return rows.labels, np.einsum("kma,km->ka", found, motion.series["multipliers"])


def has_not_begun(model: Model, motion: Trajectory) -> bool:
    """Whether a motion with closures has no accelerations, since they could not be closed at the start."""
    return bool(model.closures) and motion.status == "failed" and "qdd" not in motion.series


def state_values(model: Model, motion: Trajectory) -> dict[str, Array]:
    """Time, coordinates, or positions of ball joints, and velocities (K,) by their symbols."""
    found = {"t": motion.t} | {name: motion.q[:, a] for a, name in enumerate(model.positions)}
    return found | {f"{name}'": motion.qd[:, a] for a, name in enumerate(model.coordinates)}


def accelerations(model: Model, motion: Trajectory, values: Mapping[str, Any], more: Array | float = 0.0) -> Array:
    """q'' (K, n) of the motion, or changes of rates; ``more``: forces beside Q."""
    if "qdd" in motion.series:
        return motion.series["qdd"]
    known = {symbol.name: 0.0 for symbol in model.program.symbols if symbol.kind == "input"} | dict(values)
    found = evaluated(model.program, known, list(DYNAMICS), len(motion.t))
    return definite_solve(found["metric"], found["forces"] - found["bias"] + more)[0]
