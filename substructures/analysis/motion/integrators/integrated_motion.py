"""What an integrator leaves: results, accepted steps for the judges, zeros of what is watched, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array

#: accepted steps that are kept for the judges
KEPT = 20_000


@dataclass
class IntegratedMotion:
    """Results at the wanted times, accepted steps for the judges, and (watch, t, x) of the zeros found."""

    t: list[float] = field(default_factory=list)
    x: list[Array] = field(default_factory=list)
    step_t: list[float] = field(default_factory=list)
    step_x: list[Array] = field(default_factory=list)
    found: list[tuple[int, float, Array]] = field(default_factory=list)
    status: Literal["finished", "stopped", "failed"] = "finished"
    message: str = ""
    steps: int = 0
    evaluations: int = 0
    stride: int = 1
    cancelled: bool = False

    def judged(self) -> tuple[Array, Array, NDArray[np.int64]]:
        """Times (J,) and states (J, N), in order, of all that the judges see: steps that were kept, results and zeros;
        and which of them are the results (K,).
        """
        t = np.array([*self.step_t, *self.t, *(t for _, t, _ in self.found)], dtype=np.float64)
        x = np.array([*self.step_x, *self.x, *(x for _, _, x in self.found)], dtype=np.float64)
        # results[k] = place of the k-th result after sorting, by the inverse of the permutation
        order = np.argsort(t, kind="stable")
        results = np.argsort(order)[len(self.step_t) : len(self.step_t) + len(self.t)]
        return t[order], x[order], results

    def end(self, status: Literal["stopped", "failed"], message: str) -> None:
        """No further steps."""
        self.status, self.message = status, message

    def cancel(self, t: float) -> None:
        """No further steps: whoever watches the progress has had enough."""
        self.end("stopped", f"cancelled at t = {t:.9g} s")
        self.cancelled = True

    def keep(self, t: float, x: Array) -> None:
        """Note an accepted step; every second one is dropped when there are too many."""
        self.steps += 1
        if self.steps % self.stride == 0:
            self.step_t.append(t)
            self.step_x.append(x)
        if len(self.step_t) > KEPT:
            self.step_t, self.step_x, self.stride = self.step_t[::2], self.step_x[::2], 2 * self.stride
