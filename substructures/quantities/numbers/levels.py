"""What is said of numbers of the reduced level: ranges and limits that coordinates leave, and loops that are open or
singular.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.array import Array
from substructures.errors import listed
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.defaults import default_number, default_numbers
from substructures.tree.judge import Judge
from substructures.tree.model import Model


def ranges_left(model: Model, lowest: Array, highest: Array) -> list[dict[str, str]]:
    """A warning for each coordinate of a reduced instance that was between ``lowest`` and ``highest`` (n,) and left the
    range that its definition states.
    """
    found, own = [], {name: level for level in model.reduced for name in level["independent"]}
    for name, ends in model.reduction.ranges.items():
        if name not in own:
            continue
        a, (low, high) = model.positions.index(name), map(default_number, ends)
        gone = [x for x in (lowest[a], highest[a]) if not low <= x <= high]
        if gone:
            closures = listed(f"'{closure}'" for closure in own[name]["closures"])
            message = f"'{name}' is {gone[0]:.6g}, outside of its range {low:.6g} to {high:.6g} with {closures}"
            found.append({"pointer": f"/q/{name}", "code": "range-left", "message": message})
    return found


def dependent_left(
    model: Model, judge: Judge | None, q: Array, given: Mapping[str, Any], first: int = 0
) -> list[dict[str, str]]:
    """A warning for each dependent coordinate beyond the limits of its joint in states ``q`` (N, m); ``given``:
    parameters in place of defaults, and the time where it counts, without which nothing is known.
    """
    names = model.dependent
    if judge is None or not any(name in judge.limits_at_defaults for name in names):
        return []
    defaults = default_numbers(model.parameters)
    values: dict[str, Any] = {**defaults, **given, **{name: q[:, i] for i, name in enumerate(model.positions)}}
    needed = model.program.needs(["dependent"])
    if not all(name in values for name in needed):
        return []
    z = interpret_in_blocks(model.program, {name: values[name] for name in needed}, ["dependent"], len(q))["dependent"]
    return [dict(told) for told in judge.left(names, z, {n: x for n, x in given.items() if n != "t"}, first)]


def singular_loops(model: Model) -> str:
    """What else than sizes of numbers may be why there are none; empty without reduced instances."""
    told = (
        f"{listed(repr(x) for x in level['closures'])} at {listed(repr(x) for x in level['independent'])}"
        for level in model.reduced
    )
    where = "; ".join(told)
    return f"or a loop cannot be closed, or is singular (a dead centre), there: {where}" if where else ""


def loop_warnings(model: Model) -> list[dict[str, str]]:
    """Of a motion that failed, or is not right."""
    why = singular_loops(model)
    advice = "with 'level': 'full' motions go through dead centres"
    return [{"pointer": "/q", "code": "loop-singular", "message": f"the motion failed, {why}; {advice}"}] if why else []
