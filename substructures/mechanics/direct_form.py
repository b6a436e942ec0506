"""The direct form of metric, Christoffel symbols and gravity forces in numbers (notation.md, section 4).

Written on purpose without the recursion that generates the formulas: joint axes and points in world coordinates, one
sum over bodies, full tensors. It is the yardstick of the certificates. Batch axis N first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from substructures.array import Array


@dataclass(frozen=True)
class NumericJoint:
    """Parent joint (-1: world), kind, E (N,3,3), Z (N,3) from O_p to O_k in frame p, tau (N,), and the inertia of the
    body about its body frame origin: m (N,), s (N,3), J (N,3,3)."""

    parent: int
    s: int
    E: Array
    Z: Array
    tau: Array
    m: Array
    sm: Array
    J: Array


@dataclass(frozen=True)
class DirectForm:
    """g (N,n,n), Gamma (N,n,n,n), gravity Q (N,n)."""

    metric: Array
    christoffel: Array
    gravity: Array


def direct_form(joints: Sequence[NumericJoint], gravity: Array) -> DirectForm:
    """Sum over bodies with velocities from axes and points: u = z x (x - o) or z; d_b u_c = z_b x u_c, b <= c."""
    N, n = gravity.shape[0], len(joints)
    R, o = _poses(joints, N)
    g, Gamma, Q = np.zeros((N, n, n)), np.zeros((N, n, n, n)), np.zeros((N, n))
    for k, joint in enumerate(joints):
        chain = _chain(joints, k)
        m, x, J = _centre(joint, R[k], o[k])
        # partial velocities of the mass centre x, angular ones w_a = z_a or 0
        u = np.stack([_velocity(joints[a], R[a][:, 2], o[a], x) for a in chain], axis=1)
        w = np.stack([np.zeros((N, 3)) if joints[a].s else R[a][:, 2] for a in chain], axis=1)
        # Theta = tr(J) 1 - J
        Theta = np.trace(J, axis1=1, axis2=2)[:, None, None] * np.eye(3) - J
        at = np.ix_(range(N), chain, chain)
        # g_ac = m u_a . u_c + w_a . Theta w_c
        g[at] += m[:, None, None] * np.einsum("nai,nci->nac", u, u) + np.einsum("nai,nij,ncj->nac", w, Theta, w)
        # Q_a = m gamma . u_a
        Q[:, chain] += m[:, None] * np.einsum("nai,ni->na", u, gravity)
        Gamma[np.ix_(range(N), chain, chain, chain)] += _cubic(m, u, w, J)
    return DirectForm(g, Gamma, Q)


def _cubic(m: Array, u: Array, w: Array, J: Array) -> Array:
    """m u_a . (w_b x u_c) + w_b^T J (w_c x w_a) for b <= c in the order of the chain, mirrored to b > c."""
    wu = np.cross(w[:, :, None, :], u[:, None, :, :])
    ww = np.cross(w[:, :, None, :], w[:, None, :, :])
    # m u_a . (w_b x u_c)  +  w_b . J (w_c x w_a)
    full = m[:, None, None, None] * np.einsum("nai,nbci->nabc", u, wu)
    full += np.einsum("nbi,nij,ncaj->nabc", w, J, ww)
    p = u.shape[1]
    # Gamma_abc = Gamma_acb
    upper = np.triu(np.ones((p, p), dtype=bool))
    return np.where(upper, full, np.swapaxes(full, 2, 3))


def _poses(joints: Sequence[NumericJoint], N: int) -> tuple[list[Array], list[Array]]:
    """Rotations world -> k (rows are the frame's axes in the world) and positions of O_k in the world."""
    R: list[Array] = []
    o: list[Array] = []
    for joint in joints:
        Rp = R[joint.parent] if joint.parent >= 0 else np.broadcast_to(np.eye(3), (N, 3, 3))
        op = o[joint.parent] if joint.parent >= 0 else np.zeros((N, 3))
        # R_k = E_k R_p,   o_k = o_p + R_p^T Z_k
        R.append(joint.E @ Rp)
        o.append(op + np.einsum("nij,ni->nj", Rp, joint.Z))
    return R, o


def _chain(joints: Sequence[NumericJoint], k: int) -> list[int]:
    chain = []
    while k >= 0:
        chain.append(k)
        k = joints[k].parent
    return chain[::-1]


def _velocity(joint: NumericJoint, z: Array, o: Array, x: Array) -> Array:
    """Of the point x for the unit velocity of a joint with axis z through o."""
    return z if joint.s else np.cross(z, x - o)


def _centre(joint: NumericJoint, R: Array, o: Array) -> tuple[Array, Array, Array]:
    """Mass, mass centre in the world, Binet tensor about it in world axes."""
    # about the body frame origin s = m h, J = J_C + m h h^T
    m = joint.m
    h = joint.sm / np.where(m == 0, 1, m)[:, None]
    J = joint.J - m[:, None, None] * h[:, :, None] * h[:, None, :]
    # x = o + R^T (h + tau e3)
    z = np.zeros_like(h)
    z[:, 2] = joint.tau
    return m, o + np.einsum("nij,ni->nj", R, h + z), np.swapaxes(R, 1, 2) @ J @ R
