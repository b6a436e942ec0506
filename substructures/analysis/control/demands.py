"""What an optimal control must meet: demands on the end, bounds, limits along the motion, and what else is unknown."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from substructures.analysis.arguments import real, whole
from substructures.analysis.control.adjoint import HORIZON
from substructures.analysis.control.closed_start import Demand
from substructures.analysis.control.path_limits import Limits, limits_of, pair
from substructures.analysis.control.problem import ControlProblem
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import InvalidArgument, among
from substructures.quantities.numbers.quaternions import (
    at_zero,
    by_displacements,
    quaternions_in,
    with_unit_quaternions,
)
from substructures.tree.model import Model

#: segments that are taken where nothing says how many
SEGMENTS = 10
MAX_ITERATIONS = 100_000


#: numbers of the last state, None where nothing is demanded: all in the order of the coordinates, or some by name
Demanded = Sequence[float | None] | Mapping[str, float | None]


@dataclass(frozen=True)
class End:
    """Demands on the last state: ``q`` [rad, m] and ``qd`` [rad/s, m/s]."""

    q: Demanded = field(default_factory=dict)
    qd: Demanded = field(default_factory=dict)


@dataclass(frozen=True)
class Demands:
    """What an optimum must meet, and how it is searched for.

    ``end``: demands on the last state; ``bounds``: least and largest value by control [N m, N], None for none;
    ``path``: the same by expression in coordinates, velocities, controls, parameters and ``t``, at all nodes (each
    interval is a segment then). Unknown beside the controls: ``free_parameters``, between two values each, from
    those of the problem on; with ``free_horizon`` [s], least and largest, the horizon, from that of the problem on.

    ``guess``: controls to begin with, by name one number or one for each node (default: 0, or waves, where no change of
    0 meets the demands to first order, as with a blade at rest); ``warm_start``: an earlier Optimum, or its JSON, whose
    motion, controls, parameters and horizon the search begins with. ``segments``: divides the intervals (default: the
    largest such up to 10); ``tolerance``: change of the cost at which the search ends, after
    ``iterations`` at the latest. Raises InvalidArgument.
    """

    end: End = field(default_factory=End)
    bounds: Limits = field(default_factory=dict)
    guess: Mapping[str, Any] = field(default_factory=dict)
    segments: int | None = None
    iterations: int = 500
    tolerance: float = 1e-8
    path: Limits = field(default_factory=dict)
    free_parameters: Limits = field(default_factory=dict)
    free_horizon: tuple[float, float] | None = None
    warm_start: Any = None

    def __post_init__(self) -> None:
        if self.segments is not None:
            whole(self.segments, "segments", 1, sys.maxsize)
        whole(self.iterations, "iterations", 1, MAX_ITERATIONS)
        object.__setattr__(self, "tolerance", real(self.tolerance, "/tolerance"))
        if not 0 < self.tolerance < 1:
            code = "greater-than" if self.tolerance <= 0 else "less-than"
            message = f"'tolerance' must lie between 0 and 1, found {self.tolerance:g}"
            raise InvalidArgument.at("/tolerance", code, message)
        if self.free_horizon is not None:
            least, most = pair(self.free_horizon, "/free_horizon")
            if least is None or most is None or not 0 < least < most:
                message = f"two rising times above zero are needed, found {least} and {most}"
                raise InvalidArgument.at("/free_horizon", "empty", message)


def segments_of(problem: ControlProblem, wanted: Demands) -> int:
    """Their number. Raises InvalidArgument."""
    count, intervals = wanted.segments, problem.intervals
    if wanted.path and count not in (None, intervals):
        message = f"with limits on the 'path' there are as many as intervals, {intervals}: leave 'segments' out"
        raise InvalidArgument.at("/segments", "not-a-divisor", message)
    if wanted.path:
        return intervals
    count = count or max(k for k in range(1, SEGMENTS + 1) if intervals % k == 0)
    if intervals % count:
        raise InvalidArgument.at("/segments", "not-a-divisor", f"{count} segments do not divide {intervals} intervals")
    return count


def ranges_of(wanted: Demands) -> tuple[Array, Array]:
    """Least and largest values of free parameters and of a free horizon, in this order. Raises InvalidArgument."""
    horizon: Limits = {} if wanted.free_horizon is None else {HORIZON: wanted.free_horizon}
    return limits_of({**wanted.free_parameters, **horizon}, "free_parameters")


def demanded(model: Model, given: Any, field: str, offset: int) -> list[tuple[int, float]]:
    """(index in (q, q'), value) of every demand. Raises InvalidArgument."""
    pointer, names = f"/end/{field}", model.positions if field == "q" else model.coordinates
    if not isinstance(given, Mapping):
        if not isinstance(given, list | tuple | np.ndarray):
            message = f"numbers by coordinate, or a list of them, are needed, found {repr(given)[:80]}"
            raise InvalidArgument.at(pointer, "list-expected", message)
        if len(given) != len(names):
            raise InvalidArgument.at(pointer, "wrong-length", f"{len(given)} values for {len(names)} coordinates")
        given = dict(zip(names, given, strict=True))
    for name in given:
        if name not in names:
            message = f"unknown coordinate '{name[:80]}'{among(name, names)}"
            raise InvalidArgument.at(f"{pointer}/{escape(name)}", "unknown-coordinate", message)
    pairs = ((a, given.get(name)) for a, name in enumerate(names))
    return [(offset + a, real(x, pointer)) for a, x in pairs if x is not None]


def rows_of(model: Model, demands: Sequence[Demand]) -> tuple[Array, Array]:
    """A (d, size) and b of A x = b for the demands on the last state x. Where all numbers of a quaternion Q_d are
    demanded it is its attitude, Q = +-Q_d: the vector part of 2 Q_d^-1 Q is 0, as |Q| does not change.

    Raises InvalidArgument (``/end/q``) for a Q_d of another length than 1.
    """
    wanted, unit = dict(demands), np.eye(len(model.positions) + model.dof)
    rows, values, turning = list[Array](), list[float](), set[int]()
    for ball, some in zip(model.balls, quaternions_in(model.positions, model.balls), strict=True):
        if all(k in wanted for k in some):
            turning |= {*some}
            q = at_zero(model.positions, model.balls)
            q[some] = [wanted[k] for k in some]
            q = with_unit_quaternions(model.positions, model.balls, q[None], "/end/q")[0]
            turned = by_displacements(model.positions, model.coordinates, model.balls, q)
            for name in ball["velocities"][-3:]:
                own = np.zeros(len(unit))
                own[some] = turned[model.coordinates.index(name), some]
                rows.append(own)
                values.append(0.0)
    others = [(k, value) for k, value in demands if k not in turning]
    rows, values = [*(unit[k] for k, _ in others), *rows], [*(value for _, value in others), *values]
    return np.array(rows).reshape(-1, len(unit)), np.array(values)


def bounds_of(controls: Sequence[str], wanted: Demands) -> tuple[Array, Array]:
    """Least and largest values of the controls, (m,). Raises InvalidArgument."""
    for name in wanted.bounds:
        if name not in controls:
            message = f"'{name[:80]}' is not one of the controls{among(name, controls)}"
            raise InvalidArgument.at(f"/bounds/{escape(name)}", "unknown-input", message)
    limits_of(wanted.bounds, "bounds")
    return limits_of({name: wanted.bounds.get(name, (None, None)) for name in controls}, "bounds")
