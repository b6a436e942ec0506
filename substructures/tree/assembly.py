"""From a tree document and its parts to mounted parts in one graph: names, hosts, placements, bindings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from substructures.errors import InvalidDocument, among
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.syntax import RESERVED
from substructures.loads.friction import TreeFriction, read_friction
from substructures.loads.scope import Scope, no_names
from substructures.mechanics.balls import BallJoint
from substructures.mechanics.cut_joints import ROWS
from substructures.mechanics.kinematics import INTERFACE
from substructures.mechanics.linear3 import ZERO, Matrix, Vector
from substructures.part.definition import PartClosure, Placement
from substructures.part.forces.joint_laws import friction_of
from substructures.part.frames import cut_frames
from substructures.part.outputs import over_formulas
from substructures.part.parameters import described, described_inputs
from substructures.part.part import Part
from substructures.tree.closures import ClosureEnd, ClosureRows, Cut
from substructures.tree.document import Instance, TreeSpec, misplaced
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.loops.levels import reduced_instances
from substructures.tree.given.loops.reduction import dependent
from substructures.tree.given.ties import require_chains
from substructures.tree.mounted_part import WORLD, MountedPart, balls_of, friction_of_movers, limits_of_movers


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


def tree_name(instance: str, symbol: str) -> str:
    """The name in a tree of a symbol of an instance: arm.q1, arm.q1', tau.arm.q1; the time t is common to all."""
    if symbol == "t":
        return symbol
    return f"tau.{instance}.{symbol[4:]}" if symbol.startswith("tau.") else f"{instance}.{symbol}"


def assemble(spec: TreeSpec, parts: Mapping[str, Part]) -> Assembly:
    """Read a tree. Raises InvalidDocument with a pointer to every fault, and (``has-balls``) for what does not go with
    ball and floating joints.
    """
    assembly = unchecked(spec, parts)
    given = {name: getattr(spec, name) for name in ("driven", "ignored", "velocity_constraints", "contacts")}
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
    bound = _Bindings(spec, parts, scope)
    # all at once: bindings that no formula depends on may have faults, too
    bound.resolve_all()
    place = {spec.instances[i].name: k for k, i in enumerate(order)}
    level = reduced_instances(spec, parts, scope)
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


class _Bindings:
    """Parameters of instances that are bound to numbers or to expressions in other parameters."""

    def __init__(self, spec: TreeSpec, parts: Mapping[str, Part], scope: Scope) -> None:
        self.scope = scope
        self.given: dict[str, tuple[object, str]] = {}
        self.values: dict[str, Expr] = {}
        self.open: list[str] = []
        for i, instance in enumerate(spec.instances):
            for name, value in sorted(instance.parameters.items()):
                pointer = f"/instances/{i}/parameters/{name}"
                if name in parts[instance.name].parameters:
                    self.given[f"{instance.name}.{name}"] = (value, pointer)
                else:
                    part = parts[instance.name]
                    message = f"'{part.name}' has no parameter '{name}'{among(name, part.parameters)}"
                    scope.fault(pointer, "unknown-parameter", message)

    def resolve_all(self) -> None:
        """Read all bindings."""
        for name in self.given:
            self.lookup(name)

    def lookup(self, name: str) -> Expr | None:
        """A parameter by its name in the tree, with its binding put in."""
        if name in self.values:
            return self.values[name]
        if name not in self.given:
            return self.scope.names.get(name)
        value, pointer = self.given[name]
        # a parameter bound to itself over others, or so many of them that reading would nest too deeply
        if name in self.open or len(self.open) > 50:
            self.scope.fault(pointer, "cycle", f"the binding of '{name}' refers to itself")
            return self.scope.graph.zero
        self.open.append(name)
        self.values[name] = self.scope.read(value, pointer, self.lookup)
        self.open.pop()
        return self.values[name]


