"""Constraints that are affine in the velocities, B(q) q' + b(q, t) = 0: given as expressions, or as contacts.

===========  =====================================================================================================
type         rows
===========  =====================================================================================================
linear       ``expression`` in velocities (arm.q1'), coordinates, parameters and t; affine in the velocities, whose
             coefficients do not depend on t. What is left of it without velocities is b: a table that turns, a belt
knife_edge   the origin of ``frame`` does not move along its second axis (the edge is along the first): U_a2
rolling      the body of ``frame`` rolls without slip on a plane: U_a + Omega_a x rho in the axes of the plane, three
             rows ``slip_1``, ``slip_2`` and ``contact``; rho leads from the origin of the frame to the contact point
closure      the rows of a closure of the tree, differentiated by time: G q' = 0. With them the equations of a closed
             mechanism are formulas in independent velocities; its positions must meet the closures from the start
===========  =====================================================================================================

A rolling disc has its axis along the third axis e of the frame: rho = -r (N - (N.e) e) / |N - (N.e) e|, N the normal of
the plane; a sphere has rho = -r N. The row ``contact`` has the integral N . c + N . rho = const, the gap. Where frames
and loops move with given motions, b is what U_0 and Omega_0 make of these rows, and phi_t.
(H. Goldstein, Classical Mechanics, 2nd ed. 1980, section 1-3; Ju. I. Neimark and N. A. Fufaev, Dynamics of Nonholonomic
Systems, AMS 1972.)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from substructures.analysis.arguments import NumberOrExpression, exact, one_of, require_read
from substructures.errors import InvalidArgument, among, listed
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, array, program
from substructures.expr.replay import replay
from substructures.mechanics.linear3 import Matrix, Vector, add, apply, cross, dot, transpose
from substructures.part.frames import axis_rotation
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.given.ties import names_of
from substructures.tree.model import Model

SHAPES = ("disc", "sphere")
#: velocities of frames that given motions make
GIVEN = ("U_0", "Omega_0")


@dataclass(frozen=True)
class Linear:
    """``expression`` is zero; it is affine in the velocities: B_a q'^a + b."""

    name: str
    expression: str


@dataclass(frozen=True)
class KnifeEdge:
    """A skate: no velocity across the edge, which lies along the first axis of ``frame`` (instance.port or
    instance.body).
    """

    name: str
    frame: str


@dataclass(frozen=True)
class Rolling:
    """A disc (axis: third axis of ``frame``) or a sphere of ``radius`` [m] that rolls on a plane without slip.

    ``normal``: of the plane in the world, constant. Raises InvalidArgument.
    """

    name: str
    frame: str
    radius: NumberOrExpression
    shape: Literal["disc", "sphere"] = "disc"
    normal: tuple[NumberOrExpression, NumberOrExpression, NumberOrExpression] = (0, 0, 1)

    def __post_init__(self) -> None:
        one_of(self.shape, "shape", SHAPES)
        object.__setattr__(self, "normal", tuple(self.normal))


@dataclass(frozen=True)
class Closed:
    """The closure of the tree with this name."""

    name: str


Constraint = Linear | KnifeEdge | Rolling | Closed


TYPES: dict[str, Callable[..., Constraint]] = {"linear": Linear, "knife_edge": KnifeEdge, "rolling": Rolling}


def constraints_of(model: Model, given: Sequence[Constraint] = ()) -> tuple[Constraint, ...]:
    """The velocity constraints of a motion: those of the tree and all its closures, or those that are ``given``.

    Raises InvalidArgument (``has-velocity-constraints``) for others beside those of the tree.
    """
    own: list[Constraint] = []
    for each in model.velocity_constraints:
        fields = {name: tuple(x) if isinstance(x, list) else x for name, x in each.items() if name != "type"}
        own.append(TYPES[each["type"]](**fields))
    if own:
        own += [Closed(rows.name) for rows in model.closures]
    if not own or tuple(given) in ((), tuple(own)):
        return tuple(own or given)
    names = listed(names_of(model.velocity_constraints))
    message = f"the tree has velocity constraints of its own ({names}): leave these out, or make them part of the tree"
    raise InvalidArgument.at("/constraints", "has-velocity-constraints", message)


def closing(model: Model) -> tuple[Constraint, ...]:
    """The velocity constraints of a tree with all its closures, or these alone."""
    return constraints_of(model) or tuple(Closed(rows.name) for rows in model.closures)


