"""Curves F(u) = 0 of one dimension, followed by pseudo-arclength: u = (x, s), s from 0 to 1 over a range.

From a point u_0 with the unit tangent t, F_u t = 0, Newton's method solves F(u) = 0, t (u - u_0 - h t) = 0 for the
next, which passes where s turns back. F is over its units, so that F_u is of the order 1. Where F_u loses rank another
curve crosses; its direction d is the other root of the algebraic branching equation psi F_uu d d = 0 on the kernel of
F_u (H. B. Keller, Numerical solution of bifurcation and nonlinear eigenvalue problems, 1977; E. L. Allgower, K. Georg,
Introduction to Numerical Continuation Methods, 2003, chapters 2, 6 and 8).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from substructures.array import Array

#: of u, F (k,) and its Jacobian (k, n + 1) of rank n
Equations = Callable[[Array], tuple[Array, Array]]
#: integers at a point, whose changes along a curve are located
Signature = Callable[[Array], tuple[int, ...]]
#: u, and the integers there
Point = tuple[Array, tuple[int, ...]]
#: points of one curve over those that its length 1 would take; halvings of the place of a change
MOST, PLACED = 40, 24
#: most changes between two points
CHANGES = 12
#: steps of Newton's method; the last of them, and what rounding may leave of it
STEPS, SMALL, ROUNDED = 12, 1e-13, 1e-9
#: of a step, a gap that no curve has: the step led to another one; the shortest step, of the longest
GAP, SHORT = 1e-2, 1e-5
#: of least squares: as exactly as rounding allows
FINEST = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
#: why a curve ends
LOST = "there is no next point, however near, or these coordinates are singular there"
#: least cosine between tangents of two points
STRAIGHT = 0.9
#: singular value, relative to the largest or 1, that counts as none; step of second differences
RANK, DIFFERENCE = 1e-5, 1e-3
#: singular value beside which a crossing is looked for, and what is left of the equations of one
NEARLY, CROSSED = 0.1, 1e-8


@dataclass(frozen=True)
class Change:
    """Where an integer changes: ``which``, 0 whether s rises, then those of the signature; the points just before and
    after, each with its integers, the ``tangent`` there, and that of the point that it was ``seen_from``.
    """

    which: int
    tangent: Array
    seen_from: Array
    before: Point
    after: Point
    #: whether there was a point of the curve wherever it was looked for, and none far from the next
    is_placed: bool

    @property
    def u(self) -> Array:
        """The place."""
        return self.after[0]


@dataclass
class Continuation:
    """Curves with points at most ``step`` apart. ``message``: why the last one ended within the range, if it did."""

    equations: Equations
    signature: Signature
    step: float
    message: str = ""

    def follow(self, u: Array, direction: Array) -> Iterator[tuple[Array, list[Change]]]:
        """Points from u on to the end of the range of s, each with the changes between it and the one before."""
        self.message = ""
        t = self.tangent(u, direction)
        here, step = self._integers(u, t), self.step
        yield u, []
        for _ in range(round(MOST / self.step)):
            found = self._next(u, t, step)
            if found is None:
                self.message = LOST
                return
            new, step = found
            turned = self.tangent(new, t)
            is_last = not 0 <= new[-1] + ROUNDED * turned[-1] <= 1
            if is_last:
                new = self._at_the_end(u, t, new)
                turned = self.tangent(new, t)
            after = self._integers(new, turned)
            changes = self._changes(t, (u, here), (new, after))
            if step > 4 * self.step * SHORT and not all(change.is_placed for change in changes):
                step /= 4
                continue
            yield new, changes
            if is_last:
                return
            u, t, here, step = new, turned, after, min(self.step, 2 * step)
        self.message = f"it is longer than {MOST} ranges"

    def tangent(self, u: Array, direction: Array) -> Array:
        """The unit tangent that points along the direction."""
        t = np.linalg.svd(self.equations(u)[1])[2][len(u) - 1]
        return np.asarray(t if t @ direction >= 0 else -t, dtype=np.float64)

    def crossing(self, u: Array) -> Array | None:
        """The place near u where two curves cross: F = 0, psi F_u = 0, |psi| = 1; None where there is none."""
        n = len(u) - 1
        left, sizes, _ = np.linalg.svd(self.equations(u)[1])
        lost = sizes[:n] / sizes.max(initial=1)
        if not n or lost[-1] > NEARLY or (lost < RANK).sum() > 1:
            return None
        # n equations, where others follow from them
        independent = left[:, :n].T

        def both(z: Array) -> Array:
            """F + b psi, psi F_u and |psi|^2 - 1 at z = (u, b, psi): b unfolds what does not cross."""
            F, J = (independent @ x for x in self.equations(z[: n + 1]))
            psi = z[n + 2 :]
            return np.concatenate((F + z[n + 1] * psi, psi @ J, [psi @ psi - 1]))

        start = np.concatenate((u, [0.0], np.eye(n)[n - 1]))
        if not np.isfinite(both(start)).all():
            return None
        found = scipy.optimize.least_squares(both, start, jac="3-point", max_nfev=STEPS, **FINEST)
        place, b = found.x[: n + 1], found.x[n + 1]
        is_near = np.linalg.norm(place - u) < self.step
        return place if is_near and max(abs(b), np.abs(found.fun).max()) < CROSSED else None

    def tangents(self, u: Array) -> list[Array]:
        """The unit tangents of both curves that cross at u; none where second derivatives do not tell them."""
        F, J = self.equations(u)
        left, _, right = np.linalg.svd(J)
        n = len(u) - 1
        one, two = right[n - 1], right[n]

        def bent(d: Array) -> Array:
            """psi F_uu d d for all psi with psi F_u = 0."""
            ahead, behind = (self.equations(u + side * DIFFERENCE * d)[0] for side in (1, -1))
            return np.asarray(left[:, n - 1 :].T @ (ahead - 2 * F + behind) / DIFFERENCE**2, dtype=np.float64)

        a, c = bent(one), bent(two)
        rows = np.column_stack((a, (bent(one + two) - a - c) / 2, c))
        if not np.isfinite(rows).all():
            return []
        # the row that says something, where equations depend on each other
        a, b, c = np.linalg.svd(rows)[2][0].tolist()
        # a y^2 + 2 b y z + c z^2 = 0 for d = y one + z two: isotropic directions of [a b; b c]
        (low, high), axes = np.linalg.eigh([[a, b], [b, c]])
        if not low < 0 < high or min(-low, high) < RANK * max(-low, high):
            return []
        found = [axes @ [np.sqrt(high), side * np.sqrt(-low)] for side in (1, -1)]
        return [(y * one + z * two) / np.hypot(y, z) for y, z in found]

    def beside(self, u: Array, direction: Array) -> Array | None:
        """A point of the curve that leaves u in this direction, within a step."""
        found = self._next(u, direction, self.step)
        return None if found is None else found[0]

    def _next(self, u: Array, t: Array, step: float) -> tuple[Array, float] | None:
        while step > self.step * SHORT:
            new = self._corrected(u + step * t, t)
            if new is not None and np.linalg.norm(new - u) < 2 * step and self.tangent(new, t) @ t > STRAIGHT:
                return new, step
            step /= 2
        return None

    def _integers(self, u: Array, t: Array) -> tuple[int, ...]:
        return int(t[-1] > 0), *self.signature(u)

    def _at_the_end(self, u: Array, t: Array, beyond: Array) -> Array:
        """The point at the end of the range of s, which is between two."""
        end, chord = float(beyond[-1] > 0.5), beyond - u
        found = self._corrected(u + (end - u[-1]) / chord[-1] * chord, np.eye(len(u))[-1])
        if found is not None and 0 <= t @ (found - u) <= t @ chord:
            return found
        low, high, inside = 0.0, float(t @ chord), u
        for _ in range(PLACED):
            middle = (low + high) / 2
            point = self._corrected(u + middle * t, t)
            if point is not None and 0 <= point[-1] <= 1:
                low, inside = middle, point
            else:
                high = middle
        last = np.append(inside[:-1], end)
        found = self._corrected(last, np.eye(len(u))[-1])
        return inside if found is None or np.linalg.norm(found - last) > self.step else found

    def _corrected(self, guess: Array, normal: Array) -> Array | None:
        """The point of the curve in the plane through the guess."""
        u, before = guess.copy(), np.inf
        for _ in range(STEPS):
            F, J = self.equations(u)
            rows, right = np.vstack((J, normal)), np.append(-F, -normal @ (u - guess))
            if not (np.isfinite(rows).all() and np.isfinite(right).all()):
                return None
            du = np.linalg.lstsq(rows, right, rcond=1e-12)[0]
            size = float(np.abs(du).max())
            # that step would lead nowhere: here the equations are known
            if size <= SMALL or before / 4 < size <= ROUNDED:
                return u
            u = u + du
            if np.linalg.norm(u - guess) > self.step:
                return None
            before = size
        # beside another curve the last steps are rounding
        return u if np.abs(self.equations(u)[0]).max(initial=0) <= SMALL else None

    def _changes(self, t: Array, first: Point, last: Point) -> list[Change]:
        """Those that are seen between two points, by integers; t is the tangent at the first one."""
        found, points = list[Change](), [first, last]
        for k, end in enumerate(last[1]):
            before = first
            while before[1][k] != end and len(found) < CHANGES:
                found.append(self._located(t, k, before, points))
                before = found[-1].after
        return found

    def _located(self, t: Array, k: int, before: Point, points: list[Point]) -> Change:
        """The first change of integer k behind a point, by bisection along the tangent t between the known ``points``,
        the first and the last one and what was met before; what is met here is added.
        """

        def along(point: Point) -> float:
            return float(t @ (point[0] - points[0][0]))

        start, is_placed, length = before[1][k], True, along(points[1])
        after = min((one for one in points if along(one) > along(before) and one[1][k] != start), key=along)
        before = max((before, *(one for one in points if along(one) < along(after))), key=along)
        while along(after) - along(before) > length / 2**PLACED:
            middle, is_found = self._watched((before[0] + after[0]) / 2, t)
            is_placed &= is_found
            points += [middle] if is_found else []
            if middle[1][k] == start:
                before = middle
            else:
                after = middle
        is_placed &= bool(np.linalg.norm(after[0] - before[0]) < GAP * length)
        return Change(k, self.tangent(after[0], t), t, before, after, is_placed)

    def _watched(self, guess: Array, t: Array) -> tuple[Point, bool]:
        """The point in the plane through the guess with its integers, and whether there is one."""
        found = self._corrected(guess, t)
        point = guess if found is None else found
        return (point, self._integers(point, self.tangent(point, t))), found is not None