@dataclass(frozen=True)
class Reading:
    """What instances, closures and loads are read with.

    ``place``: index of an instance, by name, hosts first; ``known``: all parameters, bound or not.
    """

    spec: TreeSpec
    parts: Mapping[str, Part]
    scope: Scope
    place: Mapping[str, int]
    bound: _Bindings
    known: frozenset[str]
    reduced: frozenset[str]

    def dependent(self, instance: str, part: Part) -> Dependent:
        """The dependent coordinates of a reduced instance in the graph of the tree."""
        own = dependent(part)
        assert isinstance(own, Dependent)  # noqa: S101 -- it is among those that are reduced
        bindings = {q: self.scope.graph.symbol(f"{instance}.{q}") for q in part.coordinates}
        for name in part.parameters:
            bound = self.bound.lookup(f"{instance}.{name}")
            bindings[name] = self.scope.graph.symbol(f"{instance}.{name}") if bound is None else bound
        return own.moved(self.scope.graph, instance, bindings)

    def parameter(self, name: str) -> Expr | None:
        """A parameter by its name in the tree, with its binding put in; None of what is none."""
        return self.bound.lookup(name) if name in self.known else None

    def placement(self, placement: Placement, pointer: str) -> tuple[Matrix, Vector]:
        """E and position, both constant."""
        E = self.scope.rpy(placement.rpy, f"{pointer}/rpy", self.bound.lookup).matrix()
        return E, self.scope.vector(placement.position, f"{pointer}/position", self.bound.lookup)

    def frame(self, at: str, pointer: str) -> tuple[int, int]:
        """Index of an instance (or WORLD) and of its frame, for ``world`` or ``instance.frame``."""
        if at == "world":
            return WORLD, 0
        name, frame = at.split(".")
        frames = {each: self.parts[each].frames for each in self.place}
        if found := misplaced(at, frames):
            self.scope.fault(pointer, *found)
            return self.place.get(name, WORLD), 0
        return self.place[name], frames[name].index(frame)

    def mounted(self, i: int, first: int) -> MountedPart:
        """An instance of the document; ``first``: index of its first coordinate."""
        instance = self.spec.instances[i]
        part = self.parts[instance.name]
        host, frame = self.frame(instance.at, f"/instances/{i}/at")
        E, position = self.placement(instance.placement, f"/instances/{i}/placement")
        return MountedPart(part, host, frame, E, position, self.symbols(instance.name, part), first)

    def symbols(self, instance: str, part: Part) -> dict[str, Expr]:
        """What every symbol of a stored program is in the tree (inertia symbols are bound by coupling)."""
        result: dict[str, Expr] = {}
        for symbol in part.program.symbols:
            if symbol.kind == "inertia":
                continue
            name = tree_name(instance, symbol.name)
            value = self.bound.lookup(name) if symbol.kind == "parameter" else None
            if value is None:
                self.scope.symbols.setdefault(name, Symbol(name, symbol.kind, symbol.unit))
                value = self.scope.graph.symbol(name)
            result[symbol.name] = value
        return result

    def own(self, i: int, given: object) -> Expr:
        """A number or expression in the definition of an instance, with the names of the tree."""
        name = self.spec.instances[i].name
        return self.scope.read(given, f"/instances/{i}", lambda own: self.bound.lookup(f"{name}.{own}"))

    def limits(self, i: int, m: MountedPart) -> dict[int, tuple[Expr, Expr]]:
        """The limits of the coordinates of an instance that have some, by joint of the part."""
        found: dict[int, tuple[Expr, Expr]] = {}
        for c, entry in enumerate(m.part.topology.joints):
            given = m.part.definition.bodies[entry.body].joint.limits
            if given:
                low, high = given[entry.step] if isinstance(given[0], tuple) else given
                found[c] = self.own(i, low), self.own(i, high)
        return limits_of_movers(over_formulas(self.scope.graph), m, found)

    def friction(self, i: int, m: MountedPart) -> dict[int, tuple[Expr, Expr, Expr, Expr]]:
        """F_c, F_s, v_s (0 where there is none) and v_0 of the coordinates of an instance that have dry friction."""
        instance, found = self.spec.instances[i], dict[int, tuple[Expr, Expr, Expr, Expr]]()
        for c, entry in enumerate(m.part.topology.joints):
            law = friction_of(m.part.definition, entry)
            if law is not None:
                # F_s = F_c where nothing is said: a joint at rest takes no more than one that slips
                static = law.coulomb if law.static is None else law.static
                F, S, v, w = (self.own(i, x) for x in (law.coulomb, static, law.stribeck or 0, law.velocity))
                found[c] = F, S, v, w
        moved, is_one = friction_of_movers(over_formulas(self.scope.graph), m, found)
        if not is_one:
            message = f"frictions of joints of '{instance.name}' that move together are no law of one velocity"
            self.scope.fault(f"/instances/{i}", "several-frictions", f"{message}: give one of them all of it")
        return moved

    def friction_load(self, i: int) -> dict[int, tuple[Expr, Expr]]:
        """mu r and mu r_a, of prismatic joints mu and 0, of the coordinates of an instance with such friction."""
        part, found = self.parts[self.spec.instances[i].name], dict[int, tuple[Expr, Expr]]()
        for c, entry in enumerate(part.topology.joints):
            given = part.definition.bodies[entry.body].joint.friction
            law = given[entry.step] if isinstance(given, tuple) else given
            if law is not None and law.load is not None:
                # a slide rubs with the force itself, without a lever, and transmits none along its axis
                radius = 1 if entry.s else law.load.radius
                mu, r, along = (self.own(i, x) for x in (law.load.coefficient, radius, law.load.axial_radius or 0))
                found[c] = mu * r, mu * along
        return found

    def friction_loads(
        self, mounted: Sequence[MountedPart], instances: Sequence[str], known: Mapping[int, object]
    ) -> dict[int, tuple[Expr, Expr, Expr, Expr]]:
        """The same of the loads of the tree; ``known``: coordinates whose joints have friction."""
        pairs = zip(instances, mounted, strict=True)
        names = [f"{instance}.{joint.coordinate}" for instance, m in pairs for joint in m.part.topology.joints]
        found: dict[int, tuple[Expr, Expr, Expr, Expr]] = {}
        for i, load in enumerate(self.spec.loads):
            if not isinstance(load, TreeFriction) or load.coordinate not in names:
                continue
            a = names.index(load.coordinate)
            if a in known or a in found:
                message = f"'{load.coordinate}' has friction already: a coordinate has one law of it"
                self.scope.fault(f"/loads/{i}/coordinate", "several-frictions", message)
            law = read_friction(self.scope, load, f"/loads/{i}", self.parameter)
            if law is not None:
                found[a] = law.row()
        return found

    def cuts(self) -> Iterator[Cut]:
        """The closures of the tree, and those of its parts, hosts first, as ``instance.closure``."""
        names: set[str] = set()
        for i, closure in enumerate(self.spec.closures):
            if closure.name in names:
                self.scope.fault(f"/closures/{i}/name", "duplicate-name", f"duplicate closure '{closure.name}'")
            names.add(closure.name)
            yield self.cut(closure, f"/closures/{i}")
        index = {instance.name: i for i, instance in enumerate(self.spec.instances)}
        for name in self.place:
            # what is reduced has its loops in the formulas
            for own in () if name in self.reduced else self.parts[name].definition.closures:
                yield self.cut(own, f"/instances/{index[name]}", f"{name}.")

    def cut(self, closure: PartClosure, pointer: str, prefix: str = "") -> Cut:
        """A closure with its frames; ``prefix``: of its own names, where it is one of an instance."""
        frames = cut_frames(self.scope, closure, pointer, lambda name: self.bound.lookup(prefix + name))
        from_, to = prefix + closure.from_, prefix + closure.to
        start = ClosureEnd(*self.frame(from_, f"{pointer}/from"), frames.start, ZERO)
        end = ClosureEnd(*self.frame(to, f"{pointer}/to"), frames.end, frames.position)
        rows = ClosureRows(prefix + closure.name, closure.type, from_, to, ROWS[closure.type])
        return Cut(rows, start, end, frames.length)


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
