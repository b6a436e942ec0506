"""The joint limits of a stored tree, as numbers: the ranges of a random sample when none are given."""

from __future__ import annotations

from math import pi

from service.content.cache import Cache
from service.jobs.kinds.kind import stored_definition
from service.jobs.kinds.library import Library, StoredTree
from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.part.definition import Definition
from substructures.part.topology import JointEntry, topology
from substructures.quantities.numbers.defaults import default_number
from substructures.tree.document import Instance, TreeSpec
from substructures.tree.plausibility import Plausibility

JointLimits = dict[str, tuple[float, float] | None]

TREES = 1000  # a job may have thousands of items of one tree
_known: Cache[JointLimits] = Cache(TREES, lambda _: 1)


def joint_limits(tree: StoredTree, library: Library) -> JointLimits:
    """By coordinate of the tree; -pi to pi for a revolute joint without limits, None where a range has to be given."""
    return _known.once(tree.digest, lambda: _joint_limits(tree, library))


def _joint_limits(tree: StoredTree, library: Library) -> JointLimits:
    spec = TreeSpec.stored(read_json(tree.spec.encode()))
    definitions = {instance.name: _definition(instance, library) for instance in spec.instances}
    ranges = Plausibility(spec, definitions)
    result: JointLimits = {}
    for instance in spec.instances:
        definition = definitions[instance.name]
        layout = topology(definition)
        for i, a in enumerate(layout.movers):
            name = f"{instance.name}.{layout.joints[a].coordinate}"
            result[name] = _limits(definition, layout.joints[a])
            others = [k for k, of in enumerate(layout.moved_by) if of == i and k != a]
            if any(definition.bodies[layout.joints[k].body].joint.limits is not None for k in others):
                # what moves with the coordinate bounds it, too
                found = ranges.limits_at_defaults.get(name)
                result[name] = None if found is None else (float(found[0]), float(found[1]))
    return result


def _definition(instance: Instance, library: Library) -> Definition:
    if instance.definition is not None:
        return instance.definition
    digest = (instance.substructure or "").partition("@")[2]
    return stored_definition(digest, library)


def _limits(definition: Definition, joint: JointEntry) -> tuple[float, float] | None:
    limits = definition.bodies[joint.body].joint.limits
    if limits is None:
        return None if joint.s else (-pi, pi)
    low, high = limits[joint.step] if isinstance(limits[0], tuple) else limits
    try:
        return default_number(low), default_number(high)
    except InvalidDocument:  # an expression in parameters
        return None
