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

from substructures.analysis.equations.formulas import ModelFormulas, require_tree
from substructures.analysis.equations.kernels import Known, program_kernel
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.equations.nonholonomic.solved import RATES, RATES_VARIATION
from substructures.analysis.equations.nonholonomic.solved import varied as varied_constrained
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.array import Array
from substructures.certificate.derived.perturbed import varied
from substructures.expr.differentiate import directional
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program, array, program
from substructures.quantities.certificate import certified
from substructures.tree.model import Model


def variational(model: Model, parameters: Sequence[str]) -> Program:
    """``acceleration`` (n,) and its ``variation`` (n,) along the symbols ``d.<name>`` of coordinates, velocities and
    the given parameters. Raises InvalidInput for closures and for a metric that is always singular.
    """
    require_tree(model, "sensitivities")
    return _variational(Known(model.program.digest, model), tuple(parameters))


@lru_cache(maxsize=32)
def _variational(known: Known, parameters: tuple[str, ...]) -> Program:
    f = ModelFormulas(known.source)
    names = [*(str(x.value) for x in (*f.q, *f.rates)), *parameters]
    seeds = {name: f.graph.symbol(f"d.{name}") for name in names}
    acceleration = f.acceleration
    # q''(q, q', p): sum over all named z of (dq''/dz) d.z
    variation = directional(acceleration, seeds)
    symbols = f.symbols | {f"d.{name}": replace(f.symbols[name], name=f"d.{name}") for name in names}
    outputs = {
        "acceleration": array((f.n,), lambda a: acceleration[a]),
        "variation": array((f.n,), lambda a: variation[a]),
    }
    return certified(program(f.graph, outputs, symbols), f.model, varied(parameters), "variation of the motion")


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
        model, n = conditions.model, conditions.model.dof
        self.conditions, self.parameters, self.n, self.of_start = conditions, tuple(parameters), n, of_start
        self.equations, self.first = equations, conditions.start
        if equations is None or v is None:
            names, source = state_names(model), variational(model, parameters)
        else:
            names, source = [*model.coordinates, *equations.velocities], varied_constrained(equations, parameters)
            self.first = np.concatenate([conditions.q, v])
        self.source, self.size = source, len(names)
        self.columns = len(parameters) + (self.size if of_start else 0)
        batch = max(self.columns, 1)
        self.t, self.x = np.zeros(1), np.zeros((1, self.size))
        self.d = np.zeros((batch, self.size))
        self.out = {name: np.zeros((batch, *output.shape)) for name, output in source.outputs.items()}
        # inputs depend on the time alone
        self.inputs = VaryingInputs(conditions, self.t, np.zeros((1, 2 * n)), folder)
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
        if self.of_start:
            rows[-self.size :] = np.eye(self.size)
        return rows.ravel()

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
        if self.equations is None:
            result[:, :n] = rows[:, n:]
        else:
            result[0, :n], result[1:, :n] = out[RATES][0], out[RATES_VARIATION][: self.columns]
        result[0, n:] = out["acceleration"][0]
        result[1:, n:] = out["variation"][: self.columns]
        return result.ravel()

    def full(self, t: Array, rows: Array) -> Array:
        """(q, q') and its derivatives (K, 1 + k, 2n) of x, S_1, ..., S_k (K, 1 + k, size) at the times."""
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
