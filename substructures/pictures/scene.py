"""What there is to draw of a tree, as plain data: frames, joints, bodies with their inertia, loads, closures, poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import array, program
from substructures.part.definition import Body, PartClosure
from substructures.part.part import Part
from substructures.part.poses import HOME
from substructures.part.topology import BASE
from substructures.pictures.pose import kinematics, poses
from substructures.quantities.numbers.defaults import default_number
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

INERTIA = ("xx", "yy", "zz", "xy", "xz", "yz")
#: place of the world where frames are numbers
WORLD = -1


def scene(spec: TreeSpec, parts: Mapping[str, Part], model: Model) -> dict[str, Any]:
    """Plain data; frames are numbers in the order of the kinematic outputs, -1 is the world. Numbers are those of the
    default values of parameters, 1 where there is none, in SI.

    ``frames``: ``name``, ``parent``, ``instance``, ``kind`` (base, body, port); ``joints``, by coordinate: ``type`` of
    the whole joint, ``slides``, the ``frame`` that it moves, its ``axis`` there (of a joint with several axes at home),
    ``limits`` or None, ``unit``, ``home`` (0 of rates); ``bodies``: ``frame``, ``mass`` [kg], ``centre`` [m] in the
    frame, principal ``moments`` about it [kg m^2] and their ``axes`` in columns; ``loads`` and ``closures``: their
    ``ends``, each a frame and a point in it [m]; ``gravity`` [m/s^2]; ``sphere`` around all at home; ``poses`` by name,
    each a number for each of ``positions``.
    """
    place = {name: i for i, name in enumerate(model.frames)}
    numbers = _Numbers(assemble(spec, parts), model, place)
    limits = numbers.limits()
    shown = poses(spec, parts, model, limits)
    at_home = kinematics(model, shown[HOME])
    bodies = [each for instance in spec.instances for each in numbers.bodies(instance.name, parts[instance.name])]
    loads = [load for instance in spec.instances for load in numbers.loads(instance.name, parts[instance.name])]
    return {
        "frames": list(_frames(spec, parts, place)),
        "joints": list(_joints(parts, model, at_home, limits, shown[HOME], place)),
        "bodies": bodies,
        "loads": [*loads, *numbers.loads("", None)],
        "closures": list(numbers.closures()),
        "gravity": numbers.values(spec.gravity, ""),
        "sphere": _sphere(bodies, at_home),
        "positions": list(model.positions),
        "poses": shown,
    }


def _frames(spec: TreeSpec, parts: Mapping[str, Part], place: Mapping[str, int]) -> Iterator[dict[str, Any]]:
    told: dict[str, dict[str, Any]] = {}
    for instance in spec.instances:
        name, definition = instance.name, parts[instance.name].definition
        told[f"{name}.{BASE}"] = {"parent": place.get(instance.at, WORLD), "kind": "base"}
        for body in definition.bodies:
            told[f"{name}.{body.name}"] = {"parent": place[f"{name}.{body.parent}"], "kind": "body"}
        for port in definition.ports:
            told[f"{name}.{port.name}"] = {"parent": place[f"{name}.{port.body}"], "kind": "port"}
    for name in place:
        yield {"name": name, "instance": name.partition(".")[0], **told[name]}


def _joints(
    parts: Mapping[str, Part],
    model: Model,
    at_home: Mapping[str, Array],
    limits: Mapping[int, tuple[float, float]],
    home: Sequence[float],
    place: Mapping[str, int],
) -> Iterator[dict[str, Any]]:
    entries = {f"{name}.{j.coordinate}": (name, j) for name, part in parts.items() for j in part.topology.joints}
    at = dict(zip(model.positions, home, strict=True))
    for a, coordinate in enumerate(model.coordinates):
        instance, entry = entries[coordinate]
        body = parts[instance].definition.bodies[entry.body]
        frame = place[f"{instance}.{body.name}"]
        # in axes of the frame: U_a of a sliding, Omega_a of a turning joint
        axis = at_home["U" if entry.s else "Omega"][frame, a]
        yield {
            "coordinate": coordinate,
            "type": body.joint.type,
            "slides": bool(entry.s),
            "frame": frame,
            "axis": axis.tolist(),
            "limits": list(limits[a]) if a in limits else None,
            "unit": "m" if entry.s else "rad",
            "home": at.get(coordinate, 0.0),
        }


@dataclass
class _Numbers:
    """Numbers of documents at the default values of parameters."""

    assembly: Assembly
    model: Model
    place: Mapping[str, int]

    @cached_property
    def given(self) -> dict[str, float]:
        """The defaults, 1 where there is none."""
        found = self.model.parameters.items()
        return {name: 1.0 if p["value"] is None else default_number(p["value"]) for name, p in found}

    def values(self, given: Sequence[Any], instance: str) -> list[float]:
        """Of numbers and expressions with names of an instance, of the tree itself without one; 0 of what is none."""
        known, prefix = self.assembly.reading.bound, f"{instance}." if instance else ""
        faults = list(self.assembly.scope.faults)
        read = [self.assembly.scope.read(x, "", lambda name: known.lookup(prefix + name)) for x in given]
        self.assembly.scope.faults[:] = faults  # points of loads may depend on more than parameters
        return self._evaluated(read)

    def _evaluated(self, read: Sequence[Expr]) -> list[float]:
        scope = self.assembly.scope
        found = program(scope.graph, {"x": array((len(read),), lambda i: read[i])}, scope.symbols)
        values = {**dict.fromkeys((s.name for s in found.symbols), 0.0), **self.given}
        return [float(x) for x in np.nan_to_num(interpret(found, values)["x"])]

    def limits(self) -> dict[int, tuple[float, float]]:
        """Those that are numbers, the lower one first."""
        places = list(self.assembly.limits)
        ends = self._evaluated([x for a in places for x in self.assembly.limits[a]])
        pairs = zip(places, ends[::2], ends[1::2], strict=True)
        return {a: (low, high) for a, low, high in pairs if low < high and np.isfinite([low, high]).all()}

    def bodies(self, instance: str, part: Part) -> Iterator[dict[str, Any]]:
        """Those with a mass or an inertia."""
        for body in part.definition.bodies:
            mass, *numbers = self.values([body.mass, *body.com, *(getattr(body.inertia, x) for x in INERTIA)], instance)
            told = principal(body, mass, np.array(numbers[:3]), numbers[3:])
            if told is not None:
                yield {"frame": self.place[f"{instance}.{body.name}"], "name": f"{instance}.{body.name}", **told}

    def loads(self, instance: str, part: Part | None) -> Iterator[dict[str, Any]]:
        """Those between frames, of an instance or of the tree."""
        prefix = f"{instance}." if instance else ""
        for i, load in enumerate(self.assembly.reading.spec.loads if part is None else part.definition.loads):
            ends = [self._end(f"{prefix}{end.frame}", end.at, instance) for end in load.ends("")]
            if ends:
                plain = load.__dict__
                name = f"{prefix}{plain.get('name', i + 1)}"
                yield {"name": name, "type": str(plain["type"]), "is_elastic": load.is_elastic, "ends": ends}

    def closures(self) -> Iterator[dict[str, Any]]:
        """Cut joints, with the place of the joint at both ends."""
        reading = self.assembly.reading
        some: list[tuple[str, Sequence[PartClosure]]] = [("", reading.spec.closures)]
        some += [(name, reading.parts[name].definition.closures) for name in reading.place]
        for instance, closures in some:
            prefix = f"{instance}." if instance else ""
            for each in closures:
                end = self._end(prefix + each.to, each.placement.position, instance)
                ends = [self._end(prefix + each.from_, (), instance), end]
                yield {"name": prefix + each.name, "type": each.type, "ends": ends}

    def _end(self, frame: str, at: Sequence[Any], instance: str) -> dict[str, Any]:
        return {"frame": self.place.get(frame, WORLD), "at": self.values(at or (0, 0, 0), instance)}


def principal(body: Body, mass: float, centre: Array, inertia: Sequence[float]) -> dict[str, Any] | None:
    """Mass, mass centre, principal moments about it and their axes; None of a body that has no inertia at all."""
    xx, yy, zz, xy, xz, yz = inertia
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    if body.inertia.about == "origin":
        # J = J_O - m (c.c 1 - c c^T)
        J = J - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    if not np.isfinite([mass, *centre, *J.ravel()]).all() or not (mass > 0 or J.any()):
        return None
    moments, axes = np.linalg.eigh(J)
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    return {"mass": mass, "centre": centre.tolist(), "moments": moments.tolist(), "axes": axes.tolist()}


def half_axes(body: Mapping[str, Any]) -> Array:
    """Of the ellipsoid of even density with the mass and the moments of a body: a_i = sqrt(5 s_i / m) [m] with Binet's
    s_i = (J_j + J_k - J_i) / 2; 0 without a mass.
    """
    J, mass = np.array(body["moments"]), float(body["mass"])
    s = np.maximum(J.sum() / 2 - J, 0.0)
    return np.sqrt(5 * s / mass) if mass > 0 else np.zeros(3)


def _sphere(bodies: Sequence[Mapping[str, Any]], shown: Mapping[str, Array]) -> dict[str, Any]:
    """Around frames and ellipsoids."""
    places, rotations = shown["position"], shown["rotation"]
    points = [(p, 0.0) for p in places]
    for body in bodies:
        k = body["frame"]
        points.append((places[k] + rotations[k] @ np.array(body["centre"]), float(half_axes(body).max())))
    if not points:
        return {"centre": [0.0, 0.0, 0.0], "radius": 0.0}
    low, high = (np.array([p + sign * r for p, r in points]) for sign in (-1, 1))
    middle = (low.min(axis=0) + high.max(axis=0)) / 2
    radius = max(float(np.linalg.norm(p - middle)) + r for p, r in points)
    return {"centre": middle.tolist(), "radius": radius}
