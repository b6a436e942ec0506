"""Simulation of a model: a start and a span in, a judged trajectory out; trees, closed loops, rolling bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, get_args

from substructures.analysis.closed.simulation import ClosedProblem, simulate_closed
from substructures.analysis.equations.geodesics import without_forces
from substructures.analysis.equations.nonholonomic.velocity_constraints import (
    Closed,
    KnifeEdge,
    Linear,
    Rolling,
    constraints_of,
)
from substructures.analysis.motion.friction.transmitted import with_reactions
from substructures.analysis.motion.integrators.fixed_step import FixedStep
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.load_powers import with_powers
from substructures.analysis.motion.problems.contacts import Contact, contacts_of
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.kinds import (
    ClosedMotion,
    ConstrainedMotion,
    Geodesic,
    MotionKind,
    TreeMotion,
)
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.outputs import Outputs
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.problems.signals import Signal, Table
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.motion.rolling import RollingProblem, simulate_rolling
from substructures.analysis.motion.simulation import simulate_tree
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.errors import Fault, InvalidArgument
from substructures.tree.document import require_undriven, require_unignored
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

__all__ = [
    "Closed",
    "ClosedMotion",
    "ConstrainedMotion",
    "Contact",
    "Event",
    "FixedStep",
    "Geodesic",
    "Integrator",
    "KnifeEdge",
    "Linear",
    "Outputs",
    "Rolling",
    "Table",
    "TreeMotion",
    "simulate",
]

UNPLACED = (
    "reactions are those of the tree, and so of its own 'velocity_constraints' alone: make the constraints part of the "
    "tree, or leave 'reactions' out"
)
DEFAULT, PLAIN = Integrator(), Outputs()


def simulate(
    model: Model,
    q: StateVector | None,
    span: tuple[float, float],
    *,
    qd: StateVector | None = None,
    inputs: Mapping[str, Signal] | None = None,
    parameters: Mapping[str, float] | None = None,
    kind: MotionKind | None = None,
    integrator: Integrator = DEFAULT,
    outputs: Outputs = PLAIN,
) -> Trajectory:
    """The motion of a model from a start over a ``span`` (start, end) [s], with its judges.

    State: ``q`` [rad, m] and ``qd`` [rad/s, m/s; 0 by default], (n,) in the order of the coordinates or by name.
    ``inputs`` [N m, N] by name: a number, an expression in coordinates, velocities, parameters and t, or a Table;
    ``parameters``: in place of their defaults. ``kind``: TreeMotion (default; with closures ClosedMotion, with
    velocity constraints of the tree ConstrainedMotion), ClosedMotion, ConstrainedMotion or Geodesic, which say how
    joints rub, what touches, how loops close, what rolls;
    ``integrator``: its method and accuracy, real time, progress; ``outputs``: when results are wanted, and what of
    them.

    The series of the result: see simulate_tree, simulate_closed, simulate_rolling. What goes wrong on the way is a
    trajectory with status ``failed``, advice, and the motion up to there. Raises InvalidInput (pointers start with
    names of arguments, or of their fields), MissingValue, and TooLarge.

    >>> from substructures import Event, Integrator, Outputs, couple, derive
    >>> tree = {"name": "clock", "gravity": [0, 0, "-9.81"]}
    >>> tree["instances"] = [{"name": "p", "substructure": "simple-pendulum"}]
    >>> model = couple(tree, {"p": derive("simple-pendulum")})
    >>> bottom = Event("bottom", "p.q1", direction="falling")
    >>> motion = simulate(model, [0.5], (0, 10), integrator=Integrator("RK45"), outputs=Outputs(events=[bottom]))
    >>> round(float(motion.t[-1]), 3), motion.is_right
    (0.509, True)
    """
    kind = kind or _usual(model)
    _require_types(
        kind=(kind, get_args(MotionKind)), integrator=(integrator, (Integrator,)), outputs=(outputs, (Outputs,))
    )
    _require_kind(model, kind)
    if isinstance(kind, Geodesic):
        _refuse("no forces", inputs=inputs, reactions=outputs.reactions, powers=outputs.powers)
        model = without_forces(model)
    if isinstance(kind, TreeMotion):
        kind = replace(kind, contacts=contacts_of(model, kind.contacts))
    if isinstance(kind, TreeMotion) and kind.contacts:
        require_unignored(model.ignored)
        _refuse("contacts", reactions=outputs.reactions, powers=outputs.powers)
    given: dict[str, Any] = {
        "model": model,
        "start": Start(q, qd, parameters or {}, inputs or {}),
        "times": OutputTimes(span, outputs),
        "integrator": integrator,
        "events": outputs.events,
        "series": outputs.series,
    }
    if not isinstance(kind, (TreeMotion, Geodesic)):
        _require_watching(outputs.events)
    # B q' = 0: quasi-velocities; phi(q, t) = 0: multipliers; else q'' = g^-1 (Q - Gamma q' q')
    if isinstance(kind, ConstrainedMotion):
        _refuse("velocity constraints", powers=outputs.powers)
        if outputs.reactions is not None and not model.velocity_constraints:
            raise InvalidArgument.at("/reactions", "not-supported", UNPLACED)
        require_undriven(model.driven if outputs.reactions is not None else (), "leave 'reactions' out")
        motion = simulate_rolling(RollingProblem(**given, kind=kind))
    elif isinstance(kind, ClosedMotion):
        motion = simulate_closed(ClosedProblem(**given, kind=kind))
    else:
        motion = simulate_tree(TreeProblem(**given, kind=kind if isinstance(kind, TreeMotion) else TreeMotion()))
    found = with_limits(model, parameters, motion)
    if outputs.reactions is not None:
        found = with_reactions(model, outputs.reactions, found, given["start"])
    if outputs.powers is not None:
        require_undriven(model.driven if model.closures else (), "leave 'powers' out")
        moved = tuple(kind.prescribed) if isinstance(kind, ClosedMotion) else ()
        found = with_powers(model, outputs.powers, found, given["start"], moved, integrator.drift_limit)
    return found


def _usual(model: Model) -> MotionKind:
    """The kind of motion where none is given."""
    if model.velocity_constraints:
        return ConstrainedMotion(constraints_of(model))
    return ClosedMotion() if model.closures else TreeMotion()


def _require_types(**given: tuple[Any, tuple[type, ...]]) -> None:
    """Raises InvalidArgument for arguments that are no values of their classes, as a class itself."""
    for name, (value, classes) in given.items():
        if not isinstance(value, classes):
            wanted = " or ".join(f"{each.__name__}(...)" for each in classes)
            raise InvalidArgument.at(f"/{name}", "wrong-type", f"{wanted} is needed, found {repr(value)[:80]}")


def _require_kind(model: Model, kind: MotionKind) -> None:
    """Raises InvalidInput for a kind of motion that the model cannot have."""
    found = type(kind).__name__
    require_untied(model, found)
    if isinstance(kind, ConstrainedMotion):
        require_unignored(model.ignored)
        if model.driven and kind.form != "voronets":
            message = "with given motions ('driven') equations are those of Voronets: leave 'form' out"
            raise InvalidArgument.at("/form", "not-supported", message)
    if isinstance(kind, Geodesic):
        require_undriven(model.driven, f"take the tree without 'driven' for a {found}")
        require_unignored(model.ignored)
    if isinstance(kind, ClosedMotion):
        if not model.closures and not kind.prescribed:
            message = f"a tree without closures and 'prescribed' coordinates moves as TreeMotion, found {found}"
            raise InvalidArgument.at("/kind", "not-supported", message)
    elif model.closures and not isinstance(kind, ConstrainedMotion):
        message = f"a model with closures moves as ClosedMotion or ConstrainedMotion, found {found}"
        raise InvalidArgument.at("/kind", "not-supported", message)


def _require_watching(events: Sequence[Event]) -> None:
    """Raises InvalidArgument for events that change a state which has to keep closures or constraints."""
    message = "events act on trees without closures and velocity constraints: leave 'reset' out"
    faults = [Fault(f"/events/{i}/reset", "not-supported", message) for i, event in enumerate(events) if event.reset]
    if faults:
        raise InvalidArgument(faults)


def _refuse(kind: str, **arguments: Any) -> None:
    """Raises InvalidArgument for arguments that mean nothing to this kind of motion."""
    faults = [
        Fault(f"/{name}", "not-supported", f"'{name}' means nothing to a motion with {kind}: leave it out")
        for name, value in arguments.items()
        if value
    ]
    if faults:
        raise InvalidArgument(faults)
