"""Identification of trees with velocity constraints: what actuators do along the velocities that these leave free.

As on closures (:mod:`.on_closures`), N^T Y_B beta = N^T tau with B N = 0, on motions with B q' + b = 0. There N^T N =
1, N the nearest to the axes of the independent coordinates, which exists in all positions: a cart that turns round has
no coordinate whose velocity always describes its motion. Random states are those that allowed motions reach from
measured ones, and so on the same gaps of rolling bodies and closures; accelerations have B q'' = -(B' q' + b').
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.equations.nonholonomic.positions import closed_positions
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.identification.on_closures import SPREAD, Loops
from substructures.array import Array
from substructures.errors import InvalidDocument
from substructures.expr.differentiate import directional
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.quantities.numbers.defaults import default_numbers
from substructures.tree.model import Model

#: of a motion that leads to a random state (Runge and Kutta)
STEPS = 100


@dataclass(frozen=True)
class Rolled(Loops):
    """Velocity constraints beside a motion. ``rows``: B (k, n), b (k,) and B' q' + b' (k,)."""

    equations: QuasiVelocities
    rows: Program

    @classmethod
    def of(cls, model: Model, base: BaseParameters, q: Array, parameters: Mapping[str, Any]) -> Loops:
        """Near measured positions q (N, n). Raises InvalidDocument (``not-steady``) for constraints that depend on the
        time, and InvalidArgument where closures cannot be closed there.
        """
        near = dict(zip(model.coordinates, q[0].tolist(), strict=True))
        equations = quasi_velocity_equations(model, closing(model), near={**near, **parameters})
        rows = _rows(equations)
        if any(symbol.kind in ("time", "input") for symbol in rows.symbols):
            message = "the constraints move with the time or with inputs, of which the measured motion has none"
            raise InvalidDocument.at("", "not-steady", f"{message}: take the tree without 'velocity_constraints'")
        needed = {symbol.name for symbol in equations.program.select(["constraints"]).symbols}
        values = dict.fromkeys((name for name in model.parameters if name not in needed), 1.0)
        values |= {**default_numbers(model.parameters), **parameters}
        independent = tuple(name.removesuffix("'") for name in equations.velocities)
        found = cls(model, values, independent, (), np.zeros((0, base.count)), equations, rows)
        return found.told(base, found.reached(q, 8 + 3 * base.count))

    def reached(self, q: Array, count: int) -> Array:
        """Positions (count, n) to which allowed motions lead from measured ones, by steps of fourth order."""
        rng, places = np.random.default_rng(5), q[np.arange(count) % len(q)]
        ways = SPREAD * rng.uniform(-1, 1, (count, len(self.independent)))

        def rates(x: Array) -> Array:
            """Along the ways, of what the constraints allow."""
            return self._allowed(x, ways)

        h = 1 / STEPS
        for _ in range(STEPS):
            a = rates(places)
            b = rates(places + h / 2 * a)
            c = rates(places + h / 2 * b)
            places = places + h / 6 * (a + 2 * b + 2 * c + rates(places + h * c))
        return closed_positions(self.equations, {**self._still, **self.values}, places)

    @property
    def _still(self) -> dict[str, float]:
        """Values of what is in the equations beside coordinates and parameters."""
        return {**dict.fromkeys(self.model.input_names, 0.0), "t": 0.0}

    def _allowed(self, q: Array, ways: Array) -> Array:
        """q' = N y + r, B r = -b, of least size."""
        found = self._outputs(q, np.zeros_like(q), "B", "b")
        least = np.einsum("nak,nk->na", np.linalg.pinv(found["B"]), found["b"])
        return np.einsum("nar,nr->na", self._tangents(found["B"]), ways) - least

    def tangents(self, q: Array) -> Array:
        """N (N, n, r) at positions (N, n)."""
        return self._tangents(self._outputs(q, np.zeros_like(q), "B")["B"])

    def _tangents(self, B: Array) -> Array:
        r = len(self.independent)
        N = np.linalg.svd(B)[2][:, -r:].transpose(0, 2, 1)
        # of all bases N Q that with the largest trace over the independent coordinates
        chosen = [self.model.coordinates.index(name) for name in self.independent]
        U, _, V = np.linalg.svd(N[:, chosen].transpose(0, 2, 1))
        return np.asarray(N @ (U @ V), dtype=np.float64)

    def moving(self, q: Array) -> tuple[Array, Array]:
        """Random velocities and accelerations that the constraints allow, (N, n) each."""
        rng, r = np.random.default_rng(7), len(self.independent)
        qd, way = self._allowed(q, rng.uniform(-1, 1, (len(q), r))), rng.uniform(-1, 1, (len(q), r))
        found = self._outputs(q, qd, "B", "c")
        short = np.einsum("nak,nk->na", np.linalg.pinv(found["B"]), found["c"])
        return qd, np.einsum("nar,nr->na", self._tangents(found["B"]), way) - short

    def _outputs(self, q: Array, qd: Array, *names: str) -> dict[str, Array]:
        return interpret_in_blocks(self.rows, {**self.values, **self._columns(q, qd)}, names, len(q))


def _rows(equations: QuasiVelocities) -> Program:
    """B, b and B' q' + b' as functions of q and q'."""
    graph, names = Graph(), equations.model.coordinates
    present = [name for name in ("constraints", "given") if name in equations.program.outputs]
    found = replay(equations.program, graph, {}, present)
    k, n = len(equations.constraints), len(names)
    b = found["given"].entries if "given" in found else {}
    symbols = {s.name: s for s in equations.program.symbols}
    speeds = [graph.symbol(f"{name}'") for name in names]
    symbols |= {f"{name}'": Symbol(f"{name}'", "velocity", "") for name in names}
    B = {index: graph.lift(x) for index, x in found["constraints"].entries.items()}
    rows = [graph.sum(B[j, a] * speeds[a] for a in range(n) if (j, a) in B) + b.get((j,), 0) for j in range(k)]
    c = directional(rows, {**dict(zip(names, speeds, strict=True)), "t": graph.one})
    outputs = {
        "B": array((k, n), lambda j, a: B.get((j, a), graph.zero)),
        "b": array((k,), lambda j: graph.lift(b.get((j,), 0))),
        "c": array((k,), lambda j: c[j]),
    }
    return program(graph, outputs, symbols)
