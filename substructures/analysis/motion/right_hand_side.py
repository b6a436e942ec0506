"""The equations of motion as one compiled function x' = f(t, x), x = (q, q', W), a few microseconds a call.

q'' = g^-1 (Q - Gamma q' q') is a formula: g = L^T D L is factored in the graph, so that the kernel needs no linear
algebra. W' is the power of the forces without potential; H - W is constant for every model.

With ball and floating joints x = (q, v, W), with the quaternions as they are in q (notation.md, section 14),

    g v' + Gamma~ v v = Q        Q' = 1/2 Q (0, w)        p' = R v

The equations hold for quaternions of any length, so that none is held at length 1 on the way: how far they leave it
tells how well they were integrated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

from substructures.analysis.equations.expressions import vector
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.corners import Laws, follow
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.array import Array
from substructures.certificate.derived.model_formulas import simulated
from substructures.compile import Kernel, compile_program
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates
from substructures.expr.garbage import without_collections
from substructures.expr.known import Known
from substructures.expr.program import Program, array
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.quaternions import moved_on
from substructures.tree.model import Model

ACCELERATION, PIVOTS, POWER = "forward_dynamics", "pivots", "power"
#: of what states q with ball joints consist of
CHANGES = "position_rates"


def forward_dynamics(model: Model, zero: Iterable[str] = ()) -> Program:
    """Accelerations as formulas: outputs ``forward_dynamics`` (n,), ``pivots`` (n,): D of g = L^T D L, and ``power``;
    of a model with ball joints before them ``position_rates`` (m,), the changes of a state q.

    ``zero``: symbols that are 0. Raises InvalidInput for a coordinate without inertia and for a division by zero.
    """
    f = ModelFormulas(model, zero)
    changes = list(f.position_rates.values()) if model.balls else []
    acceleration, power = f.acceleration, f.power
    outputs = {CHANGES: vector(changes)} if model.balls else {}
    outputs |= {
        ACCELERATION: array((f.n,), lambda a: acceleration[a]),
        PIVOTS: array((f.n,), lambda a: f.factors.D[a]),
        POWER: array((), lambda: power),
    }
    expected = simulated(model.positions, model.balls)
    return certified(f.program(outputs), model, expected, "equations of motion", zero=f.zero)


@lru_cache(maxsize=32)
def _forward_program(model: Known, zero: frozenset[str]) -> Program:
    return forward_dynamics(model.source, zero)


@lru_cache(maxsize=32)
@without_collections
def _forward_kernel(model: Known, zero: frozenset[str], folder: Path | None, single: bool) -> Kernel:
    source = _forward_program(model, zero)
    return compile_program(source, tuple(source.outputs), folder, single=single)


def forward_kernel(model: Model, zero: Iterable[str] = (), folder: Path | None = None, single: bool = False) -> Kernel:
    """The compiled forward_dynamics(model, zero), ``single``: for one state at a time; the same object for the same
    model. Raises as forward_dynamics.
    """
    return _forward_kernel(Known(model.program.digest, model), frozenset(zero), folder, single)


class RightHandSide:
    """x' = f(t, x), x with m numbers q, n ``rates`` and W. ``values``: numbers of parameters and constant inputs;
    ``zero``: symbols that are 0.

    ``conditions``: with the inputs that vary. Not for several threads at a time. Raises InvalidInput as
    forward_dynamics, and MissingValue.
    """

    #: coordinates that a force acts on which is none of the formulas: as by a motor there
    pushed: Sequence[str] = ()

    def __init__(
        self,
        model: Model,
        values: Mapping[str, float],
        zero: Iterable[str] = (),
        conditions: Conditions | None = None,
        folder: Path | None = None,
    ) -> None:
        m, n = len(model.positions), model.dof
        self.m, self.n, self._folder = m, n, folder
        self.rates = slice(m, m + n)
        self._names = state_names(model)
        known = model.of_shape  # whose kernel may be there
        self.kernel = forward_kernel(known, zero, folder, single=True)
        self.has_power = bool(self.kernel.outputs[POWER].entries)
        self._t, self._x = np.zeros(1), np.zeros((1, m + n))
        # changes of q before accelerations, where they are more than rates
        self._first, self._turning = m if model.balls else 0, (model.positions, model.coordinates, model.balls)
        self._written = np.zeros((1, self._first + n))
        self._out = self._written[:, self._first :], np.zeros((1, n)), np.zeros(1)
        state = [(self._names, self._x)]
        self.inputs = None if conditions is None else VaryingInputs(conditions, self._t, state, folder)
        self._varying = [] if self.inputs is None else self.inputs.columns
        columns = [*state, *self._varying]
        outputs = dict(zip((ACCELERATION, PIVOTS, POWER), self._out, strict=True))
        outputs |= {CHANGES: self._written[:, :m]} if self._first else {}
        source = _forward_program(Known(known.program.digest, known), frozenset(zero))
        self._values = dict(values) | {name: float(x) for name, x in known.numbers.items()} | {"t": self._t}
        self._columns = columns
        self._laws = Laws(source, self.kernel, outputs, self._values, columns)

    def bound(self, kernel: Kernel, outputs: Mapping[str, Array]) -> Callable[[], None]:
        """Another kernel of the same symbols, at the states of :meth:`evaluate`."""
        return kernel.bind(outputs, self._values, columns=self._columns)

    def corners(self, t: float, x: Array, folder: Path | None = None) -> list[Watch]:
        """Follow force laws on one side of their corners, from a start on; the corners are to be watched."""
        given, moving = ((), ()) if self.inputs is None else (self.inputs.laws, self.inputs.moving)
        return follow([*given, self._laws], ("t", *self._names, *moving), self._move, self, (t, x), folder)

    def plain(self) -> None:
        """Force laws as they are."""
        for laws in () if self.inputs is None else self.inputs.laws:
            laws.plain()
        self._laws.plain()

    def _move(self, t: float, x: Array) -> None:
        self._t[0], self._x[0] = t, x[: self.rates.stop]
        if self.inputs is not None:
            self.inputs.fill()

    @property
    def size(self) -> int:
        """Length of x: m + n, and one for W where there is any power."""
        return self.m + self.n + self.has_power

    def moved(self, q: Array, d: Array) -> Array:
        """Where q (m,) comes at constant rates, d (n,) in all."""
        return moved_on(*self._turning, q, d)

    @property
    def has_breaks(self) -> bool:
        """Whether an input or its slope jumps."""
        return self.inputs is not None and self.inputs.has_breaks

    def enter(self, start: float, end: float) -> None:
        """Times are between two breaks of the inputs until the next call."""
        if self.inputs is not None:
            self.inputs.enter(start, end)

    def leave(self) -> None:
        """Any time again."""
        if self.inputs is not None:
            self.inputs.leave()

    def compiled(self) -> CompiledRates | None:
        """The function as calls of kernels, as its force laws are taken now; None where it is more than these."""
        given = [] if self.inputs is None else self.inputs.runs()
        runs = [*(given or ()), self._laws.run]
        calls = tuple(run for run in runs if isinstance(run, BoundCall))
        if given is None or len(calls) < len(runs):
            return None
        tables = None if self.inputs is None else self.inputs.tables
        power = self._out[2] if self.has_power else None
        return CompiledRates(calls, self._t, self._x, self._written, power, self._folder, tables=tables)

    def evaluate(self, t: float, x: Array) -> tuple[Array, Array, float]:
        """(q'', pivots of the metric, power); the arrays are overwritten by the next call."""
        self._move(t, x)
        self._laws.run()
        return self._out[0][0], self._out[1][0], float(self._out[2][0])

    def __call__(self, t: float, x: Array) -> Array:
        """x' at (t, x)."""
        # x' = (q', q'', power), q'' = g^-1 (Q - Gamma q' q')
        acceleration, _, power = self.evaluate(t, x)
        return self.changes(x, acceleration, power)

    def changes(self, x: Array, acceleration: Array, power: float) -> Array:
        """x' of these (n,), at the state x of the last evaluation."""
        m, v = self.m, self.rates
        result = np.empty(len(x))
        result[:m] = self._written[0, :m] if self._first else x[v]
        result[v] = acceleration
        if self.has_power:
            result[-1] = power
        return result


def is_definite(pivots: Sequence[float] | Array) -> bool:
    """Whether g is positive definite, by the pivots D of g = L^T D L."""
    # g = L^T D L > 0 if and only if D > 0
    d = np.asarray(pivots)
    return bool(np.isfinite(d).all() and (d > 1e-14 * np.abs(d).max(initial=0)).all())
