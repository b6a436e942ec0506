"""What everything in a tree is called in the part that it becomes, and what its bound parameters stand for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from substructures.documents import read_json
from substructures.documents.fields import in_si
from substructures.errors import Fault, InvalidDocument, meant
from substructures.part.parameters import counted
from substructures.part.part import Part
from substructures.part.topology import BASE
from substructures.tree.document import TreeSpec
from substructures.tree.publishing.renaming import Names, names_of, number_text, renamed

#: fields that are no expressions
TEXTS = frozenset(
    ("name", "type", "unit", "title", "description", "license", "source", "tags", "parent", "body", "message")
)


@dataclass
class PartNames:
    """Names of the part by names of the tree.

    ``symbols``: of parameters, inputs and coordinates; ``bodies``, ``ports``: by ``instance.name``; ``bases``: by
    instance the body that its interface is; ``bound``: by parameter what it stands for; ``given``: documents of free
    parameters by name in the tree; ``parts``: by instance; ``frames``: massless bodies that are still to be put into
    the definition; ``closures``: names of closures that are taken.
    """

    symbols: dict[str, str]
    bodies: dict[str, str]
    bound: dict[str, Any]
    given: dict[str, dict[str, Any]]
    inputs: dict[str, dict[str, Any]]
    joints: dict[str, dict[int, list[str]]]
    taken: Names
    parts: Mapping[str, Part]
    ports: dict[str, str] = field(default_factory=dict)
    bases: dict[str, str] = field(default_factory=dict)
    frames: list[dict[str, Any]] = field(default_factory=list)
    seats: dict[str, str] = field(default_factory=dict)
    closures: Names = field(default_factory=Names)
    _open: list[str] = field(default_factory=list)

    def body(self, instance: str, name: str) -> str:
        """A body of an instance."""
        return self.bases[instance] if name == BASE else self.bodies[f"{instance}.{name}"]

    def port(self, instance: str, name: str) -> str:
        """A port of an instance."""
        return self.ports.setdefault(f"{instance}.{name}", self.taken.new(instance, name))

    def joint_of(self, instance: str, body: int) -> dict[str, Any]:
        """Names of the joint of a body, by its number in the definition: coordinates, of a ball positions and rates."""
        found = [self.symbol(instance, name) for name in self.joints[instance].get(body, ())]
        for ball in self.parts[instance].topology.balls:
            if ball.body == body:
                return {"coordinate": [self.symbol(instance, name) for name in ball.positions], "velocities": found}
        return {"coordinate": found[0] if len(found) == 1 else found} if found else {}

    def symbol(self, instance: str, name: str) -> Any:
        """What a name in an expression of an instance stands for; of the tree itself without an instance."""
        whole = f"{instance}.{name}" if instance else name
        if whole not in self.bound:
            return self.symbols.get(whole, name)
        if whole in self._open or len(self._open) > 50:
            raise InvalidDocument.at("", "cycle", f"the binding of '{whole}' refers to itself")
        self._open.append(whole)
        found = self.expressions("", self.bound[whole], f"/parameters/{whole}")
        self._open.pop()
        return found

    def expressions(self, instance: str, given: Any, pointer: str) -> Any:
        """Numbers and expressions, however nested, with the names of the part. Raises InvalidDocument."""
        if isinstance(given, Mapping) and set(given) != {"value", "unit"}:
            return {key: self.expressions(instance, x, f"{pointer}/{key}") for key, x in given.items()}
        if isinstance(given, list | tuple):
            return [self.expressions(instance, x, f"{pointer}/{i}") for i, x in enumerate(given)]
        return renamed(given, lambda name: self.symbol(instance, name), pointer, lambda at: self.own(instance, at))

    def own(self, instance: str, at: str) -> str:
        """The body that a frame of an instance is; of the tree itself without an instance."""
        return self.frame(f"{instance}.{at}" if instance else at)

    def frame(self, at: str) -> str:
        """The body that a place of the tree is: of the world the interface, of a port a massless one."""
        if at == "world":
            return BASE
        instance, name = at.split(".")
        if name == BASE or f"{instance}.{name}" in self.bodies:
            return self.body(instance, name)
        # a port as a body, once: of the new part nothing but bodies and its own ports have names
        if at not in self.seats:
            plain = read_json(self.parts[instance].definition.canonical())
            port = next(each for each in plain["ports"] if each["name"] == name)
            placement = {"position": port.get("position", [0, 0, 0]), **port.get("rotation", {})}
            placed = self.expressions(instance, placement, f"/instances/{instance}/ports/{name}")
            self.seats[at] = self.add_frame(self.body(instance, port["body"]), placed, instance, name, "frame")
        return self.seats[at]

    def add_frame(self, parent: str, placement: Mapping[str, Any], *words: str) -> str:
        """A massless body that is fixed to another."""
        name = self.taken.new(*words)
        self.frames.append({"name": name, "parent": parent, "joint": {"type": "fixed", "placement": placement}})
        return name

    def new_frames(self) -> list[dict[str, Any]]:
        """Those that are not in the definition yet; from now on they are."""
        found, self.frames = self.frames, []
        return found

    def parameters(self, document: Mapping[str, Any]) -> dict[str, Any]:
        """The free parameters: all of instances, and those of the tree that something in the part depends on."""
        used = set(_names(document))
        return {
            self.symbols[name]: given for name, given in self.given.items() if "." in name or self.symbols[name] in used
        }

    def told(self) -> dict[str, str]:
        """Names in the tree to names in the part."""
        return {**self.symbols, **self.bodies, **self.ports}


def part_names(
    spec: TreeSpec, parts: Mapping[str, Part], free: tuple[str, ...], defaults: Mapping[str, Any]
) -> PartNames:
    """Names for all there is in a tree. Raises InvalidDocument for parameters that are not there, and for those without
    a value that are not asked for.
    """
    symbols, bodies = Names(), Names()
    tree = counted(read_json(spec.canonical()))
    parameters: dict[str, dict[str, Any]] = dict(tree.get("parameters", {}))
    inputs: dict[str, dict[str, Any]] = dict(tree.get("inputs", {}))
    called = {name: symbols.new(name) for name in (*parameters, *inputs)}
    bound: dict[str, Any] = {}
    frames: dict[str, str] = {}
    joints: dict[str, dict[int, list[str]]] = {}
    for instance in spec.instances:
        part, plain = parts[instance.name], counted(read_json(parts[instance.name].definition.canonical()))
        given = {f"{instance.name}.{name}": x for name, x in plain.get("parameters", {}).items()}
        bound |= {f"{instance.name}.{name}": x for name, x in instance.parameters.items()}
        inputs |= {f"{instance.name}.{name}": x for name, x in plain.get("inputs", {}).items()}
        joints[instance.name] = {}
        for joint in part.topology.joints:
            joints[instance.name].setdefault(joint.body, []).append(joint.coordinate)
        parameters |= given
        own = (
            *(joint.coordinate for joint in part.topology.joints),
            *(name for ball in part.topology.balls for name in ball.positions),
            *plain.get("parameters", ()),
            *plain.get("inputs", ()),
        )
        called |= {f"{instance.name}.{name}": symbols.new(instance.name, name) for name in own}
        frames |= {
            f"{instance.name}.{body.name}": bodies.new(instance.name, body.name) for body in part.definition.bodies
        }
    _free(parameters, bound, free, defaults)
    left = {name: x for name, x in parameters.items() if name not in bound}
    _require_values(left, free)
    shown = {called[name]: x for name, x in inputs.items()}
    return PartNames(
        {name: x for name, x in called.items() if name not in bound}, frames, bound, left, shown, joints, bodies, parts
    )


def _free(
    parameters: dict[str, dict[str, Any]], bound: dict[str, Any], free: tuple[str, ...], defaults: Mapping[str, Any]
) -> None:
    """Take the parameters that shall be free off what they are bound to, and give new defaults."""
    faults = []
    for field_name, names in (("free", free), ("defaults", defaults)):
        for k, name in enumerate(names):
            place = f"/{field_name}/{k if field_name == 'free' else name}"
            if name not in parameters:
                message = f"the tree has no parameter '{name[:160]}'{meant(name, parameters)}"
                faults.append(Fault(place, "unknown-parameter", message))
            elif field_name == "free" and name in bound:
                value = bound.pop(name)
                if any(True for _ in names_of(number_text(value))):
                    message = f"'{name}' is bound to '{number_text(value)[:80]}', which is no number, and so no default"
                    faults.append(Fault(place, "bound", message))
                else:
                    parameters[name] = {**parameters[name], "value": in_si(value)}
            elif field_name == "defaults" and name in bound:
                message = f"'{name}' is bound to '{number_text(bound[name])[:80]}': name it in 'free' as well"
                faults.append(Fault(place, "bound", message))
            elif field_name == "defaults":
                parameters[name] = {**parameters[name], "value": defaults[name]}
    if faults:
        raise InvalidDocument(faults)


def _require_values(left: Mapping[str, Mapping[str, Any]], free: tuple[str, ...]) -> None:
    """Raises InvalidDocument for parameters without a value that are not said to stay so."""
    faults = [
        Fault(
            f"/defaults/{name}",
            "unbound-name",
            f"'{name}' has no value: bind it in the tree, give it one in 'defaults', or name it in 'free'"
            " if whoever uses the part is to give it",
        )
        for name, given in left.items()
        if given.get("value") is None and name not in free
    ]
    if faults:
        raise InvalidDocument(faults)


def _names(given: Any) -> set[str]:
    """All names in the expressions of a document; words among them do no harm."""
    if isinstance(given, Mapping):
        return set().union(*(_names(x) for key, x in given.items() if key not in TEXTS))
    if isinstance(given, list | tuple):
        return set().union(*map(_names, given))
    return set(names_of(given)) if isinstance(given, str) else set()
