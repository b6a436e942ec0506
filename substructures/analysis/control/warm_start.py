"""An earlier result of optimal control as the start of a search: its motion, read off at the nodes of the new one.

Times count in parts of the horizon, so that a result on few intervals, of another horizon or other parameters starts a
search on more of them (J. T. Betts, Practical Methods for Optimal Control Using Nonlinear Programming, 2nd ed., SIAM
2010, section 4.7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.quantities.measured import numeric
from substructures.tree.model import Model

NEEDED = ("names", "trajectory")
OF_MOTION = ("coordinates", "t", "q", "qd", "series")


@dataclass(frozen=True)
class WarmStart:
    """``names`` of controls; ``at``: times in parts of the horizon (K,), rising from 0 to 1; ``states`` (K, 2 n) and
    ``controls`` (K, m) there; ``parameters`` and the ``horizon`` that were found, None where nothing is said."""

    names: tuple[str, ...]
    at: Array
    states: Array
    controls: Array
    parameters: Mapping[str, float]
    horizon: float | None

    def column(self, name: str, times: Array, hold: str) -> Array | None:
        """A control at times in parts of the horizon; None for one that was none."""
        if name not in self.names:
            return None
        values = self.controls[:, self.names.index(name)]
        if hold == "linear":
            return np.interp(times, self.at, values)
        # a step reaches from its beginning to the next one; rounding of a time must not take the one before
        return np.asarray(values[np.searchsorted(self.at, times + 1e-9, side="right") - 1], dtype=np.float64)

    def state(self, times: Array) -> Array:
        """(q, q') at times in parts of the horizon, (len(times), 2 n)."""
        columns = [np.interp(times, self.at, x) for x in self.states.T]
        return np.stack(columns, axis=1) if columns else np.zeros((len(times), 0))


def warm_start(given: Any, model: Model) -> WarmStart:
    """An earlier result, as the value or as its JSON with series. Raises InvalidArgument (``/warm_start/...``)."""
    earlier = _members(given, NEEDED, "/warm_start")
    motion = _members(earlier["trajectory"], OF_MOTION, "/warm_start/trajectory")
    series = _members(motion["series"], ("controls",), "/warm_start/trajectory/series")
    if list(motion["coordinates"]) != list(model.coordinates):
        message = f"the earlier motion has the coordinates {', '.join(map(str, motion['coordinates']))[:200]}"
        raise InvalidArgument.at(
            "/warm_start/trajectory/coordinates", "wrong-coordinates", f"{message}; needed are those of this model"
        )
    names = tuple(map(str, earlier["names"]))
    t = _array(motion["t"], "/warm_start/trajectory/t", None)
    count = len(t)
    if count < 2 or not (np.diff(t) > 0).all():
        raise InvalidArgument.at("/warm_start/trajectory/t", "not-rising", "at least two rising times are needed")
    sizes = {"q": len(model.positions), "qd": model.dof}
    q, qd = (_array(motion[key], f"/warm_start/trajectory/{key}", (count, n)) for key, n in sizes.items())
    u = _array(series["controls"], "/warm_start/trajectory/series/controls", (count, len(names)))
    found = earlier.get("parameters") or {}
    horizon = earlier.get("horizon")
    return WarmStart(
        names,
        (t - t[0]) / (t[-1] - t[0]),
        np.concatenate([q, qd], axis=1),
        u,
        {str(name): float(numeric(x, "/warm_start/parameters")) for name, x in found.items()},
        None if horizon is None else float(numeric(horizon, "/warm_start/horizon")),
    )


def _members(given: Any, needed: Sequence[str], pointer: str) -> Mapping[str, Any]:
    found = given if isinstance(given, Mapping) else {name: getattr(given, name, None) for name in (*needed, *MORE)}
    for name in needed:
        if found.get(name) is None:
            message = f"an earlier answer of optimal-controls is needed, with its '{name}'"
            raise InvalidArgument.at(f"{pointer}/{name}", "missing", message)
    return found


#: of a result, where it has them
MORE = ("parameters", "horizon")


def _array(given: Any, pointer: str, shape: tuple[int, ...] | None) -> Array:
    values = numeric(given, pointer)
    if shape is not None:
        # a list without numbers has one axis
        values = values.reshape(shape) if values.size == 0 == int(np.prod(shape)) else values
    if (values.ndim != 1 if shape is None else values.shape != shape) or not np.isfinite(values).all():
        wanted = "one list" if shape is None else f"shape {shape}"
        raise InvalidArgument.at(pointer, "wrong-length", f"shape {values.shape} found; {wanted} of numbers is needed")
    return values
