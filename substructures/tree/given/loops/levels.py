"""Which instances of a tree take the reduced level."""

from __future__ import annotations

from collections.abc import Mapping

from substructures.loads.scope import Scope
from substructures.part.part import Part
from substructures.tree.document import TreeSpec
from substructures.tree.given.loops.reduction import dependent


def reduced_instances(spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> frozenset[str]:
    """The instances whose parts name independent coordinates, with formulas of the others. Notes in the scope those
    that have none; raises InvalidDocument (``not-reduced``) where it is asked for.
    """
    found = set[str]()
    for i, instance in enumerate(spec.instances):
        definition = parts[instance.name].definition
        if instance.level == "full" or not (definition.independent or instance.level):
            continue
        why = dependent(parts[instance.name]) if definition.independent else "it names no independent coordinates"
        if not isinstance(why, str):
            found.add(instance.name)
        elif instance.level:
            message = f"'{definition.name}' has no reduced level: {why}; take 'full'"
            scope.fault(f"/instances/{i}/level", "not-reduced", message)
        else:
            message = f"'{instance.name}' has all coordinates of its loops: {why}"
            scope.notices.append({"pointer": f"/instances/{i}", "code": "full-level", "message": message})
    scope.finish()
    return frozenset(found)
