"""Steady motions with ball and floating joints: cyclic rates are constant, and everything else keeps still.

A rate of a ball joint is cyclic where its body is the same turned about this axis of its own (the spin of a top), a
coordinate where nothing depends on it (a wheel). Places are those of rest at these rates, ID(q, v, v' = 0) = 0, and
disturbances those of all displacements and rates, in the axes of bodies. Turning about the vertical, as a precession,
is no rate of a joint: what goes round steadily is found where a coordinate turns it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.stability.energy_integrals import bounded_by_integrals
from substructures.analysis.stability.equilibrium_search import NEEDS, BallSearch, RestConditions, SearchRange
from substructures.analysis.stability.found_places import confirmed
from substructures.analysis.stability.linearisation_result import Linearisation
from substructures.analysis.stability.steady_result import SteadyMotion, SteadyMotions
from substructures.analysis.stability.vibrations import Stability
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument, listed
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

Linearised = Callable[[Array, Array], Linearisation]
CHANGES = "its disturbances do not keep their equations along the motion: there are no modes, and no verdict by them"


@dataclass(frozen=True, repr=False)
class BallSteadyMotion(SteadyMotion):
    """``q`` (m,) by ``positions``; M, D, K (n, n) are those of M dv' + D dv + K dq = 0, dq' = dv + R dq, for
    displacements dq and all rates v.
    """

    positions: tuple[str, ...] = ()

    def __repr__(self) -> str:
        place = ", ".join(f"{name}={x:.6g}" for name, x in zip(self.positions, self.q.tolist(), strict=True))
        rates = ", ".join(f"{name}'={w:.6g}" for name, w in zip(self.moving, self.rates.tolist(), strict=True))
        finding = self.message if self.stability is None else f"{self.stability.verdict}: {self.stability.reason}"
        return f"SteadyMotion({', '.join(filter(None, (place, rates)))})\n{finding}"


class _Search(BallSearch):
    """At rates (n,)."""

    def __init__(self, model: Model, within: SearchRange, conditions: RestConditions, rates: Array) -> None:
        self.rates = rates
        super().__init__(model, within, conditions)

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        """The rates."""
        return {}, [([f"{name}'" for name in self.model.coordinates], self.rates[None])]


def steady_with_balls(
    model: Model, rates: Mapping[str, float], within: SearchRange, conditions: RestConditions, linearised: Linearised
) -> SteadyMotions:
    """At the ``rates`` of cyclic ones by name, 0 of the others; ``linearised``: about a state (q, v). Raises
    InvalidInput (``/rates/name``), MissingValue.
    """
    require_smooth(model)
    acting = [name for name, value in conditions.inputs.items() if value]
    zero = [name for name, value in conditions.parameters.items() if not value]
    cyclic = first_integrals(model, acting, zero).cyclic
    faults = [
        Fault(f"/rates/{name}", "not-cyclic", f"'{name[:80]}' is no cyclic rate; there are: {listed(cyclic) or 'none'}")
        for name in rates
        if name not in cyclic
    ]
    if faults:
        raise InvalidArgument(faults)
    if not cyclic:
        raise InvalidArgument.at("/rates", "no-cyclic-coordinate", "there is no rate that is constant by itself")
    v = np.array([rates.get(name, 0.0) for name in model.coordinates])
    search = _Search(model, within, conditions, v)
    places = search.starts()
    held = search.held(places)
    moving = [a for a in range(search.n) if a not in held]
    places[:, held] = places[0, held]
    found, _ = search.places(places, moving)
    motions, left_out = confirmed([_described(model, conditions, q, v, cyclic, linearised(q, v)) for q in found])
    message = "" if motions else "no steady motion was found: give 'starts' near one, other rates, or raise 'count'"
    return SteadyMotions(motions, cyclic, "momenta", message="; ".join(filter(None, (message, left_out))))


def _values(model: Model, conditions: RestConditions, q: Array, v: Array) -> dict[str, float]:
    """Of all symbols."""
    states = read_states(model, {"q": q, "qd": v}, None)
    found = symbol_values(model, vars(conditions), states, NEEDS)
    return {name: float(np.ravel(x)[0]) for name, x in found.items()}


def _described(
    model: Model, conditions: RestConditions, q: Array, v: Array, cyclic: tuple[str, ...], at: Linearisation
) -> BallSteadyMotion:
    """With its linearisation."""
    places = [model.coordinates.index(name) for name in cyclic]
    named = model.coordinates, cyclic, model.coordinates
    told = at.message if at.status == "failed" else "" if at.stability is not None else CHANGES
    judged = at.stability
    if judged is not None and judged.verdict == "undecided" and not any(conditions.inputs.values()):
        zero = [name for name, value in conditions.parameters.items() if not value]
        reason = bounded_by_integrals(model, _values(model, conditions, q, v), places, zero)
        judged = judged if reason is None else Stability("stable", reason)
    return BallSteadyMotion(
        *named, q, v[places], (at.M @ v)[places], at.M, at.D, at.K, at.qdd, at.modes, judged, told,
        positions=model.positions,
    )  # fmt: skip
