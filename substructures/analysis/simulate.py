"""Simulation of a model: a start and a span in, a judged trajectory out; trees, closed loops, rolling bodies.

::

    from substructures.analysis.simulate import Event, Table, simulate

    top = Event("top", "p.q1'", direction="falling")
    motion = simulate(model, [0.5], (0, 10), inputs={"tau.p.q1": Table([0, 5, 10], [0, 1, 0])}, events=[top])
    motion.t, motion.q, motion.is_right
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Sized
from pathlib import Path
from typing import Any, Literal

from substructures.analysis.arguments import NumberOrExpression, Numbers
from substructures.analysis.closed.simulation import ClosedProblem, simulate_closed
from substructures.analysis.equations.velocity_constraints import Closed, Constraint, KnifeEdge, Linear, Rolling
from substructures.analysis.motion.events import Event
from substructures.analysis.motion.fixed_step import FixedStep
from substructures.analysis.motion.geodesics import without_forces
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.load_powers import with_powers
from substructures.analysis.motion.output_times import OutputTimes
from substructures.analysis.motion.problem import IntegratorChoice, Start, StateVector
from substructures.analysis.motion.progress import ProgressReport
from substructures.analysis.motion.rolling import RollingProblem, simulate_rolling
from substructures.analysis.motion.signals import Signal, Table
from substructures.analysis.motion.simulation import FrictionMode, TreeProblem, simulate_tree
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.transmitted import with_reactions
from substructures.errors import Fault, InvalidArgument
from substructures.quantities.powers import PowerModel
from substructures.quantities.reactions import ReactionModel
from substructures.tree.model import Model

__all__ = ["Closed", "Event", "FixedStep", "KnifeEdge", "Linear", "Rolling", "Table", "simulate"]

UNPLACED = (
    "reactions are not known with velocity constraints: these act on coordinates, by B^T lambda, and a linear one does "
    "not say where on which body; leave 'reactions' out"
)


def simulate(
    model: Model,
    q: StateVector | None,
    span: tuple[float, float],
    *,
    qd: StateVector | None = None,
    v: StateVector | None = None,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, Signal] | None = None,
    times: Numbers | None = None,
    step: float | None = None,
    count: int | None = None,
    events: Sequence[Event] = (),
    series: Mapping[str, NumberOrExpression] | None = None,
    method: str = "DOP853",
    fixed_step: FixedStep | None = None,
    friction: FrictionMode = "regularised",
    prescribed: Mapping[str, Signal] | None = None,
    fixed: Sequence[str] = (),
    reduction: Literal["projection", "partitioning"] = "projection",
    constraints: Sequence[Constraint] = (),
    velocities: Mapping[str, str] | None = None,
    independent: Sequence[str] | None = None,
    form: Literal["voronets", "boltzmann-hamel"] = "voronets",
    relative_tolerance: float = 1e-10,
    absolute_tolerance: float = 1e-12,
    max_step: float | None = None,
    max_steps: int = 1_000_000,
    drift_limit: float = 1e-7,
    reactions: ReactionModel | None = None,
    bearings: ReactionModel | None = None,
    powers: PowerModel | None = None,
    geodesic: bool = False,
    progress: ProgressReport | None = None,
    folder: Path | None = None,
) -> Trajectory:
    """The motion of a model from a start over a span of time, with its judges.

    State: ``q`` [rad, m] and ``qd`` [rad/s, m/s; 0 by default], (n,) in the order of the coordinates or by name.
    ``parameters``: in place of their defaults. ``inputs`` [N m, N] and ``series`` (quantities to be followed) by name:
    a number or an expression in coordinates, velocities, parameters and t (``"-2*x.q1'"``); inputs also a Table.
    ``span``: (start, end) [s]; at most one of ``times`` (K,) [s], ``step`` [s] and ``count`` says where results are
    wanted (default: 101 of equal distance). ``events``: crossings that are noted, or stop the motion.

    ``method``: DOP853, RK45, RK23 for every model; Radau, BDF, LSODA (stiff equations) without closures; Taylor (with
    the package heyoka) for trees, or a ``fixed_step`` in real time. Tolerances hold for a step; ``max_step`` [s];
    ``max_steps`` at most. ``drift_limit``: relative drift of first integrals above which the result is not right.

    Closed loops: ``prescribed`` coordinates move as given [rad, m]; ``fixed`` ones keep their values while the loops
    are closed at the start; ``reduction``: the state is projected onto the closures, or independent coordinates are
    integrated. ``constraints`` on the velocities (Linear, KnifeEdge, Rolling, Closed): ``v`` are quasi-velocities at
    the start, (p,) or by name, in place of ``qd``; ``velocities``, ``independent``: see quasi_velocity_equations;
    ``form`` of the equations.

    ``friction`` of joints that have some: by the smooth law of the formulas, or ``exact``, set-valued at rest, with
    joints that stick; then the series ``friction`` and ``qdd`` (K, n), and the check ``friction`` (not with
    ``constraints``; that of ``prescribed`` coordinates stays smooth); or ``loaded``, with what the reactions of joints
    add (``bearings``: all reactions of the tree): these series, and the check ``friction-load``, of trees alone.

    ``geodesic``: of a tree without any force, q''^a + Gamma^a_bc q'^b q'^c = 0.

    ``reactions``: those that are wanted at the results, as further series (not with ``constraints``). ``powers``: those
    of all loads and joints as a further series, and the check ``power`` that they add up to dT/dt (not with
    ``constraints``, nor of a geodesic).

    ``progress`` is told the finished share of the span and stops by False; ``folder``: where compiled kernels are kept.
    The series of the result: see simulate_tree, simulate_closed, simulate_rolling. What goes wrong on the way is a
    trajectory with status ``failed``, advice, and the motion up to there. Raises InvalidInput (pointers start with
    names of arguments), MissingValue, and TooLarge.
    """
    exact = friction if friction != "regularised" else None
    if geodesic:
        closed_by = [*model.closures, *(prescribed or {})]
        others: dict[str, Any] = {"inputs": inputs, "constraints": constraints, "prescribed": closed_by}
        others |= {"reactions": reactions, "powers": powers}
        _refuse("no forces", friction=exact, **others)
        model = without_forces(model)
    given: dict[str, Any] = {
        "model": model,
        "start": Start(q, qd, parameters or {}, inputs or {}),
        "times": OutputTimes(span, times, step, count),
        "integrator": IntegratorChoice(method, relative_tolerance, absolute_tolerance, max_step, max_steps),
        "events": tuple(events),
        "series": series or {},
        "drift_limit": drift_limit,
    }
    rolling: dict[str, Any] = {"v": v, "velocities": velocities, "independent": independent}
    closed: dict[str, Any] = {"prescribed": prescribed, "fixed": fixed}
    # B q' = 0: quasi-velocities; phi(q, t) = 0: multipliers; else q'' = g^-1 (Q - Gamma q' q')
    if constraints:
        _refuse("velocity constraints", fixed_step=fixed_step, friction=exact, powers=powers, **closed)
        if reactions is not None:
            raise InvalidArgument.at("/reactions", "not-supported", UNPLACED)
        rolled = RollingProblem(**given, constraints=constraints, form=form, **rolling)
        return with_limits(model, parameters, simulate_rolling(rolled, progress, folder))
    if model.closures or prescribed:
        loaded = friction if friction == "loaded" else None
        _refuse("closures or prescribed coordinates", fixed_step=fixed_step, friction=loaded, **rolling)
        closed |= {"prescribed": prescribed or {}, "reduction": reduction, "friction": friction}
        loops = ClosedProblem(**given, **closed)
        motion = simulate_closed(loops, progress, folder)
    else:
        _refuse("neither closures nor velocity constraints", **rolling, **closed)
        motion = simulate_tree(
            TreeProblem(**given, fixed_step=fixed_step, friction=friction, bearings=bearings), progress, folder
        )
    found = with_limits(model, parameters, motion)
    if reactions is not None:
        found = with_reactions(model, reactions, found, given["start"])
    if powers is not None:
        found = with_powers(model, powers, found, given["start"], tuple(prescribed or ()), drift_limit)
    return found


def _refuse(kind: str, **arguments: Any) -> None:
    """Raises InvalidArgument for arguments that mean nothing to this kind of motion."""
    faults = [
        Fault(f"/{name}", "not-supported", f"'{name}' means nothing to a motion with {kind}: leave it out")
        for name, value in arguments.items()
        if value is not None and not (isinstance(value, Sized) and len(value) == 0)
    ]
    if faults:
        raise InvalidArgument(faults)
