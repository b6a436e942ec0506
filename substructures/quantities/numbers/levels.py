"""What is said of numbers of the reduced level: ranges that coordinates leave, and loops that are open or singular."""

from __future__ import annotations

from substructures.array import Array
from substructures.errors import listed
from substructures.quantities.numbers.states import default_number
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
