"""Motions of one model from many starts and with many parameters: columns, statistics, and a verdict of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from typing import Any

import numpy as np

from substructures.analysis.arguments import values_of
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.integral import FirstIntegrals
from substructures.analysis.motion.integrators.integration import NO_ERROR
from substructures.analysis.motion.judges.balls import conditions_in_rates, with_lengths
from substructures.analysis.motion.judges.integrals import AlongMotion, conditions
from substructures.analysis.motion.judges.states import Condition, MotionStates
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.kinds import ConstrainedMotion, TreeMotion
from substructures.analysis.motion.problems.output_times import EVEN, OutputGrid, OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.array import Array
from substructures.ensembles.columns import MotionColumns, statistics
from substructures.ensembles.constrained import accelerations, kept_gaps
from substructures.ensembles.lanes import CUT, FINISHED, TOO_SMALL, LaneMotions, LaneSettings, march
from substructures.ensembles.members import Given, KernelRates, Members, along, read_members
from substructures.ensembles.motion_column import MotionColumn
from substructures.ensembles.one_by_one import OneByOne
from substructures.ensembles.result import TOLD, Ensemble, Failure
from substructures.errors import InvalidArgument
from substructures.quantities.numbers.states import StateInput
from substructures.quantities.sources import Sources
from substructures.tree.model import Model

METHODS = ("DOP853", "RK45", "RK23")
#: states of a part of the members, which are in memory together
STATES = 400_000
STEPS_TOO_SMALL = (
    "the steps became too small: a singular position, a law with a jump, or stiff equations (simulate the member with "
    "the method Radau)"
)
DEFAULT, NO_VALUES, NO_COLUMNS = Integrator(), dict[str, Any](), dict[str, MotionColumn]()


def simulate_ensemble(
    model: Model | Sources,
    q: StateInput | None,
    span: tuple[float, float],
    *,
    qd: StateInput | None = None,
    inputs: Given = NO_VALUES,
    parameters: Given = NO_VALUES,
    columns: Mapping[str, MotionColumn] = NO_COLUMNS,
    grid: OutputGrid = EVEN,
    integrator: Integrator = DEFAULT,
    states: bool | None = None,
    kind: ConstrainedMotion | TreeMotion | None = None,
    events: Sequence[Event] = (),
) -> Ensemble:
    """Motions over a ``span`` [s] from M starts: q'' = g^-1 (Q - Gamma q' q'); with constraints g* v' + bias = forces.

    ``q`` [rad, m], ``qd`` [rad/s, m/s; 0]: (n,) for all or (M, n), or by name; ``parameters`` [SI] and ``inputs`` [N m,
    N]: by name a number or (M,), inputs also an expression in coordinates, velocities, parameters and t. ``columns``:
    numbers of each motion at the times of ``grid``; ``states``: whether q and qd are in the result (by default where
    there are no columns). ``integrator``: an explicit method, DOP853, RK45 or RK23, its tolerances and drift limit.
    ``kind``: velocity constraints (default: those of the tree, and all closures, onto which positions are moved first),
    with ``v`` (p,) or (M, p) or by name in place of ``qd``, in quasi-velocities that describe the first member; or
    TreeMotion with contacts. With these or ``events`` members move one by one, as by ``simulate``: see ``happened``.
    Each has its own steps, the same bits whatever others there are. Raises InvalidInput (``/q``, ...), MissingValue.

    >>> from substructures import couple, derive
    >>> tree = {"name": "c", "gravity": [0, 0, -9.81], "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
    >>> model = couple(tree, {"p": derive("simple-pendulum")})
    >>> top = {"angle": MotionColumn(expression="p.q1", take="largest")}
    >>> simulate_ensemble(model, [[0.1], [0.2], [0.3]], (0, 2), columns=top)
    Ensemble of 3: 3 right, 0 failed; columns: angle
    """
    sources, events = Sources(model) if isinstance(model, Model) else model, values_of(events, "events", Event)
    _require_explicit(integrator)
    times = OutputTimes(span, grid)
    members = read_members(sources.model, q, qd, parameters, inputs, times.span, kind)
    keeps = not columns if states is None else states
    run = _Run(members, times, integrator, MotionColumns.read(sources, columns), keeps)
    return run.one_by_one(kind, events).run() if _acts(sources.model, kind, events) else run.run()


def _require_explicit(integrator: Integrator) -> None:
    """Raises InvalidArgument (``/method``)."""
    if integrator.method not in METHODS:
        message = f"members are integrated by {', '.join(METHODS)}; for stiff equations simulate them one by one"
        raise InvalidArgument.at("/method", "not-supported", message)


def _acts(model: Model, kind: ConstrainedMotion | TreeMotion | None, events: Sequence[Event]) -> bool:
    """Whether something happens on the way that lanes do not follow."""
    return bool(events or model.contacts or (isinstance(kind, TreeMotion) and kind != TreeMotion()))


def _grid(times: OutputTimes) -> Array:
    """The times of results, with the start before them."""
    grid, start = np.asarray(times.grid(), dtype=np.float64), times.span[0]
    return grid if len(grid) and grid[0] == start else np.concatenate([[start], grid])


@dataclass
class _Run:
    """An ensemble part by part, so that memory holds the states of one part and the columns of all."""

    members: Members
    times: OutputTimes
    integrator: Integrator
    columns: MotionColumns
    keeps: bool
    parts: list[dict[str, Array]] = field(default_factory=list)
    worst: dict[str, list[Any]] = field(default_factory=dict)
    failures: list[Failure] = field(default_factory=list)
    failed: int = 0
    steps: int = 0
    evaluations: int = 0

    def one_by_one(self, kind: ConstrainedMotion | TreeMotion | None, events: Sequence[Event]) -> OneByOne:
        """The same members, each as it moves alone."""
        tree = kind if isinstance(kind, TreeMotion) else TreeMotion()
        grid = _grid(self.times)
        return OneByOne(self.members, self.times, grid, self.integrator, self.columns, self.keeps, tree, events)

    def run(self) -> Ensemble:
        """All members, or those up to where whoever watches the progress says that it is enough."""
        members, settings, grid = self.members, self._settings(), _grid(self.times)
        # motions go on to the end, which results may not be wanted at
        times = np.unique([*grid, self.times.span[1]])
        integrals = self._integrals()
        size = max(settings.lanes, STATES // len(times))
        is_cancelled = False
        for begin in range(0, members.count, size):
            chosen = slice(begin, min(begin + size, members.count))
            start = members.start[chosen]
            lanes = min(settings.lanes, len(start))
            rates = KernelRates(members, lanes, self.integrator.folder, self.columns.integrands, begin)
            start = np.concatenate([start, np.zeros((len(start), rates.size - rates.held))], axis=1)
            told = self._told(begin)
            found = march(rates, start, times, settings, told)
            self._note(begin, found)
            self.parts.append(self._part(chosen, times, len(grid), found.x, rates, integrals))
            is_cut = bool((found.endings == CUT).any())
            if is_cut or not told(len(start)):
                is_cancelled = is_cut or chosen.stop < members.count
                break
        return self._result(grid, is_cancelled)

    def _settings(self) -> LaneSettings:
        how = self.integrator
        tolerances = how.relative_tolerance, how.absolute_tolerance
        return LaneSettings(str(how.method), *tolerances, how.max_step or np.inf, how.max_steps)

    def _told(self, begin: int) -> Callable[[int], bool]:
        progress, count = self.integrator.progress, self.members.count
        return lambda done: progress is None or progress((begin + done) / count) is not False

    def _integrals(self) -> FirstIntegrals | None:
        """None with ball joints, of which energy and norms are known."""
        if self.members.model.balls:
            return None
        model, zero = self.members.model, self.members.zero
        given = {*self.members.conditions.formulas, *self.members.varied, *self.members.constants}
        acting = [name for name in model.input_names if name in given and name not in zero]
        return first_integrals(model, acting, zero & set(model.parameters))

    def _note(self, begin: int, found: LaneMotions) -> None:
        self.steps += int(found.steps.sum())
        self.evaluations += found.evaluations
        lost = np.flatnonzero(~np.isin(found.endings, (FINISHED, CUT)))
        self.failed += len(lost)
        for k in lost[: TOLD - len(self.failures)].tolist():
            self.failures.append(Failure(begin + k, float(found.reached[k]), self._why(begin + k, found, k)))

    def _why(self, member: int, found: LaneMotions, k: int) -> str:
        if found.endings[k] != TOO_SMALL:
            return f"more than {self.integrator.max_steps:,} steps are needed"
        is_start = found.reached[k] == self.times.span[0]
        is_tolerance = not self.integrator.absolute_tolerance and not self.members.start[member].all()
        return f"{NO_ERROR}: give one, or start elsewhere" if is_start and is_tolerance else STEPS_TOO_SMALL

    def _part(
        self, chosen: slice, t: Array, wanted: int, x: Array, rates: KernelRates, integrals: FirstIntegrals | None
    ) -> dict[str, Array]:
        """Columns, verdicts and states of a part of the members, of which so many times are wanted."""
        n = rates.n
        values, states = along(self.members, chosen, t, x)
        work = x[..., rates.held] if rates.has_power else np.zeros(x.shape[:2])
        motions = MotionStates(np.tile(t, (len(x), 1)), states[..., :n], states[..., n:], values, work)
        integrals_to_end = x[:, -1, rates.size - rates.integrals :]
        equations, held = self.members.equations, list[Condition]()
        second = None
        if equations is not None:
            second = partial(accelerations, equations, values, x[..., : rates.held])
            held = kept_gaps(equations, values, states)
        model = self.members.model
        if model.balls:
            held = list(conditions_in_rates(model, motions, not self.members.conditions.varied_potential()))
            states = np.concatenate([with_lengths(model, states[..., :n]), states[..., n:]], axis=-1)
        columns = self.columns.of(values, states, integrals_to_end, second, wanted)
        found = {f"columns.{name}": v for name, v in columns.items()}
        found["violation"] = self._judged(motions, integrals, held)
        if self.keeps:
            found |= {"q": states[:, :wanted, :n], "qd": states[:, :wanted, n:]}
        return found

    def _judged(self, motions: MotionStates, integrals: FirstIntegrals | None, held: Sequence[Condition]) -> Array:
        """The largest violation of each member in units of what is allowed."""
        model, limit = self.members.model, self.integrator.drift_limit
        largest = np.full(len(motions.t), np.nan)
        with np.errstate(invalid="ignore", divide="ignore"):
            own = () if integrals is None else conditions(AlongMotion.of(model, integrals, motions))
            for each in chain(own, held):
                # whether energy has to fall is not seen from some times of a motion; its balance is kept at all of them
                if not isinstance(each, Condition) or each.about[1] == "falling":
                    continue
                size = np.abs(each.violation).max(axis=-1, initial=0)
                allowed = limit * each.scale + each.noise
                share = np.where(size == 0, 0.0, size / allowed)
                share = np.where(each.applies, share, np.nan)
                self._note_check(each, size, share)
                largest = np.fmax(largest, share)
        return np.where(np.isnan(motions.q).any(axis=(1, 2)), np.nan, largest)

    def _note_check(self, each: Condition, size: Array, share: Array) -> None:
        name, rule, reason, unit = each.about
        told = self.worst.setdefault(f"{name} {rule}", [name, rule, reason, unit, 0.0, 0.0, 0])
        told[4] = max(told[4], float(np.nanmax(size, initial=0.0)))
        relative = np.where(each.scale > 0, size / np.where(each.scale > 0, each.scale, 1.0), 0.0)
        told[5] = max(told[5], float(np.nanmax(relative, initial=0.0)))
        told[6] += int((share > 1).sum())

    def _result(self, grid: Array, is_cancelled: bool) -> Ensemble:
        whole = {name: np.concatenate([part[name] for part in self.parts]) for name in self.parts[0]}
        columns = {name: whole[f"columns.{name}"] for name in self.columns.columns}
        limit = self.integrator.drift_limit
        names = ("name", "rule", "reason", "unit", "worst", "relative", "violated")
        checks = tuple({**dict(zip(names, told, strict=True)), "limit": limit} for told in self.worst.values())
        return Ensemble(
            self.members.model.coordinates,
            len(whole["violation"]),
            grid,
            columns,
            {name: statistics(column) for name, column in columns.items()},
            whole["violation"],
            checks,
            tuple(self.failures),
            self.failed,
            self.steps,
            self.evaluations,
            whole.get("q"),
            whole.get("qd"),
            is_cancelled,
            positions=self.members.model.positions if self.members.model.balls else (),
        )


__all__ = ["Ensemble", "Failure", "MotionColumn", "simulate_ensemble"]
