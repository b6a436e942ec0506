"""From a tree document and its parts to mounted parts in one graph: names, hosts, placements, bindings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from substructures.errors import InvalidDocument
from substructures.expr.graph import Expr, Graph
from substructures.expr.steps import RESERVED
from substructures.loads.scope import Scope, no_names
from substructures.mechanics.balls import BallJoint
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import Vector
from substructures.part.outputs import over_formulas
from substructures.part.parameters import described, described_inputs
from substructures.part.part import Part
from substructures.tree.cuts import Cut
from substructures.tree.document import Instance, TreeSpec, misplaced
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.loops.reduction import dependent
from substructures.tree.given.ties import require_chains
from substructures.tree.mounted_part import WORLD, MountedPart, balls_of
from substructures.tree.reading import Bindings, Reading, tree_name


@dataclass(frozen=True)
class Assembly:
    """Everything coupling needs, with the symbols and parameters of the tree."""

    scope: Scope
    instances: tuple[Instance, ...]  #: hosts first
    mounted: tuple[MountedPart, ...]
    gravity: Vector
    parameters: dict[str, dict[str, object]]
    cuts: tuple[Cut, ...]
    inputs: dict[str, dict[str, object]]
    limits: dict[int, tuple[Expr, Expr]]  #: of the coordinates that have limits, by joint
    friction: dict[int, tuple[Expr, Expr, Expr, Expr]]  #: F_c, F_s, v_s (0: none), v_0 of coordinates, by joint
    friction_load: dict[int, tuple[Expr, Expr]]  #: by joint: of the force beside the axis, and along it
    reading: Reading  #: for what is read when the parts have their places

    @property
    def reduced(self) -> frozenset[str]:
        """The instances whose dependent coordinates are functions of the independent ones."""
        return self.reading.reduced

    def full(self) -> Assembly:
        """With all closures of the parts, and none that is reduced; in the same graph."""
        reading = replace(self.reading, reduced=frozenset())
        return replace(self, cuts=tuple(reading.cuts()), reading=reading)

    @cached_property
    def dependent(self) -> Dependent:
        """The dependent coordinates of all reduced instances."""
        found = Dependent(self.scope.graph, ())
        for instance, m in zip(self.instances, self.mounted, strict=True):
            if instance.name in self.reduced:
                found = found.beside(self.reading.dependent(instance.name, m.part))
        return found

    @property
    def balls(self) -> tuple[BallJoint, ...]:
        """The ball and floating joints, with the names of their positions in the tree."""
        return balls_of(self.mounted, [instance.name for instance in self.instances])


def division_by_zero(spec: TreeSpec, assembly: Assembly) -> InvalidDocument:
    """The exception for bindings that make a divisor zero: names the first instance in whose formulas they do."""
    run = over_formulas(assembly.scope.graph)
    for instance, m in zip(assembly.instances, assembly.mounted, strict=True):
        try:
            run(m.part, m.bindings, tuple(m.part.program.outputs))
        except ZeroDivisionError:
            message = f"with these parameters a formula of '{instance.name}' divides by zero"
            pointer = f"/instances/{spec.instances.index(instance)}/parameters"
            return InvalidDocument.at(pointer, "division-by-zero", message)
    return InvalidDocument.at("/instances", "division-by-zero", "with these parameters a formula divides by zero")


def assemble(spec: TreeSpec, parts: Mapping[str, Part]) -> Assembly:
    """Read a tree. Raises InvalidDocument with a pointer to every fault, and (``has-balls``) for what does not go with
    ball and floating joints.
    """
    assembly = unchecked(spec, parts)
    given = {name: getattr(spec, name) for name in ("driven", "ignored", "velocity_constraints")}
    for name, some in (given | {"closures": assembly.cuts}).items():
        if some:
            require_chains(assembly.balls, f"take the tree without '{name}'", f"/{name}")
    return assembly


def unchecked(spec: TreeSpec, parts: Mapping[str, Part]) -> Assembly:
    """A tree of which it is not known that its ties go together. Raises InvalidDocument."""
    scope = Scope(Graph())
    order = _order(spec, parts, scope)
    _name_faults(spec, scope)
    scope.finish()
    parameters = _parameters(spec, parts, scope)
    for name, each in parameters.items():
        scope.declare(name, "parameter", str(each["unit"]))
    bound = Bindings(spec, parts, scope)
    # all at once: bindings that no formula depends on may have faults, too
    bound.resolve_all()
    place = {spec.instances[i].name: k for k, i in enumerate(order)}
    level = _reduced_instances(spec, parts, scope)
    reading = Reading(spec, parts, scope, place, bound, frozenset(parameters), level)
    mounted: list[MountedPart] = []
    first = 0
    for i in order:
        mounted.append(reading.mounted(i, first))
        first += mounted[-1].part.joint_count
    gravity = scope.vector(spec.gravity, "/gravity", bound.lookup)
    cuts = tuple(reading.cuts())
    limits = {m.first + c: x for i, m in zip(order, mounted, strict=True) for c, x in reading.limits(i, m).items()}
    friction = {m.first + c: x for i, m in zip(order, mounted, strict=True) for c, x in reading.friction(i, m).items()}
    loaded = {m.first + c: x for i, m in zip(order, mounted, strict=True) for c, x in reading.friction_load(i).items()}
    friction |= reading.friction_loads(mounted, [spec.instances[i].name for i in order], friction)
    inputs = _inputs(spec, parts, scope)
    scope.finish()
    left = {name: value for name, value in parameters.items() if name not in bound.values}
    instances = tuple(spec.instances[i] for i in order)
    places = tuple(mounted), gravity, left, cuts, inputs, limits, friction, loaded, reading
    return Assembly(scope, instances, *places)


def _reduced_instances(spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> frozenset[str]:
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


def _name_faults(spec: TreeSpec, scope: Scope) -> None:
    """Names that occur twice, among loads and among inputs and what else expressions of loads may name."""
    names = [load.name for load in spec.loads]
    for i, name in enumerate(names):
        if name in names[:i]:
            scope.fault(f"/loads/{i}/name", "duplicate-name", f"duplicate load '{name}'")
    for name in spec.inputs:
        if name in RESERVED or name in ("world", "tau"):
            scope.fault(f"/inputs/{name}", "reserved-name", f"'{name}' has a fixed meaning in expressions")
        elif name in spec.parameters or any(instance.name == name for instance in spec.instances):
            scope.fault(f"/inputs/{name}", "duplicate-name", f"'{name}' is a parameter or an instance, too")


def _indices(spec: TreeSpec, scope: Scope) -> dict[str, int]:
    """Indices of the instances by name; faults for names."""
    index: dict[str, int] = {}
    for i, instance in enumerate(spec.instances):
        pointer = f"/instances/{i}/name"
        if instance.name in index:
            scope.fault(pointer, "duplicate-name", f"duplicate instance '{instance.name}'")
        # at: "world", and tau.arm.q1 of the coordinate arm.q1
        if instance.name in ("world", "tau") or instance.name in spec.parameters:
            scope.fault(pointer, "reserved-name", f"an instance cannot be called '{instance.name}' here")
        index[instance.name] = i
    return index


def _order(spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> list[int]:
    """Indices of the instances, hosts first and otherwise as given; faults for names, unknown hosts and cycles."""
    index = _indices(spec, scope)
    waiting: dict[int, list[int]] = {}
    ready, frames = list[int](), {each.name: parts[each.name].frames for each in spec.instances}
    for i, instance in enumerate(spec.instances):
        host, dot, _ = instance.at.partition(".")
        if instance.at == "world":
            ready.append(i)
        elif dot and host in index:
            waiting.setdefault(index[host], []).append(i)
        elif found := misplaced(instance.at, frames):
            scope.fault(f"/instances/{i}/at", *found)
    order: list[int] = []
    while ready:
        # the first in the document whose host is there: coordinates, and digests with them, have this order;
        # publishing.published finds the same
        i = min(ready)
        ready.remove(i)
        order.append(i)
        ready += waiting.get(i, [])
    if not scope.faults:
        for i in set(range(len(spec.instances))) - set(order):
            name = spec.instances[i].name
            scope.fault(f"/instances/{i}/at", "cycle", f"instance '{name}' is on or behind a cycle of hosts")
    return order


def _parameters(spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> dict[str, dict[str, object]]:
    """All parameters of the tree with defaults, those of instances as instance.name; faults of the tree's own."""
    result: dict[str, dict[str, object]] = {}
    for name, each in sorted(described(spec.parameters).items()):
        if each["value"] is not None:
            # in a graph of its own: no formula, nor the order of operations, depends on the value
            Scope(Graph(), faults=scope.faults).read(each["value"], f"/parameters/{name}/value", no_names)
        result[name] = each
    for instance in spec.instances:
        result |= {f"{instance.name}.{name}": x for name, x in sorted(parts[instance.name].parameters.items())}
    return result


