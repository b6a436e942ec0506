"""Events: expressions in coordinates, velocities, t and parameters whose zeros are found along a motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from substructures.compile import compile_program
from substructures.errors import Fault, InvalidDocument
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import ExpressionError, parse
from substructures.expr.program import Symbol, array, program
from substructures.model import Model

Array = NDArray[np.float64]
FIELDS = {"name", "expression", "direction", "terminal"}


@dataclass(frozen=True)
class Event:
    """Zeros of ``expression`` where it rises (``direction`` 1), falls (-1) or both (0); ``terminal`` ones stop."""

    name: str
    expression: str
    direction: int = 0
    terminal: bool = True


@dataclass(frozen=True)
class Occurrence:
    """An event at a time [s]."""

    event: Event
    time: float


class Events:
    """The events of a request, evaluated together."""

    def __init__(self, model: Model, request: Mapping[str, Any], values: Mapping[str, float]) -> None:
        """``events``: a list of objects {name, expression, direction, terminal}; ``values``: of the parameters.

        Raises InvalidDocument.
        """
        given = request.get("events") or []
        if not isinstance(given, (list, tuple)):
            raise InvalidDocument.at("/events", "list-expected", "a list of events is needed")
        self.events = tuple(_event(one, f"/events/{i}") for i, one in enumerate(given))
        self._values = np.zeros((1, len(given)))
        self._run: Callable[[], None] | None = None
        if self.events:
            self._bind(model, values)

    def _bind(self, model: Model, values: Mapping[str, float]) -> None:
        names = [*model.coordinates, *(f"{name}'" for name in model.coordinates), "t"]
        known = {s.name: s for s in model.program.symbols}
        known |= {name: known.get(name, Symbol(name, "time" if name == "t" else "coordinate")) for name in names}
        graph = Graph()
        rows: list[Expr] = []
        allowed = {*names, *values}
        for i, event in enumerate(self.events):
            try:
                rows.append(parse(graph, event.expression, lambda n: graph.symbol(n) if n in allowed else None))
            except ExpressionError as error:
                raise InvalidDocument.at(f"/events/{i}/expression", "bad-expression", str(error)) from None
        p = program(graph, {"events": array((len(rows),), lambda k: rows[k])}, known)
        self._x = np.zeros((1, len(names)))
        self._run = compile_program(p, ["events"]).bind({"events": self._values}, values, columns=[(names, self._x)])

    def at(self, t: float, q: Array, qd: Array) -> Array:
        """Values of all expressions (a new array)."""
        if self._run is not None:
            self._x[0] = np.concatenate((q, qd, (t,)))
            self._run()
        return self._values[0].copy()

    def between(
        self, before: tuple[float, Array], after: tuple[float, Array], values: Callable[[float], Array]
    ) -> list[Occurrence]:
        """Zeros between two times with values of the expressions; ``values``: these at a time. In the order of time."""
        found = []
        for k, event in enumerate(self.events):
            a, b = before[1][k], after[1][k]
            rises = np.sign(b) - np.sign(a)
            if a == 0 or a * b > 0 or rises == 0 or (event.direction and rises * event.direction < 0):
                continue
            time = brentq(lambda t, k=k: values(t)[k], before[0], after[0], xtol=1e-14)
            found.append(Occurrence(event, float(time)))
        return sorted(found, key=lambda one: one.time)


def _event(given: Any, pointer: str) -> Event:
    if not isinstance(given, Mapping):
        raise InvalidDocument.at(pointer, "object-expected", "an event is an object")
    faults = [Fault(f"{pointer}/{k}", "unknown-field", f"unknown field '{k}'") for k in given if k not in FIELDS]
    if not isinstance(given.get("expression"), str):
        faults.append(Fault(f"{pointer}/expression", "missing", "an event has an expression"))
    if given.get("direction", 0) not in (-1, 0, 1):
        faults.append(Fault(f"{pointer}/direction", "bad-direction", "-1, 0 or 1 is needed"))
    if faults:
        raise InvalidDocument(faults)
    name = str(given.get("name", given["expression"]))
    return Event(name, given["expression"], int(given.get("direction", 0)), bool(given.get("terminal", True)))


def first_stop(found: Sequence[Occurrence]) -> Occurrence | None:
    """The first occurrence that stops the motion."""
    return next((one for one in found if one.event.terminal), None)
