"""Equations of motion of a tree whose joints slip or stick, in machine code.

With s = 1 or -1 for a joint that slips that way, and 0 for one that sticks, and m = s^2 (1 for all other coordinates),

    h_ab q''^b = m_a (Q_a - Gamma q'q' + F_a (tanh(v_a/v_0) - s_a))

h_aa = g_aa, and h_ab = m_a m_b g_ab beside the diagonal, F the size of the force of slipping: the smooth law
of the formulas is taken off, and what sticks has q'' = 0 exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.kernels import program_kernel
from substructures.array import Array
from substructures.compile.kernel import Kernel
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates, SaddlePoint
from substructures.expr.graph import Expr, Graph
from substructures.expr.laws import tanh
from substructures.expr.operations import Symbol
from substructures.expr.program import Program, array, program
from substructures.tree.model import Model

#: of the model, and numbers of a joint with friction: its sign, F_c, F_s - F_c, v_s and v_0
DYNAMICS, LAW = ("metric", "forces", "bias"), ("s", "c", "d", "w", "z")


class FreeMotion(Protocol):
    """x' = f(t, x) with the smooth law of friction, of ``n`` coordinates."""

    n: int

    def bound(self, kernel: Kernel, outputs: Mapping[str, Array]) -> Callable[[], None]:
        """Another kernel of the same symbols, at the states of f."""

    def compiled(self) -> CompiledRates | None:
        """f in machine code; None where it is not."""


class DryRates:
    """``metric`` (1, n, n): at the state of f, when ``dynamics`` is called. ``law`` (k, 4): F_c, F_s - F_c, v_s, v_0 of
    the coordinates ``places``. Not for several threads at a time.
    """

    def __init__(self, f: FreeMotion, model: Model, places: tuple[int, ...], law: Array) -> None:
        n = f.n
        self.f, self._numbers = f, np.column_stack((np.zeros(len(law)), law))
        self.metric, self._forces, self._bias = np.zeros((1, n, n)), np.zeros((1, n)), np.zeros((1, n))
        out = dict(zip(DYNAMICS, (self.metric, self._forces, self._bias), strict=True))
        self.dynamics = f.bound(program_kernel(model.program.select(list(DYNAMICS))), out)
        self._held, self._left, self._power = np.zeros((1, n, n)), np.zeros((1, n)), np.zeros(1)
        self._places = places
        self._made: BoundCall | None = None

    def compiled(self, signs: NDArray[np.int64]) -> CompiledRates | None:
        """With these signs (k,), until others are taken; None where more than kernels is called."""
        rates = self.f.compiled()
        if rates is None or rates.power is None or not isinstance(self.dynamics, BoundCall):
            return None
        self._numbers[:, 0] = signs
        n, none = self.f.n, np.zeros(0, dtype=np.int64)
        saddle = SaddlePoint(self._held[0], np.zeros((0, n)), np.zeros(0), self._left[0], np.zeros(n), none)
        calls = (*rates.calls, self.dynamics, self._equations(rates.x, rates.power))
        return replace(rates, calls=calls, power=self._power, saddle=saddle)

    def _equations(self, x: Array, power: Array) -> BoundCall:
        """What makes the equations of what the other calls have written."""
        if self._made is not None:
            return self._made
        n = self.f.n
        columns = [
            ([f"v {a}" for a in range(n)], x[:, n:]),
            ([f"g {a} {b}" for a in range(n) for b in range(n)], self.metric.reshape(1, n * n)),
            ([f"Q {a}" for a in range(n)], self._forces),
            ([f"B {a}" for a in range(n)], self._bias),
        ]
        values = {
            f"{name} {a}": self._numbers[k, j : j + 1] for k, a in enumerate(self._places) for j, name in enumerate(LAW)
        }
        kernel = program_kernel(_equations(n, self._places))
        out = {"metric": self._held, "forces": self._left, "power": self._power}
        self._made = cast(BoundCall, kernel.bind(out, values | {"power": power}, columns=columns))
        return self._made


@lru_cache(maxsize=32)
def _equations(n: int, places: tuple[int, ...]) -> Program:
    """Outputs ``metric`` (n, n), ``forces`` (n,) and ``power`` of the formulas above, of symbols for all in them."""
    graph, symbols = Graph(), dict[str, Symbol]()

    def symbol(name: str) -> Expr:
        """One that is noted: numbers of laws stay, all else is read anew at every state."""
        symbols[name] = Symbol(name, "parameter" if name[0] in LAW[1:] else "input")
        return graph.symbol(name)

    power, moves = symbol("power"), [graph.one] * n
    forces = [symbol(f"Q {a}") - symbol(f"B {a}") for a in range(n)]
    for a in places:
        s, c, d, w, z = (symbol(f"{name} {a}") for name in LAW)
        v = symbol(f"v {a}")
        instead = (c + d * graph.function("exp", -((v / w) ** 2))) * (tanh(v / z) - s)
        moves[a] = s * s
        forces[a] = moves[a] * (forces[a] + instead)
        power = power + instead * v

    def held(a: int, b: int) -> Expr:
        """Of the metric."""
        one = symbol(f"g {min(a, b)} {max(a, b)}")
        return one if a == b else moves[a] * moves[b] * one

    outputs = {
        "metric": array((n, n), held),
        "forces": array((n,), forces.__getitem__),
        "power": array((), lambda: power),
    }
    return program(graph, outputs, symbols)
