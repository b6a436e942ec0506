"""Root locus: the eigenvalues of an equilibrium, followed while a parameter changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import Numbers, reals
from substructures.analysis.given import StateArray, numbers
from substructures.analysis.stability.equilibria import Equilibrium, equilibria_within
from substructures.analysis.stability.equilibrium_search import FREE, SAME, SearchRange
from substructures.analysis.stability.linearisation_result import (
    ClosedLinearisation,
    ConstrainedLinearisation,
    Linearisation,
)
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.operating_point import RestConditions
from substructures.array import Array, ComplexArray
from substructures.errors import InvalidArgument, among
from substructures.quantities.measured import numeric
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.quantities.numbers.quaternions import by_displacements, with_unit_quaternions
from substructures.quantities.numbers.states import read_states
from substructures.tree.model import Model

#: of a parameter
MAX_VALUES = 10_000
#: how many first steps of Newton's method lead to an equilibrium that is the same one: at a fold it is two
FARTHER = 3.0


@dataclass(frozen=True, repr=False)
class RootLocus:
    """Branches: ``eigenvalues`` (N, k) [1/s], ``q`` (N, n), with ball joints (N, m) with quaternions, and
    ``stability`` verdicts at ``values`` (N,). k is twice the number of degrees of freedom (2n of a tree without
    closures); with velocity constraints those of the motions that keep the gaps, without coordinates on which nothing
    depends.

    ``status`` ``failed``: the equilibrium was lost, ``message`` says where; the arrays end before.
    """

    values: Array
    q: Array
    eigenvalues: ComplexArray
    stability: tuple[str, ...]
    status: str = "finished"
    message: str = ""

    def __repr__(self) -> str:
        branches = self.eigenvalues.shape[1]
        finding = ", then ".join(verdict for verdict, _ in groupby(self.stability))
        message = f"failed: {self.message}" if self.status == "failed" else finding
        return f"RootLocus(values={len(self.values)}, branches={branches})\n{message}"


def root_locus(
    model: Model,
    parameter: str,
    values: Numbers,
    q: StateArray,
    *,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
) -> RootLocus:
    """Eigenvalues of x' = A x at an equilibrium, in branches that change least from value to value of a parameter.

    ``parameter`` takes the ``values`` (N,) one after the other; ``q`` (n,) [rad, m]: where the first equilibrium is
    near to. ``parameters``: all others, in place of their defaults; ``inputs``: constant [N m, N], their defaults,
    or 0. An equilibrium that is lost ends the locus with advice. Raises InvalidInput (``/parameter``, ``/values``,
    ``/q``, ...) and MissingValue. Source: W. R. Evans, Graphical analysis of control systems, Trans. AIEE 67, 1948.
    """
    at = reals(values, "/values")
    if not 0 < len(at) <= MAX_VALUES:
        message = f"{len(at):,} values; 1 to {MAX_VALUES:,} are needed"
        raise InvalidArgument.at("/values", "too-short" if not at else "too-long", message)
    others = numbers(parameters, "parameters")
    constant = numbers(with_input_defaults(model.inputs, inputs or {}), "inputs")
    if parameter not in model.parameters:
        message = f"unknown parameter '{str(parameter)[:80]}'{among(parameter, model.parameters)}"
        raise InvalidArgument.at("/parameter", "unknown-parameter", message)
    near, before = _start(model, q), None
    rows: list[tuple[Array, ComplexArray, str]] = []
    status, message = "finished", ""
    for value in at:
        conditions = RestConditions(0.0, others | {parameter: value}, constant)
        found = _nearest(model, near, conditions)
        if found is None or (before is not None and _is_lost(model, (near, before), (found, conditions), rows[-1][1])):
            status = "failed"
            near_to = "the last one" if rows else "'q'"
            way = "take smaller steps" if rows else "give another 'q'"
            message = f"there is no equilibrium near {near_to} at {parameter} = {value:g}: {way}"
            break
        near, before, roots = found.q, conditions, _eigenvalues(found.at)
        rows.append((near, _followed(rows[-1][1], roots) if rows else roots, found.verdict))
    return RootLocus(np.array(at[: len(rows)]), *_branches(rows, model), status, message)


def _branches(
    rows: Sequence[tuple[Array, ComplexArray, str]], model: Model
) -> tuple[Array, ComplexArray, tuple[str, ...]]:
    """q (N, m), eigenvalues (N, 2r) and verdicts."""
    count, width = len(rows), len(rows[0][1]) if rows else 2 * model.dof
    q = np.array([row[0] for row in rows]).reshape(count, len(model.positions))
    roots = np.array([row[1] for row in rows], dtype=np.complex128).reshape(count, width)
    return q, roots, tuple(row[2] for row in rows)


def _start(model: Model, q: Any) -> Array:
    """One position (n,), by coordinate, or a number where there is one coordinate. Raises InvalidInput."""
    if isinstance(q, Mapping):
        return read_states(model, {"q": q}, 1).q[0]
    start = np.atleast_1d(numeric(q, "/q"))
    n = len(model.positions)
    if start.shape != (n,):
        raise InvalidArgument.at("/q", "wrong-length", f"shape {start.shape} found, ({n},) expected")
    return with_unit_quaternions(model.positions, model.balls, start[None])[0]


def _nearest(model: Model, q: Array, conditions: RestConditions) -> Equilibrium | None:
    """The equilibrium with a verdict that Newton's method finds from q."""
    found = equilibria_within(model, SearchRange(q[None], count=0, from_zero=False), conditions).found
    return found[0] if found and found[0].at.stability is not None else None


