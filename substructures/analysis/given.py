"""What a request gives, as numbers and functions of time of a model; faults have pointers."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed_requests import StateRequest
from substructures.analysis.signals import Signals
from substructures.definition import escape
from substructures.errors import Fault, InvalidDocument
from substructures.model import Model
from substructures.states import States, read_states, symbol_values

Array = NDArray[np.float64]


def read_inputs(model: Model, request: StateRequest) -> Signals:
    """The inputs that are given; all others are zero. Raises InvalidDocument."""
    known = {s.name for s in model.program.symbols if s.kind == "input"}
    known |= {f"tau.{name}" for name in model.coordinates}
    check_names(request.inputs, known, "input", "/inputs")
    return Signals(request.inputs, "/inputs", smooth=False)


def check_names(given: Iterable[str], known: Collection[str], kind: str, pointer: str) -> None:
    """Raises InvalidDocument for names that are not known."""
    faults = [
        Fault(f"{pointer}/{escape(name)}", f"unknown-{kind}", f"unknown {kind} '{name[:80]}'")
        for name in given
        if name not in known
    ]
    if faults:
        raise InvalidDocument(faults)


def check_fixed(model: Model, fixed: Sequence[str]) -> None:
    """Raises InvalidDocument for coordinates that are not known."""
    for i, name in enumerate(fixed):
        if name not in model.coordinates:
            raise InvalidDocument.at(f"/fixed/{i}", "unknown-coordinate", f"unknown coordinate '{name[:80]}'")


def parameter_values(model: Model, request: StateRequest, needs: Sequence[str]) -> dict[str, float]:
    """Values of all symbols for outputs; states are zero. Raises InvalidDocument and MissingValue."""
    nothing = States(np.zeros((1, model.dof)), np.zeros((1, model.dof)), None, 1, True)
    found = symbol_values(model, {"parameters": request.parameters}, nothing, needs)
    return {name: float(np.reshape(x, -1)[0]) for name, x in found.items()}


def read_state(model: Model, request: StateRequest) -> tuple[Array, Array]:
    """One state q, qd (n,) of a request. Raises InvalidDocument."""
    states = read_states(model, {"q": request.q, "qd": request.qd}, None)
    if len(states.q) != 1:
        raise InvalidDocument.at("/q", "wrong-length", f"one state is needed, found {len(states.q)}")
    return states.q[0].copy(), states.qd[0].copy()
