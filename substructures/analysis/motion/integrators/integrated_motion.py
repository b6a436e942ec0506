"""What an integrator leaves: results, accepted steps for the judges, zeros of what is watched, and how it ended."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array

#: accepted steps that are kept for the judges
KEPT = 20_000


class Stretch(NamedTuple):
    """Steps: times (k,) and states (k, N) at their ends; results in them: times (m,) and states (m, N)."""

    t: Array
    x: Array
    result_t: Sequence[float]
    result_x: Array


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

    def keep_last(self, t: float, x: Array) -> None:
        """The last state that was reached is a result, where it is none yet."""
        if not self.t or self.t[-1] < t:
            self.t.append(t)
            self.x.append(x)

    def go_on(self, stretch: Stretch) -> None:
        """Steps that were taken at once, and their results."""
        self.keep_all(stretch.t, stretch.x)
        self.t += stretch.result_t
        self.x += list(stretch.result_x)

    def keep(self, t: float, x: Array) -> None:
        """Note an accepted step."""
        self.steps += 1
        if self.steps % self.stride == 0:
            self.step_t.append(t)
            self.step_x.append(x)
        self._thin()

    def keep_all(self, t: Array, x: Array) -> None:
        """Note accepted steps (k,), (k, N)."""
        # those whose number is a multiple of the stride
        chosen = slice(-(self.steps + 1) % self.stride, None, self.stride)
        self.steps += len(t)
        self.step_t += t[chosen].tolist()
        self.step_x += list(x[chosen].copy())
        self._thin()

    def _thin(self) -> None:
        """Every second step is dropped when there are too many."""
        while len(self.step_t) > KEPT:
            self.step_t, self.step_x, self.stride = self.step_t[::2], self.step_x[::2], 2 * self.stride