def _is_lost(
    model: Model, last: tuple[Array, RestConditions], new: tuple[Equilibrium, RestConditions], roots: ComplexArray
) -> bool:
    """Whether an equilibrium is another one than the ``last``: it has another number of eigenvalues than ``roots``, or
    is farther away than Newton's first step leads, and the way back does not lead to the last one.
    """
    (q, before), (found, now) = last, new
    if len(_eigenvalues(found.at)) != len(roots):
        return True
    step = _first_step(linearise(model, q, parameters=now.parameters, inputs=now.inputs))
    way = _way(model, q, found.q)
    if not np.linalg.norm(way) > FARTHER * np.linalg.norm(step) + SAME:
        return False
    back = _nearest(model, found.q, before)
    return back is None or bool(np.linalg.norm(_way(model, q, back.q)) > np.linalg.norm(way) / 2)


def _first_step(at: Linearisation) -> Array:
    """dq of K dq = M q'' (n,), on closures and constraints; not finite where there is none."""
    if at.status == "failed":
        return np.full(len(at.coordinates), np.inf)
    if isinstance(at, ConstrainedLinearisation):
        K, accelerations, ways = at.K @ at.T, at.vd, at.T
    elif isinstance(at, ClosedLinearisation):
        free = [at.coordinates.index(name) for name in at.independent]
        K, accelerations, ways = at.K, at.qdd[free], at.tangent
    else:
        K, accelerations, ways = at.K, at.qdd, np.eye(len(at.K))
    return np.asarray(ways @ np.linalg.lstsq(K, at.M @ accelerations, rcond=FREE)[0])


def _way(model: Model, q: Array, other: Array) -> Array:
    """From one place to another one (n,), of angles the shorter way, of ball joints by displacements."""
    way = by_displacements(model.positions, model.coordinates, model.balls, q) @ (other - q)
    turning = [kind == "R" for kind in model.joints]
    return np.where(turning, np.mod(way + np.pi, 2 * np.pi) - np.pi, way)


def _eigenvalues(at: Linearisation | ClosedLinearisation | ConstrainedLinearisation) -> ComplexArray:
    """z of det(A - z 1) = 0; with velocity constraints of the part of A whose modes are told."""
    if not isinstance(at, ConstrainedLinearisation):
        return np.linalg.eigvals(at.A).astype(np.complex128)
    # modes have the eigenvalue of a pair that is not below the real axis
    upper = [mode.eigenvalue for mode in at.modes]
    return np.array([*upper, *(z.conjugate() for z in upper if z.imag)], dtype=np.complex128)


def _followed(before: ComplexArray, roots: ComplexArray) -> ComplexArray:
    """The roots in the order in which they are nearest to the ones before."""
    # the permutation s of least sum |z_i - z'_s(i)|
    _, order = scipy.optimize.linear_sum_assignment(np.abs(before[:, None] - roots[None, :]))
    return roots[order]
