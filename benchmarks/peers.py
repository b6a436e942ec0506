"""A tree with numbers for all parameters as a Pinocchio model with the same coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

from substructures import Definition, TreeSpec
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Symbol, array, program
from substructures.part.topology import CHAINS

Array = Any
UNIT = {
    1: (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
    0: (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
}


def number(given: Any, names: Mapping[str, float]) -> float:
    """An expression of a definition."""
    if given is None or not isinstance(given, str):
        return float(given or 0)
    graph = Graph()
    parsed = parse(graph, given, lambda name: graph.symbol(name) if name in names else None)
    symbols = {name: Symbol(name, "parameter") for name in names}
    return float(interpret(program(graph, {"x": array((), lambda: parsed)}, symbols), dict(names))["x"])


@dataclass
class Peer:
    """The model; ``order[a]``: index in it of our coordinate a."""

    model: pin.Model = field(default_factory=pin.Model)
    frames: dict[str, tuple[int, pin.SE3]] = field(default_factory=dict)
    order: list[int] = field(default_factory=list)

    @classmethod
    def of(cls, spec: TreeSpec, library: Mapping[str, Definition], values: Mapping[str, float]) -> Peer:
        """All instances; ``values`` of the parameters ``instance.name``; gravity 9.81 along -z."""
        peer = cls()
        peer.model.gravity.linear = np.array([0, 0, -9.81])
        for instance in spec.instances:
            definition = library[str(instance.substructure)]
            names = {
                p: values[f"{instance.name}.{p}"] for p in definition.parameters if f"{instance.name}.{p}" in values
            }
            base = (0, pin.SE3.Identity()) if instance.at == "world" else peer.frames[instance.at]
            peer.frames[f"{instance.name}.base"] = base
            plain = definition.model_dump()
            for body in plain["bodies"]:
                peer._add(instance.name, body, names)
            for port in plain["ports"]:
                joint, place = peer.frames[f"{instance.name}.{port['body']}"]
                at = np.array([number(x, names) for x in port["position"]])
                peer.frames[f"{instance.name}.{port['name']}"] = joint, place * pin.SE3(np.eye(3), at)
        return peer

    def _add(self, instance: str, body: dict[str, Any], names: Mapping[str, float]) -> None:
        joint = body["joint"]
        parent, place = self.frames[f"{instance}.{body['parent']}"]
        place = place * _seat(joint, names)
        for s, axis in CHAINS[joint["type"]]:
            if joint.get("axis"):
                axis = [number(x, names) for x in joint["axis"]].index(1.0)
            parent = self.model.addJoint(parent, UNIT[s][axis](), place, f"joint{self.model.njoints}")
            self.order.append(self.model.joints[parent].idx_v)
            place = pin.SE3.Identity()
        self.frames[f"{instance}.{body['name']}"] = parent, place
        m, com = number(body["mass"], names), np.array([number(x, names) for x in body["com"]])
        xx, yy, zz, xy, xz, yz = (number(body["inertia"][e], names) for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        self.model.appendBodyToJoint(parent, pin.Inertia(m, com, tensor), place)


def _seat(joint: Mapping[str, Any], names: Mapping[str, float]) -> pin.SE3:
    """From the parent's frame to the joint at zero."""
    if joint.get("placement"):
        where = joint["placement"]
        turned = pin.rpy.rpyToMatrix(*(number(x, names) for x in where["rpy"]))
        return pin.SE3(turned, np.array([number(x, names) for x in where["position"]]))
    psi, theta, d, sigma, phi, tau = (number(joint[x], names) for x in ("psi", "theta", "d", "sigma", "phi", "tau"))
    screws = [("z", psi, sigma), ("x", theta, d), ("z", phi, tau)]
    result = pin.SE3.Identity()
    for axis, angle, shift in screws:
        e = np.eye(3)["xyz".index(axis)]
        result = result * pin.SE3(pin.utils.rotate(axis, angle), shift * e)
    return result
