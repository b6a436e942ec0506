"""Parts and trees with parts as robots: all parameters are numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

from substructures.export.robots.links import at_zero, loop_outputs, loops_in, require_finite, robot_of
from substructures.export.robots.rigid import Pose, RigidLink, Robot
from substructures.expr.program import Program, array, program
from substructures.part.frames import CutFrames
from substructures.part.part import Part
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.document import TreeSpec
from substructures.tree.mounted_part import WORLD

ROOT = "world"
#: puts numbers into a program
Bind = Callable[[Program], Program]


def robot_of_part(part: Part, bind: Bind, angles: bool) -> Robot:
    """A part as it stands alone; its interface is the root. ``angles``: in place of the quaternions of ball joints."""
    return robot_of(part.definition, lambda p: at_zero(bind(p), {}), angles)


def robot_of_tree(spec: TreeSpec, parts: Mapping[str, Part], bind: Bind, angles: bool) -> Robot:
    """A tree with its parts by instance; the root is the world, names are those of the tree (``arm.link1``)."""
    assembly = assemble(spec, parts)
    numbers = at_zero(bind(_values(spec, assembly)), {})
    require_finite(numbers, spec.name)
    links, left_out = [RigidLink(ROOT, None)], list(_not_of_trees(spec))
    loops = list(loops_in(spec.closures, numbers))
    for k, (instance, mounted) in enumerate(zip(assembly.instances, assembly.mounted, strict=True)):
        own = dict(zip(mounted.part.parameters, numbers[f"parameters.{k}"].tolist(), strict=True))
        found = robot_of(mounted.part.definition, lambda p, own=own: at_zero(p, own), angles, f"{instance.name}.")  # type: ignore[misc]
        host = ROOT
        if mounted.host != WORLD:
            frame = assembly.mounted[mounted.host].part.frames[mounted.frame]
            host = f"{assembly.instances[mounted.host].name}.{frame}"
        place: Pose = (numbers[f"E.{k}"].T, numbers[f"position.{k}"])
        links += [replace(found.links[0], parent=host, pose=place), *found.links[1:]]
        loops += found.loops
        left_out += found.left_out
    return Robot(tuple(links), tuple(loops), tuple(left_out), numbers["gravity"])


def _values(spec: TreeSpec, assembly: Assembly) -> Program:
    """Gravity, closures and, of every instance, parameters and placement, as formulas in the parameters of the tree."""
    cuts = assembly.cuts[: len(spec.closures)]
    frames = [CutFrames(cut.start.E, cut.end.E, cut.end.position, cut.length) for cut in cuts]
    graph, outputs = assembly.scope.graph, loop_outputs(frames)
    outputs["gravity"] = array((3,), lambda i: assembly.gravity[i])
    for k, (instance, m) in enumerate(zip(assembly.instances, assembly.mounted, strict=True)):
        own = [assembly.reading.parameter(f"{instance.name}.{name}") for name in m.part.parameters]
        outputs[f"parameters.{k}"] = array((len(own),), lambda i, own=own: own[i])
        outputs[f"E.{k}"] = array((3, 3), lambda i, j, E=m.E: E[i][j])
        outputs[f"position.{k}"] = array((3,), lambda i, r=m.position: r[i])
    return program(graph, outputs, assembly.scope.symbols)


def _not_of_trees(spec: TreeSpec) -> Iterator[str]:
    for load in spec.loads:
        yield f"the load '{load.name}' ({load.type})"
    for name in spec.driven:
        yield f"the given motion of '{name}'"
    for name in spec.ignored:
        yield f"the given momentum of '{name}'"
    for contact in spec.contacts:
        yield f"the contact '{contact.name}'"
    for each in spec.velocity_constraints:
        yield f"the velocity constraint '{each.name}' ({each.type})"
