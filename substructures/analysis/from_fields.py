"""Arguments of motions from flat documents: the fields of a request over HTTP, of an item of a job, of a file.

A field has the name that it has in the class that takes it (``method``: of Integrator, ``series``: of Outputs, ...);
only ``fixed_step`` is a method. What is no field of them, as ``q``, stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sized
from dataclasses import fields
from typing import Any

from substructures.analysis.equations.nonholonomic.velocity_constraints import closing, constraints_of
from substructures.analysis.motion.problems.kinds import (
    ClosedMotion,
    ConstrainedMotion,
    Geodesic,
    MotionKind,
    TreeMotion,
)
from substructures.analysis.motion.problems.outputs import Outputs, SensitivityOutputs
from substructures.analysis.motion.problems.problem import Integrator
from substructures.documents.grouped import take
from substructures.errors import Fault, InvalidArgument
from substructures.tree.model import Model

#: what a kind of motion is called beside a field that it does not have
SAID: dict[type[MotionKind], str] = {
    Geodesic: "no forces",
    ConstrainedMotion: "velocity constraints",
    ClosedMotion: "closures or prescribed coordinates",
    TreeMotion: "neither closures nor velocity constraints",
}

#: what every motion has where nothing else is said
USUAL = ("friction", "regularised")


def motion_arguments(model: Model, /, **given: Any) -> dict[str, Any]:
    """Arguments of simulate. Raises InvalidArgument for a field that means nothing to the kind of motion."""
    rest = _constrained(model, given)
    kind = _kind(model, rest)
    fixed = rest.pop("fixed_step", None)
    if fixed is not None and kind in (ConstrainedMotion, ClosedMotion):
        _refuse(kind, {"fixed_step": fixed})
    elif fixed is not None:
        rest |= {"method": fixed, "max_step": None}
    of_others = {field.name for other in SAID for field in fields(other)} - {field.name for field in fields(kind)}
    _refuse(kind, {name: rest.pop(name) for name in of_others & set(rest)})
    found = {"kind": take(kind, rest), "integrator": take(Integrator, rest), "outputs": take(Outputs, rest)}
    return rest | found


def sensitivity_arguments(model: Model | None = None, /, **given: Any) -> dict[str, Any]:
    """Arguments of sensitivities. Raises InvalidArgument for fields of constraints without any; ``model``: see
    :func:`reduced_kind`.
    """
    rest = dict(given)
    if model is not None:
        rest["kind"] = reduced_kind(model, rest)
    return {"integrator": take(Integrator, rest), "outputs": take(SensitivityOutputs, rest), **rest}


def linearisation_arguments(model: Model, /, **given: Any) -> dict[str, Any]:
    """Arguments of linearise. Raises InvalidArgument for fields of velocity constraints without any."""
    rest = _constrained(model, given)
    if rest.get("constraints"):
        return {"kind": take(ConstrainedMotion, rest), **rest}
    of_constraints = {field.name for field in fields(ConstrainedMotion)} & set(rest)
    _refuse(TreeMotion, {name: rest.pop(name) for name in sorted(of_constraints)})
    return rest


def reduced_kind(model: Model, rest: dict[str, Any]) -> ConstrainedMotion | None:
    """The motion in quasi-velocities, whose fields are taken out of ``rest``: with velocity constraints that are given,
    those of the tree, or its closures alone; None without any.

    Raises InvalidArgument for other fields of constraints then.
    """
    constraints = constraints_of(model, rest.pop("constraints", None) or ()) or closing(model)
    if constraints:
        rest["constraints"] = constraints
        return take(ConstrainedMotion, rest)
    _refuse(TreeMotion, {f.name: rest.pop(f.name) for f in fields(ConstrainedMotion) if f.name in rest})
    return None


def _constrained(model: Model, given: Mapping[str, Any]) -> dict[str, Any]:
    """Fields with the velocity constraints of the tree."""
    found = constraints_of(model, given.get("constraints") or ())
    return {**given, "constraints": found} if found else dict(given)


def _kind(model: Model, given: dict[str, Any]) -> type[MotionKind]:
    if given.pop("geodesic", False):
        return Geodesic
    if given.get("constraints"):
        return ConstrainedMotion
    return ClosedMotion if model.closures or given.get("prescribed") else TreeMotion


def _refuse(kind: type[MotionKind], given: dict[str, Any]) -> None:
    """Raises InvalidArgument for fields of other kinds of motion, but where these say nothing."""
    faults = [
        Fault(f"/{name}", "not-supported", f"'{name}' means nothing to a motion with {SAID[kind]}: leave it out")
        for name, value in given.items()
        if not (value is None or (isinstance(value, Sized) and len(value) == 0) or (name, str(value)) == USUAL)
    ]
    if faults:
        raise InvalidArgument(faults)
