"""The direction of a derivative as values of the symbols ``d.*`` (see :mod:`substructures.quantities.derivatives`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.errors import InvalidArgument, InvalidInput
from substructures.quantities.derivatives import direction
from substructures.quantities.measured import si_values
from substructures.quantities.numbers.states import StateInput, States, ValueInput, given_values, read_states
from substructures.tree.given.ties import require_chains
from substructures.tree.model import Model

#: what follows the name of a coordinate in that of its position, velocity and acceleration
PRIMES = {"q": "", "qd": "'", "qdd": "''"}


@dataclass(frozen=True)
class Direction:
    """The direction (dq, dq', dq'', dtau) of a derivative; what is not given is zero.

    ``q``, ``qd``, ``qdd``: (n,) for all states, (N, n), or by coordinate name; ``inputs``: by name, a number or (N,).
    """

    q: StateInput | None = None
    qd: StateInput | None = None
    qdd: StateInput | None = None
    inputs: ValueInput | None = None


def direction_values(model: Model, along: Direction | None, states: States) -> dict[str, Any]:
    """Values of all symbols ``d.*``; zero where nothing is given. Raises InvalidArgument (``/along/...``),
    and InvalidDocument (``has-balls``) for rates that are no derivatives of coordinates.
    """
    if along is None:
        raise InvalidArgument.at("/along", "missing", "the direction 'along' is needed: q, qd, qdd and inputs")
    require_chains(model.balls, pointer="/quantities")
    count = states.count
    values: dict[str, Any] = {direction(name): 0.0 for name in model.input_names}
    for field, primes in PRIMES.items():
        # dq, dq', dq'' are the symbols d.arm.q1, d.arm.q1', d.arm.q1''
        columns = _columns(model, getattr(along, field), field, count)
        values |= {direction(name + primes): x for name, x in columns.items()}
    # dtau of actuators, du of loads
    given = given_values(along.inputs, "inputs", "/along/inputs", count, model.input_names, model.units)
    return values | {direction(name): x for name, x in given.items()}


def _columns(model: Model, given: StateInput | None, field: str, count: int) -> dict[str, Any]:
    """A direction of the states by coordinate, read like states."""
    if given is None or not model.dof:
        return dict.fromkeys(model.coordinates, 0.0)
    plain = si_values(given, model.state_units[field], f"/along/{field}")
    try:
        x = read_states(model, {"q": plain}, None).q
    except InvalidInput as error:
        raise error.moved(lambda pointer: f"/along/{field}" + pointer.removeprefix("/q")) from None
    if len(x) not in (1, count):
        raise InvalidArgument.at(f"/along/{field}", "wrong-length", f"{len(x)} directions for {count} states")
    return dict(zip(model.coordinates, np.broadcast_to(x, (count, model.dof)).T, strict=True))
