"""Events along a motion: crossings of levels by expressions in coordinates, velocities, t and parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from substructures.analysis.closed_requests import Event
from substructures.analysis.formulation import Formulation
from substructures.compile import compile_program
from substructures.expr.program import array, program
from substructures.model import Model

Array = NDArray[np.float64]
SENSE = {"rising": 1, "falling": -1, "both": 0}


@dataclass(frozen=True)
class Occurrence:
    """An event at a time [s]."""

    event: Event
    time: float


class Events:
    """The events of a request, evaluated together."""

    def __init__(self, model: Model, events: Sequence[Event], values: Mapping[str, float]) -> None:
        """``values``: of the parameters. Raises InvalidDocument with pointers ``/events/i/quantity``."""
        self.events = tuple(events)
        self._values = np.zeros((1, len(events)))
        self._levels = np.array([event.level for event in events])
        self._run: Callable[[], None] | None = None
        if events:
            self._bind(model, values)

    def _bind(self, model: Model, values: Mapping[str, float]) -> None:
        names = [*model.coordinates, *(f"{name}'" for name in model.coordinates), "t"]
        f = Formulation(model)
        f.scope.declare("t", "time", "s")
        rows = [f.scope.read(event.quantity, f"/events/{i}/quantity") for i, event in enumerate(self.events)]
        f.scope.finish()
        p = program(f.graph, {"events": array((len(rows),), lambda k: rows[k])}, f.symbols)
        self._x = np.zeros((1, len(names)))
        self._run = compile_program(p, ["events"]).bind({"events": self._values}, values, columns=[(names, self._x)])

    def at(self, t: float, q: Array, qd: Array) -> Array:
        """Values of all quantities above their levels (a new array)."""
        if self._run is not None:
            self._x[0] = np.concatenate((q, qd, (t,)))
            self._run()
        return np.asarray(self._values[0] - self._levels)

    def between(
        self, before: tuple[float, Array], after: tuple[float, Array], values: Callable[[float], Array]
    ) -> list[Occurrence]:
        """Crossings between two times with values of the quantities; ``values``: these at a time. In order of time."""
        found = []
        for k, event in enumerate(self.events):
            a, b = before[1][k], after[1][k]
            if a == 0 or a * b > 0 or (np.sign(b) - np.sign(a)) * SENSE[event.direction] < 0:
                continue
            time = brentq(lambda t, k=k: values(t)[k], before[0], after[0], xtol=1e-14)
            found.append(Occurrence(event, float(time)))
        return sorted(found, key=lambda one: one.time)


def first_stop(found: Sequence[Occurrence]) -> Occurrence | None:
    """The first occurrence that stops the motion."""
    return next((one for one in found if one.event.action == "stop"), None)
