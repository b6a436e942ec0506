"""The power of each force, by the forces that documents with this one alone give: Q_a q'^a."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb

from substructures.certificate.bodies import NONE, Bodies, laws_of
from substructures.certificate.by_coordinate import along, rates
from substructures.certificate.dynamics import carried_by_joints
from substructures.certificate.linear import Ball, dot
from substructures.certificate.loads.forces import Forces
from substructures.certificate.loads.joint_laws import joint_law
from substructures.certificate.loads.part_loads import LOADS
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.relations import written
from substructures.certificate.tree_outputs import beside, built
from substructures.errors import VerificationFailed

OUTPUT = "powers"
#: (row, Q_a)
Row = tuple[str, Mapping[int, Ball]]


def power_outputs(
    tree: Plain, definitions: Mapping[str, Plain], rows: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """Powers of all ``rows``. Raises VerificationFailed for others than the documents have."""
    numbers, bodies, loads, _ = built(tree, definitions, values)
    found = list(_rows(tree, definitions, bodies, numbers, loads, values))
    if [name for name, _ in found] != list(rows):
        raise VerificationFailed(f"the rows are not those of the documents: {', '.join(rows)}")
    moving = rates(bodies, values, "'")
    result = Outputs()
    watts = (sum((Q * moving[a] for a, Q in forces.items()), arb(0)) for _, forces in found)
    result.array(OUTPUT, (len(found),)).update({(k,): x for k, x in enumerate(watts)})
    return result


def _rows(
    tree: Plain,
    definitions: Mapping[str, Plain],
    bodies: Bodies,
    numbers: Numbers,
    loads: Sequence[tuple[str, Numbers, range]],
    values: Mapping[str, Ball],
) -> Iterator[Row]:
    gravity = numbers.vector(tree.get("gravity", NONE))
    yield "gravity", {a: dot(gravity, each.f) for a, each in enumerate(carried_by_joints(bodies, bodies.own))}
    efforts = {a: values[f"tau.{bodies.joints[a].coordinate}"] for a in along(bodies)}
    for name, inside, joints in loads:
        for a, (joint, step) in zip(joints, laws_of(definitions[name]), strict=True):
            alone = Forces(bodies, written(definitions[name]), inside, joints, f"{name}.")
            joint_law(alone, a, joint, step)
            yield f"joint {bodies.joints[a].coordinate}", {a: alone.applied[a] - efforts.get(a, arb(0))}
    yield from ((f"tau.{bodies.joints[a].coordinate}", {a: effort}) for a, effort in efforts.items())
    for name, inside, joints in loads:
        for i, load in enumerate(written(definitions[name]).get("loads", ())):
            alone = Forces(bodies, definitions[name], inside, joints, f"{name}.")
            LOADS[load["type"]](alone, load)
            both = (alone.applied, alone.wrenches)
            sums = {a: sum((x[a] for x in both if a in x), arb(0)) for a in {**alone.applied, **alone.wrenches}}
            yield f"{load['type']} {name}.loads/{i}", sums
    for load in tree.get("loads", ()):
        yield f"{load['type']} {load['name']}", beside({**tree, "loads": [load]}, definitions, bodies, numbers).applied
