"""Functions of time that are given for inputs and prescribed coordinates: numbers, expressions, tables."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import scipy

from substructures.analysis.arguments import NumberOrExpression, Numbers, one_of, reals
from substructures.errors import InvalidArgument

INTERPOLATIONS = ("hold", "linear", "cubic")


@dataclass(frozen=True)
class Table:
    """``values`` (K,) at increasing ``times`` (K,) [s], K >= 2.

    ``interpolation`` of inputs: ``hold`` (each value up to the next time), ``linear``, or ``cubic`` (a spline with
    two continuous derivatives); prescribed motions are splines of degree five whatever it says. Raises InvalidArgument.
    """

    times: Numbers
    values: Numbers
    interpolation: Literal["hold", "linear", "cubic"] = "linear"

    def __post_init__(self) -> None:
        for name in ("times", "values"):
            numbers = reals(getattr(self, name), f"/{name}")
            if len(numbers) < 2:
                raise InvalidArgument.at(f"/{name}", "too-short", f"'{name}' needs at least two numbers")
            object.__setattr__(self, name, numbers)
        one_of(self.interpolation, "interpolation", INTERPOLATIONS)
        if len(self.times) != len(self.values):
            raise InvalidArgument.at("/values", "wrong-length", "as many 'values' as 'times' are needed")
        require_increasing(self.times)


#: a number, an expression in coordinates, velocities, parameters and t, or a table over time
Signal = NumberOrExpression | Table


def require_increasing(times: Numbers) -> None:
    """Raises InvalidArgument (``/times``, ``not-increasing``)."""
    if any(b <= a for a, b in pairwise(times)):
        raise InvalidArgument.at("/times", "not-increasing", "'times' must increase")


def require_covered(table: Table, span: tuple[float, float], pointer: str) -> None:
    """Raises InvalidArgument (``not-covered``) for a table that holds in a part of the span only."""
    if table.times[0] > span[0] or table.times[-1] < span[1]:
        message = f"the table covers {table.times[0]:g} s to {table.times[-1]:g} s, less than the span"
        raise InvalidArgument.at(f"{pointer}/times", "not-covered", message)


class Curve:
    """A table as piecewise polynomial of the time; ``breaks``: inner times where its value or its slope jumps."""

    def __init__(self, table: Table) -> None:
        self.times = list(table.times)
        self.pieces = _pieces(table)
        self.breaks = [] if table.interpolation == "cubic" else self.times[1:-1]
        self._piece: int | None = None

    def enter(self, start: float, end: float) -> None:
        """Until the next call times lie between two breaks: at both the value is the limit from inside."""
        self._piece = self._at((start + end) / 2) if self.breaks else None

    def leave(self) -> None:
        """Any time again."""
        self._piece = None

    def _at(self, t: float) -> int:
        return min(max(bisect_right(self.times, t) - 1, 0), len(self.pieces) - 1)

    def __call__(self, t: float) -> float:
        """The value at t, in the table's range."""
        k = self._at(t) if self._piece is None else self._piece
        # Horner: s(t) = (... (c_0 x + c_1) x + ...) x + c_d with x = t - t_k
        x, value = t - self.times[k], 0.0
        for c in self.pieces[k]:
            value = value * x + c
        return value


def _pieces(table: Table) -> list[list[float]]:
    """Coefficients of every piece, highest power first."""
    t, y = np.array(table.times), np.array(table.values)
    if table.interpolation == "cubic":
        rows = scipy.interpolate.CubicSpline(t, y).c.T
    elif table.interpolation == "linear":
        # s(t) = (y_k+1 - y_k) / (t_k+1 - t_k) (t - t_k) + y_k
        rows = np.stack([np.diff(y) / np.diff(t), y[:-1]], axis=1)
    else:
        rows = y[:-1, None]
    pieces: list[list[float]] = rows.tolist()
    return pieces
