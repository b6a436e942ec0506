"""Closures of loops as formulas: residuals, Jacobian and acceleration terms from U and Omega alone.

A closure equates a frame A (``from``) and a frame B (``to``) as far as its joint demands. Where the joint has an
``axis``, A and B are these frames turned by one constant rotation that makes it the third axis. With everything in the
axes of A, d = r_B - r_A, M = R_A R_B^T (components in B -> components in A, columns m_j = axes of B) and the relative
partial velocities of coordinate a

    u_a = M U_Ba - U_Aa - Omega_Aa x d        w_a = M Omega_Ba - Omega_Aa

the rows are

=========  ===================================  =================  =========================================
row        residual phi                         G_a = dphi/dq^a    its multiplier is, on B, in the axes of A
=========  ===================================  =================  =========================================
x, y, z    d_i [m]                              (u_a)_i            a force along axis i [N]
length     (d . d - L^2) / (2 L) [m]            d . u_a / L        a force along d (pushing) [N]
rx ry rz   -m_3 . e_2, m_3 . e_1, m_1 . e_2 [1] w_a . (m_j x e_i)  a moment about axis 1, 2, 3 [N m]
cross      m_2 . e_3 [1]                        w_a . (m_2 x e_3)  a moment across both axes [N m]
=========  ===================================  =================  =========================================

The acceleration terms G' q' are the second time derivatives of phi at q'' = 0: cross products of the motions of A and B
(notation.md, sections 3 and 10). With them g q'' + Gamma q'q' = Q + G^T lambda and G q'' + G' q' = 0.

========================  =====  ====================================================================
output                    shape  meaning (m rows of all closures in order)
========================  =====  ====================================================================
closure.residual          m      phi
closure.jacobian          m n    G
closure.acceleration      m      G' q'
closure.direction         m 3    force or moment on B of a unit multiplier, in the axes of ``from``
closure.alignment         m      m_j . e_j of the axes that a row makes parallel: 1 when closed, -1 when upside down;
                                 0 for all other rows
========================  =====  ====================================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from substructures.expr.graph import Expr
from substructures.expr.program import Formulas
from substructures.mechanics.cut_joints import ALIGNED, PLACE, TURNS
from substructures.mechanics.kinematics import Columns, Pose, Twist, from_body
from substructures.mechanics.linear3 import (
    IDENTITY,
    ZERO,
    Matrix,
    Scalar,
    Vector,
    add,
    apply,
    cross,
    dot,
    multiply,
    scale,
    sub,
    transpose,
)
from substructures.mechanics.newton_euler import BodyMotion
from substructures.tree.cuts import ClosureEnd, Cut
from substructures.tree.inverse_dynamics import Motions, body_motions
from substructures.tree.mounted_part import WORLD, PlacedPart


@dataclass(frozen=True)
class _Frame:
    """Pose in the world; columns and motion at q'' = 0 in the axes of the frame."""

    pose: Pose
    columns: Columns
    motion: BodyMotion


@dataclass(frozen=True)
class _Relative:
    """Of B with respect to A, in the axes of A: d, M^T (its rows are the axes of B) and partial velocities; rates."""

    d: Vector
    axes: Matrix
    twists: Mapping[int, Twist]
    v: Vector
    w: Vector
    dv: Vector
    dw: Vector


def closure_formulas(placed: Sequence[PlacedPart], cuts: Sequence[Cut], rates: Sequence[Scalar]) -> dict[str, Formulas]:
    """The outputs of the table above; ``rates``: the velocities of all coordinates."""
    motions = body_motions(placed, rates)
    entries: dict[str, dict[tuple[int, ...], Scalar]] = {n: {} for n in ("residual", "jacobian", "acceleration")}
    directions: dict[tuple[int, ...], Scalar] = {}
    alignment: dict[tuple[int, ...], Scalar] = {}
    k = 0
    for cut in cuts:
        frames = [_frame(placed, motions, end) for end in (cut.start, cut.end)]
        relative = _relative(frames[0], frames[1], rates)
        for name in cut.rows.rows:
            residual, direction, columns, acceleration = _row(name, relative, cut.length)
            entries["residual"][(k,)] = residual
            entries["jacobian"] |= {(k, a): x for a, x in columns.items()}
            entries["acceleration"][(k,)] = acceleration
            # from the axes of A, turned to the joint axis, to those of the frame ``from``
            shown = apply(transpose(cut.start.E), direction)
            directions |= {(k, i): shown[i] for i in range(3)}
            alignment[(k,)] = relative.axes[ALIGNED[name]][ALIGNED[name]] if name in ALIGNED else 0
            k += 1
    shapes = {"residual": (k,), "jacobian": (k, len(rates)), "acceleration": (k,)}
    outputs = {f"closure.{name}": Formulas(shapes[name], some) for name, some in entries.items()}
    return outputs | {"closure.direction": Formulas((k, 3), directions), "closure.alignment": Formulas((k,), alignment)}


def _frame(placed: Sequence[PlacedPart], motions: Sequence[Motions], end: ClosureEnd) -> _Frame:
    if end.part == WORLD:
        return _Frame(Pose(end.E, end.position), {}, BodyMotion())
    here = placed[end.part]
    link = here.frame_link(end.frame, end.E, end.position)
    motion = motions[end.part][link.parent].at(from_body(here.links, link), link.rotation)
    return _Frame(*here.frame_kinematics(end.frame, end.E, end.position), motion)


def _relative(A: _Frame, B: _Frame, rates: Sequence[Scalar]) -> _Relative:
    """v, w: velocity of B's origin and angular velocity seen from A; dv, dw: their rates seen from A at q'' = 0."""
    # d = R_A (r_B - r_A),   M = R_A R_B^T
    d = apply(A.pose.R, sub(B.pose.r, A.pose.r))
    M = multiply(A.pose.R, transpose(B.pose.R))
    none = Twist(ZERO, ZERO)
    twists: dict[int, Twist] = {}
    v: Vector = ZERO
    for a in sorted({*A.columns, *B.columns}):
        own, other = A.columns.get(a, none), B.columns.get(a, none)
        # u_a = M U_Ba - U_Aa - Omega_Aa x d,   w_a = M Omega_Ba - Omega_Aa
        U = sub(sub(apply(M, other.U), own.U), cross(own.Omega, d))
        twists[a] = Twist(U, sub(apply(M, other.Omega), own.Omega))
        v = add(v, scale(rates[a], U))
    omega = A.motion.omega
    w = sub(apply(M, B.motion.omega), omega)
    # dv = M a_B - a_A - alpha_A x d - omega_A x (omega_A x d) - 2 omega_A x v
    carried = add(A.motion.a, apply(A.motion.field(), d))
    dv = sub(sub(apply(M, B.motion.a), carried), scale(2, cross(omega, v)))
    # dw = M alpha_B - alpha_A - omega_A x w
    dw = sub(sub(apply(M, B.motion.alpha), A.motion.alpha), cross(omega, w))
    return _Relative(d, transpose(M), twists, v, w, dv, dw)


