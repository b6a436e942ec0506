"""A computed motion with its judges: quantities that must be constant, must fall or must vanish along it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from substructures.analysis.motion.events import Event
from substructures.array import Array
from substructures.errors import listed

Rule = Literal["constant", "falling", "zero"]


@dataclass(frozen=True)
class Check:
    """A necessary condition along a motion.

    ``rule``: the quantity ``name`` is constant (first integral), never rises (energy with dissipation) or is zero (a
    residual of closures). ``worst``: the largest violation at all steps and all results, in ``unit``: of a constant the
    largest difference of two of its values, of what falls the largest rise. Relative to ``scale`` it is judged against
    ``limit``, and what rounding may add (next to singular positions of closures up to a hundred limits). ``time``: when
    the limit was first exceeded [s], None where the condition holds.
    """

    name: str
    rule: Rule
    reason: str
    unit: str
    worst: float
    scale: float
    limit: float
    time: float | None = None

    @classmethod
    def of(
        cls,
        about: tuple[str, Rule, str, str],
        violation: Array,
        t: Array,
        scale: float,
        limit: float,
        noise: Array | float = 0,
    ) -> Check:
        """``about``: name, rule, reason, unit; ``violation`` (K,): allowed up to limit * scale + noise (K,)."""
        # |violation| <= limit * scale + noise; not a number is a violation, too
        size = np.abs(violation)
        bad = np.flatnonzero(~(size <= limit * scale + noise))
        first = float(t[bad[0]]) if len(bad) else None
        return cls(*about, float(np.nanmax(size, initial=0.0)), scale, limit, first)

    @property
    def holds(self) -> bool:
        """Whether the condition holds everywhere."""
        return self.time is None

    @property
    def relative(self) -> float:
        """The largest violation over its scale."""
        return self.worst / self.scale if self.scale else self.worst


@dataclass(frozen=True)
class Crossing:
    """An event: ``name``, when [s], and the state."""

    name: str
    t: float
    q: Array
    qd: Array


def crossings(events: Sequence[Event], found: Sequence[tuple[int, float, Array]], n: int) -> tuple[Crossing, ...]:
    """Zeros that an integration found (event, time, state (q, q', ...)) as crossings."""
    return tuple(Crossing(events[k].name, t, x[:n], x[n : 2 * n]) for k, t, x in found)


@dataclass(frozen=True)
class Trajectory:
    """States at the times ``t`` (K,): ``q``, ``qd`` (K, n) in the order of ``coordinates`` [rad, m; per s].

    ``series``: further quantities by name, (K, ...): energies, momenta, residuals, reactions. ``status`` is a value:
    ``finished``; ``stopped`` by an event; ``failed``, and ``message`` says why and what to change, with the motion up
    to there. ``steps``: accepted steps of the integrator. ``figures``: numbers about the computation (evaluations of
    the right-hand side, seconds, real-time factor). ``reached``: lowest and highest values of the coordinates on the
    way, (n,) each, between steps too; ``limits``: those of the joints; ``warnings``: what was left of them.
    """

    coordinates: tuple[str, ...]
    t: Array
    q: Array
    qd: Array
    series: Mapping[str, Array] = field(default_factory=dict)
    checks: tuple[Check, ...] = ()
    status: Literal["finished", "stopped", "failed"] = "finished"
    message: str = ""
    steps: int = 0
    events: tuple[Crossing, ...] = ()
    figures: Mapping[str, float] = field(default_factory=dict)
    reached: tuple[Array, Array] | None = None
    limits: Mapping[str, list[float]] = field(default_factory=dict)
    warnings: tuple[Mapping[str, str], ...] = ()

    def __repr__(self) -> str:
        when = f"t = {self.t[0]:g} to {self.t[-1]:g} s" if len(self.t) else "at no time"
        kept = sum(check.holds for check in self.checks)
        names = ", ".join(f"{check.name} {check.rule}" for check in self.checks)
        states = f"{len(self.t)} states of {listed(self.coordinates)}"
        return (
            f"Trajectory: {states}, {when}, {self.steps} steps, {self.status}\n"
            f"is_right={self.is_right}: {kept} of {len(self.checks)} checks hold ({names or 'none'}); "
            f"series: {listed(self.series) or 'none'}"
        )

    @property
    def is_right(self) -> bool:
        """False when a necessary condition is violated: the numbers are wrong, whatever the integrator says."""
        return all(check.holds for check in self.checks)

    def arrays(self) -> dict[str, Array]:
        """t, q, qd and all series by name."""
        return {"t": self.t, "q": self.q, "qd": self.qd, **self.series}

    def summary(self) -> dict[str, Any]:
        """What was found beside the arrays, as plain data."""
        checks = [{**vars(c), "relative": c.relative, "holds": c.holds} for c in self.checks]
        events = [{"name": e.name, "t": e.t, "q": e.q.tolist(), "qd": e.qd.tolist()} for e in self.events]
        return {
            "coordinates": list(self.coordinates),
            "count": len(self.t),
            "status": self.status,
            "message": self.message,
            "is_right": self.is_right,
            "checks": checks,
            "events": events,
            "steps": self.steps,
            "figures": dict(self.figures),
            "limits": dict(self.limits),
            "warnings": [dict(warning) for warning in self.warnings],
        }
