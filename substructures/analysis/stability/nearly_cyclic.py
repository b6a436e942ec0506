"""Coordinates that are cyclic but for the rounding of decimals: a world that is turned by them has its gravity along an
axis to 16 digits, and no formula of it is zero.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from substructures.analysis.stability.equilibrium_search import RestConditions
from substructures.array import Array
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: what rounding of decimals is of the size of what it is in; states that are looked at
ROUNDING, STATES = 1e-12, 12


def nearly_cyclic(model: Model, conditions: RestConditions) -> list[str]:
    """The coordinates c on which, and along which, nothing depends or acts but rounding, by numbers at random states.

    Sizes are those of the geometry, whatever the units: of g_ab sqrt(g_aa g_bb), of Q_a sqrt(g_aa) times the largest
    Q_b / sqrt(g_bb) there is, of G_ka the largest element of G.
    """
    rng, n = np.random.default_rng(7), model.dof
    q, qd = rng.uniform(-1, 1, (2, STATES, n))
    shift = rng.uniform(0.5, 1.5, STATES)
    here = _sized(model, conditions, q, qd)
    found = []
    for c, name in enumerate(model.coordinates):
        there = _sized(model, conditions, q + shift[:, None] * np.eye(n)[c], qd)
        stays = all(np.abs(there[k] - x).max(initial=0) <= ROUNDING for k, x in here.items())
        if stays and all(np.abs(here[k][..., c]).max(initial=0) <= ROUNDING for k in ("forces", "closures")):
            found.append(name)
    return found


def _sized(model: Model, conditions: RestConditions, q: Array, qd: Array) -> dict[str, Array]:
    """Metric (N, n, n), forces (N, n) and the Jacobian of closures (N, m, n) over their sizes; not a number where there
    is none.
    """
    names = [name for name in ("metric", "forces", "closure.jacobian") if name in model.program.outputs]
    states = read_states(model, {"q": q, "qd": qd}, None)
    given: dict[str, Any] = symbol_values(model, vars(conditions), states, names)
    found = interpret_in_blocks(model.program, given, names, len(q))
    g, Q, G = found["metric"], found["forces"], found.get("closure.jacobian", np.zeros((len(q), 0, model.dof)))
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(np.einsum("naa->na", g))
        forces = Q / root
        return {
            "metric": g / (root[:, :, None] * root[:, None, :]),
            "forces": forces / (np.abs(forces).max(initial=0) or 1.0),
            "closures": G / (np.abs(G).max(initial=0) or 1.0),
        }
