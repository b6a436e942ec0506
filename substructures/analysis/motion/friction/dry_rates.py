"""Equations of motion of a tree whose joints slip or stick, in machine code.

With s = 1 or -1 for a joint that slips that way, and 0 for one that sticks,

    g_ab q''^b + Gamma_abc q'^b q'^c = Q_a + F_a (tanh(v_a/v_0) - s_a)

of all coordinates but those that stick, whose q'' is 0; F is the size of the force of slipping: the smooth law of the
formulas is taken off. With closures they have G q'' = -c beside them.
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
from substructures.expr.laws.formulas import tanh
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


class DryForces:
    """Exact friction in place of the smooth law: ``forces`` (1, n) and ``power`` (1,) of those of the formulas, which
    other calls write before. ``law`` (k, 4): F_c, F_s - F_c, v_s, v_0 of the coordinates ``places``.
    """

    def __init__(self, places: tuple[int, ...], law: Array) -> None:
        self._places, self._numbers = places, np.column_stack((np.zeros(len(law)), law))
        self._made: BoundCall | None = None

    def taken(self, rates: CompiledRates, forces: Array, signs: NDArray[np.int64]) -> tuple[BoundCall, Array, Array]:
        """The call with these signs (k,), until others are taken, and where it writes forces and power.

        ``rates``: with what else is called; ``forces`` (1, n): those of the formulas.
        """
        self._numbers[:, 0] = signs
        if self._made is None:
            n = forces.size
            self.forces, self.power = np.zeros((1, n)), np.zeros(1)
            columns = [([f"v {a}" for a in range(n)], rates.x[:, -n:]), ([f"Q {a}" for a in range(n)], forces)]
            values = {
                f"{name} {a}": self._numbers[k, j : j + 1]
                for k, a in enumerate(self._places)
                for j, name in enumerate(LAW)
            }
            values["power"] = cast(Array, rates.power)
            out = {"forces": self.forces, "power": self.power}
            self._made = cast(
                BoundCall, program_kernel(_dry_forces(n, self._places)).bind(out, values, columns=columns)
            )
        return self._made, self.forces, self.power


class DryRates:
    """``metric`` (1, n, n): at the state of f, when ``dynamics`` is called. ``law`` (k, 4): F_c, F_s - F_c, v_s, v_0 of
    the coordinates ``places``. Not for several threads at a time.
    """

    def __init__(self, f: FreeMotion, model: Model, places: tuple[int, ...], law: Array) -> None:
        n = f.n
        self.f, self._places, self._dry = f, np.array(places, dtype=np.int64), DryForces(places, law)
        self.metric, self._forces, self._bias = np.zeros((1, n, n)), np.zeros((1, n)), np.zeros((1, n))
        out = dict(zip(DYNAMICS, (self.metric, self._forces, self._bias), strict=True))
        self.dynamics = f.bound(program_kernel(model.program.select(list(DYNAMICS))), out)

    def compiled(self, signs: NDArray[np.int64]) -> CompiledRates | None:
        """With these signs (k,), until others are taken; None where more than kernels is called."""
        rates = self.f.compiled()
        if rates is None or rates.power is None or not isinstance(self.dynamics, BoundCall):
            return None
        call, forces, power = self._dry.taken(rates, self._forces, signs)
        moving = np.setdiff1d(np.arange(self.f.n), self._places[signs == 0])
        closures = np.zeros((0, self.f.n)), np.zeros(0)
        rows = np.zeros(0, dtype=np.int64)
        first = rates.written.size - self.f.n
        saddle = SaddlePoint(self.metric[0], *closures, forces[0], self._bias[0], rows, moving, first)
        return replace(rates, calls=(*rates.calls, self.dynamics, call), power=power, saddle=saddle)


@lru_cache(maxsize=32)
def _dry_forces(n: int, places: tuple[int, ...]) -> Program:
    """Outputs ``forces`` (n,) and ``power`` of the formulas above, of symbols for all in them."""
    graph, symbols = Graph(), dict[str, Symbol]()

    def symbol(name: str) -> Expr:
        """One that is noted: numbers of laws stay, all else is read anew at every state."""
        symbols[name] = Symbol(name, "parameter" if name[0] in LAW[1:] else "input")
        return graph.symbol(name)

    power, forces = symbol("power"), [symbol(f"Q {a}") for a in range(n)]
    for a in places:
        s, c, d, w, z = (symbol(f"{name} {a}") for name in LAW)
        v = symbol(f"v {a}")
        instead = (c + d * graph.function("exp", -((v / w) ** 2))) * (tanh(v / z) - s)
        forces[a] = forces[a] + instead
        power = power + instead * v
    outputs = {"forces": array((n,), forces.__getitem__), "power": array((), lambda: power)}
    return program(graph, outputs, symbols)
