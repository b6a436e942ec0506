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
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearisation_result import (
    ClosedLinearisation,
    ConstrainedLinearisation,
    Linearisation,
)
from substructures.array import Array, ComplexArray
from substructures.errors import InvalidArgument, among
from substructures.quantities.measured import numeric
from substructures.quantities.numbers.quaternions import by_displacements, with_unit_quaternions
from substructures.quantities.numbers.states import read_states
from substructures.tree.model import Model

#: of a parameter
MAX_VALUES = 10_000


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
    others, constant = numbers(parameters, "parameters"), numbers(inputs, "inputs")
    if parameter not in model.parameters:
        message = f"unknown parameter '{str(parameter)[:80]}'{among(parameter, model.parameters)}"
        raise InvalidArgument.at("/parameter", "unknown-parameter", message)
    near = _start(model, q)
    rows: list[tuple[Array, ComplexArray, str]] = []
    status, message = "finished", ""
    for value in at:
        found = _nearest(model, near, others | {parameter: value}, constant)
        if found is None or (rows and len(found[1]) != len(rows[-1][1])):
            status = "failed"
            message = f"there is no equilibrium near the last one at {parameter} = {value:g}: take smaller steps"
            break
        near, roots, verdict = found
        rows.append((near, _followed(rows[-1][1], roots) if rows else roots, verdict))
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


def _nearest(
    model: Model, q: Array, parameters: Mapping[str, float], inputs: Mapping[str, float]
) -> tuple[Array, ComplexArray, str] | None:
    """The equilibrium that Newton's method finds from q, its eigenvalues, and the verdict."""
    found = equilibria(model, starts=q, count=0, parameters=parameters, inputs=inputs).found
    if not found:
        return None
    moved = by_displacements(model.positions, model.coordinates, model.balls, q)
    near = min(found, key=lambda e: float(np.abs(moved @ (e.q - q)).max(initial=0)))
    if near.at.stability is None:
        return None
    return near.q, _eigenvalues(near.at), near.at.stability.verdict


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
