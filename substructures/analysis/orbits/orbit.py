"""What is known of a periodic orbit, and what its multipliers say of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from substructures.analysis.arguments import NumberOrExpression, one_of, positive, real, whole
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import Check, verdict
from substructures.array import Array
from substructures.documents import escape
from substructures.documents.units import read_unit
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.expr.units.dimensions import DimensionError, Inference
from substructures.expr.units.unit_check import dimension_of, steps_of
from substructures.quantities.numbers.defaults import default_numbers
from substructures.tree.model import Model

Stability = Literal["stable", "unstable", "neutral", "unknown"]
BifurcationKind = Literal["fold", "branch-point", "period-doubling", "torus"]
#: |multiplier| - 1 that says something: multipliers of a double eigenvalue 1 are only known to the root of their errors
NOISE = 1e-4
#: turns of a coordinate in a period
MOST = 1_000_000


@dataclass(frozen=True)
class Section:
    """The surface ``quantity`` (an expression in coordinates, velocities and parameters, its unit) = ``level`` that an
    orbit crosses in a ``direction`` ``count`` times in its period; each return takes at most a ``duration`` [s].

    Raises InvalidArgument.
    """

    quantity: NumberOrExpression
    level: float = 0.0
    direction: Literal["rising", "falling"] = "rising"
    count: int = 1
    duration: float = 100.0

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "level", real(self.level, "/level"))
            one_of(self.direction, "direction", ("rising", "falling"))
            whole(self.count, "count", 1, 1000)
            positive(self.duration, "duration")
        except InvalidArgument as error:
            raise error.below("/section") from None


@dataclass(frozen=True)
class Orbit:
    """``q``, ``qd`` (n,) [rad, m; per s] on the orbit, its ``period`` [s], the ``multipliers`` (2n,), the largest one
    first, and Floquet's ``exponents`` log(multiplier)/period [1/s].

    ``stability`` of the orbit, with its ``reason``: asymptotically stable, unstable, or neutral, when multipliers are
    on the unit circle and linear equations say no more. ``trajectory``: the motion over a period; ``value``: of what
    varies along a family. ``status`` is ``failed`` where no orbit was found, with a ``message``.
    """

    q: Array
    qd: Array
    period: float
    multipliers: Array
    exponents: Array
    stability: Stability
    reason: str
    status: Literal["finished", "failed"]
    message: str
    iterations: int
    checks: tuple[Check, ...]
    trajectory: Trajectory
    value: float | None = None

    @property
    def is_right(self) -> bool | None:
        """Whether all checks hold; None where no orbit was found."""
        return verdict(self.checks, self.status == "finished")


@dataclass(frozen=True)
class OrbitBifurcation:
    """Where a family turns back, meets others or changes its stability: the orbit ``at`` it, with its ``value``; its
    ``kind`` by the names of :mod:`substructures.analysis.orbits.families`, and the reason.
    """

    kind: BifurcationKind
    reason: str
    at: Orbit


@dataclass(frozen=True)
class Family:
    """``found``: the orbits, each from the one before; ``coordinates``; ``vary``: what varies. Of a family that was
    followed by arclength the ``bifurcations``, and a ``message`` where it ends within the range.
    """

    coordinates: tuple[str, ...]
    vary: str | None
    found: tuple[Orbit, ...]
    bifurcations: tuple[OrbitBifurcation, ...] = ()
    message: str = ""

    def __len__(self) -> int:
        return len(self.found)

    def __iter__(self) -> Iterator[Orbit]:
        return iter(self.found)

    def __getitem__(self, k: int) -> Orbit:
        return self.found[k]

    @property
    def is_right(self) -> bool | None:
        """Whether all that were found are; None where any was not."""
        rights = [orbit.is_right for orbit in (*self.found, *(one.at for one in self.bifurcations))]
        return False if False in rights else None if None in rights else True


@dataclass(frozen=True)
class Shooting:
    """What is looked for. ``period`` [s], a number or an expression in parameters (``2*pi/w``): a guess, of forced
    motions the period, or None: the time of return to the ``section`` that the start is near; ``is_fixed``: it stays
    as it is; ``hold``: components of the state (``arm.q1``, ``arm.q1'``) that stay as they are; ``turns``: whole turns
    that revolute coordinates make in a period. Raises InvalidArgument.
    """

    period: float | str | None
    is_fixed: bool = False
    hold: tuple[str, ...] = ()
    turns: Mapping[str, int] | None = None
    section: Section | None = None

    def __post_init__(self) -> None:
        for name, turns in (self.turns or {}).items():
            whole(turns, f"turns/{escape(name)}", -MOST, MOST)

    def period_at(self, model: Model, parameters: Mapping[str, float]) -> float | None:
        """The period [s] as a number, at these ``parameters`` and the defaults of others. Raises InvalidArgument (for a
        formula that is no time, ``unit-mismatch``; whole numbers and pi in it have no unit), MissingValue.
        """
        if not isinstance(self.period, str):
            return self.period
        read = read_expressions(model, {"period": [(self.period, "/period")]})
        for symbol in read.symbols:
            if symbol.kind != "parameter":
                message = f"a period depends on parameters alone, not on '{symbol.name}'"
                raise InvalidArgument.at("/period", "unknown-name", message)
        inference = Inference(lambda name: dimension_of(model.units.get(name, "")), counts=True)
        try:
            inference.require(inference.of(steps_of(self.period)), read_unit("s").dimension)
        except DimensionError as error:
            message = f"'{self.period[:80]}' is no time: {error}"
            raise InvalidArgument.at("/period", "unit-mismatch", message) from None
        values = {**default_numbers(model.parameters), **parameters}
        return positive(float(interpret(read, values)["period"][0]), "period")

    def longest(self, period: float | None) -> float:
        """Of the ``period`` or the section, which is given in place of it, the longest time [s]. Raises
        InvalidArgument.
        """
        if self.section is None:
            if period is None:
                message = "give 'period', or the 'section' whose time of return it is"
                raise InvalidArgument.at("/period", "missing", message)
            return positive(period, "period")
        if period is not None:
            message = "give 'period', or the 'section' whose time of return it is, not both"
            raise InvalidArgument.at("/section", "contradiction", message)
        if self.is_fixed:
            message = "the time of return to 'section' is unknown: leave 'fixed' out, or give 'period'"
            raise InvalidArgument.at("/fixed", "contradiction", message)
        return self.section.duration


def stability(multipliers: Array, is_free: bool) -> tuple[Stability, str]:
    """What the multipliers say of an orbit, and why; ``is_free``: one is 1, along the motion."""
    sizes = np.abs(multipliers)
    if sizes.max(initial=0) > 1 + NOISE:
        return "unstable", f"a multiplier has the modulus {sizes.max():.6g}"
    rest = np.sort(np.abs(multipliers - 1)) if is_free else np.array([])
    others = np.delete(sizes, np.argmin(np.abs(multipliers - 1))) if is_free else sizes
    if is_free and rest[0] > 100 * NOISE:
        return "unknown", "no multiplier is 1, which the one along a motion has to be"
    if others.max(initial=0) < 1 - NOISE:
        return "stable", f"all multipliers{' but that along the motion' if is_free else ''} are within the unit circle"
    count = int((others >= 1 - NOISE).sum())
    return "neutral", f"{count} multipliers{' beside that along the motion' if is_free else ''} are on the unit circle"
