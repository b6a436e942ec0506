"""Small vibrations of M x'' + D x' + K x = 0: eigenvalues, mode shapes, damping, and what they say about stability.

P. C. Mueller, Stabilitaet und Matrizen, 1977; K. Magnus, Schwingungen, 1961.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import scipy

from substructures.array import Array, ComplexArray

Verdict = Literal["asymptotically stable", "stable", "unstable", "undecided"]

#: real parts of this size, relative to the largest eigenvalue, cannot be told from zero (double eigenvalues)
NEUTRAL = 1e-7
SYMMETRIC = 1e-12
#: why what does not depend on the time is stable, and why at constant momenta and rates
DIRICHLET = "the potential energy has a strict minimum (Lagrange, Dirichlet)"
ROUTH = "the amended potential V + 1/2 p g^-1 p has a strict minimum at constant momenta (Routh, Salvadori)"
AT_RATES = "V - 1/2 w g w has a strict minimum at constant rates (Routh, Salvadori)"
#: rounding errors of an eigenvalue problem, and relative differences of eigenvalues that count as none
ROUNDED, SAME = 64 * float(np.finfo(float).eps), 1e-9


@dataclass(frozen=True, repr=False)
class Mode:
    """x = Re(shape e^(eigenvalue t)). Of a pair of complex eigenvalues the one with positive imaginary part.

    ``frequency``: absolute value [rad/s]; ``damping_ratio``: -Re/|.|, 1 for aperiodic, 0 for undamped; ``shape`` (n,):
    largest element 1.
    """

    eigenvalue: complex
    shape: ComplexArray

    def __repr__(self) -> str:
        largest = int(np.abs(self.shape).argmax()) if len(self.shape) else 0
        finding = f"{self.hertz:.6g} Hz, damping ratio {self.damping_ratio:.4g}, largest in coordinate {largest}"
        return f"Mode(eigenvalue={self.eigenvalue:.6g} 1/s, n={len(self.shape)})\n{finding}"

    @property
    def frequency(self) -> float:
        """|eigenvalue| [rad/s]."""
        return abs(self.eigenvalue)

    @property
    def damping_ratio(self) -> float:
        """-Re/|eigenvalue|; 0 for the eigenvalue 0."""
        return -self.eigenvalue.real / abs(self.eigenvalue) if self.eigenvalue else 0.0

    @property
    def hertz(self) -> float:
        """|Im eigenvalue|/(2 pi): oscillations in a second."""
        return abs(self.eigenvalue.imag) / (2 * np.pi)


#: a mode, and by how much its eigenvalue is uncertain
_Doubtful = tuple[Mode, float]


@dataclass(frozen=True)
class Stability:
    """The verdict of the linearisation, and why."""

    verdict: Verdict
    reason: str


def modes(M: Array, D: Array, K: Array, R: Array | None = None) -> tuple[Mode, ...]:
    """Modes by frequency, slowest first. Without dampers and with symmetric K from the symmetric problem K x = w^2 M x.

    Of equal frequencies the one with the lesser real part comes first, as -k before +k; differences that rounding may
    have made count as none. A double eigenvalue 0 of the second case (motion without restoring force) is exactly 0
    here, listed once; eigenvalues whose imaginary parts may come from rounding are real, both listed. ``R``: of
    x' = v + R x, M v' + D v + K x = 0.
    """
    if not len(M):
        return ()
    undamped = R is None and np.abs(D).max() == 0 and is_symmetric(K)
    found = _undamped(M, K) if undamped else _general(M, first_order(M, D, K, R))
    keys = [abs, lambda z: z.real, lambda z: z.imag]
    return tuple(mode for mode, _ in _ordered(found, keys))


def _ordered(found: list[_Doubtful], keys: Sequence[Callable[[complex], float]]) -> list[_Doubtful]:
    """By the first key of eigenvalues, neighbours within their doubts by the next one, and so on."""
    if not keys or len(found) < 2:
        return found
    size = keys[0]
    found = sorted(found, key=lambda one: size(one[0].eigenvalue))
    groups = [[found[0]]]
    for before, one in pairwise(found):
        same = size(one[0].eigenvalue) - size(before[0].eigenvalue) <= max(one[1], before[1])
        if same:
            groups[-1].append(one)
        else:
            groups.append([one])
    return [one for group in groups for one in _ordered(group, keys[1:])]


def is_symmetric(K: Array) -> bool:
    """Up to rounding."""
    return bool(np.abs(K - K.T).max() <= SYMMETRIC * np.abs(K).max())


def _undamped(M: Array, K: Array) -> list[_Doubtful]:
    # K x = w^2 M x
    squares, shapes = scipy.linalg.eigh((K + K.T) / 2, (M + M.T) / 2)
    floor = 1e-13 * np.abs(squares).max()
    found: list[_Doubtful] = []
    # z = 0 (listed once), +-i w, or +-sqrt(-w^2)
    for square, shape in zip(squares.tolist(), shapes.T, strict=True):
        size = np.sqrt(abs(square))
        if abs(square) <= floor:
            values = [0j]
        elif square > 0:
            values = [1j * size]
        else:
            values = [complex(size), complex(-size)]
        # dw = d(w^2) / 2w
        doubt = max(SAME * size, floor / (2 * size)) if size else 0.0
        found += [(Mode(complex(value), normed(shape)), doubt) for value in values]
    return found


def _general(M: Array, A: Array) -> list[_Doubtful]:
    n = len(M)
    values, left, right = scipy.linalg.eig(A, left=True, right=True)
    doubts = _doubts(A, values, left, right)
    found: list[_Doubtful] = []
    for value, vector, doubt in zip(values.tolist(), right.T, doubts.tolist(), strict=True):
        z = complex(value.real) if abs(value.imag) <= doubt else complex(value)
        if z.imag >= 0:
            found.append((Mode(z, normed(vector[:n])), max(doubt, SAME * abs(z))))
    return found


def _doubts(A: Array, values: ComplexArray, left: ComplexArray, right: ComplexArray) -> Array:
    """What rounding may change an eigenvalue by: eps |A| |x| |y| / |y^H x| (J. H. Wilkinson, 1965), with velocities in
    units of the largest eigenvalue; of a double one that has a single shape, at most NEUTRAL of the largest.
    """
    n, scale = len(A) // 2, float(np.abs(values).max()) or 1.0
    units = np.repeat([1.0, scale], n)
    x, y = right / units[:, None], left * units[:, None]
    size = np.linalg.norm(A / units[:, None] * units)
    with np.errstate(divide="ignore"):
        condition = np.linalg.norm(x, axis=0) * np.linalg.norm(y, axis=0) / np.abs(np.sum(y.conj() * x, axis=0))
    return np.asarray(np.minimum(ROUNDED * size * condition, NEUTRAL * scale), dtype=np.float64)


def first_order(M: Array, D: Array, K: Array, R: Array | None = None) -> Array:
    """A (2n, 2n) of x' = A x, x = (q, q'); ``R`` of q' = v + R q, then x = (q, v)."""
    # A = [R 1; -M^-1 K  -M^-1 D]
    lower = -np.linalg.solve(M, np.hstack([K, D]))
    return np.vstack([np.hstack([np.zeros_like(M) if R is None else R, np.eye(len(M))]), lower])


