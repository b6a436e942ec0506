"""What steady motions are asked for: rates or momenta, and what varies; and the coordinates that move then."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.analysis.arguments import reals
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.precession import BallRequest
from substructures.analysis.equations.steady import require_free
from substructures.analysis.given import numbers
from substructures.analysis.stability.equilibrium_search import SearchRange
from substructures.analysis.stability.operating_point import AT_REST, RestConditions, rounding
from substructures.analysis.stability.steady_result import Held
from substructures.analysis.stability.steady_search import ClosedSteadySearch, SteadySearch
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: what rounding of decimals is of the size of what it is in; states that are looked at
ROUNDING, STATES = 1e-12, 12


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


def require_of_balls(request: BallRequest, held: Held, vary: str | None) -> None:
    """Raises InvalidArgument for what is not known with ball joints."""
    if vary is not None and request.precession == "any":
        message = "'any' is of single places: give a number, or let 'precession' vary"
        raise InvalidArgument.at("/precession", "not-supported", message)
    if held != "momenta":
        message = "rates that are held are not known with ball and floating joints: leave 'held' out for momenta"
        raise InvalidArgument.at("/held", "not-supported", message)
    if (request.rates is None) == (request.momenta is None):
        message = "give either 'rates' or 'momenta', by name; those that are not named are 0"
        raise InvalidArgument.at("/rates", "rates-or-momenta", message)


def require_no_precession(precession: object) -> None:
    """Raises InvalidArgument for a precession of a tree of which coordinates turn."""
    if precession is not None:
        message = "is for trees with ball and floating joints; else it is a rate or a momentum of a coordinate"
        raise InvalidArgument.at("/precession", "not-supported", f"'precession' {message}")


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


def nearly_cyclic(model: Model, conditions: RestConditions) -> list[str]:
    """The coordinates c on which, and along which, nothing depends or acts but rounding, by numbers at random states: a
    world that is turned by decimals has its gravity along an axis to 16 digits, and no formula of it is zero.

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


def _is_rounding(model: Model, given: Mapping[str, Any], found: Mapping[str, Array]) -> bool:
    """Whether forces accelerate hardly, and are nothing but rounding at the first state."""
    g, Q = np.einsum("naa->na", found["metric"]), found["forces"]
    if not Q.any() or (np.abs(Q) > AT_REST * g).any():
        return False
    first = {name: np.ravel(x)[:1] for name, x in given.items()}
    return bool((np.abs(Q[0]) <= rounding(model.program, first, ["forces"])["forces"]).all())


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
        forces = np.zeros_like(Q) if _is_rounding(model, given, found) else Q / root
        return {
            "metric": g / (root[:, :, None] * root[:, None, :]),
            "forces": forces / (np.abs(forces).max(initial=0) or 1.0),
            "closures": G / (np.abs(G).max(initial=0) or 1.0),
        }
