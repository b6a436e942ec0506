"""What a tree document says of its instances, closures and loads, in the names and the graph of the tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from substructures.errors import among
from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.expr.steps import needed_first
from substructures.loads.friction import TreeFriction, read_friction
from substructures.loads.names import names_in
from substructures.loads.scope import Scope
from substructures.mechanics.cut_joints import ROWS
from substructures.mechanics.linear3 import ZERO, Matrix, Vector
from substructures.part.definition import PartClosure, Placement
from substructures.part.forces.joint_laws import friction_of
from substructures.part.frames import cut_frames
from substructures.part.outputs import over_formulas
from substructures.part.part import Part
from substructures.tree.cuts import ClosureEnd, ClosureRows, Cut
from substructures.tree.document import TreeSpec, misplaced
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.given.loops.reduction import dependent
from substructures.tree.mounted_part import WORLD, MountedPart, friction_of_movers, limits_of_movers

#: bindings that are read one within the other
DEEP = 50


def tree_name(instance: str, symbol: str) -> str:
    """The name in a tree of a symbol of an instance: arm.q1, arm.q1', tau.arm.q1; the time t is common to all."""
    if symbol == "t":
        return symbol
    return f"tau.{instance}.{symbol[4:]}" if symbol.startswith("tau.") else f"{instance}.{symbol}"


class Bindings:
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
            chain = needed_first(name, self._unread)
            # few nest in each other, in the order in which their operations are stored
            for each in chain if len(chain) > DEEP else (name,):
                self.lookup(each)

    def _unread(self, name: str) -> list[str]:
        return [x for x in names_in(self.given[name][0]) if x in self.given and x not in self.values]

    def lookup(self, name: str) -> Expr | None:
        """A parameter by its name in the tree, with its binding put in."""
        if name in self.values:
            return self.values[name]
        if name not in self.given:
            return self.scope.names.get(name)
        value, pointer = self.given[name]
        # a parameter bound to itself over others, so many maybe that reading would nest too deeply
        if name in self.open or len(self.open) > DEEP:
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
    bound: Bindings
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
