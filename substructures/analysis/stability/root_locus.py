"""Root locus: the eigenvalues of an equilibrium, followed while a parameter changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field
from scipy.optimize import linear_sum_assignment

from substructures.analysis.stability.equilibria import equilibria
from substructures.array import Array, ComplexArray
from substructures.documents import DocumentPart, read_model
from substructures.documents.fields import Real
from substructures.errors import InvalidDocument
from substructures.tree.model import Model


class RootLocusRequest(DocumentPart):
    """``parameter`` takes the ``values`` one after the other; ``q``: where the first equilibrium is near to."""

    parameter: str
    values: Annotated[tuple[Real, ...], Field(min_length=1, max_length=10_000)]
    q: Any
    parameters: dict[str, Real] = Field({}, description="of all others, in place of their defaults")
    inputs: dict[str, Real] = Field({}, description="constant; 0 by default")


@dataclass(frozen=True)
class RootLocus:
    """Branches: ``eigenvalues`` (N, 2r) [1/s] for r degrees of freedom (n of a tree without closures), ``q`` (N, n) and
    ``stability`` verdicts at ``values`` (N,).

    ``status`` ``failed``: the equilibrium was lost, ``message`` says where; the arrays end before.
    """

    values: Array
    q: Array
    eigenvalues: ComplexArray
    stability: tuple[str, ...]
    status: str = "finished"
    message: str = ""

    def summary(self) -> dict[str, Any]:
        """As plain data and arrays; eigenvalues as pairs, (N, 2r, 2)."""
        pairs = np.stack([self.eigenvalues.real, self.eigenvalues.imag], axis=-1)
        return {**vars(self), "eigenvalues": pairs, "stability": list(self.stability)}


def root_locus(model: Model, request: Mapping[str, Any]) -> RootLocus:
    """Eigenvalues of x' = A x over the values of a parameter, in branches that change least from value to value.

    ``request``: see RootLocusRequest. Raises InvalidDocument (pointers) and MissingValue.
    """
    read = read_model(RootLocusRequest, request)
    if read.parameter not in model.parameters:
        raise InvalidDocument.at("/parameter", "unknown-parameter", f"unknown parameter '{read.parameter[:80]}'")
    q: Any = read.q
    rows: list[tuple[Array, ComplexArray, str]] = []
    status, message = "finished", ""
    for value in read.values:
        found = _nearest(model, read, value, q)
        if found is None or (rows and len(found[1]) != len(rows[-1][1])):
            status = "failed"
            message = f"there is no equilibrium near the last one at {read.parameter} = {value:g}: take smaller steps"
            break
        q, roots, verdict = found
        rows.append((q, _followed(rows[-1][1], roots) if rows else roots, verdict))
    n, count = model.dof, len(rows)
    return RootLocus(
        np.array(read.values[:count]),
        np.array([row[0] for row in rows]).reshape(count, n),
        np.array([row[1] for row in rows], dtype=np.complex128).reshape(count, len(rows[0][1]) if rows else 2 * n),
        tuple(row[2] for row in rows),
        status,
        message,
    )


def _nearest(model: Model, read: RootLocusRequest, value: float, q: Any) -> tuple[Array, ComplexArray, str] | None:
    """The equilibrium that Newton's method finds from q."""
    parameters = read.parameters | {read.parameter: value}
    request = {"starts": [np.asarray(q).tolist()], "count": 0, "parameters": parameters, "inputs": read.inputs}
    found = equilibria(model, request).found
    if not found:
        return None
    near = min(found, key=lambda e: float(np.abs(e.q - np.asarray(q, dtype=np.float64)).max(initial=0)))
    if near.at.stability is None:
        return None
    return near.q, np.linalg.eigvals(near.at.A).astype(np.complex128), near.at.stability.verdict


def _followed(before: ComplexArray, roots: ComplexArray) -> ComplexArray:
    """The roots in the order in which they are nearest to the ones before."""
    _, order = linear_sum_assignment(np.abs(before[:, None] - roots[None, :]))
    return roots[order]
