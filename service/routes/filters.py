"""Query parameters that searches of parts and of trees have in common."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Query
from pydantic import StringConstraints

from service.queries.searching.search import SORTS
from substructures.documents.patterns import NAME, PATTERNS

PortName = Annotated[str, StringConstraints(pattern=NAME)]
JOINTS = "^[RPrp]*$"
PATTERNS[JOINTS] = lambda _: "joints are R (revolute) and P (prismatic) in order, as in RRP"
SORTED = ", ".join(SORTS)


async def _narrow(
    dof_min: Annotated[int | None, Query(ge=0, le=10**6)] = None,
    dof_max: Annotated[int | None, Query(ge=0, le=10**6)] = None,
    joints: Annotated[str | None, Query(pattern=JOINTS, max_length=1000)] = None,
    mass_min: Annotated[float | None, Query(ge=0, allow_inf_nan=False, description="kg, of all bodies")] = None,
    mass_max: Annotated[float | None, Query(ge=0, allow_inf_nan=False, description="kg, of all bodies")] = None,
    owner: Annotated[str | None, Query(max_length=64)] = None,
    sort: Annotated[str, Query(description=f"one of {SORTED}; default: relevance with q, name without")] = "",
) -> dict[str, Any]:
    """Fields of a search by their names."""
    masses = {"mass_min": mass_min, "mass_max": mass_max}
    joints = joints and joints.upper()
    return {"dof_min": dof_min, "dof_max": dof_max, "joints": joints, **masses, "owner": owner, "sort": sort}


NarrowOf = Annotated[dict[str, Any], Depends(_narrow)]
