"""Warnings about what a definition leaves out of what its source says, and about coordinates that move no mass."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.errors import among
from substructures.expr.graph import Graph
from substructures.expr.program import Program
from substructures.expr.units.unit_check import Notice
from substructures.loads.scope import Scope, no_names
from substructures.part.definition import Definition

_WEIGHTLESS = "no mass, moment of inertia or armature moves with '{}': forces do not determine its acceleration"


def require_relations(definition: Definition, coordinates: Sequence[str]) -> None:
    """Raise InvalidDocument for relations between coordinates that are not there, or with factors that vary."""
    scope = Scope(Graph())
    for i, each in enumerate(definition.left_out):
        if each.relation is None:
            continue
        for field in ("coordinate", "of"):
            name, pointer = getattr(each.relation, field), f"/left_out/{i}/relation/{field}"
            if name not in coordinates:
                scope.fault(pointer, "unknown-coordinate", f"there is no coordinate '{name}'{among(name, coordinates)}")
        for field in ("multiplier", "offset"):
            scope.read(getattr(each.relation, field), f"/left_out/{i}/relation/{field}", no_names)
    scope.finish()


def left_out_warnings(definition: Definition) -> list[Notice]:
    """A warning for each remark; pointers lead into the definition."""
    return [
        {"pointer": f"/left_out/{i}", "code": "left-out", "message": each.message}
        for i, each in enumerate(definition.left_out)
    ]


def weightless_warnings(program: Program, coordinates: Sequence[str]) -> list[Notice]:
    """A warning for each coordinate a with g_aa = 0 in all positions, where the metric is stored."""
    metric = program.outputs.get("metric")
    stored = None if metric is None else set(metric.index)
    return [
        {"pointer": "", "code": "weightless", "message": _WEIGHTLESS.format(name)}
        for a, name in enumerate(coordinates)
        if stored is not None and (a, a) not in stored
    ]
