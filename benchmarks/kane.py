"""The same chains derived by SymPy's KanesMethod: the peer of derive.py."""

from __future__ import annotations

from typing import Any

from sympy import Matrix, count_ops, pi, symbols
from sympy.physics.mechanics import KanesMethod, Point, ReferenceFrame, RigidBody, dynamicsymbols, inertia

from benchmarks.chains import TENSOR


def derive_by_kane(rows: list[dict[str, Any]]) -> tuple[Any, Any]:
    """Mass matrix and forcing vector of a revolute chain with gravity along -z."""
    n = len(rows)
    q, u = dynamicsymbols(f"q1:{n + 1}"), dynamicsymbols(f"u1:{n + 1}")
    g = symbols("g")
    inertial = ReferenceFrame("N")
    origin = Point("O")
    origin.set_vel(inertial, 0)
    frame, point = inertial, origin
    bodies, forces = [], []
    for i, row in enumerate(rows, 1):
        before = frame.orientnew(f"B{i}", "Axis", (_value(row.get("theta", 0)), frame.x))
        after = before.orientnew(f"A{i}", "Axis", (q[i - 1] + _value(row.get("phi", 0)), before.z))
        after.set_ang_vel(frame, u[i - 1] * before.z)
        joint = point.locatenew(f"J{i}", _value(row.get("d", 0)) * frame.x + _value(row.get("tau", 0)) * after.z)
        velocity = point.vel(inertial) + frame.ang_vel_in(inertial).cross(_value(row.get("d", 0)) * frame.x)
        joint.set_vel(inertial, velocity + after.ang_vel_in(inertial).cross(_value(row.get("tau", 0)) * after.z))
        x, y, z = symbols(f"cx{i} cy{i} cz{i}")
        centre = joint.locatenew(f"C{i}", x * after.x + y * after.y + z * after.z)
        centre.v2pt_theory(joint, inertial, after)
        xx, yy, zz, xy, xz, yz = symbols([f"I{e}{i}" for e in TENSOR])
        tensor = inertia(after, xx, yy, zz, xy, yz, xz)
        bodies.append(RigidBody(f"L{i}", centre, after, symbols(f"m{i}"), (tensor, centre)))
        forces.append((centre, -symbols(f"m{i}") * g * inertial.z))
        frame, point = after, joint
    kinematic = [a.diff() - b for a, b in zip(q, u, strict=True)]
    method = KanesMethod(inertial, q_ind=q, u_ind=u, kd_eqs=kinematic)
    method.kanes_equations(bodies, forces)
    return method.mass_matrix, method.forcing


def _value(text: Any) -> Any:
    return pi / 2 if text == "pi/2" else symbols(text) if isinstance(text, str) else text


def operations(*matrices: Matrix) -> int:
    """SymPy's operation count of all entries."""
    return int(sum(count_ops(entry) for matrix in matrices for entry in matrix))
