"""The right-hand side of equations in quasi-velocities, compiled."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy

from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.corners import Laws, follow
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.array import Array
from substructures.compile import compile_program
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates, SaddlePoint

FORMS = {"voronets": "bias", "boltzmann-hamel": "hamel_bias"}


class ReducedMotion:
    """y = (q, v, work) and its rates; x = (q, q', work) for velocities v of coordinates."""

    def __init__(self, equations: QuasiVelocities, conditions: Conditions, form: str, folder: Path | None) -> None:
        model, self.conditions, self.form = equations.model, conditions, FORMS[form]
        self.equations, self.n, self.p = equations, model.dof, len(equations.velocities)
        self.columns = [*model.coordinates, *equations.velocities]
        #: the coordinates whose velocities are not among the chosen ones
        self.dependent = [a for a, name in enumerate(model.coordinates) if f"{name}'" not in equations.velocities]
        size = self.n + self.p
        #: the state, and its rates (q', v')
        self._t, self._y, self._written = np.zeros(1), np.zeros((1, size)), np.zeros((1, size))
        #: v', and the power of constraints that move, which depends on it
        self._rates, self._dv, self._power = self._written[:, : self.n], self._written[:, self.n :], np.zeros(1)
        names = state_names(model)
        state = [(names[: self.n], self._y[:, : self.n]), (names[self.n :], self._rates)]
        self.inputs, self._folder = VaryingInputs(conditions, self._t, state, folder), folder
        wanted = ("metric", self.form, "forces", "lost_power")
        self._out = {name: np.zeros((1, *equations.program.outputs[name].shape)) for name in wanted}
        values = self.conditions.values | {"t": self._t}
        columns = [(self.columns, self._y)]
        rates = compile_program(equations.program, ["rates"], folder, single=True)
        self._move = rates.bind({"rates": self._rates}, values, columns=columns)
        kernel = compile_program(equations.program, wanted, folder, single=True)
        self._work = None
        if "constraint_power" in equations.program.outputs:
            rate = compile_program(equations.program, ["constraint_power"], folder, single=True)
            moving = [*columns, ([f"{name}'" for name in equations.velocities], self._dv), *self.inputs.columns]
            self._work = rate.bind({"constraint_power": self._power}, values, columns=moving)
        source = equations.program.select(wanted)
        self._laws = Laws(source, kernel, self._out, values, [*columns, *self.inputs.columns])

    def corners(self, t: float, y: Array, folder: Path | None) -> list[Watch]:
        """Follow force laws on one side of their corners, from a start on; the corners are to be watched."""
        moving = ("t", *self.columns, *self.inputs.moving)
        return follow([*self.inputs.laws, self._laws], moving, self._fill, self.rates, (t, y), folder)

    def plain(self) -> None:
        """Force laws as they are."""
        for laws in (*self.inputs.laws, self._laws):
            laws.plain()

    def _fill(self, t: float, y: Array) -> None:
        self.state(t, y)
        self.inputs.fill()

    def compiled(self) -> CompiledRates | None:
        """The same in machine code; None where more than kernels is called, or constraints move."""
        given = self.inputs.runs()
        runs = [self._move, *(given or ()), self._laws.run]
        calls = tuple(run for run in runs if isinstance(run, BoundCall))
        if given is None or len(calls) < len(runs) or self._work is not None:
            return None
        out, none = self._out, np.zeros(0, dtype=np.int64)
        closures = np.zeros((0, self.p)), np.zeros(0)
        sides = out["forces"][0], out[self.form][0]
        saddle = SaddlePoint(out["metric"][0], *closures, *sides, none, np.arange(self.p), self.n)
        state = self._t, self._y, self._written, out["lost_power"]
        return CompiledRates(calls, *state, self._folder, saddle, self.inputs.tables)

    def __call__(self, t: float, y: Array) -> Array:
        """:meth:`rates`, as a function that integrators take."""
        return self.rates(t, y)

    def state(self, t: float, y: Array) -> Array:
        """(q, q') of y (a new array)."""
        self._t[0], self._y[0] = t, y[:-1]
        self._move()
        return np.concatenate((y[: self.n], self._rates[0]))

    def rates(self, t: float, y: Array) -> Array:
        """y'; not finite where the reduced metric is singular."""
        # g* v' = forces - bias, g* = T^T g T, q' = T v  (quasi_velocities)
        self._fill(t, y)
        self._laws.run()
        out, result = self._out, np.empty(len(y))
        force = out["forces"][0] - out[self.form][0]
        # LAPACK takes no matrix without rows: nothing is left free
        _, acceleration, info = scipy.linalg.lapack.dposv(out["metric"][0], force) if self.p else (None, force, 0)
        result[: self.n], result[-1] = self._rates[0], out["lost_power"][0]
        result[self.n : -1] = acceleration if not info else np.nan
        if self._work is not None:
            self._dv[0] = result[self.n : -1]
            self._work()
            result[-1] += self._power[0]
        return result

    def reduced(self, x: Array) -> Array:
        """y of x, where v are velocities of coordinates."""
        rates = [f"{name}'" for name in self.equations.model.coordinates]
        v = x[[self.n + rates.index(name) for name in self.equations.velocities]]
        return np.concatenate((x[: self.n], v, x[-1:]))

    def full(self, t: float, y: Array) -> Array:
        """x of y."""
        return np.concatenate((self.state(t, y), y[-1:]))
