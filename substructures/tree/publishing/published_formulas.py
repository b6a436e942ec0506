"""The formulas of a tree that becomes a part, coupled out of the stored formulas of its parts.

As coupling does (:mod:`.coupling`), but with the inertia symbols of all bodies left open, and on an interface in place
of the world: nothing inside of a part is derived again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from substructures.documents.fields import in_si
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import INTERFACE, Columns, Link, constant_rotation, joined
from substructures.mechanics.linear3 import ZERO
from substructures.part.derive import derive
from substructures.part.formulas import Coupled, parallel_axes
from substructures.part.inertia_symbols import inertia_symbols
from substructures.part.mechanism import Mechanism
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part
from substructures.tree.coupling import OWN, evaluate_parts, place, with_momenta
from substructures.tree.document import Instance
from substructures.tree.inertial import FRAMES, LINKS, Plan, inertial_entries, planned
from substructures.tree.mounted_part import WORLD, MountedPart, PlacedPart
from substructures.tree.publishing.published import Published
from substructures.tree.publishing.published_names import PartNames
from substructures.tree.publishing.renaming import number_text

USED = (*LINKS, *FRAMES, "U", "Omega", "subtree.m", "subtree.s", "subtree.J")


def published_part(
    found: Published,
    parts: Mapping[str, Part],
    max_nodes: int = MAX_NODES,
    admit: Callable[[int], None] | None = None,
) -> Part:
    """The part that a tree becomes, coupled, verified and certified; ``parts``: by name of the instance.

    Raises as :func:`substructures.part.derive.derive`.
    """
    return derive(found.definition, max_nodes, admit, lambda m, large: _coupled(found, parts, m, large))


def _coupled(found: Published, parts: Mapping[str, Part], m: Mechanism, large: bool) -> Coupled:
    run = over_formulas(m.graph)
    mounted = _mounted(found, parts, m)
    plan = planned(run, mounted, not large, True)
    symbols = inertia_symbols(m.scope, m.topology)
    axes = parallel_axes(plan.chain, symbols)
    by_angles = axes.by_angles(plan.by_angles, not large)
    own = [run(here.part, here.bindings, OWN) for here in mounted]
    # what is fixed to a body, interfaces with it, is counted in its symbols
    inertias = [{k: symbols[here.first + k] for k in here.part.inertia_symbols} for here in mounted]
    evaluated, total = evaluate_parts(run, mounted, own, inertias, [(*USED, *names) for names in plan.stored])
    evaluated = with_momenta(plan.chain, evaluated, axes.body)
    placed: list[PlacedPart] = []
    for part in evaluated:
        # gravity is the host's
        placed.append(place(part, placed, ZERO))
    inertial, n = inertial_entries(plan, placed, not large, by_angles), len(m.joints)
    columns: dict[int, Columns] = {INTERFACE: {}}
    carried: dict[int, Inertia] = {INTERFACE: total}
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta):
            columns[here.first + c], carried[here.first + c] = here.columns[c], momentum.composite
    equations = {"metric": Formulas((n, n), inertial.metric, "symmetric")}
    if inertial.christoffel is not None:
        equations["christoffel"] = Formulas((n, n, n), inertial.christoffel, "christoffel")
    return Coupled(_chain(plan, mounted), columns, carried, equations)


def _chain(plan: Plan, mounted: Sequence[MountedPart]) -> tuple[Link, ...]:
    """The links of all joints; those of the first ones begin at the interface, where the tree begins at a part."""
    chain, roots = list(plan.chain), list[MountedPart]()
    for here in mounted:
        roots.append(here if here.host == WORLD else roots[here.host])
        seat = Link(INTERFACE, 0, constant_rotation(roots[-1].E), roots[-1].position)
        for c in range(here.first, here.first + here.part.joint_count):
            if chain[c].parent == INTERFACE:
                chain[c] = joined(seat, chain[c])
    return tuple(chain)


def _mounted(found: Published, parts: Mapping[str, Part], m: Mechanism) -> list[MountedPart]:
    """The parts in the graph of the definition, hosts first."""
    place = {instance.name: k for k, instance in enumerate(found.instances)}
    mounted: list[MountedPart] = []
    first = 0
    for instance in found.instances:
        part, host, frame = parts[instance.name], WORLD, 0
        if instance.at != "world":
            name, at = instance.at.split(".")
            host, frame = place[name], parts[name].frames.index(at)
        E, position = (_read(found.given, instance, field) for field in ("rpy", "position"))
        bindings = _bindings(found.given, m, instance.name, part)
        mounted.append(
            MountedPart(part, host, frame, m.scope.rpy(E, "").matrix(), m.scope.vector(position, ""), bindings, first)
        )
        first += part.joint_count
    return mounted


def _read(names: PartNames, instance: Instance, field: str) -> Sequence[object]:
    """Numbers of the placement of an instance, as those of the definition."""
    given = getattr(instance.placement, field)
    return [in_si(x) for x in names.expressions("", [in_si(x) for x in given], "")]


def _bindings(names: PartNames, m: Mechanism, instance: str, part: Part) -> dict[str, Expr]:
    """What every symbol of a stored program is in the part; not of inertias."""
    result = {}
    for symbol in part.program.symbols:
        if symbol.kind == "inertia":
            continue
        # of tau.q and q' the name between is another one in the part, the marks stay
        effort = "tau." if symbol.name.startswith("tau.") else ""
        name = symbol.name.removeprefix(effort).rstrip("'")
        stands_for = names.symbol(instance, name)
        if symbol.kind == "parameter":
            result[symbol.name] = m.scope.read(_number(stands_for), "")
        else:
            marks = symbol.name[len(effort) + len(name) :]
            result[symbol.name] = m.graph.symbol(f"{effort}{stands_for}{marks}")
    return result


def _number(given: object) -> object:
    """A number of a document in SI, or an expression."""
    return number_text(given) if isinstance(given, Mapping) else in_si(given)
