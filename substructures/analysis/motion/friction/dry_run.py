"""A motion with dry friction as pieces, from where a joint stops or breaks away to where the next one does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np

from substructures.analysis.motion.friction.dry_friction import DryMotion, FrictionLaws, Signs
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, TimeReport, integrate
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.trajectory import Crossing
from substructures.analysis.verdict import About, Check
from substructures.array import Array

#: so many pieces, one after the other, of less than this share of the span mean that the motion is stuck
STUCK, LEAST = 50, 1e-9
SINGULAR = (
    "the metric is singular: spherical and free joints are at pitch = +-pi/2, where 'ball' and 'floating' go on, or a "
    "body has no mass"
)
ADVICE = "joints stop and break away without end: raise 'max_steps', or take the smooth law of friction ('regularised')"


class Deciding(Protocol):
    """x' = f(t, x), x = (q, q', ...), while what sticks and slips does as ``signs`` say."""

    n: int

    @property
    def signs(self) -> Any:
        """By joint with friction: 1 and -1 slip that way, 0 sticks; of contacts their modes."""

    @signs.setter
    def signs(self, signs: Any) -> None: ...

    def __call__(self, t: float, x: Array) -> Array:
        """x' at (t, x)."""

    def enter(self, start: float, end: float) -> None:
        """Told the times between which it is called next."""

    def decided(self, t: float, x: Array) -> tuple[Any, Array]:
        """Who slips and who sticks at a state, and the state with those at rest at rest. Raises ArithmeticError."""

    def watches(self) -> list[Watch]:
        """What ends that."""


class Sticking(Deciding, Protocol):
    """The same of joints with friction."""

    laws: FrictionLaws

    def moved(self, t: float, x: Array, signs: Signs) -> tuple[Array, Array, float]:
        """q'' (n,), the friction of the joints that have some (k,), and the power of all forces without potential."""


@dataclass
class DryRun(IntegratedMotion):
    """With the times from which on joints slip and stick as ``signs`` say, and the states ``starts`` then."""

    since: list[float] = field(default_factory=list)
    starts: list[Array] = field(default_factory=list)
    signs: list[Any] = field(default_factory=list)
    advice: ClassVar[str] = ADVICE

    def at(self, t: float) -> Any:
        """Who slips and who sticks at a time; of two that meet there the later one."""
        return self.signs[max(0, int(np.searchsorted(self.since, t, side="right")) - 1)]

    def forces(self, f: Sticking, t: Array, x: Array) -> tuple[Array, Array]:
        """q'' (K, n) and the friction on all coordinates (K, n)."""
        second, force = np.zeros((len(t), f.n)), np.zeros((len(t), f.n))
        for i, (at, state) in enumerate(zip(t.tolist(), x, strict=True)):
            second[i], force[i, f.laws.places], _ = f.moved(at, state, self.at(at))
        return second, force

    def told(self, names: Sequence[str], laws: FrictionLaws, rates: slice) -> list[Crossing]:
        """Joints that begin to stick and to slip after the start; ``names``: of all coordinates, whose ``rates`` are
        there in a state.
        """
        found = list[Crossing]()
        for t, x, before, now in zip(self.since[1:], self.starts[1:], self.signs, self.signs[1:], strict=False):
            for k in np.flatnonzero((np.asarray(before) == 0) != (np.asarray(now) == 0)).tolist():
                kind = "slip" if now[k] else "stick"
                found.append(Crossing(names[laws.places[k]], t, x[: rates.start].copy(), x[rates].copy(), kind=kind))
        return found

    def undecided(self, t: float, x: Array, signs: Any, why: str) -> None:
        """End where nobody can tell who slips and who sticks, with the state there."""
        self.since.append(t)
        self.starts.append(x)
        self.signs.append(signs)
        if not self.t or self.t[-1] < t:
            self.t.append(t)
            self.x.append(x)
        self.end("failed", f"at t = {t:.9g} s {why}")

    def add(self, piece: IntegratedMotion, outputs: Array, events: int) -> None:
        """One more piece; what it has at its own end is no result, unless the motion ends there."""
        ends = piece.status != "stopped" or piece.cancelled or piece.found[-1][0] < events
        for t, x in zip(piece.t, piece.x, strict=True):
            if ends or t in outputs:
                self.t.append(t)
                self.x.append(x)
        self.step_t += piece.step_t
        self.step_x += piece.step_x
        self.found += [each for each in piece.found if each[0] < events]
        self.steps, self.evaluations = self.steps + piece.steps, self.evaluations + piece.evaluations
        self.stride, self.cancelled = max(self.stride, piece.stride), piece.cancelled
        if ends:
            self.status, self.message = piece.status, piece.message


Run = TypeVar("Run", bound=DryRun)


def integrate_dry(
    f: Deciding,
    x: Array,
    span: tuple[float, float],
    outputs: Array,
    settings: IntegratorSettings,
    watches: Sequence[Watch],
    breaks: Sequence[float],
    progress: TimeReport | None,
    run: Run,
) -> Run:
    """As :func:`~substructures.analysis.motion.integrators.integration.integrate`; joints slip and stick. ``run``: what
    the pieces are added to.
    """
    t, still = span[0], 0
    while True:
        try:
            f.signs, x = f.decided(t, x)
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            run.undecided(t, x, f.signs, SINGULAR if isinstance(error, np.linalg.LinAlgError) else str(error))
            return run
        run.since.append(t)
        run.starts.append(x)
        run.signs.append(f.signs)
        left = replace(settings, max_steps=max(1, settings.max_steps - run.steps))
        wanted = outputs if t == span[0] else outputs[outputs > t]
        pieces = (t, span[1]), wanted, left, [*watches, *f.watches()], [b for b in breaks if b > t]
        piece = integrate(f, x, *pieces, progress, f.enter)
        run.add(piece, outputs, len(watches))
        if piece.status != "stopped" or piece.cancelled or piece.found[-1][0] < len(watches):
            return run
        _, end, x = piece.found[-1]
        still = still + 1 if end - t <= LEAST * (span[1] - span[0]) else 0
        if end >= span[1]:
            return run
        if still > STUCK or run.steps >= settings.max_steps:
            run.end("failed", f"at t = {end:.9g} s {run.advice}")
            return run
        t = end


def sticking(f: Sticking, run: DryRun, t: Array, force: Array, limit: float) -> Check:
    """No joint sticks with more than its static friction; ``force``: on all coordinates (K, n)."""
    about: About = "friction", "zero", "no joint that sticks needs more than its static friction F_s", "1"
    stuck = np.array([run.at(at) == 0 for at in t.tolist()]).reshape(len(t), -1)
    beyond = np.abs(force[:, f.laws.places]) / np.maximum(f.laws.static, 1e-300) - 1
    return Check.of(about, np.where(stuck, np.maximum(beyond, 0), 0).max(axis=1, initial=0), t, 1.0, limit)


def with_friction(series: dict[str, Array], dry: DryMotion, motion: DryRun, t: Array, x: Array, limit: float) -> Check:
    """Accelerations and friction as further series; whether nothing sticks with more than it can."""
    second, force = motion.forces(dry, t, x)
    if "power" in series:
        series["power"] = series["power"] + dry.instead(force, x)
    series |= {"qdd": second, "friction": force}
    return sticking(dry, motion, t, force, limit)
