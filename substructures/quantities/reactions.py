"""Reactions: the force and the moment that every joint transmits, as formulas (notation.md, section 7).

Newton and Euler's recursion inwards (Luh, Walker, Paul 1980): what hangs on a joint needs the force m a + A s and the
moment s x a + axial(A J) of :mod:`substructures.mechanics.newton_euler` for its motion, in a world accelerated against
gravity; loads on it are taken off, also those between parts and the forces of closures, and the rest comes from the
body before it. So

    (f, n)_k = (f, n)_k of inertia - applied loads + sum over the children c of (f, n)_c, turned back and moved

is what the **inner body exerts on the outer one**, all of it: bearing, actuator, spring, damper and stop of the joint.
Its component along the axis (prismatic: f . e3; revolute: n . e3) is Q_k - armature q''^k, with the force Q_k of what
acts on the coordinate k alone. f stands at the origin of the body frame that the joint moves, n is about it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.certificate.derived.reactions import reaction_outputs
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, array
from substructures.expr.walk import transfer
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import Matrix, Scalar, apply, negate, transpose
from substructures.mechanics.newton_euler import inertial_load
from substructures.mechanics.wrench import Wrench
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.part.relations import of_coordinates
from substructures.quantities.of_parts import DYNAMIC, bare, formed
from substructures.quantities.part_models import OUTPUTS, ReactionModel
from substructures.tree.assembly import Assembly
from substructures.tree.couple import loaded_outputs
from substructures.tree.coupling import OWN, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.forces.applied_wrenches import applied_wrenches
from substructures.tree.given.driven import every_coordinate
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.loops.multipliers import PREFIX, loop_multipliers
from substructures.tree.given.projection import changed
from substructures.tree.inverse_dynamics import WrenchesByCarrier, body_motions, pass_back
from substructures.tree.model_outputs import rate_symbols
from substructures.tree.mounted_part import PlacedPart

NEEDED = "inverse_dynamics"
#: outputs of parts that neither move nor load anything
_LEFT_OUT = tuple(name for name in DYNAMIC if name not in ("load.at", "load.vector"))


def reactions(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> ReactionModel:
    """The reactions of a tree of stored parts (by instance name). Raises as :func:`.of_parts.formed`."""
    return ReactionModel(*formed("reactions", spec, parts, _outputs, reaction_outputs, max_nodes))


def _outputs(assembly: Assembly) -> tuple[dict[str, Formulas], tuple[str, ...]]:
    """OUTPUTS, and the names of their rows."""
    loops = assembly.dependent
    assembly = assembly.full()
    run = over_formulas(assembly.scope.graph)
    placed = couple_parts(bare(run, _LEFT_OUT), assembly.mounted, assembly.gravity, christoffel=False).placed
    rates, accelerations = rate_symbols(assembly)
    loads = _needed(assembly, placed, rates, accelerations)
    for part, carrier, wrench in applied_wrenches(assembly, placed, rates):
        # a force that acts is one that the joints need not transmit
        loads[part][carrier] += Wrench(negate(wrench.f), negate(wrench.n))
    transmitted = pass_back(placed, loads, len(rates))
    joints: list[tuple[str, Wrench, Matrix]] = []
    seats: list[tuple[str, Wrench, Matrix]] = []
    for instance, here, own in zip(assembly.instances, placed, loads, strict=True):
        for c, joint in enumerate(here.part.topology.joints):
            joints.append((f"{instance.name}.{joint.coordinate}", own[c], here.pose(c).R))
        seats.append((f"{instance.name}.base", own[INTERFACE], here.pose(INTERFACE).R))
    found: dict[str, dict[tuple[int, ...], Scalar]] = {name: {} for name in OUTPUTS}
    for k, (_, wrench, R) in enumerate([*joints, *seats]):
        # from the axes of the frame to those of the world: R^T
        shown = wrench.f, wrench.n, apply(transpose(R), wrench.f), apply(transpose(R), wrench.n)
        for name, vector in zip(OUTPUTS, shown, strict=True):
            found[name] |= {(k, i): vector[i] for i in range(3)}
    rows = tuple(name for name, *_ in (*joints, *seats))
    outputs = {name: Formulas((len(rows), 3), some) for name, some in found.items()}
    return _with_loops(assembly, loops, transmitted, outputs), rows


def _with_loops(
    assembly: Assembly, loops: Dependent, transmitted: Sequence[Scalar], outputs: dict[str, Formulas]
) -> dict[str, Formulas]:
    """With the forces of loops of the reduced level in place of their multipliers."""
    if not loops.values:
        return outputs
    graph, coordinates = assembly.scope.graph, list(every_coordinate(assembly))
    coupled = couple_parts(over_formulas(graph), assembly.mounted, assembly.gravity, christoffel=False)
    needed = loaded_outputs(assembly, coupled, frozenset({NEEDED}))[NEEDED]
    through = array((len(transmitted),), lambda a: transmitted[a])
    rows = (needed, of_coordinates({NEEDED: through}, coupled.ratios)[NEEDED])
    own, passed = (
        {q: graph.lift(each.entries.get((a,), 0)) for a, q in enumerate(coordinates) if q in loops.values}
        for each in rows
    )
    names = [name for name in assembly.scope.symbols if name.startswith(PREFIX)]
    forces = loop_multipliers(loops, names, own, passed)
    return changed(graph, outputs, lambda every: transfer(every, graph, forces))


def _needed(
    assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr], accelerations: Sequence[Expr]
) -> list[WrenchesByCarrier]:
    """What the motion needs of every carrier, with the masses where the definitions put them: what is moved along an
    axis for fewer operations changes no generalised force, but the load of the bearing."""
    run = over_formulas(assembly.scope.graph)
    result: list[WrenchesByCarrier] = []
    for m, motions in zip(assembly.mounted, body_motions(placed, rates, accelerations), strict=True):
        own = run(m.part, m.bindings, OWN)
        carriers = (*range(m.part.joint_count), INTERFACE)
        result.append({c: inertial_load(motions[c], own.own_inertia(c)) for c in carriers})
    return result
