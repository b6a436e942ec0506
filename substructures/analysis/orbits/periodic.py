"""Periodic orbits: a state that the motion comes back to, by Newton's method on the return map (shooting).

F(x, T) = x(T; x) - x = 0 with F_x = M - 1, F_T = f, M the monodromy matrix, whose eigenvalues are the multipliers
(R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. 2010, chapters 7.1 to 7.6). Steps are the shortest
that solve the linear equations, orthogonal to the motion where its phase is free.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from substructures.analysis.arguments import reals, whole
from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.families import orbit_family
from substructures.analysis.orbits.orbit import Family, Orbit, Section, Shooting, stability
from substructures.analysis.orbits.search import Search
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, among
from substructures.quantities.numbers.states import read_states
from substructures.tree.model import Model

DEFAULT = Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-13)


def periodic_orbits(
    model: Model,
    q: StateVector | None,
    shooting: Shooting,
    *,
    qd: StateVector | None = None,
    inputs: Mapping[str, Signal] | None = None,
    parameters: Mapping[str, float] | None = None,
    vary: str | None = None,
    values: Sequence[float] = (),
    between: tuple[float, float] | None = None,
    steps: int = 50,
    events: Sequence[Event] = (),
    integrator: Integrator = DEFAULT,
) -> Family:
    """Orbits of a tree near ``q``, ``qd``: one, or one for each of the ``values`` of ``vary``, a
    parameter or a component of the state that is held there; or those that are met from the first to the last value of
    a parameter ``between`` two, through folds, in ``steps`` of arclength at least, with their bifurcations.

    ``inputs``: numbers, tables or expressions in t alone; then the period is given. ``events``: those that act, by
    their resets; a start at which one of them happens is moved along the motion. Raises InvalidInput (pointers start
    with names of arguments) and MissingValue.
    """
    given = dict(parameters or {})
    start = Start(q, qd, given, inputs or {})
    times = OutputTimes((0.0, shooting.longest(shooting.period_at(model, given))))
    problem = TreeProblem(model=model, start=start, times=times, integrator=integrator, events=events)
    names = state_names(model)
    _check(model, shooting, vary, values if between is None else between, names)
    if vary is not None and between is not None:
        whole(steps, "steps", 2, 1000)
        return orbit_family(problem, shooting, vary, _range(model, vary, values, between), steps)
    if vary is None:
        return Family(model.coordinates, None, (Search(problem, shooting).run(),))
    return Family(model.coordinates, vary, tuple(_family(problem, shooting, vary, values)))


def _range(model: Model, vary: str, values: Sequence[float], between: tuple[float, float]) -> tuple[float, float]:
    ends = reals(between, "/between")
    if len(ends) != 2:
        raise InvalidArgument.at("/between", "wrong-length", "two values are needed: the first and the last")
    first, last = ends
    if len(values):
        message = "'values' says which orbits, 'between' from where to where: give one of them"
        raise InvalidArgument.at("/between", "contradiction", message)
    if first == last:
        raise InvalidArgument.at("/between", "empty-span", "the ends of the range are the same")
    if vary not in model.parameters:
        message = f"families are followed over parameters{among(vary, list(model.parameters))}; a state takes 'values'"
        raise InvalidArgument.at("/vary", "unknown-parameter", message)
    return first, last


def _family(problem: TreeProblem, shooting: Shooting, vary: str, values: Sequence[float]) -> Iterator[Orbit]:
    """The orbits for all values, each from the one before."""
    names, start = state_names(problem.model), problem.start
    for value in values:
        if vary in names:
            x = _with(problem.model, start, names.index(vary), value)
            own = replace(shooting, hold=tuple(dict.fromkeys((*shooting.hold, vary))))
        else:
            x, own = replace(start, parameters={**start.parameters, vary: value}), shooting
        orbit = replace(Search(replace(problem, start=x), own).run(), value=value)
        if orbit.status == "finished":
            start = replace(start, q=orbit.q, qd=orbit.qd)
            shooting = shooting if isinstance(shooting.period, str) else replace(shooting, period=orbit.period)
        yield orbit


def _check(model: Model, shooting: Shooting, vary: str | None, values: Sequence[float], names: Sequence[str]) -> None:
    faults = [
        Fault(f"/hold/{k}", "unknown-name", f"there is no coordinate or velocity '{name[:80]}'{among(name, names)}")
        for k, name in enumerate(shooting.hold)
        if name not in names
    ]
    kinds = dict(zip(model.coordinates, model.joints, strict=True))
    for name in shooting.turns or {}:
        if kinds.get(name) != "R":
            message = f"'{name[:80]}' is no coordinate of a revolute joint"
            faults.append(Fault(f"/turns/{escape(name)}", "unknown-coordinate", message))
    if vary is not None and vary not in (*names, *model.parameters):
        message = (
            f"there is no parameter, coordinate or velocity '{vary[:80]}'{among(vary, [*model.parameters, *names])}"
        )
        faults.append(Fault("/vary", "unknown-name", message))
    if (vary is None) != (len(values) == 0):
        message = "'vary' says what, and 'values' which ones: give both, or none"
        faults.append(Fault("/values" if vary else "/vary", "missing", message))
    if faults:
        raise InvalidArgument(faults)


def _with(model: Model, start: Start, place: int, value: float) -> Start:
    m, states = len(model.positions), read_states(model, {"q": start.q, "qd": start.qd}, 1)
    q, qd = states.q[0].copy(), states.qd[0].copy()
    (q if place < m else qd)[place if place < m else place - m] = value
    return replace(start, q=q, qd=qd)


__all__ = ["Family", "Orbit", "Section", "Shooting", "periodic_orbits", "stability"]
