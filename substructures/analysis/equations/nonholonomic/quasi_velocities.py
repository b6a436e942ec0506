"""Equations of motion in quasi-velocities: Voronets and Boltzmann-Hamel (notation.md, section 7), as formulas.

With p quasi-velocities v and m constraints B q' + b = 0, Y q' = (v, -b): the first p rows of Y define v, the others
are B. The columns of Y^-1 are T and S (B S = 1), and q' = T v + r with r = -S b. Both forms are g* v' + bias = forces
with g* = T^T g T:

    Voronets          bias = T^T (g (T' v + r') + Gamma q'q')
    Boltzmann-Hamel   bias_i = (g*' v + (T^T g r)')_i - X_i(T*) - c^k_ji v^j p_k,  p = (T S)^T g q',  X_i = T^a_i d_a,
                      [X_i, X_j] = c^k_ij X_k: the structure coefficients, formed from T; where b is not 0 the sum over
                      j has a member with v^0 = 1 and X_0 = d/dt + r^a d_a
                      (G. Hamel, Theoretische Mechanik, 1949; A. M. Bloch, J. E. Marsden, D. V. Zenkov, Dynamical
                      Systems 24, 2009)

====================  =====  ==============================================================================
output                shape  meaning (n coordinates, p quasi-velocities, m constraints)
====================  =====  ==============================================================================
constraints           m n    B
given                 m      b, where it is not zero
T                     n p    q' = T v + r
rates                 n      T v + r
metric                p p    T^T g T
bias                  p      of Voronets' form
hamel_bias            p      of the Boltzmann-Hamel form; not with given motions
forces                p      T^T Q
structure             n p p  c^k_ij at [k, i, j]
multipliers           m      lambda in g q'' + Gamma q'q' = Q + B^T lambda; needs v' (``name'``): S^T (g q'' + ... - Q)
kinetic_energy               T* = v^T g* v / 2, of trees with given motions T_2 - T_0 [J]
potential_energy             of gravity and springs [J]
lost_power                   power of the forces without potential, and dV/dt of springs that change with time [W]
constraint_power             of the constraints where b is not zero: -lambda_k b_k; needs v' [W]
gaps                  k      constant [m, 1]: distances of rolling bodies from planes, residuals of closures
====================  =====  ==============================================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

from substructures.analysis.equations.cofactors import MatrixRows, inverse
from substructures.analysis.equations.nonholonomic.expected import quasi_expected
from substructures.analysis.equations.nonholonomic.independent_rows import independent_rows
from substructures.analysis.equations.nonholonomic.quasi_choice import (
    independent_coordinates,
    quasi_velocity_rows,
    vanishing,
)
from substructures.analysis.equations.nonholonomic.quasi_equations import QuasiEquations
from substructures.analysis.equations.nonholonomic.velocity_constraints import (
    GIVEN,
    Closed,
    Constraint,
    VelocityRows,
    constraints_of,
)
from substructures.errors import InvalidArgument, listed
from substructures.expr.graph import Expr
from substructures.expr.known import Known
from substructures.expr.program import Program, array, program
from substructures.printers.render import write
from substructures.quantities.certificate import DYNAMICS as CERTIFIED
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.memo import known_model
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.document import require_undriven, require_unignored
from substructures.tree.model import KINEMATICS, Model

#: of quasi-velocities by name, or of independent coordinates, near values of coordinates and parameters
Choice = tuple[tuple[tuple[str, str], ...] | None, tuple[str, ...] | None, tuple[tuple[str, float], ...] | None]


@dataclass(frozen=True)
class QuasiVelocities:
    """The equations (the table above) with names: quasi-velocities v, constraint rows, gaps; rows left out because
    they follow from others (``dependent``). Where the ``determinant`` is zero they do not describe the motion; None
    where no such place is known.
    """

    model: Model
    program: Program
    velocities: tuple[str, ...]
    constraints: tuple[str, ...]
    gaps: tuple[str, ...]
    dependent: tuple[str, ...]
    determinant: Program | None = None

    @cached_property
    def singular(self) -> str:
        """The determinant as text, printed when it is told; empty where there is none."""
        if self.determinant is None:
            return ""
        text = write(self.determinant, "text", "readable").partition("determinant = ")[2].strip()
        return text or "the determinant of the velocities"

    def __repr__(self) -> str:
        return (
            f"QuasiVelocities: {listed(self.velocities)} of {self.model.dof} coordinates; "
            f"constraints: {listed(self.constraints) or 'none'}\n"
            f"gaps: {listed(self.gaps) or 'none'}; dependent: {listed(self.dependent) or 'none'}; "
            f"{len(self.program)} operations"
        )


def quasi_velocity_equations(
    model: Model,
    constraints: Sequence[Constraint] = (),
    *,
    velocities: Mapping[str, str] | None = None,
    independent: Sequence[str] | None = None,
    near: Mapping[str, float] | None = None,
) -> QuasiVelocities:
    """The equations of a model with velocity constraints, all formulas; ``constraints``: default those of the tree.

    The quasi-velocities: ``velocities``, as many as the constraints leave free, by name, each an expression linear in
    the velocities; or those of the coordinates ``independent``; default: those that the parts name, where closures are
    the only constraints and nothing is ``near``, else chosen for short formulas that describe the motion well ``near``
    these values of coordinates and parameters.

    Raises InvalidInput (pointers start with names of arguments): constraints that are not linear, quasi-velocities that
    do not determine the velocities; TooLarge.
    """
    require_undriven([name for name in model.driven if name in model.inputs], "give their motions as formulas in t")
    require_unignored(model.ignored)
    constraints = constraints_of(model, constraints)
    is_free = velocities is None and independent is None and near is None
    if is_free and all(isinstance(each, Closed) for each in constraints):
        independent = model.reduction.independent or None
    if velocities is None and independent is None and near is not None:
        independent = chosen_near(model, constraints, near)
    named = None if velocities is None else tuple(velocities.items())
    found = _equations(known_model(model), constraints, named, None if independent is None else tuple(independent))
    return replace(found, model=model)


def chosen_near(model: Model, constraints: tuple[Constraint, ...], near: Mapping[str, float]) -> tuple[str, ...]:
    """The independent coordinates by which the motion is described well near these values of coordinates and
    parameters. Raises InvalidInput for constraints that are none.
    """
    return tuple(independent_coordinates(*rows_of(model, constraints), near))


def rows_of(model: Model, constraints: tuple[Constraint, ...]) -> tuple[Workspace, MatrixRows]:
    """The rows of constraints that are independent, and where they are formulas. Raises InvalidInput."""
    return _rows_of(known_model(model), constraints)


@lru_cache(maxsize=32)
def _rows_of(known: Known, constraints: tuple[Constraint, ...]) -> tuple[Workspace, MatrixRows]:
    f = Workspace(known.source)
    return f, independent_rows(f, constraints)[0].rows


@lru_cache(maxsize=32)
def _equations(
    known: Known,
    constraints: tuple[Constraint, ...],
    named: tuple[tuple[str, str], ...] | None,
    independent: tuple[str, ...] | None,
) -> QuasiVelocities:
    model: Model = known.source
    velocities = None if named is None else dict(named)
    f = Workspace(model)
    rows, dependent = independent_rows(f, constraints)
    names, own = quasi_velocity_rows(f, rows, velocities, independent)
    # Y q' = (v, -b), Y^-1 = [T S]
    Y = [*own, *rows.rows]
    inverted = inverse(Y)
    if inverted is None:
        pointer = "/independent" if velocities is None else "/velocities"
        message = "these velocities and the constraints do not determine the velocities of all coordinates"
        raise InvalidArgument.at(pointer, "dependent", message)
    result = _formed(QuasiEquations(f, names, Y, inverted, _given(rows, f)), rows)
    texts = {name: name for name in names} if velocities is None else dict(velocities)
    expectation = quasi_expected(model, result, texts, rows, constraints)
    kinds = {s.name: s.kind for s in f.symbols.values()}
    needs = (*CERTIFIED, *KINEMATICS, *GIVEN, "closure.rate")
    result = certified(result, model, expectation, "velocity equations", needs=needs, more=kinds)
    labels = tuple(rows.labels), tuple(rows.gaps), tuple(dependent)
    return QuasiVelocities(model, result, tuple(names), *labels, vanishing(f, Y))


def _given(rows: VelocityRows, f: Workspace) -> list[Expr]:
    """The given velocities of all rows; none where no row has one."""
    return [rows.given.get(label, f.graph.zero) for label in rows.labels] if rows.given else []


def _formed(equations: QuasiEquations, rows: VelocityRows) -> Program:
    """The equations, with the gaps that the constraints keep closed."""
    outputs, gaps = equations.outputs(), list(rows.gaps.values())
    if gaps:
        outputs["gaps"] = array((len(gaps),), lambda k: gaps[k])
    return program(equations.f.graph, outputs, equations.f.symbols)
