"""Verification of a coupled tree: the parts' joint rows in numbers, put together, against the coupled formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, array, program
from substructures.mechanics.direct_form import NumericJoint, direct_form
from substructures.mechanics.kinematics import INTERFACE
from substructures.part.certificate import STATES, TOLERANCE, compare, finite_comparison, random_values
from substructures.part.physics import constants
from substructures.tree.assembly import Assembly
from substructures.tree.mounted_part import WORLD, MountedPart

ROWS = (
    *("E", "Z", "tau", "armature", "inertia.m", "inertia.s", "inertia.J", "base.m", "base.s", "base.J"),
    *("frame.E", "frame.position"),
)


@dataclass(frozen=True)
class Seat:
    """Where an interface frame is: joint (or -1), E from its frame, vector from O of the joint, in its frame."""

    joint: int
    E: Array
    z: Array


def certify_tree(assembly: Assembly, names: Sequence[str], result: Program, seconds: float) -> dict[str, Any]:
    """Compare metric, Christoffel symbols, gravity and velocity forces with the direct form at random states.

    ``names``: the coordinates of the tree.
    Raises VerificationFailed.
    """
    start = perf_counter()
    certificate: dict[str, Any] = {"states": STATES, "tolerance": TOLERANCE}
    if names:
        values = random_values(assembly.scope.symbols)
        defaults = constants(assembly.scope, {name: p["value"] for name, p in assembly.parameters.items()})
        certificate["direct_form"] = finite_comparison(
            lambda some: _comparison(assembly, names, result, some), values, defaults
        )
    certificate["seconds"] = {"couple": round(seconds, 6), "verify": round(perf_counter() - start, 6)}
    return certificate


def _comparison(
    assembly: Assembly, names: Sequence[str], result: Program, values: Mapping[str, Array]
) -> dict[str, Any]:
    joints, armature = _numeric_tree(assembly, values)
    form = direct_form(joints, _gravity(assembly, values))
    # the direct form knows bodies only: g_cc += armature_c
    form.metric[...] += armature[..., None] * np.eye(len(joints))
    rates = np.stack([values[f"{name}'"] for name in names], axis=-1)
    # bias_a = Gamma_abc q'^b q'^c
    bias = np.einsum("nabc,nb,nc->na", form.christoffel, rates, rates)
    expected = {"metric": form.metric, "christoffel": form.christoffel, "gravity": form.gravity, "bias": bias}
    return compare(interpret(result, values, list(expected)), expected)


def _gravity(assembly: Assembly, values: Mapping[str, Array]) -> Array:
    p = program(assembly.scope.graph, {"g": array((3,), lambda i: assembly.gravity[i])}, assembly.scope.symbols)
    return np.broadcast_to(interpret(p, values)["g"], (STATES, 3))


def _numeric_tree(assembly: Assembly, values: Mapping[str, Array]) -> tuple[list[NumericJoint], Array]:
    joints: list[NumericJoint] = []
    armature = []
    seats: list[Seat] = []
    rows: list[dict[str, Array]] = []
    for m in assembly.mounted:
        x = _part_rows(assembly, m, values)
        seat = _seat(assembly, m, seats, rows, joints, values)
        seats.append(seat)
        rows.append(x)
        if seat.joint >= 0:
            joints[seat.joint] = _with_base(joints[seat.joint], seat, x)
        for c, j in enumerate(m.part.topology.joints):
            inertia = (x["inertia.m"][:, c], x["inertia.s"][:, c], x["inertia.J"][:, c])
            E, Z, parent = x["E"][:, c], x["Z"][:, c], m.first + j.parent
            if j.parent == INTERFACE:
                # from the joint under the interface: Z = z_I + E_I^T Z_c,   E = E_c E_I
                Z, E, parent = seat.z + np.einsum("nij,ni->nj", seat.E, Z), E @ seat.E, seat.joint
            joints.append(NumericJoint(parent, j.s, E, Z, x["tau"][:, c], *inertia))
            armature.append(x["armature"][:, c])
    return joints, np.stack(armature, axis=1) if armature else np.zeros((STATES, 0))


def _part_rows(assembly: Assembly, m: MountedPart, values: Mapping[str, Array]) -> dict[str, Array]:
    """Joint rows, inertias and frames of a part from its own stored program, with the bound values of its symbols."""
    graph, symbols = assembly.scope.graph, assembly.scope.symbols
    bound = program(graph, {s: array((), lambda e=e: e) for s, e in m.bindings.items()}, symbols)
    numbers: dict[str, Any] = dict(interpret(bound, values))
    numbers |= {s.name: np.zeros(STATES) for s in m.part.program.symbols if s.kind == "inertia"}
    numbers["_batch"] = np.zeros(STATES)
    return interpret(m.part.program, numbers, ROWS)


def _placement(assembly: Assembly, m: MountedPart, values: Mapping[str, Array]) -> tuple[Array, Array]:
    outputs = {"E": array((3, 3), lambda i, j: m.E[i][j]), "z": array((3,), lambda i: m.position[i])}
    x = interpret(program(assembly.scope.graph, outputs, assembly.scope.symbols), values)
    return np.broadcast_to(x["E"], (STATES, 3, 3)), np.broadcast_to(x["z"], (STATES, 3))


def _seat(
    assembly: Assembly,
    m: MountedPart,
    seats: list[Seat],
    rows: list[dict[str, Array]],
    joints: list[NumericJoint],
    values: Mapping[str, Array],
) -> Seat:
    E, z = _placement(assembly, m, values)
    if m.host == WORLD:
        return Seat(-1, E, z)
    host, x = assembly.mounted[m.host], rows[m.host]
    E_f, z_f = x["frame.E"][:, m.frame], x["frame.position"][:, m.frame]
    # in the body frame of the carrier: E E_f,   z_f + E_f^T z
    E, z = E @ E_f, z_f + np.einsum("nij,ni->nj", E_f, z)
    carrier = host.part.frame_carriers[m.frame]
    if carrier == INTERFACE:
        seat = seats[m.host]
        return Seat(seat.joint, E @ seat.E, seat.z + np.einsum("nij,ni->nj", seat.E, z))
    # from O of the carrier: + tau e3
    z = z.copy()
    z[:, 2] += joints[host.first + carrier].tau
    return Seat(host.first + carrier, E, z)


def _with_base(joint: NumericJoint, seat: Seat, x: Mapping[str, Array]) -> NumericJoint:
    """The joint's body with the masses fixed to an interface frame added, about the body frame origin."""
    # (m, s, J) about I in its axes -> E^T s + m z, E^T J E + s z^T + z s^T + m z z^T about the body frame origin
    z = seat.z.copy()
    z[:, 2] -= joint.tau
    m = x["base.m"]
    s = np.einsum("nij,ni->nj", seat.E, x["base.s"])
    J = np.swapaxes(seat.E, 1, 2) @ x["base.J"] @ seat.E
    cross = s[:, :, None] * z[:, None, :]
    J = J + cross + np.swapaxes(cross, 1, 2) + m[:, None, None] * z[:, :, None] * z[:, None, :]
    return replace(joint, m=joint.m + m, sm=joint.sm + s + m[:, None] * z, J=joint.J + J)
