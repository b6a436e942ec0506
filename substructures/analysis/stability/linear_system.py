"""A linearised tree as a linear system x' = A x + B u: its poles, and which modes inputs reach and outputs see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import NumberOrExpression
from substructures.analysis.equations.formulas import unsteady
from substructures.analysis.given import StateArray
from substructures.analysis.stability.linearisation_result import Linearisation
from substructures.analysis.stability.linearise import linearise
from substructures.array import Array, ComplexArray
from substructures.errors import InvalidArgument
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

#: relative distances to an uncontrollable pair: below the first it is one, above the second it is none
LOST, SURE = 1e-10, 1e-7
#: of a vector of length 1, what is told of it
PART = 0.3


@dataclass(frozen=True)
class Reach:
    """How far a mode is from what inputs do not move, or outputs do not see: ``eigenvalue`` [1/s], ``distance`` the
    least singular value of (A - s, B), or of (A - s, C), states and inputs scaled, relative to its largest; ``parts``:
    names of the components of x of which what is not moved (not seen) mostly consists, the largest first.
    """

    eigenvalue: complex
    distance: float
    parts: tuple[str, ...] = ()


def linear_system(
    model: Model, q: StateArray, point: Mapping[str, Any], outputs: Mapping[str, NumberOrExpression], what: str
) -> Linearisation:
    """A, B, C, D about one state, with inputs that act, for ``what``. Raises as :func:`linearise`, and
    InvalidArgument.
    """
    require_untied(model, what)
    if why := unsteady(model, point.get("inputs") or {}):
        raise InvalidArgument.at("/q", "not-steady", f"{why}: linearise gives A, B, C, D at any time")
    found = linearise(model, q, outputs=outputs, **point)
    if found.M.ndim == 3:
        raise InvalidArgument.at("/q", "one-state", "one state is needed, not several")
    if found.status == "failed":
        raise InvalidArgument.at("/q", "not-linearised", found.message)
    if not found.inputs:
        raise InvalidArgument.at("/of_inputs", "no-input", "no input acts: name one in 'of_inputs'")
    return found


def eigenvalues(A: Array) -> ComplexArray:
    """In the order of their real parts."""
    found = np.linalg.eigvals(A).astype(np.complex128)
    return found[np.lexsort((found.imag, found.real))]


def reach(A: Array, B: Array, names: Sequence[str]) -> tuple[Reach, ...]:
    """The test of Popov, Belevitch and Hautus for every mode, slowest first; columns of B of equal size; ``names``: of
    the components of x.
    """
    balanced, (scales, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    sizes = np.linalg.norm(B / scales[:, None], axis=0)
    columns = (B / scales[:, None])[:, sizes > 0] / sizes[sizes > 0]
    columns = columns * max(1.0, float(np.linalg.norm(balanced, 2)))
    found = []
    for s in sorted(eigenvalues(A), key=lambda x: (abs(x), x.imag)):
        U, values, _ = scipy.linalg.svd(np.hstack([balanced - s * np.eye(len(A)), columns]), full_matrices=False)
        distances = values / values[0] if values[0] > 0 else np.zeros(len(A))
        shares = np.linalg.norm(U[:, distances < SURE], axis=1)
        worst = [int(i) for i in np.argsort(-shares, kind="stable") if shares[i] > PART]
        found.append(Reach(complex(s), float(distances[-1]), tuple(names[i] for i in worst)))
    return tuple(found)


def is_complete(modes: Sequence[Reach]) -> bool | None:
    """Whether every mode is reached; None where rounding decides."""
    least = min((each.distance for each in modes), default=1.0)
    return True if least > SURE else False if least < LOST else None
