"""Arguments of functions as flat documents have them: the fields of typed arguments in place of these."""

from collections.abc import Callable
from dataclasses import MISSING, Field, fields
from inspect import Parameter, signature
from typing import Any

from substructures import (
    ClosedMotion,
    ConstrainedMotion,
    ControlProblem,
    Demands,
    Integrator,
    Outputs,
    SensitivityOutputs,
    TreeMotion,
    sensitivities,
)

TYPED: dict[str, tuple[type, ...]] = {
    "kind": (TreeMotion, ClosedMotion, ConstrainedMotion),
    "integrator": (Integrator,),
    "outputs": (Outputs,),
    "problem": (ControlProblem,),
    "demands": (Demands,),
}


def flat_arguments(function: Callable[..., Any]) -> dict[str, Any]:
    """Default by name; Parameter.empty where there is none."""
    found: dict[str, Any] = {}
    for name, parameter in signature(function).parameters.items():
        classes = TYPED.get(name, ()) if function is not sensitivities or name != "outputs" else (SensitivityOutputs,)
        if name == "outputs" and "Mapping" in str(parameter.annotation):  # of linearise: names and expressions
            classes = ()
        if name == "kind" and "MotionKind" not in str(parameter.annotation):  # of linearise: with velocity constraints
            classes = (ConstrainedMotion,)
        for each in classes:
            found |= {field.name: _default(field) for field in fields(each)}
        if not classes:
            found[name] = parameter.default
    return found


def _default(field: Field[Any]) -> Any:
    if field.default_factory is not MISSING:
        return field.default_factory()
    return Parameter.empty if field.default is MISSING else field.default
