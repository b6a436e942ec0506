"""Functions of time that are given for inputs and prescribed coordinates: numbers, expressions, tables."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import scipy

from substructures.analysis.arguments import NumberOrExpression, Numbers, one_of, reals
from substructures.array import Array
from substructures.errors import InvalidArgument

Interpolation = Literal["hold", "linear", "cubic", "quintic"]
INTERPOLATIONS: tuple[Interpolation, ...] = ("hold", "linear", "cubic", "quintic")


@dataclass(frozen=True)
class Table:
    """``values`` (K,) at increasing ``times`` (K,) [s], K >= 2.

    ``interpolation``: ``hold`` (each value up to the next time), ``linear``, ``cubic`` or ``quintic`` (splines with two
    and four continuous derivatives). Where none is given inputs are linear, and prescribed motions quintic, as a motion
    must not jump, nor its velocity. Raises InvalidArgument.
    """

    times: Numbers
    values: Numbers
    interpolation: Interpolation | None = None

    def __post_init__(self) -> None:
        for name in ("times", "values"):
            numbers = reals(getattr(self, name), f"/{name}")
            if len(numbers) < 2:
                raise InvalidArgument.at(f"/{name}", "too-short", f"'{name}' needs at least two numbers")
            object.__setattr__(self, name, numbers)
        if self.interpolation is not None:
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
        times, coefficients = _pieces(table, "linear")
        # coefficients of every piece, highest power first
        self.times, self.pieces = times.tolist(), coefficients.T.tolist()
        self.breaks = [] if table.interpolation in ("cubic", "quintic") else self.times[1:-1]
        self._piece: int | None = None

    def enter(self, start: float, end: float) -> None:
        """Until the next call times lie between two breaks: at both the value is the limit from inside."""
        self._piece = self._at((start + end) / 2) if self.breaks else None

    def leave(self) -> None:
        """Any time again."""
        self._piece = None

    @property
    def taken(self) -> tuple[int, int]:
        """The first of the pieces that may be asked for, and how many these are."""
        return (0, len(self.pieces)) if self._piece is None else (self._piece, 1)

    def _at(self, t: float) -> int:
        return min(max(bisect_right(self.times, t) - 1, 0), len(self.pieces) - 1)

    def __call__(self, t: float) -> float:
        """The value at t, in the table's range."""
        k = self._at(t) if self._piece is None else self._piece
        begin, piece = self.times[k], self.pieces[k]
        # Horner: s(t) = (... (c_0 x + c_1) x + ...) x + c_d with x = t - t_k
        x, value = t - begin, 0.0
        for c in piece:
            value = value * x + c
        return value


def polynomials(table: Table, default: Interpolation) -> Any:
    """A table as scipy.interpolate.PPoly; ``default``: the interpolation where it has none."""
    times, coefficients = _pieces(table, default)
    return scipy.interpolate.PPoly(coefficients, times)


def _pieces(table: Table, default: Interpolation) -> tuple[Array, Array]:
    """The ends of its pieces (m + 1,), and their coefficients (d + 1, m), highest power first."""
    t, y = np.array(table.times, dtype=np.float64), np.array(table.values, dtype=np.float64)
    how = table.interpolation or default
    if how == "cubic":
        spline = scipy.interpolate.CubicSpline(t, y)
        return spline.x, spline.c
    if how == "quintic":
        # of few points the degree is less; the knots at the ends are there several times
        spline = scipy.interpolate.PPoly.from_spline(scipy.interpolate.make_interp_spline(t, y, k=min(5, len(t) - 1)))
        x, long = spline.x, np.diff(spline.x) > 0
        return np.append(x[:-1][long], x[-1]), spline.c[:, long]
    # s(t) = (y_k+1 - y_k) / (t_k+1 - t_k) (t - t_k) + y_k, or s(t) = y_k
    rows = [np.diff(y) / np.diff(t), y[:-1]] if how == "linear" else [y[:-1]]
    return t, np.stack(rows)
