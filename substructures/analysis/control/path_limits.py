"""Limits along the motion of optimal control: expressions c(q, q', u, t, p) that stay between two numbers.

They are demanded at all nodes, which are the starts of segments then: a state there is a variable of the nonlinear
program, and the derivatives of c are those of the expression alone (H. G. Bock and K. J. Plitt, A multiple shooting
algorithm for direct solution of optimal control problems, IFAC World Congress 1984). Between the nodes they are judged.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from substructures.analysis.arguments import real
from substructures.analysis.control.problem import declared
from substructures.analysis.motion.conditions import state_names
from substructures.array import Array
from substructures.compile import compile_program
from substructures.documents import escape
from substructures.errors import InvalidArgument
from substructures.expr.differentiate import pullback
from substructures.expr.graph import Graph
from substructures.expr.program import array, program
from substructures.loads.scope import Scope
from substructures.quantities.formulas import derived
from substructures.tree.model import Model

#: least and largest value of each expression, None for none
Limits = Mapping[str, tuple[float | None, float | None]]


class PathLimits:
    """The expressions of ``limits`` with their derivatives by (q, q', controls, varied), compiled.

    ``low``, ``high`` (k,). Raises InvalidInput (``/path/expression``).
    """

    def __init__(self, model: Model, limits: Limits, controls: Sequence[str], varied: Sequence[str]) -> None:
        self.texts = tuple(limits)
        self.low, self.high = limits_of(limits, "path")
        self._states, self._controls = state_names(model), list(controls)
        names = [*self._states, *controls, *varied]
        scope = Scope(Graph())
        declared(
            model, scope, {s.name: s for s in (*derived(model, "inverse_dynamics").symbols, *model.program.symbols)}
        )
        known = {name: x for name, x in scope.names.items() if not name.endswith("''")}
        rows = [scope.read(text, f"/path/{escape(text)}", known.get) for text in self.texts]
        scope.finish()
        slopes = [pullback([row], [scope.graph.one], names) for row in rows]
        outputs = {
            "value": array((len(rows),), lambda i: rows[i]),
            "slope": array((len(rows), len(names)), lambda i, j: slopes[i][j]),
        }
        self._compiled = compile_program(program(scope.graph, outputs, scope.symbols), ("value", "slope"))

    def at(self, values: Mapping[str, float], states: Array, controls: Array, t: Array) -> tuple[Array, Array]:
        """Values (K, k) and slopes (K, k, 2 n + m + r) at states (K, 2 n) under controls (K, m) at times (K,).

        ``values``: of all other symbols.
        """
        columns = [(self._states, states), (self._controls, controls)]
        with np.errstate(all="ignore"):
            found = self._compiled.evaluate({**values, "t": t}, columns=columns)
        count = len(t)
        return tuple(np.broadcast_to(found[name], (count, *found[name].shape[1:])) for name in ("value", "slope"))  # type: ignore[return-value]

    def excess(self, value: Array) -> Array:
        """By how much values (K, k) lie outside, (K, k); not a number counts as infinitely far."""
        return np.nan_to_num(np.maximum(np.maximum(self.low - value, value - self.high), 0.0), nan=np.inf)


def pair(given: Any, pointer: str) -> tuple[float | None, float | None]:
    """A least and a largest number, None (or infinite) for none. Raises InvalidArgument."""
    if not isinstance(given, list | tuple | np.ndarray) or len(given) != 2:
        message = f"a least and a largest number are needed, found {repr(given)[:80]}"
        raise InvalidArgument.at(pointer, "wrong-length", message)
    ends = zip(given, (-math.inf, math.inf), strict=True)
    least, most = (None if x is None or x == none else real(x, f"{pointer}/{i}") for i, (x, none) in enumerate(ends))
    return least, most


def limits_of(limits: Limits, field: str) -> tuple[Array, Array]:
    """Least and largest values as arrays, infinite where there is none. Raises InvalidArgument."""
    low, high = np.full(len(limits), -np.inf), np.full(len(limits), np.inf)
    for i, (name, given) in enumerate(limits.items()):
        least, most = pair(given, f"/{field}/{escape(name)}")
        low[i], high[i] = -np.inf if least is None else least, np.inf if most is None else most
        if not low[i] <= high[i]:
            message = f"no number lies between {least} and {most}"
            raise InvalidArgument.at(f"/{field}/{escape(name)}", "empty", message)
    return low, high