@dataclass
class VelocityRows:
    """Rows of B with their names (constraint, or constraint.row), b of those where it is not zero, and what they keep
    constant by name: the gaps of rolling contacts and the residuals of closures.
    """

    labels: list[str] = field(default_factory=list)
    rows: list[list[Expr]] = field(default_factory=list)
    given: dict[str, Expr] = field(default_factory=dict)
    gaps: dict[str, Expr] = field(default_factory=dict)

    def add(self, label: str, row: list[Expr], given: Expr | None = None) -> None:
        """A row, unless it is zero as a formula."""
        if any(not x.is_zero for x in row):
            self.labels.append(label)
            self.rows.append(row)
            if given is not None and not given.is_zero:
                self.given[label] = given


def velocity_rows(f: Workspace, constraints: Sequence[Constraint]) -> VelocityRows:
    """The rows of all constraints. Raises InvalidArgument, also for a closure of the model that is not among them."""
    scope = f.scope  # its symbols come first in the graph, and so in what is stored
    if any(isinstance(c, Linear) for c in constraints):
        scope.declare("t", "time", "s")
    _require_closed(f, constraints)
    result = VelocityRows()
    framed = any(isinstance(c, (KnifeEdge, Rolling)) for c in constraints)
    kinematics = f.kinematics() if framed else {}
    if framed and f.model.driven:
        kinematics = {**kinematics, **f.outputs(GIVEN)}
    for i, constraint in enumerate(constraints):
        pointer = f"/constraints/{i}"
        if isinstance(constraint, Linear):
            result.add(constraint.name, *affine_row(f, constraint.expression, f"{pointer}/expression"))
        elif isinstance(constraint, Closed):
            _close(f, constraint.name, f"{pointer}/name", result)
        elif constraint.frame not in f.model.frames:
            message = f"unknown frame '{constraint.frame}'{among(constraint.frame, f.model.frames)}"
            scope.fault(f"{pointer}/frame", "unknown-frame", message)
        else:
            frame = _Frame(f, kinematics, f.model.frames.index(constraint.frame))
            if isinstance(constraint, KnifeEdge):
                # B_a = U_a2, b = U_02 of given motions
                result.add(constraint.name, [f.graph.lift(U[1]) for U in frame.U], f.graph.lift(frame.given[0][1]))
            else:
                _roll(f, constraint, pointer, frame, result)
    names = [c.name for c in constraints]
    for i, name in enumerate(names):
        if name in names[:i]:
            scope.fault(f"/constraints/{i}/name", "duplicate-name", f"duplicate constraint '{name}'")
    require_read(scope)
    return result


class _Frame:
    """Kinematics of one frame: rotation to the world, origin, U and Omega of every coordinate in its axes."""

    def __init__(self, f: Workspace, kinematics: Mapping[str, Mapping[tuple[int, ...], Expr]], k: int) -> None:
        zero = f.graph.zero

        def vector(name: str, *index: int) -> Vector:
            """Three elements of a kinematic output."""
            x, y, z = (kinematics[name].get((k, *index, i), zero) for i in range(3))
            return x, y, z

        # R: to the axes of the world; c: origin; U_a, Omega_a: columns in the axes of the frame
        self.R: Matrix = (vector("rotation", 0), vector("rotation", 1), vector("rotation", 2))
        self.c = vector("position")
        self.U = [vector("U", a) for a in range(f.n)]
        self.Omega = [vector("Omega", a) for a in range(f.n)]
        #: of given motions, where the coordinates rest
        self.given = (vector("U_0"), vector("Omega_0")) if "U_0" in kinematics else ((zero,) * 3, (zero,) * 3)


def _require_closed(f: Workspace, constraints: Sequence[Constraint]) -> None:
    """Every closure of the model is among the constraints; else it would be open."""
    given = {c.name for c in constraints if isinstance(c, Closed)}
    for rows in f.model.closures:
        if rows.name not in given:
            message = f"the closure '{rows.name}' is not among them: add {{'name': '{rows.name}', 'type': 'closure'}}"
            raise InvalidArgument.at("/constraints", "open-closure", message)


def _close(f: Workspace, name: str, pointer: str, result: VelocityRows) -> None:
    names = [(rows.name, row) for rows in f.model.closures for row in rows.rows]
    if name not in {closure for closure, _ in names}:
        known = [rows.name for rows in f.model.closures]
        f.scope.fault(pointer, "unknown-closure", f"unknown closure '{name}'{among(name, known)}")
        return
    rates = ["closure.rate"] if "closure.rate" in f.model.program.outputs else []
    found = f.outputs(["closure.jacobian", "closure.residual", *rates])
    zero = f.graph.zero
    for k, (closure, row) in enumerate(names):
        residual = found["closure.residual"].get((k,), zero)
        # phi_k = const is the integral of G_ka q'^a = 0
        if closure == name and not residual.is_zero:
            moved = found[rates[0]].get((k,), zero) if rates else None
            result.add(f"{name}.{row}", [found["closure.jacobian"].get((k, a), zero) for a in range(f.n)], moved)
            result.gaps[f"{name}.{row}"] = residual


