"""The direction of a derivative as values of the symbols ``d.*`` (see :mod:`substructures.quantities.derivatives`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.documents import escape
from substructures.errors import Fault, InvalidDocument
from substructures.quantities.derivatives import direction
from substructures.quantities.states import States, given_values, input_names, read_states
from substructures.tree.model import Model

PRIMES = {"q": "", "qd": "'", "qdd": "''"}


def direction_values(model: Model, along: Any, states: States) -> dict[str, Any]:
    """Values of all symbols of a direction; zero where nothing is given.

    ``along``: ``q``, ``qd``, ``qdd`` in the shapes of a request, one row for all states or one for each, and ``inputs``
    by name. Raises InvalidDocument with pointers ``/along/...``.
    """
    if not isinstance(along, Mapping):
        raise InvalidDocument.at("/along", "missing", "the direction 'along' is needed: q, qd, qdd and inputs")
    unknown = [key for key in along if key not in (*PRIMES, "inputs")]
    if unknown:
        faults = (Fault(f"/along/{escape(k)}", "unknown-field", f"unknown field '{str(k)[:80]}'") for k in unknown)
        raise InvalidDocument(faults)
    count = states.count
    values: dict[str, Any] = {direction(name): 0.0 for name in input_names(model)}
    for field, primes in PRIMES.items():
        values |= {direction(name + primes): x for name, x in _columns(model, along, field, count).items()}
    given = given_values(along.get("inputs"), "inputs", "/along/inputs", count, input_names(model))
    return values | {direction(name): x for name, x in given.items()}


def _columns(model: Model, along: Mapping[str, Any], field: str, count: int) -> dict[str, Any]:
    """A direction of the states by coordinate, read like the states of a request."""
    given = along.get(field)
    if given is None or not model.dof:
        return dict.fromkeys(model.coordinates, 0.0)
    try:
        x = read_states(model, {"q": given}, None).q
    except InvalidDocument as error:
        faults = [replace(f, pointer=f"/along/{field}" + f.pointer.removeprefix("/q")) for f in error.faults]
        raise InvalidDocument(faults) from None
    if len(x) not in (1, count):
        raise InvalidDocument.at(f"/along/{field}", "wrong-length", f"{len(x)} directions for {count} states")
    return dict(zip(model.coordinates, np.broadcast_to(x, (count, model.dof)).T, strict=True))