def declared(spec: TreeSpec, parts: Mapping[str, Part]) -> dict[str, Any]:
    """``parameters`` that are not bound and ``inputs`` of a tree, whether or not a formula depends on them. Raises
    InvalidDocument for values of its own that cannot be read.
    """
    scope = Scope(Graph())
    bound = {f"{instance.name}.{name}" for instance in spec.instances for name in instance.parameters}
    parameters, inputs = _parameters(spec, parts, scope), _inputs(spec, parts, scope)
    scope.finish()
    return {"parameters": {name: x for name, x in parameters.items() if name not in bound}, "inputs": inputs}


def _inputs(spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> dict[str, dict[str, object]]:
    """All inputs of loads: of the tree, and those that the definitions declare; faults of the tree's defaults."""
    for name, given in sorted(spec.inputs.items()):
        if given.default is not None:
            Scope(Graph(), faults=scope.faults).read(given.default, f"/inputs/{name}/default", no_names)
    return described_inputs(spec.inputs) | {
        tree_name(instance.name, name): each
        for instance in spec.instances
        for name, each in described_inputs(parts[instance.name].definition.inputs).items()
    }


def joint_parents(mounted: Sequence[MountedPart]) -> list[tuple[int, int]]:
    """(parent, kind) of every joint of a tree, by index in the tree; hosts come first."""
    result: list[tuple[int, int]] = []
    #: the joint of the tree that carries each interface, or WORLD
    seats: list[int] = []
    for m in mounted:
        seats.append(WORLD if m.host == WORLD else _joint(mounted[m.host], seats[m.host], m.frame))
        joints = m.part.topology.joints
        result += [(seats[-1] if j.parent == INTERFACE else m.first + j.parent, j.s) for j in joints]
    return result


def _joint(host: MountedPart, seat: int, frame: int) -> int:
    """The joint of the tree that carries a frame of a part; ``seat``: the one that carries its interface."""
    carrier = host.part.frame_carriers[frame]
    return seat if carrier == INTERFACE else host.first + carrier
