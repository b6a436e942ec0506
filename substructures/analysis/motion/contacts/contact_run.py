"""A motion with contacts as pieces between impacts and changes of who sticks, slips and lifts off; and its checks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.motion.contacts.contact_motion import OPEN, STICK
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.friction.dry_run import DryRun, integrate_dry
from substructures.analysis.motion.integrators.compiled_steps import CompiledStepper
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, TimeReport, integrate
from substructures.analysis.motion.integrators.steppers import Stepper
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.verdict import About, Check
from substructures.array import Array

#: largest penetration of a right motion [m]
PENETRATION = 1e-9


@dataclass
class ContactRun(DryRun):
    """With the number of the piece of every step, result and event; ``piece`` (J,): of the states that are judged."""

    pieces: tuple[list[int], list[int], list[int]] = field(default_factory=lambda: ([], [], []))
    piece: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    advice: ClassVar[str] = (
        "contacts change without end: try 'Radau' if the method was another one, raise 'max_steps' or "
        "'rest_velocity', or take contacts that depend less on each other"
    )

    def add(self, piece: IntegratedMotion, outputs: Array, events: int) -> None:
        """One more piece, with its end, where the next one may begin with other velocities."""
        if piece.status == "stopped" and not piece.cancelled and piece.step_t[-1] < piece.found[-1][1]:
            _, t, x = piece.found[-1]
            piece.step_t.append(t)
            piece.step_x.append(x)
        super().add(piece, outputs, events)
        for mine, count in zip(self.pieces, (len(self.step_t), len(self.t), len(self.found)), strict=True):
            mine += [len(self.signs) - 1] * (count - len(mine))

    def judged(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """As that of every motion; states before an impact come before those after it."""
        steps, results, found = self.pieces
        # of a start where nothing could be decided there is no piece
        results = [*results, *[max(0, len(self.signs) - 1)] * (len(self.t) - len(results))]
        piece = np.array([*steps, *results, *found], dtype=np.int64)
        t = np.array([*self.step_t, *self.t, *(t for _, t, _ in self.found)], dtype=np.float64)
        x = np.array([*self.step_x, *self.x, *(x for _, _, x in self.found)], dtype=np.float64)
        order = np.lexsort((piece, t))
        self.piece = piece[order]
        return t[order], x[order], np.argsort(order)[len(steps) : len(steps) + len(results)]


def integrate_contacts(
    f: DecidedContacts,
    x: Array,
    span: tuple[float, float],
    outputs: Array,
    settings: IntegratorSettings,
    watches: Sequence[Watch],
    breaks: Sequence[float],
    progress: TimeReport | None,
) -> ContactRun:
    """As :func:`~substructures.analysis.motion.integrators.integration.integrate`, from one change to the next."""
    f.begin()
    landed = replace(settings, stepper=landing(f, settings.stepper))
    run = integrate_dry(f, x, span, outputs, landed, watches, breaks, progress, ContactRun())
    f.at = run.at
    return run


def landing(contacts: DecidedContacts, plain: Stepper) -> Stepper:
    """Steps that land on closed contacts where they have drifted from them."""

    def make(f: Any, start: float, x: Array, end: float, **first_step: float) -> Any:
        """A stepper of f from x at start to end."""
        solver = plain(f, start, x, end, **first_step)
        step: Callable[[], str | None] = solver.step

        def landed() -> str | None:
            """A step, and the state on the contacts."""
            message = step()
            if solver.status != "failed" and contacts.has_drifted(solver.t, solver.y):
                y = contacts.land(solver.t, solver.y, contacts.closed, contacts.modes[:, 0] == STICK)
                if isinstance(solver, CompiledStepper):
                    solver.go_on(y)
                else:
                    solver.y, solver.f = y, solver.fun(solver.t, y)
            return message

        solver.step, solver.is_watched = landed, True
        return solver

    return make


def again(
    f: DecidedContacts, x: Array, span: tuple[float, float], outputs: Array, settings: IntegratorSettings
) -> IntegratedMotion:
    """A step once more, with contacts as they were then."""
    f.modes = f.at((span[0] + span[1]) / 2)
    f.evaluate(span[0], x)
    return integrate(f, x, span, outputs, settings, enter=f.enter)


def with_contacts(
    f: DecidedContacts, run: ContactRun, t: Array, x: Array, series: dict[str, Array]
) -> tuple[Check, ...]:
    """Gaps, contact forces and accelerations along a motion as further series, and what has to be true of them."""
    k, n = len(f.contacts), f.n
    gap, force, second, bad = np.zeros((len(t), k)), np.zeros((len(t), k, 3)), np.zeros((len(t), n)), np.zeros(len(t))
    deep = np.zeros(len(t))
    for j, (at, state, piece) in enumerate(zip(t.tolist(), x, run.piece.tolist(), strict=True)):
        f.modes = run.signs[piece]
        second[j], _, _ = f.evaluate(at, state)
        f.look(at, state)
        gap[j], force[j] = f.gap, f.force
        deep[j] = np.where(f.modes[:, 0] >= OPEN, -f.gap, 0).max(initial=0)
        bad[j] = _violation(f)
        if "power" in series:
            series["power"][j] += f.power(state)
    series |= {"qdd": second, "gaps": gap, "contact_forces": force}
    return _checks(f, t, deep, bad, float(np.abs(force).max(initial=0)))


def _violation(f: DecidedContacts) -> float:
    """By how much forces pull, or drag more than they can [N]."""
    drag = np.linalg.norm(f.force[:, 1:], axis=1) - f.friction * f.force[:, 0]
    return float(np.where(f.closed, np.maximum(-f.force[:, 0], drag), 0.0).max(initial=0))


def _checks(f: DecidedContacts, t: Array, deep: Array, bad: Array, size: float) -> tuple[Check, ...]:
    """Penetration, forces, and impacts."""
    through: About = "penetration", "zero", "no contact that acts is below its plane", "m"
    pressed: About = "contacts", "zero", "contacts press, and drag no more than friction times that", "N"
    checks = [Check.of(through, deep, t, 1.0, PENETRATION), Check.of(pressed, bad, t, size or 1.0, 1e-7)]
    if f.impacts:
        times = np.array([impact.t for impact in f.impacts])
        missing = np.array([abs(impact.missing) + max(0.0, impact.work) for impact in f.impacts])
        why = "T changes by 1/2 (q'+ + q'-) . G^T L in each impact, and beside what moves planes it does not rise"
        largest = max(impact.energy for impact in f.impacts)
        checks.append(Check.of(("impact-energy", "zero", why, "J"), missing, times, largest or 1.0, 1e-10))
        failed = np.array([impact.violation for impact in f.impacts])
        why = "impulses and velocities after each impact meet the conditions of complementarity"
        checks.append(Check.of(("impacts", "zero", why, "1"), failed, times, 1.0, 1e-9))
    return tuple(checks)
