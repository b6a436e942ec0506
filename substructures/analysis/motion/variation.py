"""The right-hand side of variational equations: x' = f(x, p, t) and S' = f_x S + f_p of all directions at once.

f_x S + f_p is one directional derivative of the accelerations, a formula: of a tree x = (q, q'); with velocity
constraints x = (q, v), and :mod:`substructures.analysis.equations.nonholonomic.solved` has the formulas.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import scipy

from substructures.analysis.equations.formulas import ModelFormulas, require_tree
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.equations.nonholonomic.solved import RATES, RATES_VARIATION, VARIATION
from substructures.analysis.equations.nonholonomic.solved import varied as varied_constrained
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.array import Array
from substructures.certificate.derived.perturbed import varied
from substructures.expr.differentiate import directional
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.known import Known
from substructures.expr.program import Program, program
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.quaternions import by_displacements
from substructures.quantities.numbers.workspace import vector
from substructures.tree.model import Model

#: outputs with their derivatives along the motion's neighbours
VARIATIONS = {RATES: RATES_VARIATION, "acceleration": VARIATION}


def variational(model: Model, parameters: Sequence[str]) -> Program:
    """``acceleration`` (n,) and its ``variation`` (n,) along the symbols ``d.<name>`` of coordinates, velocities and
    the given parameters; with ball joints along those of all numbers of a state, of which ``rates`` (m,) are the
    changes and ``rates_variation`` (m,) their variation. Raises InvalidInput for closures and for a metric that is
    always singular.
    """
    require_tree(model, "sensitivities")
    return _variational(Known(model.program.digest, model), tuple(parameters))


@lru_cache(maxsize=32)
def _variational(known: Known, parameters: tuple[str, ...]) -> Program:
    f = ModelFormulas(known.source)
    names, model = [*state_names(f.model), *parameters], f.model
    seeds = {name: f.graph.symbol(f"d.{name}") for name in names}
    # q' of a tree is part of its state, but for ball joints
    found = {RATES: list(f.position_rates.values())} if model.balls else {}
    found["acceleration"] = f.acceleration
    # q''(q, q', p): sum over all named z of (dq''/dz) d.z
    slopes = {name: directional(x, seeds) for name, x in found.items()}
    found |= {VARIATIONS[name]: x for name, x in slopes.items()}
    symbols = f.symbols | {f"d.{name}": replace(f.symbols[name], name=f"d.{name}") for name in names}
    outputs = {name: vector(x) for name, x in found.items()}
    expected = varied(parameters, model.positions, model.balls)
    return certified(program(f.graph, outputs, symbols), model, expected, "variation of the motion")


def displaced(model: Model, rows: Array) -> Array:
    """Derivatives (K, k, 2n) in displacements of bodies and rates, of x, S_1, ..., S_k (K, 1 + k, m + n) in all numbers
    of states with ball joints.
    """
    m, result = len(model.positions), np.zeros((len(rows), rows.shape[1] - 1, 2 * model.dof))
    for found, (x, *slopes) in zip(result, rows, strict=True):
        moved = by_displacements(model.positions, model.coordinates, model.balls, x[:m])
        for row, slope in zip(found, slopes, strict=True):
            row[:] = np.concatenate([moved @ slope[:m], slope[m:]])
    return result


class Variation:
    """The right-hand side for rows x, S_1, ..., S_k: all directions at once, as a batch of the kernel.

    ``columns`` = k: those of the parameters, and with ``of_start`` one that is 1 at the start for each element of x.
    ``equations`` with velocity constraints and their ``v`` (p,) at the start: x = (q, v); else x = (q, q').
    """

    def __init__(
        self,
        conditions: Conditions,
        parameters: Sequence[str],
        of_start: bool,
        folder: Path | None,
        equations: QuasiVelocities | None = None,
        v: Array | None = None,
    ) -> None:
        model, n = conditions.model, len(conditions.model.positions)
        self.conditions, self.parameters, self.n, self.of_start = conditions, tuple(parameters), n, of_start
        self.equations, self.first = equations, conditions.start
        if equations is None or v is None:
            names, source = state_names(model), variational(model, parameters)
        else:
            names, source = [*model.coordinates, *equations.velocities], varied_constrained(equations, parameters)
            self.first = np.concatenate([conditions.q, v])
        self.source, self.names, self.size = source, names, len(names)
        self.starts = self._starts() if of_start else np.zeros((0, self.size))
        self.columns = len(parameters) + len(self.starts)
        batch = max(self.columns, 1)
        self.t, self.x = np.zeros(1), np.zeros((1, self.size))
        self.d = np.zeros((batch, self.size))
        self.out = {name: np.zeros((batch, *output.shape)) for name, output in source.outputs.items()}
        # inputs depend on the time alone
        self.inputs = VaryingInputs(conditions, self.t, [(state_names(model), np.zeros((1, n + model.dof)))], folder)
        columns = [(names, self.x), ([f"d.{name}" for name in names], self.d), *self.inputs.columns]
        # dp_i = 1 in the i-th direction, 0 in all others
        seeds = {f"d.{name}": np.eye(1, batch, i)[0] for i, name in enumerate(parameters)}
        kernel = program_kernel(source, folder)
        self.run = kernel.bind(self.out, conditions.values | {"t": self.t} | seeds, columns=columns)

    def start(self) -> Array:
        """The start, S = 0 for parameters and S = 1 for the start itself."""
        rows = np.zeros((self.columns + 1, self.size))
        # x(0) = x_0, S(0) = 0 for parameters, dx/dx_0 = 1
        rows[0] = self.first
        rows[len(rows) - len(self.starts) :] = self.starts
        return rows.ravel()

    def _starts(self) -> Array:
        """Directions of the start: all numbers of x, but of ball joints displacements."""
        model = self.conditions.model
        if not model.balls:
            return np.eye(self.size)
        ways = np.linalg.pinv(by_displacements(model.positions, model.coordinates, model.balls, self.first[: self.n]))
        return np.asarray(scipy.linalg.block_diag(ways.T, np.eye(model.dof)), dtype=np.float64)

    def __call__(self, t: float, flat: Array) -> Array:
        """x', S_1', ..., S_k' at t, as they stand in ``flat``."""
        rows = flat.reshape(self.columns + 1, self.size)
        n, out = self.n, self.out
        self.t[0], self.x[0] = t, rows[0]
        self.d[: self.columns] = rows[1:]
        self.inputs.fill()
        self.run()
        result = np.empty_like(rows)
        # rows x, S_1, ..., S_k: (q, q')' = (q', q''), (dq, dq')' = (dq', variation of q''), and so for v in place of q'
        if RATES not in out:
            result[:, :n] = rows[:, n:]
        else:
            result[0, :n], result[1:, :n] = out[RATES][0], out[RATES_VARIATION][: self.columns]
        result[0, n:] = out["acceleration"][0]
        result[1:, n:] = out["variation"][: self.columns]
        return result.ravel()

    def full(self, t: Array, rows: Array) -> Array:
        """(q, q') and its derivatives (K, 1 + k, 2n) of x, S_1, ..., S_k (K, 1 + k, size) at the times; with ball
        joints as they are.
        """
        if self.equations is None:
            return rows
        n, parts = self.n, [rows[..., : self.n], np.zeros((*rows.shape[:2], self.n))]
        names, count = [*self.conditions.model.coordinates, *self.equations.velocities], len(rows)
        values = self.conditions.values | self.conditions.inputs_at(t, np.zeros((count, 2 * n))) | {"t": t}
        values |= dict(zip(names, rows[:, 0].T, strict=True)) | {f"d.{name}": 0.0 for name in self.parameters}
        for i in range(max(self.columns, 1)):
            along = {f"d.{name}": rows[:, 1 + i, k] if self.columns else 0.0 for k, name in enumerate(names)}
            own = {f"d.{name}": float(i == k) for k, name in enumerate(self.parameters)}
            found = interpret_in_blocks(self.source, values | along | own, [RATES, RATES_VARIATION], count)
            parts[1][:, 0] = found[RATES]
            parts[1][:, 1 + i : 2 + i] = np.broadcast_to(found[RATES_VARIATION], (count, n))[:, None]
        return np.concatenate(parts, axis=-1)