def _roll(f: Workspace, c: Rolling, pointer: str, frame: _Frame, result: VelocityRows) -> None:
    radius = f.scope.read(exact(c.radius, f"{pointer}/radius"), f"{pointer}/radius")
    x, y, z = (exact(component, f"{pointer}/normal/{i}") for i, component in enumerate(c.normal))
    plane = axis_rotation(f.scope, (x, y, z), f"{pointer}/normal")
    normal = plane[2]
    # n = R^T N: the normal in the axes of the frame, where the axis e of a disc is (0, 0, 1)
    n = apply(transpose(frame.R), normal)
    if c.shape == "disc":
        across = f.graph.lift(n[0] * n[0] + n[1] * n[1])
        if across.is_zero:
            f.scope.fault(f"{pointer}/frame", "flat-disc", "the axis of the disc is the normal of the plane")
            return
        # rho = -r (n - (n.e) e) / |n - (n.e) e|
        width = f.graph.sqrt(across)
        rho: Vector = (f.graph.lift(-(radius * n[0])) / width, f.graph.lift(-(radius * n[1])) / width, f.graph.zero)
    else:
        # rho = -r n
        rho = (-(radius * n[0]), -(radius * n[1]), -(radius * n[2]))
    # B_a = P R (U_a + Omega_a x rho), P: rotation from the world to the axes of the plane
    columns = []
    for U, Omega in (*zip(frame.U, frame.Omega, strict=True), frame.given):
        columns.append(apply(plane, apply(frame.R, add(U, cross(Omega, rho)))))
    for i, row in enumerate(("slip_1", "slip_2", "contact")):
        *own, given = (f.graph.lift(column[i]) for column in columns)
        result.add(f"{c.name}.{row}", own, given)
    # N . c + n . rho
    result.gaps[c.name] = f.graph.lift(dot(normal, frame.c) + dot(n, rho))


def affine_row(f: Workspace, text: str, pointer: str) -> tuple[list[Expr], Expr]:
    """The coefficients B_a of the velocities in an expression that is affine in them, and what is left: b; else a fault
    is noted.
    """
    x = f.scope.read(text, pointer)
    rates = [f"{name}'" for name in f.model.coordinates]
    # B_a = d x / d q'^a with d B_a / d q'^b = 0 = d B_a / d t, and b = x at q' = 0
    (row,) = gradient([x], rates)
    rest = x - f.graph.sum(c * f.graph.symbol(v) for c, v in zip(row, rates, strict=True))
    if any(not d.is_zero for some in gradient(row, rates) for d in some):
        f.scope.fault(pointer, "not-linear", "the expression must be affine in the velocities: B(q) q' + b(q, t)")
        return row, f.graph.zero
    if not rest.is_zero:
        still = program(f.graph, {"x": Formulas((), {(): x})}, f.symbols)
        rest = f.graph.lift(replay(still, f.graph, dict.fromkeys(rates, f.graph.zero))["x"].entries.get((), 0))
    if any(not d.is_zero for (d,) in gradient(row, ["t"])):
        f.scope.fault(pointer, "not-linear", "the coefficients of the velocities must not depend on the time")
    elif all(c.is_zero for c in row) and not rest.is_zero:
        f.scope.fault(pointer, "not-linear", "the expression must depend on a velocity")
    return row, rest


def linear_row(f: Workspace, text: str, pointer: str) -> list[Expr]:
    """Coefficients of the velocities in an expression that is linear and homogeneous in them; else a fault is noted."""
    row, rest = affine_row(f, text, pointer)
    if not rest.is_zero:
        f.scope.fault(pointer, "not-linear", "the expression must be linear and homogeneous in the velocities")
    return row


def row_values(f: Workspace, rows: Sequence[Sequence[Expr]], near: Mapping[str, float] | None = None) -> Any:
    """Values of rows (K, m, n) at three random states, or ``near`` the given one."""
    n = len(rows[0])
    p = program(f.graph, {"x": array((len(rows), n), lambda k, a: rows[k][a])}, f.symbols)
    rng = np.random.default_rng(3)
    values = {s.name: rng.uniform(0.3, 1.1, 3) for s in p.symbols}
    if near is not None:
        values |= {name: np.full(3, near[name]) for name in values if name in near}
    # rows of numbers only have no axis of states
    return np.broadcast_to(interpret(p, values)["x"], (3, len(rows), n))