def input_matrix(M: Array, F: Array) -> Array:
    """B (2n, m) of x' = A x + B u."""
    # B = [0; M^-1 F]
    return np.vstack([np.zeros_like(F), np.linalg.solve(M, F)])


def normed(shape: Any) -> ComplexArray:
    """Largest element 1, the first one of several that differ by rounding."""
    z = np.asarray(shape, dtype=np.complex128)
    k = int((np.abs(z) >= (1 - NEUTRAL) * np.abs(z).max()).argmax()) if len(z) else 0
    return z / z[k] if len(z) and z[k] != 0 else z


def stability(found: tuple[Mode, ...], D: Array, K: Array, has_potential: bool, minimum: str = DIRICHLET) -> Stability:
    """What the eigenvalues of an equilibrium say about the motion near it.

    ``has_potential``: forces without potential are linear in the velocities, with the same coefficients in all
    positions, or there are none: then a positive definite K decides where the linearisation does not, if D feeds no
    energy in (Lagrange and Dirichlet). ``minimum``: the reason then.
    """
    if not found:
        return Stability("stable", "there is nothing that moves")
    scale = max(mode.frequency for mode in found)
    worst = max(found, key=lambda mode: mode.eigenvalue.real)
    if worst.eigenvalue.real > NEUTRAL * scale:
        return Stability("unstable", f"the eigenvalue {_text(worst.eigenvalue)} 1/s has a positive real part")
    if worst.eigenvalue.real < -NEUTRAL * scale:
        return Stability("asymptotically stable", "all eigenvalues have negative real parts")
    if has_potential and is_symmetric(K) and _is_definite(K) and _least(D) >= -SYMMETRIC:
        return Stability("stable", minimum)
    where = "0" if abs(worst.eigenvalue) <= NEUTRAL * scale else f"{_text(worst.eigenvalue)} 1/s on the imaginary axis"
    return Stability("undecided", f"the eigenvalue {where} leaves the decision to terms of higher order")


def _is_definite(K: Array) -> bool:
    """Whether K is positive definite beyond doubt, whatever the units of its coordinates; nothing is of rounding."""
    sizes = np.diag(K)
    return bool((sizes > SYMMETRIC * sizes.max()).all()) and _least(K / np.sqrt(np.outer(sizes, sizes))) > NEUTRAL


def _least(x: Array) -> float:
    """The least eigenvalue of the symmetric part, over the largest element."""
    size = np.abs(x).max()
    return float(np.linalg.eigvalsh((x + x.T) / 2).min() / size) if size else 0.0


def _text(z: complex) -> str:
    return f"{z.real:.6g}" if z.imag == 0 else f"{z.real:.6g}{z.imag:+.6g}i"
