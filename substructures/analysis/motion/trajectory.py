"""A computed motion with its judges: quantities that must be constant, must fall or must vanish along it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from substructures.analysis.motion.problems.events import Event
from substructures.analysis.verdict import Check, verdict
from substructures.array import Array
from substructures.errors import listed


@dataclass(frozen=True)
class Crossing:
    """An event: ``name``, when [s], and the state; where it acts the state ``after`` it (q, q'), and by how much the
    energy has changed [J]. ``kind``: what a contact of that name does, impact, lift_off, stick or slip; of an impact
    with its ``impulse`` along the normal and both tangents [N s]; or lost-rank, where closures no longer determine it.
    """

    name: str
    t: float
    q: Array
    qd: Array
    after: tuple[Array, Array] | None = None
    energy_change: float = 0.0
    kind: str = ""
    impulse: tuple[float, ...] = ()

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        told: dict[str, Any] = {"name": self.name, "t": self.t, "q": self.q.tolist(), "qd": self.qd.tolist()}
        told |= {"kind": self.kind} if self.kind else {}
        told |= {"impulse": list(self.impulse)} if self.impulse else {}
        if self.after is None:
            return told
        q, qd = self.after
        return told | {"after": {"q": q.tolist(), "qd": qd.tolist()}, "energy_change": self.energy_change}


def crossings(events: Sequence[Event], found: Sequence[tuple[int, float, Array]], rates: slice) -> tuple[Crossing, ...]:
    """Zeros that an integration found (event, time, state (q, q', ...)) as crossings; ``rates``: where q' is."""
    return tuple(Crossing(events[k].name, t, x[: rates.start], x[rates]) for k, t, x in found)


def in_order(*found: Sequence[Crossing]) -> tuple[Crossing, ...]:
    """All of them, in the order of time."""
    return tuple(sorted((event for some in found for event in some), key=lambda event: event.t))


@dataclass(frozen=True)
class Trajectory:
    """States at the times ``t`` (K,): ``q``, ``qd`` (K, n) in the order of ``coordinates`` [rad, m; per s].

    ``series``: further quantities by name, (K, ...): energies, momenta, residuals, reactions. ``status`` is a value:
    ``finished``; ``stopped`` by an event; ``failed``, and ``message`` says why and what to change, with the motion up
    to there. ``steps``: accepted steps of the integrator. ``figures``: numbers about the computation (evaluations of
    the right-hand side, seconds, real-time factor). ``cancelled``: stopped by whoever watched its progress.
    ``reached``: lowest and highest values of the coordinates on the way, (n,) each, between steps too; ``limits``:
    those of the joints; ``warnings``: what was left of them. ``joints``: the rows of reactions, ``loads``: of powers;
    ``positions``: the columns of ``q``, where they are not the coordinates.
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
    cancelled: bool = False
    reached: tuple[Array, Array] | None = None
    limits: Mapping[str, list[float]] = field(default_factory=dict)
    warnings: tuple[Mapping[str, str], ...] = ()
    joints: tuple[str, ...] = ()
    loads: tuple[str, ...] = ()
    positions: tuple[str, ...] = ()

    def __repr__(self) -> str:
        when = f"t = {self.t[0]:g} to {self.t[-1]:g} s" if len(self.t) else "at no time"
        made = [check for check in self.checks if check.made]
        kept = sum(check.holds is True for check in made)
        names = ", ".join(f"{check.name} {check.rule}" for check in made)
        states = f"{len(self.t)} states of {listed(self.coordinates)}"
        return (
            f"Trajectory: {states}, {when}, {self.steps} steps, {self.status}\n"
            f"is_right={self.is_right}: {kept} of {len(made)} checks hold ({names or 'none'}); "
            f"series: {listed(self.series) or 'none'}"
        )

    @property
    def is_right(self) -> bool | None:
        """True when all checks hold; False when a necessary condition is violated: the numbers are wrong, whatever the
        integrator says; None when nothing could be checked, or the motion failed or was cancelled.
        """
        return verdict(self.checks, self.status != "failed" and not self.cancelled)

    def arrays(self) -> dict[str, Array]:
        """t, q, qd and all series by name."""
        return {"t": self.t, "q": self.q, "qd": self.qd, **self.series}

    def summary(self) -> dict[str, Any]:
        """What was found beside the arrays, as plain data."""
        return {
            "coordinates": list(self.coordinates),
            "count": len(self.t),
            "status": self.status,
            "message": self.message,
            "is_right": self.is_right,
            "checks": [check.summary() for check in self.checks],
            "events": [event.plain() for event in self.events],
            "steps": self.steps,
            "figures": dict(self.figures),
            "limits": dict(self.limits),
            "warnings": [dict(warning) for warning in self.warnings],
            **({"joints": list(self.joints)} if self.joints else {}),
            **({"loads": list(self.loads)} if self.loads else {}),
            **({"positions": list(self.positions)} if self.positions else {}),
        }
