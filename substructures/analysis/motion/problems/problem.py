"""What a motion is computed from: the start, what acts, the span, what is noted on the way, and how accurately."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from substructures.analysis.arguments import NumberOrExpression, in_range, one_of, positive, whole
from substructures.analysis.motion.integrators.compiled_steps import compiled_stepper
from substructures.analysis.motion.integrators.fixed_step import FixedStep
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.integrators.steppers import METHODS, Stepper
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.start import Start
from substructures.errors import InvalidArgument
from substructures.tree.model import Model


@dataclass(frozen=True)
class Integrator:
    """How a motion is computed, and how accurate it must be.

    ``method``: DOP853, RK45, RK23 and, of stiff equations, Radau, BDF for every model; LSODA (stiff) without closures;
    a FixedStep (real time) for trees. Tolerances of a step, |error| <= absolute + relative |x|; ``max_step`` [s], but
    of steps of a fixed size; ``max_steps``: so many accepted steps at most. ``drift_limit``: relative drift of first
    integrals above which a result is not right. ``progress`` is told the finished share of the span and stops by
    False; ``folder``: where compiled kernels are kept. Raises InvalidArgument.
    """

    method: str | FixedStep = "DOP853"
    relative_tolerance: float = 1e-10
    absolute_tolerance: float = 1e-12
    max_step: float | None = None
    max_steps: int = 1_000_000
    drift_limit: float = 1e-7
    progress: ProgressReport | None = None
    folder: Path | None = None

    def __post_init__(self) -> None:
        if self.fixed_step is None:
            one_of(self.method, "method", METHODS)
        elif self.max_step is not None:
            message = f"steps have the size {self.fixed_step.step:g} s here: leave 'max_step' ({self.max_step}) out"
            raise InvalidArgument.at("/max_step", "not-supported", message)
        object.__setattr__(self, "drift_limit", positive(self.drift_limit, "drift_limit"))
        object.__setattr__(
            self, "relative_tolerance", in_range(self.relative_tolerance, "relative_tolerance", 1e-14, 0.1)
        )
        object.__setattr__(self, "absolute_tolerance", in_range(self.absolute_tolerance, "absolute_tolerance", 0, 0.1))
        if self.max_step is not None:
            object.__setattr__(self, "max_step", positive(self.max_step, "max_step"))
        whole(self.max_steps, "max_steps", 1, 100_000_000)

    @property
    def fixed_step(self) -> FixedStep | None:
        """The size of its steps, where they are all of one."""
        return self.method if isinstance(self.method, FixedStep) else None

    def stepper(self) -> Stepper:
        """SciPy's; steps of explicit ones are machine code where the function is."""
        tolerances = self.relative_tolerance, self.absolute_tolerance
        return compiled_stepper(str(self.method), *tolerances, self.max_step)


@dataclass(frozen=True, kw_only=True)
class MotionProblem:
    """An initial value problem: a model from a start over a span; see :func:`substructures.analysis.simulate.simulate`.

    ``series``: expressions to be followed, by name.
    """

    model: Model
    start: Start
    times: OutputTimes
    integrator: Integrator = field(default_factory=Integrator)
    events: Sequence[Event] = ()
    series: Mapping[str, NumberOrExpression] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", self.start.with_defaults(self.model))

    @property
    def span(self) -> tuple[float, float]:
        """When the motion starts and when it ends [s]."""
        return self.times.span

    @property
    def drift_limit(self) -> float:
        """Of first integrals, relative, in a right result."""
        return self.integrator.drift_limit
