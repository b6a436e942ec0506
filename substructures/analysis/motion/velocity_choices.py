"""Velocities of coordinates that are changed on the way, where those at hand determine the others badly.

With constraints B q' = 0 and velocities v of some coordinates, B_z z' = -B_v v for the others z. A blade that has
turned by a right angle is described by another coordinate; no choice holds in all positions. How good one is at a
position is the smallest singular value of B_z there over that of B. The state is x = (q, q', work) for all choices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.integrators.steppers import Stepper, within
from substructures.analysis.motion.reduced_motion import ReducedMotion
from substructures.array import Array
from substructures.compile import Kernel

#: a choice is given up where it is worse than this, and the best one there is taken
WORN = 0.3


class VelocityChoices:
    """The choices that were made along a motion, the ``first`` of them; ``make``: the motion in the velocities of the
    coordinates that are named, None where the first choice stays, and states are y = (q, v, work) of it.
    """

    def __init__(self, first: ReducedMotion, make: Callable[[Sequence[str]], ReducedMotion] | None) -> None:
        self.first, self.make = first, make
        self.known: dict[tuple[str, ...], ReducedMotion] = {first.equations.velocities: first}
        self._between: tuple[float, float] | None = None

    @property
    def rates(self) -> int:
        """How many velocities are in a state."""
        return self.first.p if self.make is None else self.first.n

    def enter(self, start: float, end: float) -> None:
        """Told the times between which states are next."""
        self._between = start, end
        for motion in self.known.values():
            motion.inputs.enter(start, end)

    def leave(self) -> None:
        """Any time again."""
        self._between = None
        for motion in self.known.values():
            motion.inputs.leave()

    def begun(self, t: float, y: Array) -> Array:
        """The state of y of the first choice."""
        return y if self.make is None else self.first.full(t, y)

    def state(self, t: float, x: Array) -> Array:
        """(q, q') of a state."""
        return self.first.state(t, x) if self.make is None else x[:-1]

    def stepper(self, make: Stepper) -> Stepper:
        """Of states, by an integrator of y."""
        if self.make is None:
            return make
        return lambda _, t, x, end, **__: ChangingStepper(self, make, t, x, end)

    def pieces(self, t: Array, x: Array) -> list[tuple[ReducedMotion, NDArray[np.int64], Array]]:
        """States (K, N) at times (K,) by the choice that is best at them: their places, and y there."""
        if self.make is None:
            return [(self.first, np.arange(len(x)), x)]
        best = [self._best(B) for B in self._constraints(t, x)]
        found = []
        for motion in dict.fromkeys(best):
            places = np.flatnonzero([one is motion for one in best])
            found.append((motion, places, np.array([motion.reduced(state) for state in x[places]])))
        return found

    def good(self, t: float, x: Array, motion: ReducedMotion) -> bool:
        """Whether a choice may be kept at a state."""
        return self._share(self._constraints(np.full(1, t), x[None])[0], motion) >= WORN

    def at(self, t: float, x: Array) -> ReducedMotion:
        """The best choice at a state, of those that are known if one of them is good."""
        return self._best(self._constraints(np.full(1, t), x[None])[0])

    def _best(self, B: Array) -> ReducedMotion:
        """The same where the constraints are B (m, n)."""
        shares = {motion: self._share(B, motion) for motion in self.known.values()}
        best = max(shares, key=lambda motion: shares[motion])
        return best if shares[best] >= WORN else self._new(B)

    def _new(self, B: Array) -> ReducedMotion:
        """The choice by QR with pivoting of B."""
        names = self.first.equations.model.coordinates
        others = scipy.linalg.qr(B, mode="economic", pivoting=True)[2][: len(B)]
        chosen = tuple(name for a, name in enumerate(names) if a not in others)
        key = tuple(f"{name}'" for name in chosen)
        if key not in self.known and self.make is not None:
            self.known[key] = self.make(chosen)
            if self._between is not None:
                self.known[key].inputs.enter(*self._between)
        return self.known[key]

    def _constraints(self, t: Array, x: Array) -> Array:
        """B (K, m, n) at times (K,) and states (K, N)."""
        conditions = self.first.conditions
        columns = [(list(self.first.equations.model.coordinates), x[:, : self.first.n])]
        values = conditions.values | conditions.inputs_at(t, x[:, :-1]) | {"t": t}
        return self._rows.evaluate(values, columns=columns)["constraints"]

    @cached_property
    def _rows(self) -> Kernel:
        return program_kernel(self.first.equations.program.select(["constraints"]))

    @staticmethod
    def _share(B: Array, motion: ReducedMotion) -> float:
        least = float(np.linalg.svd(B, compute_uv=False)[-1])
        return float(np.linalg.svd(B[:, motion.dependent], compute_uv=False)[-1]) / least if least else 0.0


class ChangingStepper:
    """Steps of states x = (q, q', work); the attributes are those of scipy.integrate.OdeSolver."""

    def __init__(self, choices: VelocityChoices, make: Stepper, t: float, x: Array, end: float) -> None:
        self.choices, self.make, self.end = choices, make, end
        self.t = self.t_old = t
        self.y, self.status, self._counted = x, "running", 0
        self._begin({})

    def _begin(self, step: dict[str, float]) -> None:
        self.motion = self.choices.at(self.t, self.y)
        self.inner: Any = self.make(self.motion, self.t, self.motion.reduced(self.y), self.end, **step)

    @property
    def nfev(self) -> int:
        """Evaluations of the right-hand side."""
        return self._counted + int(self.inner.nfev)

    def step(self) -> str | None:
        """Advance by one step, at most to the end; a message when that failed."""
        if not self.choices.good(self.t, self.y, self.motion):
            self._counted += self.inner.nfev
            # machine code may be steps ahead, where it came to the end of its choice
            known = hasattr(self.inner, "h_abs") and self.t > self.t_old
            self._begin({"first_step": min(self.t - self.t_old, self.end - self.t)} if known else {})
        self.t_old = self.t
        message: str | None = self.inner.step()
        self.status = self.inner.status
        if self.status != "failed":
            self.t, self.y = float(self.inner.t), self.motion.full(self.inner.t, self.inner.y)
        return message

    def dense_output(self) -> Callable[[float], Array]:
        """States within the last step."""
        motion, dense = self.motion, within(self.inner, self.make)
        return lambda t: motion.full(t, dense(t))
