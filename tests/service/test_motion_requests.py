"""Bodies of requests about motions: one schema for every face, pointers into the body, one set of defaults."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest
from closed_trees import at, slider_crank
from random_trees import Plain
from rolling_bodies import sleigh

from service.models.formulas.constraints import velocity_equations_of
from service.models.numbers import ANALYSES
from service.models.requests import arguments, read_request
from service.models.results import plain
from service.models.source import Source
from service.schemas.analyses.motions import (
    AnySimulationRequest,
    ClosedRequest,
    LoopRequest,
    RollingRequest,
    SensitivityRequest,
    SimulationRequest,
)
from service.schemas.analyses.velocity_constraints import VelocityConstraints
from service.settings import Limits
from substructures import InvalidInput, Model
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.simulate import Event, FixedStep, KnifeEdge, Table, simulate
from substructures.quantities.sources import Sources

from .flat_arguments import flat_arguments

CRANK, SLEIGH = slider_crank(), sleigh()
BLADE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
CLOSED: Plain = {"q": [0, 0, 0.18], "span": [0, 1]}
ROLLING: Plain = {"constraints": [BLADE], "q": [0, 0, 0], "span": [0, 1]}
TREE: Plain = {"q": [0, 0, 0], "span": [0, 1]}


def faults(model: Model, name: str, body: Any) -> list[tuple[str, str]]:
    with pytest.raises(InvalidInput) as caught:
        ANALYSES[name].compute(Source(Sources(model), "", Limits()), body, lambda _: None)
    return [(f.pointer, f.code) for f in caught.value.faults]


OF_SPANS: list[tuple[Plain, str, str]] = [
    ({"count": 5, "step": 0.1}, "/step", "one-grid"),
    ({"span": [0, 0]}, "/span", "empty-span"),
    ({"span": None}, "/span", "tuple-type"),
    ({"span": [0]}, "/span/1", "missing"),
    ({"span": [0, 10**400]}, "/span/1", "number-not-finite"),
    ({"span": [0, "b"]}, "/span/1", "number-expected"),
    ({"step": 1e-9}, "/step", "too-many-outputs"),
    ({"count": 1}, "/count", "greater-than-equal"),
    ({"times": [0, 0]}, "/times", "not-increasing"),
    ({"times": [0, 2]}, "/times", "outside"),
    ({"relative_tolerance": -1}, "/relative_tolerance", "greater-than-equal"),
    ({"events": [{"name": "x"}]}, "/events/0/quantity", "missing"),
    ({"velocity": 1}, "/velocity", "extra-forbidden"),
    ({"method": "euler"}, "/method", "literal-error"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), OF_SPANS)
def test_spans(change: Plain, pointer: str, code: str) -> None:
    for model, name, good in (
        (CRANK, "simulations", CLOSED),
        (SLEIGH, "simulations", ROLLING),
        (SLEIGH, "simulations", TREE),
        (SLEIGH, "sensitivities", TREE),
    ):
        assert faults(model, name, good | change) == [(pointer, code)]


OF_LOOPS: list[tuple[Plain, str, str]] = [
    ({"fixed": 5}, "/fixed", "tuple-type"),
    ({"inputs": {"tau.x.crank": {"times": [0, 0], "values": [1, 2]}}}, "/inputs/tau.x.crank/times", "not-increasing"),
    ({"inputs": {"tau.x.crank": {"times": [0, 1], "values": [1, 2, 3]}}}, "/inputs/tau.x.crank/values", "wrong-length"),
    ({"inputs": {"tau.x.crank": {"times": [0, 1]}}}, "/inputs/tau.x.crank/values", "missing"),
    ({"speed": 1}, "/speed", "extra-forbidden"),
    ({"t": [1, 2]}, "/t", "number-expected"),
    ({"prescribed": ["x.crank"]}, "/prescribed", "dict-type"),
    ({"parameters": {"x.r": "long"}}, "/parameters/x.r", "number-expected"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), OF_LOOPS)
def test_loops(change: Plain, pointer: str, code: str) -> None:
    assert faults(CRANK, "loop-states", {"q": [0, 0, 0.18]} | change) == [(pointer, code)]


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"constraints": [{"name": "c", "type": "skid"}]}, "/constraints/0/type", "union-tag-invalid"),
        ({"constraints": [BLADE | {"frame": "s.c"}]}, "/constraints/0/frame", "unknown-frame"),
        ({"constraints": [BLADE, {"name": "c", "type": "linear"}]}, "/constraints/1/expression", "missing"),
        ({"form": "lagrange"}, "/form", "literal-error"),
        ({"fixed": ["s.x"]}, "/fixed", "extra-forbidden"),
        ({"powers": True}, "/powers", "extra-forbidden"),
        ({"friction": "loaded"}, "/friction", "extra-forbidden"),
    ],
)
def test_constraints(change: Plain, pointer: str, code: str) -> None:
    assert faults(SLEIGH, "simulations", ROLLING | change) == [(pointer, code)]


def test_linearisations_about_motions() -> None:
    """With constraints in quasi-velocities, which mean nothing without."""
    velocities = {"u": "cos(s.f)*s.x' + sin(s.f)*s.y'", "w": "s.f'"}
    asked: Plain = {"q": [0, 0, 0], "constraints": [BLADE], "velocities": velocities, "v": {"u": 2}}
    found = ANALYSES["linearisations"].compute(Source(Sources(SLEIGH), "", Limits()), asked, lambda _: None)
    told = plain(getattr(found, "result", found))
    assert (told["is_steady"], told["is_equilibrium"], told["ignorable"]) == (True, False, ["s.x", "s.y", "s.f"])
    assert faults(SLEIGH, "linearisations", {"q": [0, 0, 0], "v": [1]}) == [("/v", "not-supported")]
    assert faults(SLEIGH, "linearisations", asked | {"qdd": [0, 0, 0]}) == [("/qdd", "not-supported")]


def test_friction_that_loops_do_not_have() -> None:
    assert faults(CRANK, "simulations", CLOSED | {"friction": "loaded"}) == [("/friction", "literal-error")]
    assert faults(CRANK, "simulations", CLOSED | {"friction": "exact"}) == [("/friction", "no-friction")]


def test_a_body_is_an_object() -> None:
    for name in ANALYSES:
        assert faults(SLEIGH, name, []) == [("", "object-expected")]
    with pytest.raises(InvalidInput):
        velocity_equations_of(Source(Sources(SLEIGH), "", Limits()), "rolling")


def test_parts_become_values_of_the_science() -> None:
    body = {
        "q": [0],
        "span": [0, 1],
        "inputs": {"u": {"times": [0, 1], "values": [1, 2]}, "v": "t", "w": 2},
        "events": [{"name": "e", "quantity": "t", "level": 0.5}],
        "fixed_step": {"step": 0.1},
    }
    assert arguments(read_request(AnySimulationRequest, body)) == {
        "q": [0],
        "span": (0, 1),
        "inputs": {"u": Table((0, 1), (1, 2)), "v": "t", "w": 2},
        "events": (Event("e", "t", 0.5),),
        "fixed_step": FixedStep(0.1),
    }
    given = arguments(read_request(VelocityConstraints, {"constraints": [BLADE]}))
    assert given == {"constraints": (KnifeEdge("blade", "s.b"),)}


def test_a_loop_state_as_plain_data() -> None:
    answer = plain(loop_state(CRANK, at(CRANK, crank=0.4, piston=0.17)))
    assert {"q", "qd", "qdd", "multipliers", "actuation", "mobility", "reactions", "message"} <= answer.keys()
    assert answer["mobility"]["degrees_of_freedom"] == 1
    assert [r["closure"] for r in answer["reactions"]] == ["wrist"]


@pytest.mark.parametrize(
    ("schemas", "function", "left_out"),
    [
        ((SimulationRequest, ClosedRequest, RollingRequest), simulate, {"model", "progress", "folder", "bearings"}),
        ((LoopRequest,), loop_state, {"model", "folder"}),
        ((VelocityConstraints,), quasi_velocity_equations, {"model", "near"}),
        ((SensitivityRequest,), sensitivities, {"model", "progress", "folder", "form"}),
    ],
)
def test_bodies_and_functions_have_the_same_fields_and_defaults(
    schemas: tuple[Any, ...], function: Callable[..., Any], left_out: set[str]
) -> None:
    """What is left out of a body is left out of the call: both must mean the same by it."""
    known = flat_arguments(function)
    if function is simulate:
        # a method and a kind of motion
        known |= {"fixed_step": None, "geodesic": False}
    fields = {name: field for schema in schemas for name, field in schema.model_fields.items()}
    refused = (
        {"events", "series", "fixed_step", "reactions", "powers", "friction", "geodesic", "contacts"}
        if function is sensitivities
        else set()
    )
    assert set(fields) - refused == set(known) - left_out
    for name in set(fields) - refused:
        default = known[name]
        if default is not inspect.Parameter.empty:
            assert (fields[name].default or None) == (default or None), name
