"""Checks of what requests give for the states of a tree, as far as names and lengths tell without its formulas."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from service.models.requests import arguments
from service.schemas.numbers import EvaluationRequest
from substructures.errors import InvalidDocument
from substructures.expr.program import Program
from substructures.mechanics.state_names import resting_state
from substructures.quantities.numbers.states import States, given_values, read_states
from substructures.quantities.quantity import REGRESSOR, TABLE
from substructures.quantities.sources import read_quantities
from substructures.tree.cuts import ClosureRows
from substructures.tree.model import Model

#: what of a summary says how a model moves
TIED = ("velocity_constraints", "contacts", "balls", "reduced")


def without_formulas(summary: Mapping[str, Any]) -> Model:
    """The model of a stored summary with an empty program, for checks of names, units and lengths."""
    names = tuple(summary["coordinates"]), summary["joints"], tuple(summary["frames"])
    closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
    tied: dict[str, Any] = {name: tuple(summary.get(name, ())) for name in TIED}
    empty = Program((), (), {})
    inputs = summary.get("inputs", {})
    return Model(empty, *names, summary["parameters"], {}, closures, inputs, **tied)


def check_states(summary: Mapping[str, Any], request: EvaluationRequest) -> States:
    """The states that are listed in a request. Raises InvalidInput with pointers into it."""
    states = read_states(without_formulas(summary), request.arguments(), None)
    if not states.count:
        raise InvalidDocument.at("/q", "missing", "at least one state is needed")
    _check_values(summary, request, states.count, states.qdd is not None)
    return states


def check_analysis(summary: Mapping[str, Any], read: BaseModel, is_motion: bool, has_all: bool) -> None:
    """The states and parameters in a request for an analysis that was read; ``is_motion``: it has one state, where it
    starts, ``has_all``: all of its parameters are those of the formulas. Raises InvalidInput.
    """
    given, model, count = arguments(read), without_formulas(summary), 1
    if "q" in given or is_motion:
        states = {name: given.get(name) for name in ("q", "qd", "qdd")}
        count = read_states(model, states, 1 if is_motion else None).count
    if has_all:
        given_values(given.get("parameters"), "parameters", "/parameters", count, summary["parameters"], model.units)


def check_described(summary: Mapping[str, Any], request: EvaluationRequest, count: int) -> None:
    """What a request gives for so many states that a grid or sample describes. Raises InvalidInput."""
    model = without_formulas(summary)
    start = resting_state(model.positions, model.balls)
    given = read_states(model, {"q": start, "qdd": request.qdd}, None).qdd
    if given is not None and len(given) not in (1, count):
        raise InvalidDocument.at("/qdd", "wrong-length", f"{len(given)} accelerations where there are {count} states")
    _check_values(summary, request, count, given is not None)


def _check_values(summary: Mapping[str, Any], request: EvaluationRequest, count: int, has_accelerations: bool) -> None:
    quantities = read_quantities(request.quantities)
    needed = {field for name in quantities for field in TABLE[name].requires}
    if "qdd" in needed and not has_accelerations and summary["coordinates"]:
        raise InvalidDocument.at("/qdd", "missing", "the quantities need accelerations 'qdd'")
    if "along" in needed and request.along is None:
        raise InvalidDocument.at("/along", "missing", "the direction 'along' is needed: q, qd, qdd and inputs")
    if request.t is not None:
        given_values({"t": request.t}, "times", "", count, ("t",))
    for field, given in (("inputs", request.inputs), ("parameters", request.parameters)):
        known = list(given) if isinstance(given, Mapping) else []
        if field == "parameters" and not any(TABLE[name].source == REGRESSOR for name in quantities):
            known = list(summary["parameters"])  # the regressor has more of them; inputs of loads are in the formulas
        given_values(given, field, f"/{field}", count, known, without_formulas(summary).units)
