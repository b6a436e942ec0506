"""What steady motions are asked for: rates or momenta, and what varies; and the coordinates that move then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.analysis.arguments import reals
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.steady import require_free
from substructures.analysis.given import numbers
from substructures.analysis.stability.equilibrium_search import RestConditions, SearchRange
from substructures.analysis.stability.nearly_cyclic import nearly_cyclic
from substructures.analysis.stability.steady_result import Held
from substructures.analysis.stability.steady_search import ClosedSteadySearch, SteadySearch
from substructures.errors import Fault, InvalidArgument, among
from substructures.tree.model import Model


@dataclass(frozen=True)
class SteadyConditions:
    """``given``: rates or momenta (``field``) by name of coordinates, ``parameters`` in place of their defaults,
    constant ``inputs``; at a value of what varies (``vary``), a parameter or a coordinate.
    """

    model: Model
    given: Mapping[str, float]
    field: Literal["rates", "momenta"]
    held: Held
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]
    vary: str | None

    def at(self, value: float) -> tuple[Mapping[str, float], RestConditions]:
        """What is given of the moving coordinates, and the conditions."""
        given, parameters = self.given, self.parameters
        if self.vary in self.model.coordinates:
            given = {**given, str(self.vary): value}
        elif self.vary is not None:
            parameters = {**parameters, self.vary: value}
        return given, RestConditions(0.0, parameters, self.inputs)

    def moving(self, value: float) -> list[int]:
        """The coordinates s."""
        given, conditions = self.at(value)
        places = {name: "/vary" if name == self.vary else f"/{self.field}/{name}" for name in given}
        return _moving(self.model, conditions, places, self.field, self.held)

    def search(self, moving: Sequence[int], within: SearchRange, value: float) -> SteadySearch:
        """The search for places."""
        given, conditions = self.at(value)
        wanted = np.array([given.get(self.model.coordinates[s], 0.0) for s in moving])
        kind = ClosedSteadySearch if self.model.closures else SteadySearch
        return kind(self.model, moving, within, conditions, wanted, self.field == "momenta")


def ends_of(model: Model, vary: str | None, between: Any, velocities: Sequence[str] = ()) -> tuple[float, ...]:
    """The two values between which a parameter, a coordinate or one of the ``velocities`` varies; else any. Raises
    InvalidArgument.
    """
    if (vary is None) != (between is None):
        message = "'vary' says what, and 'between' from where to where: give both, or none"
        raise InvalidArgument.at("/vary" if vary is None else "/between", "missing", message)
    if vary is None:
        return (0.0,)
    known = [*model.parameters, *model.coordinates, *velocities]
    if vary not in known:
        message = f"there is no parameter or coordinate '{str(vary)[:80]}'{among(vary, known)}"
        raise InvalidArgument.at("/vary", "unknown-name", message)
    ends = reals(between, "/between")
    if len(ends) != 2 or ends[0] == ends[1]:
        raise InvalidArgument.at("/between", "wrong-length", "two different values are needed: the first and the last")
    return ends


def require_rates(rates: object, momenta: object, held: Held) -> None:
    """Raises InvalidArgument for what needs momenta that are kept, which trees with velocity constraints have not."""
    what = "a tree with velocity constraints, whose cyclic coordinates keep no momenta"
    pairs = (("momenta", momenta is not None), ("held", held != "momenta"))
    faults = [Fault(f"/{name}", "not-supported", f"'{name}' is not for {what}") for name, given in pairs if given]
    if not faults and rates is None:
        faults = [Fault("/rates", "missing", "'rates' are needed; none by name for any")]
    if faults:
        raise InvalidArgument(faults)


def require_no_velocities(velocities: object, independent: object) -> None:
    """Raises InvalidArgument for quasi-velocities of a tree without velocity constraints."""
    pairs = (("velocities", velocities is not None), ("independent", independent is not None))
    message = "is for trees with velocity constraints"
    faults = [Fault(f"/{name}", "not-supported", f"'{name}' {message}: leave it out") for name, given in pairs if given]
    if faults:
        raise InvalidArgument(faults)


def given_of(
    rates: Mapping[str, float] | None, momenta: Mapping[str, float] | None, held: Held
) -> tuple[dict[str, float], Literal["rates", "momenta"]]:
    """What is given, by coordinate, and what it is. Raises InvalidArgument."""
    if (rates is None) == (momenta is None):
        raise InvalidArgument.at("/rates", "rates-or-momenta", "give either 'rates' or 'momenta'")
    if momenta is not None and held == "rates":
        raise InvalidArgument.at("/momenta", "not-supported", "rates that are held are given as 'rates'")
    return (numbers(momenta, "momenta"), "momenta") if rates is None else (numbers(rates, "rates"), "rates")


def _moving(model: Model, conditions: RestConditions, given: Mapping[str, str], field: str, held: Held) -> list[int]:
    """The coordinates s; ``given``: those named, with their pointers. Raises InvalidArgument for names that are none,
    or not free to move at constant rates.
    """
    acting = [name for name, value in conditions.inputs.items() if value]
    free = {*first_integrals(model, acting).cyclic, *nearly_cyclic(model, conditions)} if held == "momenta" else set()
    cyclic = [name for name in model.coordinates if name in free]
    known = model.coordinates if held == "rates" else cyclic
    what = "coordinate" if held == "rates" else "cyclic coordinate"
    faults = [
        Fault(pointer, "not-cyclic", f"'{name[:80]}' is no {what}; there are: {', '.join(known) or 'none'}")
        for name, pointer in given.items()
        if name not in known
    ]
    if faults:
        raise InvalidArgument(faults)
    moving = sorted(model.coordinates.index(name) for name in (given if held == "rates" else cyclic))
    if not moving and not model.ignored:
        raise InvalidArgument.at(
            f"/{field}", "no-cyclic-coordinate", "there is no coordinate that moves at a constant rate"
        )
    if held == "rates":
        require_free(model, moving)
    return moving
