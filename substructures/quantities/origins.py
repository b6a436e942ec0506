"""Where the entries of formulas come from: bodies by the structure of the tree, symbols by the formulas themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from substructures.expr.operations import operands
from substructures.expr.program import Program
from substructures.mechanics.kinematics import INTERFACE
from substructures.part.definition import Body
from substructures.part.part import Part
from substructures.part.topology import BASE
from substructures.tree.assembly import assemble, joint_parents
from substructures.tree.document import TreeSpec
from substructures.tree.given.driven import every_coordinate
from substructures.tree.reading import tree_name


@dataclass(frozen=True)
class Movers:
    """``bodies``: names of bodies that may have inertia; ``moved``: of every coordinate, the numbers of those bodies
    that it moves when all others stand still."""

    bodies: tuple[str, ...]
    moved: tuple[frozenset[int], ...]


def movers_of_part(part: Part) -> Movers:
    """The bodies of a part as it stands alone."""
    joints = part.topology.joints
    carriers = {body.name: part.topology.carrier[body.name] for body in part.definition.bodies if _has_inertia(body)}
    return _movers([joint.parent for joint in joints], carriers, part.topology.moved_by)


def movers_of_tree(spec: TreeSpec, parts: Mapping[str, Part]) -> Movers:
    """The bodies of all parts, by their names in the tree. Raises as :func:`substructures.tree.assembly.assemble`."""
    assembly = assemble(spec, parts)
    parents = joint_parents(assembly.mounted)
    carriers: dict[str, int] = {}
    seats: list[int] = []
    for instance, m in zip(assembly.instances, assembly.mounted, strict=True):
        host = None if m.host == INTERFACE else assembly.mounted[m.host]
        carrier = INTERFACE if host is None else host.part.frame_carriers[m.frame]
        inner = INTERFACE if host is None or carrier == INTERFACE else host.first + carrier
        seats.append(seats[m.host] if host is not None and carrier == INTERFACE else inner)
        for body in m.part.definition.bodies:
            if _has_inertia(body):
                own = m.part.topology.carrier[body.name]
                carriers[tree_name(instance.name, body.name)] = seats[-1] if own == INTERFACE else m.first + own
    first, of = 0, list[int]()
    for m in assembly.mounted:
        of += [first + i for i in m.part.topology.moved_by]
        first += m.part.dof
    found, names = _movers([parent for parent, _ in parents], carriers, of), every_coordinate(assembly)
    known = assembly.dependent
    given, moved = {**spec.driven, **spec.ignored, **known.values}, dict(zip(names, found.moved, strict=True))
    for z in known.values:
        # what a dependent coordinate moves is moved by those that it depends on
        moved |= {y: moved[y] | moved[z] for y in known.N[z]}
    free = [some for name, some in moved.items() if name not in given]
    return replace(found, moved=tuple(free))


def _movers(parents: Sequence[int], carriers: Mapping[str, int], of: Sequence[int]) -> Movers:
    """``of``: by joint, the coordinate that moves it."""
    moved: list[set[int]] = [set() for _ in set(of)]
    for k, joint in enumerate(carriers.values()):
        while joint != INTERFACE:
            moved[of[joint]].add(k)
            joint = parents[joint]
    return Movers(tuple(carriers), tuple(map(frozenset, moved)))


def _has_inertia(body: Body) -> bool:
    """Whether a body is given any, or may get some by a parameter."""
    numbers = [body.mass, *body.inertia.model_dump().values()]
    return body.name != BASE and any(x not in (0, "0", None) for x in numbers)


def origins(program: Program, movers: Movers) -> dict[str, Any]:
    """What every independent entry of the outputs of a program comes from, as plain data with numbers into lists.

    ``bodies`` of an entry are those that all coordinates of its index move: M_ab is a sum over bodies that a and b
    move, Gamma_abc over those that all three do, Q_a over those that a does. So an entry that is not listed is zero
    because there is no such body, or because its formula vanishes in every pose. ``symbols`` are those that occur in
    its formula.
    """
    masks = _symbols(program)
    return {
        "bodies": list(movers.bodies),
        "moved": [sorted(some) for some in movers.moved],
        "symbols": [symbol.name for symbol in program.symbols],
        "quantities": {
            name: {
                "shape": list(output.shape),
                "symmetry": output.symmetry,
                "entries": [
                    {
                        "index": list(index),
                        "bodies": sorted(frozenset.intersection(*(movers.moved[a] for a in index))) if index else [],
                        "symbols": [k for k in range(len(program.symbols)) if masks[entry] >> k & 1],
                    }
                    for index, entry in zip(output.index, output.entries, strict=True)
                ],
            }
            for name, output in program.outputs.items()
        },
    }


def _symbols(program: Program) -> list[int]:
    """Of every operation, the symbols that it depends on, as bits."""
    masks: list[int] = []
    for operation in program.operations:
        mask = 1 << operation[1] if operation[0] == "sym" else 0
        for operand in operands(operation):
            mask |= masks[operand]
        masks.append(mask)
    return masks