def _row(name: str, r: _Relative, length: Expr) -> tuple[Scalar, Vector, dict[int, Scalar], Scalar]:
    """Residual, direction of the multiplier, columns of the Jacobian, acceleration term."""
    if name in TURNS:
        j, i, sign = TURNS[name]
        axis = IDENTITY[i]
        direction = scale(sign, cross(r.axes[j], axis))
        # the axis m_j of B, seen from A: m_j'' = w' x m_j + w x (w x m_j)
        turned = add(cross(r.dw, r.axes[j]), cross(r.w, cross(r.w, r.axes[j])))
        columns = {a: dot(t.Omega, direction) for a, t in r.twists.items()}
        # phi = +-m_j . e_i,   G_a = +-w_a . (m_j x e_i)
        return sign * dot(r.axes[j], axis), direction, columns, sign * dot(turned, axis)
    if name == "length":
        lift = length.graph.lift
        # without a root, and by L a length: beside the closed position phi is the distance less L
        # phi = (d . d - L^2) / (2 L),   G_a = d . u_a / L,   G' q' = (v . v + d . dv) / L
        direction = lift(r.d[0]) / length, lift(r.d[1]) / length, lift(r.d[2]) / length
        residual = lift(dot(r.d, r.d) - length * length) / (2 * length)
        acceleration = lift(dot(r.v, r.v) + dot(r.d, r.dv)) / length
        return residual, direction, {a: dot(t.U, direction) for a, t in r.twists.items()}, acceleration
    # phi = d_i,   G_a = (u_a)_i
    i = PLACE.index(name)
    return r.d[i], IDENTITY[i], {a: t.U[i] for a, t in r.twists.items()}, r.dv[i]
