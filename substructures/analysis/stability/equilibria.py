"""Equilibria from the force formulas, by Newton's method with the exact Jacobian: Q_a(q, q' = 0) = 0, and with closures
Q_a + lambda_k G_ka = 0, phi_k(q) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.stability.equilibria_closed import ClosedSearch
from substructures.analysis.stability.equilibrium_search import EquilibriaRequest, RestSearch
from substructures.analysis.stability.linearisation import Linearisation
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.linearise_closed import ClosedLinearisation
from substructures.array import Array
from substructures.documents import read_model
from substructures.tree.model import Model

#: two equilibria closer than this are one [rad, m]
SAME = 1e-6
#: singular values of K below this share of the largest leave a direction undetermined
SINGULAR = 1e-9


@dataclass(frozen=True)
class Equilibrium:
    """``q`` (n,): angles in (-pi, pi]. ``free``: directions (k, n) in which the forces do not decide (K singular); with
    closures those that keep them.

    ``at``: the linearisation there with modes and stability.
    """

    q: Array
    free: Array
    at: Linearisation


@dataclass(frozen=True)
class Equilibria:
    """All that were found, in the order of their coordinates. ``held``: coordinates on which no force and no closure
    depends, kept at their start. ``message``: advice when nothing was found.
    """

    found: tuple[Equilibrium, ...]
    held: tuple[str, ...]
    message: str = ""

    def summary(self) -> dict[str, Any]:
        """As plain data and arrays."""
        found = [{"q": e.q, "free": e.free, "at": e.at.summary()} for e in self.found]
        return {"found": found, "held": list(self.held), "message": self.message}


def equilibria(model: Model, request: Mapping[str, Any] | None = None) -> Equilibria:
    """Equilibria of a model; ``request``: see EquilibriaRequest.

    Starts of closed loops are first moved onto the closures; an equilibrium in a singular position has a linearisation
    that is ``failed``. Raises InvalidDocument (pointers; ``not-smooth``) and MissingValue.
    """
    require_moving(model)
    read = read_model(EquilibriaRequest, request or {})
    search = ClosedSearch(model, read) if model.closures else RestSearch(model, read)
    starts = search.starts()
    held = search.held(starts)
    moving = [a for a in range(model.dof) if a not in held]
    found: list[Array] = []
    starts[:, held] = starts[0, held]
    for start in starts:
        q = search.solve(start, moving)
        if q is not None and not any(search.distance(q, other) < SAME for other in found):
            found.append(q)
    names = tuple(model.coordinates[a] for a in held)
    ordered = [found[i] for i in np.lexsort(np.round(found, 6).T[::-1])] if found and model.dof else found
    results = tuple(_described(model, read, q) for q in ordered)
    message = "" if results else search.advice(starts[0], held)
    return Equilibria(results, names, message)


def _described(model: Model, read: EquilibriaRequest, q: Array) -> Equilibrium:
    """With its singular directions and its linearisation."""
    at = linearise(model, {"q": q, "t": read.t, "parameters": read.parameters, "inputs": read.inputs})
    if isinstance(at, ClosedLinearisation):
        q = at.q
    if at.status == "failed" or not len(at.K):
        return Equilibrium(q, np.zeros((0, model.dof)), at)
    _, sizes, rows = np.linalg.svd(at.K)
    free = rows[sizes <= SINGULAR * max(1.0, float(sizes.max(initial=0)))]
    if isinstance(at, ClosedLinearisation):
        free = free @ at.tangent.T
        free /= np.linalg.norm(free, axis=1, keepdims=True)
    return Equilibrium(q, free, at)
