"""Powers of loads and joints along a motion, and whether they add up to the rate of the kinetic energy.

dT/dt = dT/dq^a q'^a + dT/dq'^a q''^a, and d_t T at given motions, is a derivative of T by formulas, in which no force
is; the accelerations are those of the motion. Closures do no work; what moves a prescribed or driven coordinate does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from substructures.analysis.equations.kernels import evaluated
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.friction.dry_friction import friction_laws
from substructures.analysis.motion.friction.transmitted import accelerations, has_not_begun, state_values
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.second_run import ROUNDING
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.certificate.derived.powers import OUTPUT
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr
from substructures.expr.known import Known
from substructures.expr.program import Formulas, Program
from substructures.expr.replay import replay
from substructures.quantities.formulas import kept
from substructures.quantities.numbers.memo import known_model
from substructures.quantities.numbers.workspace import Workspace
from substructures.quantities.part_models import PowerModel
from substructures.tree.model import Model

RATE, DRIVES = "kinetic_energy_rate", "drive_powers"


def with_powers(
    model: Model, by_load: PowerModel, motion: Trajectory, start: Start, prescribed: Sequence[str], limit: float
) -> Trajectory:
    """The trajectory with the series ``powers`` (K, rows) [W], whose rows ``loads`` names, and the check ``power``.

    ``start``: what the motion began with; ``prescribed``: coordinates, each of which has a row of its own; ``limit``:
    of the sum less dT/dt, relative to the largest sum of sizes. A motion that did not begin has no powers.
    """
    if has_not_begun(model, motion) or (prescribed and "actuation" not in motion.series):
        return motion
    conditions = read_conditions(model, start, (float(motion.t[0]), float(motion.t[-1])), ())
    values: dict[str, Any] = {**conditions.values, **state_values(model, motion)}
    values |= conditions.inputs_at(motion.t, np.concatenate([motion.q, motion.qd], axis=1))
    second = accelerations(model, motion, values)
    found = evaluated(by_load.program, values, [OUTPUT], len(motion.t))[OUTPUT]
    rows = by_load.rows
    if "friction" in motion.series:
        found = _with_friction(model, conditions.values, rows, found, motion)
    for k, name in enumerate(prescribed):
        rate = motion.qd[:, model.coordinates.index(name)]
        rows, watts = (*rows, f"prescribed {name}"), motion.series["actuation"][:, k] * rate
        found = np.concatenate([found, watts[:, None]], axis=1)
    if model.driven:
        known = values | {f"{name}''": second[:, a] for a, name in enumerate(model.coordinates)}
        watts = evaluated(model.program, known, [DRIVES], len(motion.t))[DRIVES]
        rows, found = (*rows, *(f"drive {name}" for name in model.driven)), np.concatenate([found, watts], axis=1)
    check = _check(model, values, second, found, motion, limit)
    return replace(motion, series={**motion.series, OUTPUT: found}, loads=rows, checks=(*motion.checks, check))


def kinetic_energy_rate(model: Model) -> Program:
    """dT/dt as a function of q, q', q'' and parameters, where the metric is that of rates v also by Q': the output RATE
    [W].
    """
    r = Workspace(model)
    T = replay(kept(model, "kinetic_energy"), r.graph, {})["kinetic_energy"].entries.get((), r.graph.zero)
    seeds: dict[str, Expr] = r.time if model.driven else {}
    seeds |= r.moved([r.velocity_symbol(a) for a in range(model.dof)])
    seeds |= {f"{name}'": r.acceleration_symbol(a) for a, name in enumerate(model.coordinates)}
    return r.program({RATE: Formulas((), {(): directional([r.graph.lift(T)], seeds)[0]})})


@lru_cache(maxsize=32)
def _rate(model: Known) -> Program:
    return kinetic_energy_rate(model.source)


def _with_friction(
    model: Model, values: Mapping[str, float], rows: Sequence[str], found: Array, motion: Trajectory
) -> Array:
    """The powers with the friction that was exact in the place of the smooth law."""
    laws, found = friction_laws(model, dict(values)), found.copy()
    rates = motion.qd[:, laws.places]
    more = (motion.series["friction"][:, laws.places] - laws.smooth(rates)) * rates
    found[:, [rows.index(f"joint {model.coordinates[a]}") for a in laws.places]] += more
    return found


def _check(
    model: Model, values: Mapping[str, Any], second: Array, found: Array, motion: Trajectory, limit: float
) -> Check:
    """Whether the rows add up to dT/dt, where the motion has accelerations."""
    known = dict(values) | {f"{name}''": second[:, a] for a, name in enumerate(model.coordinates)}
    K = len(motion.t)
    rate = evaluated(_rate(known_model(model)), known, [RATE], K)[RATE]
    metric = evaluated(model.program, known, ["metric"], K)["metric"]
    # what rounding is of: |q'^a| |g_ab| |q''^b|; where closures are not met exactly, their forces do some work
    sizes = np.einsum("ka,kab,kb->k", np.abs(motion.qd), np.abs(metric), np.abs(second))
    noise = ROUNDING * sizes
    if "multipliers" in motion.series:
        noise = noise + np.abs(motion.series["multipliers"]).sum(axis=1) * motion.series["velocity_residual"]
    has = np.isfinite(second).all(axis=1)
    violation = (found.sum(axis=1) - rate)[has]
    scale = float(np.abs(found[has]).sum(axis=1).max(initial=0)) or 1.0
    reason = "the powers of gravity, joints, actuators and loads add up to dT/dt"
    reason = reason.replace(" and loads", ", loads and drives") if model.driven else reason
    return Check.of(("power", "zero", reason, "W"), violation, motion.t[has], scale, limit, noise[has])
