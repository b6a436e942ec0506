"""A tree as a part: one definition out of those of its instances, with which it can be mounted in other trees.

What was ``arm.q1`` in the tree is ``arm_q1`` in the part. What hangs on the world hangs on the interface ``base``;
gravity is left to the tree that the part comes into. Parameters that are bound keep what they are bound to; free ones
are parameters of the part, with their defaults.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from substructures.documents import read_json
from substructures.errors import Fault, InvalidDocument, among
from substructures.part.definition import Definition
from substructures.part.parameters import counted
from substructures.part.part import Part
from substructures.part.topology import BASE
from substructures.tree.document import Instance, TreeSpec, require_ungiven
from substructures.tree.given.ties import require_untied
from substructures.tree.publishing.published_loads import closure_of_part, frames_of_part, load_of_part
from substructures.tree.publishing.published_names import PartNames, part_names

#: fields of bodies, ports and loads that are names or words, not numbers
WORDS = frozenset(("name", "parent", "type", "coordinate", "velocities", "about", "body", "frame", "axes"))


@dataclass(frozen=True, slots=True)
class Publication:
    """What the part shall be.

    ``about``: name, title, description, tags, license, source; ``ports``: places of the tree by name of the port, all
    ports of all instances where it is None; ``free``: parameters that are bound to a number, which becomes their
    default, or without a value, that shall be parameters of the part; ``defaults``: new defaults of free ones.
    """

    about: Mapping[str, Any]
    ports: Mapping[str, str] | None = None
    free: tuple[str, ...] = ()
    defaults: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Published:
    """The definition, and what the coordinates, parameters, inputs, bodies and ports of the tree are called in it;
    ``instances``: of the tree, hosts first; ``given``: all that is known of names.
    """

    definition: Definition
    names: Mapping[str, str]
    instances: tuple[Instance, ...]
    given: PartNames


def published(spec: TreeSpec, parts: Mapping[str, Part], wanted: Publication) -> Published:
    """The definition of a tree as a part; ``parts``: by name of the instance.

    Raises InvalidDocument for names of ports, frames and parameters that are not there, and parameters without a value.
    """
    _require_tree(spec)
    names = part_names(spec, parts, wanted.free, wanted.defaults)
    document: dict[str, Any] = {**wanted.about, "bodies": [], "loads": [], "relations": [], "poses": {}, "left_out": []}
    for instance in _hosts_first(spec):
        document["bodies"] += _seat(instance, names)
        own = _plain(parts[instance.name])
        # parents first, so that the coordinates have the order that they have in the tree
        order = parts[instance.name].topology.order
        document["bodies"] += [_body(names, instance.name, own["bodies"][k], k) for k in order]
        loads = zip(parts[instance.name].definition.loads, own.get("loads", ()), strict=True)
        document["loads"] += [
            _load(names, instance.name, load.frames, given, f"/instances/{instance.name}/loads/{k}")
            for k, (load, given) in enumerate(loads)
        ]
        document["relations"] += [
            _relation(names, instance.name, each, f"/instances/{instance.name}/relations/{k}")
            for k, each in enumerate(own.get("relations", ()))
        ]
        document["left_out"] += [_left_out(names, instance.name, each) for each in own.get("left_out", ())]
        for pose, given in own.get("poses", {}).items():
            moved = {names.symbol(instance.name, name): value for name, value in given.items()}
            document["poses"].setdefault(pose, {}).update(moved)
    document["ports"] = list(_ports(parts, names, wanted.ports))
    for load in spec.loads:
        document["loads"].append(load_of_part(load, names))
    # in this order: closures may need frames of ports, and parameters are those that all of it names
    document["closures"] = list(_closures(spec, parts, names))
    document |= _reduction(spec, parts, names)
    document["bodies"] += names.frames
    document["parameters"], document["inputs"] = names.parameters(document), names.inputs
    definition = Definition.read({name: x for name, x in document.items() if x or name == "bodies"})
    return Published(definition, names.told(), tuple(_hosts_first(spec)), names)


def _require_tree(spec: TreeSpec) -> None:
    """Raises InvalidDocument for what no part can be."""
    if not spec.instances:
        raise InvalidDocument.at("", "empty-tree", "a tree without instances is no part")
    require_untied(spec, "publish")
    require_ungiven(spec, "publish the tree without 'driven', and drive the tree that it comes into")


def _hosts_first(spec: TreeSpec) -> Iterator[Instance]:
    """The instances in the order of the coordinates of the tree."""
    waiting, done = list(spec.instances), {"world"}
    while waiting:
        # as tree.assembly orders them: the first of the document whose host is there
        ready = next(each for each in waiting if each.at.partition(".")[0] in done)
        waiting.remove(ready)
        done.add(ready.name)
        yield ready


def _plain(part: Part) -> dict[str, Any]:
    plain: dict[str, Any] = counted(read_json(part.definition.canonical()))
    return plain


def _seat(instance: Instance, names: PartNames) -> list[dict[str, Any]]:
    """The massless bodies on which an instance hangs: its port of the host, its placement there, as far as they turn
    or shift anything. Notes which body its interface is.
    """
    seat = names.frame(instance.at)
    placement = instance.placement.model_dump(exclude_defaults=True)
    if not placement:
        names.bases[instance.name] = seat
        return names.new_frames()
    placed = names.expressions("", placement, f"/instances/{instance.name}/placement")
    names.bases[instance.name] = names.add_frame(seat, placed, instance.name, "base")
    return names.new_frames()


def _body(names: PartNames, instance: str, body: Mapping[str, Any], k: int) -> dict[str, Any]:
    """A body of an instance, with the coordinates of its joint named."""
    moved = _moved(names, instance, body, f"/instances/{instance}/bodies/{k}")
    moved["name"], moved["parent"] = names.body(instance, body["name"]), names.body(instance, body["parent"])
    joint = {name: x for name, x in moved["joint"].items() if name not in ("coordinate", "velocities")}
    return moved | {"joint": joint | names.joint_of(instance, k)}


def _relation(names: PartNames, instance: str, given: Mapping[str, Any], pointer: str) -> dict[str, Any]:
    """A relation between joints of an instance, in the coordinates of the part."""
    ends = {end: names.symbol(instance, given[end]) for end in ("coordinate", "of")}
    factors = {x: names.expressions(instance, given[x], f"{pointer}/{x}") for x in given if x not in ends}
    return {**ends, **factors}


def _left_out(names: PartNames, instance: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """What the source of an instance says beside its equations, in the coordinates of the part."""
    moved = dict(given)
    if "relation" in given:
        relation = given["relation"]
        ends = {end: names.symbol(instance, relation[end]) for end in ("coordinate", "of")}
        moved["relation"] = {**relation, **ends}
    return moved


def _closures(spec: TreeSpec, parts: Mapping[str, Part], names: PartNames) -> Iterator[dict[str, Any]]:
    """The closures of the tree, then those of its instances, in the order of the model."""
    for k, closure in enumerate(spec.closures):
        yield closure_of_part(closure, "", names, f"/closures/{k}")
    for instance in _hosts_first(spec):
        for k, own in enumerate(parts[instance.name].definition.closures):
            yield closure_of_part(own, instance.name, names, f"/instances/{instance.name}/closures/{k}")


def _reduction(spec: TreeSpec, parts: Mapping[str, Part], names: PartNames) -> dict[str, Any]:
    """Independent coordinates with their ranges, where all loops are those of parts that name them, and starts."""
    closed = [part.definition for part in parts.values() if part.definition.closures]
    is_said = closed and all(definition.independent for definition in closed) and not spec.closures
    found: dict[str, Any] = {"independent": [], "start": {}, "ranges": {}}
    for name, part in ((instance.name, parts[instance.name]) for instance in _hosts_first(spec)):
        given, own = _plain(part), part.definition.independent if part.definition.closures else part.coordinates
        found["independent"] += [names.symbol(name, c) for c in part.coordinates if c in own and is_said]
        for which in ("start", "ranges") if is_said else ("start",):
            found[which] |= {names.symbol(name, c): x for c, x in given.get(which, {}).items()}
    return found


def _load(
    names: PartNames, instance: str, frames: Collection[str], given: Mapping[str, Any], pointer: str
) -> dict[str, Any]:
    """A load with its names as those of the part; ``frames``: its fields that name frames."""
    # with the frame that it acts on opposite, also where that is the interface, which is left out
    whole = {"from": BASE, **given} if "from" in frames else given
    moved: dict[str, Any] = _moved(names, instance, {x: whole[x] for x in whole if x not in frames}, pointer)
    return moved | {x: frames_of_part(whole[x], instance, names, f"{pointer}/{x}") for x in whole if x in frames}


def _moved(names: PartNames, instance: str, given: Any, pointer: str) -> Any:
    """A body or load with its names and expressions as those of the part."""
    if isinstance(given, Mapping) and set(given) != {"value", "unit"}:
        found: dict[str, Any] = {}
        for key, value in given.items():
            if key == "body":
                found[key] = names.body(instance, value)
            elif key == "coordinate" and isinstance(value, str):
                found[key] = names.symbol(instance, value) if given.get("type") in ("joint", "friction") else value
            else:
                found[key] = value if key in WORDS else _moved(names, instance, value, f"{pointer}/{key}")
        return found
    if isinstance(given, list):
        return [_moved(names, instance, value, f"{pointer}/{i}") for i, value in enumerate(given)]
    return names.expressions(instance, given, pointer)


def _ports(parts: Mapping[str, Part], names: PartNames, wanted: Mapping[str, str] | None) -> Iterator[dict[str, Any]]:
    """Those that are wanted, or all ports of all instances."""
    places = {f"{name}.{port}": names.port(name, port) for name, part in parts.items() for port in part.ports}
    if wanted is None:
        chosen = {port: place for place, port in places.items()}
    else:
        _require_places(parts, wanted)
        chosen = dict(wanted)
        names.ports.clear()
    for port, place in chosen.items():
        instance, frame = place.split(".")
        names.ports[place] = port
        given = next((p for p in _plain(parts[instance]).get("ports", ()) if p["name"] == frame), {"body": frame})
        moved = _moved(names, instance, {x: y for x, y in given.items() if x != "name"}, f"/ports/{port}")
        yield {"name": port, **moved}


def _require_places(parts: Mapping[str, Part], wanted: Mapping[str, str]) -> None:
    """Raises InvalidDocument for places that the tree does not have."""
    known = [f"{name}.{frame}" for name, part in parts.items() for frame in part.frames]
    faults = [
        Fault(f"/ports/{port}", "unknown-port", f"the tree has no place '{place[:160]}'{among(place, known)}")
        for port, place in wanted.items()
        if place not in known
    ]
    if faults:
        raise InvalidDocument(faults)
