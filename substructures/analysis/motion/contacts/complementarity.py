"""Contact forces, or impulses, and what they leave: Coulomb's law as a linear complementarity problem.

For contacts i with normal forces p_i, facets D of their friction and what these leave, w = A p + b:

    0 <= p_N  with  w_N >= 0,    0 <= beta  with  D^T w_T + gamma >= 0,    0 <= gamma  with  mu p_N - sum beta >= 0

and the product of both sides zero (D. E. Stewart and J. C. Trinkle, Int. J. Numer. Meth. Eng. 39, 1996; M. Anitescu and
F. A. Potra, Nonlinear Dynamics 14, 1997), by Lemke's pivoting. From there Newton's method leads to Coulomb's cones
where points slip in two directions. Where contacts are alike and redundant, so that pivots tie, it follows the forces
of contacts that yield less and less, which are unique where all yield much (continuation; the springs of R. W. Cottle,
J.-S. Pang, R. E. Stone, The Linear Complementarity Problem, 1992, section 5.6, Tikhonov's regularisation). Whatever
these say, forces count by the conditions that they meet.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.motion.contacts.pivoting import JAMMED, ZERO, lemke
from substructures.array import Array

#: of the largest force and the largest velocity (acceleration): by how much conditions may fail
MET = 1e-9
#: facets of a cone, and how often they are turned where Newton's method leads nowhere from there
FACETS, TURNS = 8, 8
#: so much a contact yields, beside A_NN, and how often what that leaves is taken away
SOFT, ROUNDS = 1e-8, 30
#: and how much more on the way there from contacts that hardly know of each other
YIELDING = 10.0 ** np.arange(1, -8, -1)
#: most steps of that, parts of one that are tried, most that lead away, and of the largest of b when it has arrived
NEWTON, SHARES, STRAYS, EXACT = 100, (1.0, 0.5, 0.25, 0.1, 0.03, 0.01), 10, 1e-14
#: of the largest: what is nothing but rounding; an inverse mass above zero
ROUNDING, LEAST = 4e-16, 1e-300


@dataclass(frozen=True)
class Cones:
    """Contacts that may press: ``A`` (k, 3, k, 3) and ``b`` (k, 3) of w = A p + b, along the normal and two tangents;
    ``friction`` mu (k,), and which tangents there are (k, 2): none where a point slips already, as its friction is a
    part of what its normal force does. ``yields`` (k,): A_NN of the contacts alone, without friction.
    """

    A: Array
    b: Array
    friction: Array
    tangents: NDArray[np.bool_]
    yields: Array

    def left(self, p: Array) -> Array:
        """w (k, 3)."""
        return np.asarray(np.einsum("iajb,jb->ia", self.A, p) + self.b)

    @property
    def spatial(self) -> bool:
        """Whether some point may slip in two directions."""
        return bool(self.tangents.all(axis=1).any())

    def size(self, p: Array) -> float:
        """The largest |A| |p| + |b|, of which w is the rest."""
        found = np.einsum("iajb,jb->ia", np.abs(self.A), np.abs(p)) + np.abs(self.b)
        return max(float(found.max(initial=0)), 1e-300)

    def violation(self, p: Array) -> float:
        """The largest failure of a condition, relative to the largest force and to :meth:`size`."""
        w, size = self.left(p), self.size(p)
        force = float(np.abs([p, self.b / self.yields[:, None]]).max(initial=1e-300))
        w_T, p_T = (np.where(self.tangents, x[:, 1:], 0.0) for x in (w, p))
        slip, drag = np.linalg.norm(w_T, axis=1), np.linalg.norm(p_T, axis=1)
        most = self.friction * p[:, 0]
        return float(
            np.max(
                [
                    -w[:, 0] / size,
                    -p[:, 0] / force,
                    np.abs(w[:, 0] * p[:, 0]) / size / force,
                    (drag - most) / force,
                    # what slips has all of its friction against its way: |w_T| mu p_N + w_T . p_T = 0
                    np.where(self.tangents.any(axis=1), slip * most + (w_T * p_T).sum(axis=1), 0) / size / force,
                ],
                initial=0.0,
            )
        )


def coulomb(cones: Cones) -> Array:
    """Forces p (k, 3) by which all conditions hold; where many do, those of contacts that yield a little, all alike.

    Raises ArithmeticError where there are none.
    """
    k = len(cones.b)
    # contacts side by side, whatever their masses: p = S p^, w^ = S w with S = (A_NN)^(-1/2)
    scale = 1 / np.sqrt(cones.yields)
    size = float(np.abs(cones.b * scale[:, None]).max(initial=0)) or 1.0
    A, b = cones.A * scale[:, None, None, None] * scale[:, None], cones.b * scale[:, None] / size
    scaled = Cones(A, b, cones.friction, cones.tangents, np.ones(k))
    soft, p = _softer(Cones(A, b, cones.friction, cones.tangents, cones.yields), SOFT), np.zeros((k, 3))
    for _ in range(ROUNDS):
        # what yields less and less: w = A p + SOFT (p - p_before) + b
        p = _found(replace(soft, b=b - SOFT * p), p)
        if scaled.violation(p) <= EXACT:
            break
    if not scaled.violation(p) <= MET:
        raise ArithmeticError(JAMMED)
    return np.asarray(p * scale[:, None] * size)


def _softer(cones: Cones, more: float) -> Cones:
    """Contacts that yield by so much more, each by itself."""
    k = len(cones.b)
    return replace(cones, A=cones.A + more * np.eye(3 * k).reshape(k, 3, k, 3))


def _found(cones: Cones, near: Array) -> Array:
    """The same of contacts that yield; ``near``: forces that may be beside. Raises ArithmeticError."""
    for start in _starts(cones, near):
        p = _on_cones(cones, start)
        if cones.violation(p) <= MET:
            return p
    raise ArithmeticError(JAMMED)


def _starts(cones: Cones, near: Array) -> Iterator[Array]:
    """Forces (k, 3) from which Newton's method may lead on: those that are near; of facets; of contacts that yield less
    and less, from where they hardly know of each other, as redundant ones that are alike need; of other facets.
    """
    if near.any():
        yield near
    first, *others = np.arange(TURNS if cones.spatial else 1) * (2 * np.pi / FACETS / TURNS)
    yield _pressed(cones, first)
    p = np.zeros(near.shape)
    for more in YIELDING:
        p = _on_cones(_softer(cones, more), p)
    yield p
    for turn in others:
        yield _pressed(cones, turn)


def _on_cones(cones: Cones, p: Array) -> Array:
    """p on Coulomb's cones, from facets of them, by Newton's method for

        p_N = max(0, p_N - w_N),    p_T = the point of the disc of radius mu max(0, p_N - w_N) nearest to p_T - w_T

    (P. Alart and A. Curnier, Comput. Methods Appl. Mech. Engrg. 92, 1991).
    """
    k, strays = len(p), 0
    A = cones.A.reshape(3 * k, 3 * k)
    left, slopes = _missing(cones, p)
    size = least_left = float(np.abs(left).max(initial=0))
    nearest = p
    for _ in range(NEWTON):
        if size <= EXACT:
            break
        step = np.linalg.lstsq(np.eye(3 * k) - slopes @ (np.eye(3 * k) - A), left.ravel(), rcond=ZERO)[0]
        for share in SHARES:
            trial = p - share * step.reshape(k, 3)
            left, slopes = _missing(cones, trial)
            if np.abs(left).max() < size:
                break
        else:  # it may come back from a corner of the law
            strays += 1
            if strays > STRAYS:
                break
            trial = p - step.reshape(k, 3)
            left, slopes = _missing(cones, trial)
        p, size = trial, float(np.abs(left).max())
        if size < least_left:
            least_left, nearest = size, p
    return nearest


def _missing(cones: Cones, p: Array) -> tuple[Array, Array]:
    """p less its projection (k, 3), and the derivative (3k, 3k) of the projection by p - w."""
    y = p - cones.left(p)
    k, near = len(p), np.zeros(p.shape)
    slopes = np.zeros((k, 3, k, 3))
    for i, mu in enumerate(cones.friction.tolist()):
        there, pressed = cones.tangents[i], y[i, 0] > 0
        if not pressed:
            continue
        near[i, 0] = y[i, 0]
        slopes[i, 0, i, 0] = 1.0
        y_T = np.where(there, y[i, 1:], 0.0)
        size, most = float(np.linalg.norm(y_T)), mu * y[i, 0]
        if size <= most:
            near[i, 1:] = y_T
            slopes[i, 1:, i, 1:] = np.diag(there.astype(float))
        else:
            way = y_T / size
            near[i, 1:] = most * way
            slopes[i, 1:, i, 0] = mu * way
            slopes[i, 1:, i, 1:] = most / size * (np.diag(there.astype(float)) - np.outer(way, way))
    return p - near, slopes.reshape(3 * k, 3 * k)


def _pressed(cones: Cones, turn: float) -> Array:
    """p (k, 3) with facets in place of cones, turned by an angle; 0 where none are found."""
    k = len(cones.b)
    columns, of = _facets(cones.tangents, turn)
    m, rough = len(of), np.flatnonzero(cones.tangents.any(axis=1))
    # z = (p_N, beta, gamma)
    F = np.zeros((k, 3, k + m))
    F[np.arange(k), 0, np.arange(k)] = 1.0
    F[of, 1:, k + np.arange(m)] = columns
    n = k + m + len(rough)
    M, q = np.zeros((n, n)), np.zeros(n)
    M[: k + m, : k + m] = np.einsum("iar,iajb,jbs->rs", F, cones.A, F)
    q[: k + m] = np.einsum("iar,ia->r", F, cones.b)
    for row, i in enumerate(rough.tolist(), k + m):
        mine = k + np.flatnonzero(of == i)
        M[mine, row], M[row, mine], M[row, i] = 1.0, -1.0, cones.friction[i]
    try:
        z = lemke(M, q)
    except ArithmeticError:  # a ray, or rounding
        return np.zeros((k, 3))
    return np.asarray(np.einsum("iar,r->ia", F, z[: k + m]))


def _facets(tangents: NDArray[np.bool_], turn: float) -> tuple[Array, NDArray[np.int64]]:
    """Unit vectors (m, 2) of the friction of all contacts, and whose they are (m,)."""
    columns, of = list[Array](), list[int]()
    for i, there in enumerate(tangents.tolist()):
        if all(there):
            angle = 2 * np.pi * np.arange(FACETS) / FACETS + turn
            some = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        else:
            some = np.array([[1.0, 0.0], [-1.0, 0.0]]) if there[0] else np.zeros((0, 2))
        columns.append(some)
        of += [i] * len(some)
    return np.concatenate([np.zeros((0, 2)), *columns]), np.array(of, dtype=np.int64)


def least(A: Array, b: Array, yields: Array) -> Array:
    """x with A x = b; where many do, that of rows that yield a little, as in :func:`coulomb`."""
    x, left, soft = np.zeros(len(b)), b, A + np.diag(SOFT * np.maximum(yields, LEAST))
    lu, order, singular = scipy.linalg.lapack.dgetrf(soft) if len(b) else (soft, b, 0)
    if singular:
        raise np.linalg.LinAlgError("nothing moves a contact")
    for _ in range(ROUNDS if len(b) else 0):
        x += scipy.linalg.lapack.dgetrs(lu, order, left)[0]
        left = b - A @ x
        if np.abs(left).max() <= ROUNDING * (np.abs(A) @ np.abs(x) + np.abs(b)).max():
            break
    return x
