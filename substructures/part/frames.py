"""Constant frames: rotation matrices that fold to as few operations as possible, joint axes, mounted placements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from flint import arb, ctx

from substructures.documents.fields import in_si
from substructures.expr.direct import ball
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import array, program
from substructures.expr.trigonometry import of_sum
from substructures.loads.scope import Lookup, Scope, no_names
from substructures.mechanics.linear3 import (
    IDENTITY,
    Matrix,
    Planar,
    Vector,
    add,
    apply,
    cross,
    multiply,
    negate,
    transpose,
)
from substructures.mechanics.parallel_axes import one_after_the_other
from substructures.part.definition import PartClosure

#: rows of the rotation that turns frame axis 0, 1 or 2 into the third axis, by renaming the axes
#: cyclic, so that they are turns and no reflections
AXES: tuple[Matrix, Matrix, Matrix] = (
    ((0, 1, 0), (0, 0, 1), (1, 0, 0)),
    ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
    IDENTITY,
)


#: bits by which it is told whether a component of an axis is zero
EXACT = 1100


@dataclass(frozen=True, slots=True)
class Frame:
    """A frame fixed in a carrier: ``E`` (components in the carrier's body frame -> components here), position [m]."""

    carrier: int
    E: Matrix
    position: Vector

    def placed(self, E: Matrix, position: Vector) -> Frame:
        """A frame placed in this one, seen from the carrier: E E_f, r_f + E_f^T r."""
        return Frame(self.carrier, multiply(E, self.E), self.point(position))

    def point(self, position: Vector) -> Vector:
        """A point given in this frame, in the carrier's body frame."""
        return add(self.position, apply(transpose(self.E), position))


def axis_rotation(scope: Scope, axis: tuple[Any, Any, Any], pointer: str) -> Matrix:
    """E of a frame whose third axis is the given constant direction, of any length but zero; faults (``bad-axis``) go
    to the scope.
    """
    n = scope.vector(axis, pointer, no_names)
    # which components are zero, and which one is the least, not even roots of roots may hide
    balls = {i: ball(in_si(axis[i]), precision=EXACT) for i, component in enumerate(n) if not component.is_zero}
    given = [i for i, x in balls.items() if not x.contains(0)]
    if not given or not all(x.is_finite() for x in balls.values()):
        scope.fault(pointer, "bad-axis", "the joint axis must be three constant numbers, not all zero")
        return IDENTITY
    x, y, z = (component if i in given else scope.graph.zero for i, component in enumerate(n))
    # along an axis of the frame axes change their names: neither roots nor products come into the formulas
    if len(given) == 1:
        return AXES[given[0]] if balls[given[0]] > 0 else _reversed(AXES[given[0]])
    # |e_i x n|^2 = |n|^2 - n_i^2 is 2/3 |n|^2 or more for the axis that n is least along: never near zero
    return _general_axis(scope, (x, y, z), _least([balls.get(i, arb(0)) for i in range(3)]))


def _least(n: Sequence[Any]) -> int:
    """The axis that a direction is least along; of equal ones, however they are written, the first."""
    with ctx.workprec(EXACT):
        sizes = [abs(x.mid()) for x in n]
        return next(i for i, size in enumerate(sizes) if not size > min(sizes) * (1 + arb(2) ** -80))


class CutFrames(NamedTuple):
    """The frames of a closure: E in the frame ``from``, E and position in the frame ``to``; their third axes are the
    joint axis. ``length``: of a rod.
    """

    start: Matrix
    end: Matrix
    position: Vector
    length: Expr


def cut_frames(scope: Scope, closure: PartClosure, pointer: str, lookup: Lookup | None = None) -> CutFrames:
    """Read the numbers of a closure, which are constant; ``lookup``: of names in its expressions."""
    axis: Matrix = IDENTITY if closure.axis is None else axis_rotation(scope, closure.axis, f"{pointer}/axis")
    E = scope.rpy(closure.placement.rpy, f"{pointer}/placement/rpy", lookup).matrix()
    position = scope.vector(closure.placement.position, f"{pointer}/placement/position", lookup)
    length = scope.graph.zero
    if closure.length is not None:
        length = scope.read(closure.length, f"{pointer}/length", lookup)
        if not scope.faults and (length.is_zero or (length.is_number and length.negative)):
            scope.fault(f"{pointer}/length", "bad-length", "the length of a rod is positive")
    # the same turn in both frames: where the loop is closed their axes are the same for any axis of the joint
    return CutFrames(axis, multiply(axis, E), position, length)


def joined_turns(first: Planar, second: Planar) -> Planar:
    """One turn after the other about the third axis, by the sum of the angles where formulas show it."""
    graph = next((x.graph for x in (first.c, first.s, second.c, second.s) if isinstance(x, Expr)), None)
    if graph is None:
        return one_after_the_other(first, second)
    one, other = ((graph.lift(turn.c), graph.lift(turn.s)) for turn in (first, second))
    return Planar(2, *of_sum(one, other))


def constant(x: Expr) -> float:
    """The value of a constant expression, roots and pi included."""
    return float(interpret(program(x.graph, {"x": array((), lambda: x)}, {}), {})["x"])


def _reversed(e: Matrix) -> Matrix:
    """The same axis in the opposite direction: a half turn about the first axis of the frame."""
    # Rx(pi): e1 stays, e2 and e3 are turned round
    return e[0], negate(e[1]), negate(e[2])


def _general_axis(scope: Scope, n: tuple[Expr, Expr, Expr], smallest: int) -> Matrix:
    """Rows: a unit vector across n and the frame axis least aligned with it, its complement, n."""
    graph = scope.graph
    length2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2]
    root = graph.sqrt(length2)
    unit: Vector = (n[0] / root, n[1] / root, n[2] / root)
    # |e_i x n|^2 = |n|^2 - n_i^2
    across = cross(IDENTITY[smallest], n)
    length = graph.sqrt(length2 - n[smallest] * n[smallest])
    first: Vector = (graph.lift(across[0]) / length, graph.lift(across[1]) / length, graph.lift(across[2]) / length)
    # right-handed rows: a = e_i x n / |e_i x n|, n x a, n
    return first, cross(unit, first), unit
