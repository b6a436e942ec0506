"""Arguments of optimal control from flat documents (see substructures.analysis.from_fields)."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from substructures.analysis.control.demands import Demands
from substructures.analysis.control.problem import ControlProblem
from substructures.documents.grouped import take


def control_arguments(**given: Any) -> dict[str, Any]:
    """Arguments of cost_gradient and of optimal_control."""
    rest = dict(given)
    problem = take(ControlProblem, rest)
    demanded = {field.name for field in fields(Demands)} & set(rest)
    return {"problem": problem, **({"demands": take(Demands, rest)} if demanded else {}), **rest}
