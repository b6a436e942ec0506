"""Joint limits of a model in numbers, and what is said when a coordinate leaves them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.tree.model import Model

#: further than this beyond a limit, relative to its size and the range, a coordinate has left it
BEYOND = 1e-9


@dataclass(frozen=True)
class Limits:
    """``low``, ``high`` (n,): limits of the coordinates [rad, m], infinite where there are none; ``unknown``: the
    parameter without value for want of which no limit is known."""

    coordinates: tuple[str, ...]
    joints: str
    low: Array
    high: Array
    unknown: str = ""

    def plain(self) -> dict[str, list[float]]:
        """[low, high] of every coordinate that has limits."""
        pairs = zip(self.coordinates, self.low.tolist(), self.high.tolist(), strict=True)
        return {name: [low, high] for name, low, high in pairs if np.isfinite(low) or np.isfinite(high)}

    def warnings(self, lowest: Array, highest: Array) -> list[dict[str, str]]:
        """What to say of coordinates that were between ``lowest`` and ``highest`` (n,): one warning for each that left
        its limits, with how far it went."""
        found = []
        if self.unknown:
            message = f"the limits of the joints are not known: the parameter '{self.unknown}' has no value"
            found.append({"pointer": f"/parameters/{self.unknown}", "code": "limits-unknown", "message": message})
        for a, name in enumerate(self.coordinates):
            low, high, unit = self.low[a], self.high[a], "rad" if self.joints[a] == "R" else "m"
            slack = BEYOND * (1 + sum(abs(x) for x in (low, high) if np.isfinite(x)))
            went = [
                f"{way} to {reached:.6g} {unit}"
                for way, reached, beyond in (
                    ("down", lowest[a], low - lowest[a]),
                    ("up", highest[a], highest[a] - high),
                )
                if beyond > slack
            ]
            if went:
                message = f"'{name}' leaves its limits [{low:.6g}, {high:.6g}] {unit}: it goes {' and '.join(went)}"
                found.append({"pointer": f"/q/{name}", "code": "limits-left", "message": message})
        return found


def joint_limits(model: Model, parameters: Mapping[str, float] | None = None) -> Limits:
    """The limits of all coordinates; ``parameters``: in place of their defaults."""
    low, high, unknown = np.full(model.dof, -np.inf), np.full(model.dof, np.inf), ""
    if model.limited:
        defaults = default_numbers(model.parameters)
        values = defaults | dict(parameters or {})
        needed = model.program.needs(["limits"])
        unknown = next((name for name in needed if name not in values), "")
        if not unknown:
            rows = interpret(model.program, {n: values[n] for n in needed}, ["limits"])["limits"]
            for name in model.limited:
                a = model.coordinates.index(name)
                low[a], high[a] = rows[a]
    return Limits(model.coordinates, model.joints, low, high, unknown)


def reached(t: Array, q: Array, qd: Array) -> tuple[Array, Array]:
    """Lowest and highest values (n,) of coordinates with rates ``qd`` (K, n) at the times (K,), between them along the
    cubic with the same values and rates at both ends.

    Source: E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I, section II.6.
    """
    # a row for each coordinate, whose numbers are neighbours
    q, qd = np.ascontiguousarray(q.T), np.ascontiguousarray(qd.T)
    low, high = q.min(axis=1, initial=np.inf), q.max(axis=1, initial=-np.inf)
    h, start = np.diff(t), q[:, :-1]
    if not len(h):
        return low, high
    # q(s) = q0 + h v0 s + c s^2 + d s^3, with q'(s) = 0 in 0 < s < 1
    rise, v0, v1 = q[:, 1:] - start, h * qd[:, :-1], h * qd[:, 1:]
    c, d = 3 * rise - 2 * v0 - v1, v0 + v1 - 2 * rise
    with np.errstate(all="ignore"):
        root = np.sqrt(c * c - 3 * d * v0)
        for s in ((-c + root) / (3 * d), (-c - root) / (3 * d), -v0 / (2 * c)):
            turned = np.where((s > 0) & (s < 1), start + s * (v0 + s * (c + s * d)), start)
            low, high = np.minimum(low, turned.min(axis=1)), np.maximum(high, turned.max(axis=1))
    return low, high
