"""Every number of a request that has a dimension may have a unit, which is converted and checked: one table of them.

The table is walked in two ways: the schemas of all requests say which numbers have a dimension, and none of these may
be missing here; and every place is read with a unit, without one, and with a wrong one.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from decimal import Decimal
from math import pi
from typing import Any, get_args

import numpy as np
import pytest
from fastapi.testclient import TestClient
from pydantic import BaseModel, ValidationError

from service.models.numbers import ANALYSES
from service.models.requests import arguments, read_request
from service.schemas.measured import WithUnits
from substructures import Definition, InvalidInput, Model, TreeSpec, couple, derive
from substructures.documents import escape
from substructures.documents.units import read_unit
from substructures.ensembles.samples import Distribution
from substructures.quantities.measured import si_values
from substructures.quantities.numbers.evaluation import evaluate

from .conftest import PENDULUM, SLIDER

Plain = dict[str, Any]
ARM, SLIDE = "arm.q", "slide.x"
SPAN: Plain = {"q": [0.1, 0.2], "span": [0, 1]}
CONTROL: Plain = {"controls": ["tau.arm.q"], "horizon": 1, "intervals": 2, "q": [0, 0]}


def measured(value: Any, unit: str) -> Plain:
    return {"value": value, "unit": unit}


#: request, a body that is right, the place in it, what stands there with a unit and in SI, and a wrong unit
Row = tuple[str, Plain, str, Any, Any, str]
MM, DEG = measured(250, "mm"), measured(90, "deg")
HANDS: tuple[Any, Any] = ([DEG, MM], [pi / 2, 0.25])
MOTION: list[Row] = [
    ("simulations", SPAN, "/q/0", DEG, pi / 2, "m"),
    ("simulations", SPAN, "/q/1", MM, 0.25, "rad"),
    ("simulations", SPAN, "/q", {ARM: DEG, SLIDE: MM}, {ARM: pi / 2, SLIDE: 0.25}, "s"),
    ("simulations", SPAN, "/qd", [measured(60, "rpm"), 2], [2 * pi, 2], "rad"),
    ("simulations", SPAN, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("simulations", SPAN, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("simulations", SPAN, "/inputs/tau.slide.x", measured(2, "kN"), 2000.0, "N m"),
    ("simulations", SPAN | {"inputs": {"tau.arm.q": {"values": [0, 1]}}}, "/inputs/tau.arm.q/times",
     measured([0, 60000], "ms"), [0.0, 60.0], "m"),
    ("simulations", SPAN | {"inputs": {"tau.arm.q": {"times": [0, 1]}}}, "/inputs/tau.arm.q/values",
     [measured(2, "kN m"), 3], [2000.0, 3], "N"),
    ("simulations", SPAN, "/span", [0, measured(1, "min")], [0, 60.0], "m"),
    ("simulations", SPAN, "/times", measured([0, 500], "ms"), [0.0, 0.5], "m"),
    ("simulations", SPAN, "/step", measured(100, "ms"), 0.1, "m"),
    ("simulations", SPAN, "/max_step", measured(100, "ms"), 0.1, "Hz"),
    ("simulations", SPAN, "/fixed_step/step", measured(1, "ms"), 0.001, "m"),
    ("simulations", SPAN | {"events": [{"name": "a", "quantity": "2*arm.l"}]}, "/events/0/level", MM, 0.25, "rad"),
    ("simulations", SPAN | {"events": [{"name": "a", "quantity": "arm.q", "direction": "rising"}]}, "/events/0/reset",
     {"slide.x": MM, "slide.x'": measured(2, "km/s")}, {"slide.x": 0.25, "slide.x'": 2000.0}, "rad"),
    ("simulations", SPAN | {"events": [{"name": "a", "quantity": "arm.q'"}]}, "/events/0/level",
     measured(60, "rpm"), 2 * pi, "m"),
    ("simulations", SPAN | {"contacts": [{"name": "a", "point": "arm.body"}]}, "/contacts/0/rest_velocity",
     measured(1, "mm/s"), 0.001, "m"),
    ("loop-states", {"q": [0, 0]}, "/t", measured(1, "min"), 60.0, "m"),
    ("loop-states", {"q": [0, 0]}, "/prescribed/slide.x", MM, 0.25, "rad"),
    ("loop-states", {"prescribed": {"arm.q": {"values": [0, 1]}}}, "/prescribed/arm.q/times",
     measured([0, 60000], "ms"), [0.0, 60.0], "rad"),
    ("loop-states", {"prescribed": {"arm.q": {"times": [0, 1]}}}, "/prescribed/arm.q/values",
     measured([0, 90], "deg"), [0.0, pi / 2], "m"),
    ("reduced-equations", {}, "/q/slide.x", MM, 0.25, "rad"),
    ("reduced-equations", {}, "/qd/arm.q", measured(60, "rpm"), 2 * pi, "m/s"),
    ("reduced-equations", {}, "/start/arm.q", DEG, pi / 2, "m"),
    ("reduced-equations", {}, "/t", measured(1, "min"), 60.0, "m"),
    ("simulations", SPAN | {"constraints": [{"type": "linear", "name": "a", "expression": "arm.q'"}],
     "velocities": {"w": "arm.l*arm.q'"}}, "/v/w", measured(36, "km/h"), 10.0, "rad/s"),
    ("simulations", SPAN | {"constraints": [{"type": "linear", "name": "a", "expression": "arm.q'"}],
     "independent": [SLIDE]}, "/v", {SLIDE: measured(36, "km/h")}, {SLIDE: 10.0}, "rad/s"),
    ("simulations", SPAN | {"constraints": [{"type": "rolling", "name": "a", "frame": "arm.tip"}]},
     "/constraints/0/radius", MM, 0.25, "rad"),
]  # fmt: skip
AROUND: Plain = {"q": [0, 0], "section": {"quantity": "2*arm.l"}}
LOCUS: Plain = {"parameter": "arm.l", "values": [1], "q": [0, 0]}
QUESTIONS: list[Row] = [
    ("linearisations", {"q": [0, 0]}, "/q", *HANDS, "s"),
    ("linearisations", {"q": [0, 0]}, "/qd", [measured(60, "rpm"), 0], [2 * pi, 0], "m"),
    ("linearisations", {"q": [0, 0]}, "/qdd", [0, measured(250, "mm/s^2")], [0, 0.25], "m"),
    ("linearisations", {"q": [0, 0]}, "/t", measured([1, 2], "min"), [60.0, 120.0], "m"),
    ("linearisations", {"q": [0, 0]}, "/parameters/arm.m", measured([250, 500], "g"), [0.25, 0.5], "m"),
    ("linearisations", {"q": [0, 0]}, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("frequency-responses", {"q": [0, 0]}, "/frequencies", measured([60], "rpm"), [2 * pi], "m"),
    ("frequency-responses", {"q": [0, 0]}, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("frequency-responses", {}, "/q", *HANDS, "s"),
    ("frequency-responses", {"q": [0, 0]}, "/qd", [measured(60, "rpm"), 0], [2 * pi, 0], "m"),
    ("frequency-responses", {"q": [0, 0]}, "/t", measured(1, "min"), 60.0, "m"),
    ("frequency-responses", {"q": [0, 0]}, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("regulators", {}, "/q", *HANDS, "s"),
    ("regulators", {"q": [0, 0]}, "/qd", [measured(60, "rpm"), 0], [2 * pi, 0], "m"),
    ("regulators", {"q": [0, 0]}, "/t", measured(1, "min"), 60.0, "m"),
    ("regulators", {"q": [0, 0]}, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("regulators", {"q": [0, 0]}, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("equilibria", {}, "/starts", [HANDS[0]], [HANDS[1]], "s"),
    ("equilibria", {}, "/reach", MM, 0.25, "rad"),
    ("equilibria", {}, "/t", measured(1, "min"), 60.0, "m"),
    ("equilibria", {}, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("equilibria", {}, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("steady-motions", {}, "/rates/arm.q", measured(60, "rpm"), 2 * pi, "m/s"),
    ("steady-motions", {}, "/momenta/slide.x", measured(2, "kN s"), 2000.0, "N m s"),
    ("steady-motions", {"rates": {}}, "/starts", [HANDS[0]], [HANDS[1]], "s"),
    ("steady-motions", {"rates": {}}, "/reach", MM, 0.25, "rad"),
    ("steady-motions", {"rates": {}}, "/precession", measured(60, "rpm"), 2 * pi, "m/s"),
    ("steady-motions", {"rates": {}}, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("steady-motions", {"rates": {}}, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("steady-motions", {"vary": "arm.l"}, "/between", [MM, 1], [0.25, 1], "rad"),
    ("steady-motions", {"vary": "arm.q", "rates": {}}, "/between", [0, measured(60, "rpm")], [0, 2 * pi], "m"),
    ("steady-motions", {"vary": "slide.x", "momenta": {}}, "/between", [0, measured(2, "kN s")], [0, 2000.0], "m"),
    ("root-loci", {"parameter": "arm.l", "q": [0, 0]}, "/values", measured([250, 500], "mm"), [0.25, 0.5], "kg"),
    ("root-loci", {"parameter": "arm.l", "q": [0, 0]}, "/values", [MM, 1], [0.25, 1], "kg"),
    ("root-loci", {"parameter": "arm.l", "values": [1]}, "/q", *HANDS, "s"),
    ("root-loci", LOCUS, "/parameters/g", measured(981, "cm/s^2"), 9.81, "m"),
    ("root-loci", LOCUS, "/inputs/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
    ("periodic-orbits", {"vary": "arm.l", "period": 1, "q": [0, 0]}, "/values", measured([250], "mm"), [0.25], "kg"),
    ("periodic-orbits", {"vary": "arm.q'", "period": 1, "q": [0, 0]}, "/values", measured([60], "rpm"), [2 * pi], "m"),
    ("periodic-orbits", {"q": [0, 0]}, "/period", measured(1, "min"), 60.0, "m"),
    ("periodic-orbits", {"vary": "arm.l", "period": 1, "q": [0, 0]}, "/between", [MM, 1], [0.25, 1], "kg"),
    ("periodic-orbits", AROUND, "/section/level", MM, 0.25, "rad"),
    ("periodic-orbits", AROUND, "/section/duration", measured(1, "min"), 60.0, "m"),
    ("poincare-sections", {"q": [0, 0], "quantity": "arm.q"}, "/duration", measured(1, "min"), 60.0, "m"),
    ("poincare-sections", {"q": [0, 0], "quantity": "2*arm.l", "duration": 1}, "/level", MM, 0.25, "rad"),
    ("lyapunov-exponents", {"q": [0, 0]}, "/duration", measured(1, "min"), 60.0, "m"),
    ("lyapunov-exponents", {"q": [0, 0], "duration": 1}, "/transient", measured(1, "min"), 60.0, "m"),
    ("curvatures", {}, "/q", *HANDS, "s"),
    ("curvatures", {"q": [0, 0]}, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("excitations", {"qdd": [[0, 0]]}, "/q", [HANDS[0]], [HANDS[1]], "s"),
    ("excitations", {"q": [[0, 0]], "qdd": [[0, 0]]}, "/qd", [[measured(60, "rpm"), 0]], [[2 * pi, 0]], "m"),
    ("excitations", {"q": [[0, 0]]}, "/qdd", [[0, measured(250, "mm/s^2")]], [[0, 0.25]], "m"),
    ("excitations", {"q": [[0, 0]], "qdd": [[0, 0]]}, "/parameters/arm.l", MM, 0.25, "kg"),
    ("identifications", {"q": [[0, 0]], "qdd": [[0, 0]]}, "/tau", [[measured(25, "N cm"), measured(2, "kN")]],
     [[0.25, 2000.0]], "m"),
]  # fmt: skip
CONTROLS: list[Row] = [
    ("optimal-parameters", {"minimise": "m"}, "/vary/arm.m", measured([250, 500], "g"), [0.25, 0.5], "m"),
    (
        "optimal-parameters",
        {"minimise": "m", "vary": {"arm.l": [1, 2]}},
        "/parameters/arm.m",
        measured(1, "g"),
        0.001,
        "m",
    ),
    ("optimal-controls", CONTROL, "/horizon", measured(1, "min"), 60.0, "m"),
    ("optimal-controls", CONTROL, "/q", *HANDS, "s"),
    ("optimal-controls", CONTROL, "/qd", [measured(60, "rpm"), 0], [2 * pi, 0], "m"),
    ("optimal-controls", CONTROL, "/t", measured(1, "min"), 60.0, "m"),
    ("optimal-controls", CONTROL, "/inputs/tau.slide.x", measured(2, "kN"), 2000.0, "N m"),
    ("optimal-controls", CONTROL, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
    ("optimal-controls", CONTROL, "/end/q", [DEG, None], [pi / 2, None], "m"),
    ("optimal-controls", CONTROL, "/end/qd", {SLIDE: measured(36, "km/h")}, {SLIDE: 10.0}, "rad/s"),
    ("optimal-controls", CONTROL, "/bounds/tau.arm.q", [None, measured(25, "N cm")], [None, 0.25], "N"),
    ("optimal-controls", CONTROL, "/bounds/tau.arm.q", measured([-25, 25], "N cm"), [-0.25, 0.25], "N"),
    ("optimal-controls", CONTROL, "/guess/tau.arm.q", measured([25, 50], "N cm"), [0.25, 0.5], "N"),
    ("optimal-controls", CONTROL, "/free_horizon", [0, measured(1, "min")], [0, 60.0], "m"),
    ("optimal-controls", CONTROL, "/free_parameters/arm.m", [measured(250, "g"), 1], [0.25, 1], "m"),
    ("cost-gradients", CONTROL, "/values/tau.arm.q", measured(25, "N cm"), 0.25, "N"),
]
ABOUT: Plain = {"quantity": "metric", "simplify": 0.01}
RANGES: list[Row] = [
    ("abbreviations", ABOUT, "/ranges/arm.q", [measured(-90, "deg"), DEG], [-pi / 2, pi / 2], "m"),
    ("abbreviations", ABOUT, "/ranges/slide.x", measured([-250, 250], "mm"), [-0.25, 0.25], "rad"),
    ("abbreviations", ABOUT, "/ranges/arm.q'", measured([0, 60], "rpm"), [0, 2 * pi], "rad"),
    ("abbreviations", ABOUT, "/ranges/slide.x''", measured([0, 250], "mm/s^2"), [0, 0.25], "m/s"),
    ("abbreviations", ABOUT, "/ranges/arm.m", measured([250, 500], "g"), [0.25, 0.5], "m"),
    ("abbreviations", ABOUT, "/ranges/tau.arm.q", measured([0, 25], "N cm"), [0, 0.25], "N"),
    ("abbreviations", ABOUT, "/parameters/arm.m", measured(250, "g"), 0.25, "m"),
]  # fmt: skip
TABLE = [*MOTION, *QUESTIONS, *CONTROLS, *RANGES]
#: numbers without a dimension, or with one that changes from coordinate to coordinate
PURE = {
    "simplify",
    # a share, a factor, an answer as it was given
    *("held_out", "prior_deviation", "warm_start"),
    # limits of any expression
    "path",
    # of squares of anything
    *("weights", "efforts"),
    *("absolute_tolerance", "relative_tolerance", "drift_limit", "error_limit", "tolerance", "constraints.normal"),
    *("contacts.friction", "contacts.restitution"),
    # samples have a unit beside the numbers, columns may be of anything
    *("samples.of.values", "samples.of.uniform", "samples.of.normal", "columns.expression"),
    # states of columns are converted where they are used
    *("columns.at", "columns.over", "columns.span", "columns.relative_tolerance", "columns.absolute_tolerance"),
}


@pytest.fixture(scope="module")
def model() -> Model:
    """A pendulum with a slider at its tip."""
    parts = {each["name"]: derive(Definition.read(each)) for each in (PENDULUM, SLIDER)}
    slide = {"name": "slide", "substructure": "slider", "at": "arm.tip", "parameters": {"k": 3}}
    arm = {"name": "arm", "substructure": "pendulum"}
    tree: Plain = {"name": "both", "gravity": [0, "-g", 0], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    return couple(
        TreeSpec.read(tree | {"instances": [arm, slide]}), {"arm": parts["pendulum"], "slide": parts["slider"]}
    )


def put(body: Plain, pointer: str, value: Any) -> Plain:
    """A copy of a body with something in a place."""
    result: Any = copy.deepcopy(body)
    *steps, last = pointer.split("/")[1:]
    here = result
    for step in steps:
        here = here[int(step)] if isinstance(here, list) else here.setdefault(step, {})
    here[int(last) if isinstance(here, list) else last] = value
    return result  # type: ignore[no-any-return]


def units_in(given: Any, pointer: str = "") -> Iterator[str]:
    """Where something with a unit stands."""
    if isinstance(given, dict) and "unit" in given:
        yield pointer
    elif isinstance(given, dict | list):
        for step, x in given.items() if isinstance(given, dict) else enumerate(given):
            yield from units_in(x, f"{pointer}/{escape(step)}")


def with_unit(given: Any, unit: str) -> tuple[Any, str]:
    """The same with another unit in the first place that has one, and where that is."""
    place = next(units_in(given))
    return put({"x": given}, f"/x{place}/unit", unit)["x"], place


def same(found: Any, expected: Any) -> None:
    if isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for name in expected:
            same(found[name], expected[name])
    elif hasattr(expected, "__dict__"):
        assert type(found) is type(expected)
        same(vars(found), vars(expected))
    elif isinstance(expected, list | tuple):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            same(one, other)
    else:
        assert found == (pytest.approx(expected, rel=1e-15) if isinstance(expected, float) else expected)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: row[0] + row[2])
def test_numbers_of_analyses_have_units(model: Model, row: Row) -> None:
    name, body, place, given, plain, wrong = row
    read = {
        kind: arguments(ANALYSES[name].read(put(body, place, x), model)) for kind, x in (("g", given), ("p", plain))
    }
    same(read["g"], read["p"])
    for unit, code in ((wrong, "unit-mismatch"), ("furlog", "unknown-unit")):
        changed, below = with_unit(given, unit)
        with pytest.raises(InvalidInput) as caught:
            ANALYSES[name].read(put(body, place, changed), model)
        assert [(f.pointer, f.code) for f in caught.value.faults] == [(place + below, code)]


def numbers_of(annotation: Any, metadata: tuple[Any, ...] = (), path: str = "") -> Iterator[tuple[str, bool]]:
    """Paths of the fields with numbers in a schema, and whether these may have units."""
    args = get_args(annotation)
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        for name, field in annotation.model_fields.items():
            below = f"{path}.{name}".removeprefix(".root").lstrip(".")
            yield from numbers_of(field.annotation, tuple(field.metadata), below)
    elif any(isinstance(x, WithUnits) for x in (*metadata, *args)):
        yield path, True
        for each in args:
            yield from ((p, has) for p, has in numbers_of(each, (), path) if p != path)
    elif annotation in (float, Decimal, Any):
        yield path, False
    else:
        for each in args:
            if isinstance(each, type) or get_args(each) or each is Any:
                yield from numbers_of(each, (), path)


def test_the_table_has_all_numbers_of_all_requests() -> None:
    """So that whoever adds a field has to say what stands there."""
    has_units, without = set(), set()
    for analysis in ANALYSES.values():
        for path, has in numbers_of(analysis.schema):
            (has_units if has else without).add(path)
    assert without == PURE
    steps = [[step for step in row[2].split("/")[1:] if not step.isdigit()] for row in TABLE]
    listed = {".".join(path) for path in steps} | {f"{path[0]}.{path[-1]}" for path in steps}
    # what stands below of values by name belongs to the field
    texts = {"series", "outputs", "events.quantity", "section.quantity", "quantity"}
    missing = [p for p in has_units - texts if not any(f"{x}.".startswith(f"{p}.") for x in listed)]
    assert not missing


@pytest.mark.parametrize("value", [1e308, -1e308, [1, 1e308], 10**308])
def test_numbers_that_are_not_finite_in_si_are_refused(filled: TestClient, value: Any) -> None:
    """Beyond the range of doubles only when they are converted."""
    body = SPAN | {"inputs": {"tau.arm.q": {"values": measured(value, "kN m"), "times": [0, 1]}}}
    answer = filled.post("/v1/trees/cell/simulations", json=body)
    assert answer.status_code == 422, answer.text
    assert [fault["code"] for fault in answer.json()["errors"]] == ["number-not-finite"]


def test_a_fault_of_many_numbers_names_the_coordinate(model: Model) -> None:
    with pytest.raises(InvalidInput) as caught:
        read_request(ANALYSES["linearisations"].schema, {"q": measured([[0, 0]], "deg")}, model)
    assert str(caught.value) == "/q: m expected for 'slide.x', found deg"


@pytest.mark.parametrize(
    ("name", "body", "pointer"),
    [
        ("simulations", SPAN | {"inputs": {"tau.arm.q": "-2*(arm.m + arm.l)"}}, "/inputs/tau.arm.q"),
        ("simulations", SPAN | {"inputs": {"tau.arm.q": "arm.m*g"}}, "/inputs/tau.arm.q"),
        ("simulations", SPAN | {"series": {"x": "sin(arm.l)"}}, "/series/x"),
        ("simulations", SPAN | {"events": [{"name": "a", "quantity": "arm.m + g"}]}, "/events/0/quantity"),
        (
            "simulations",
            SPAN | {"events": [{"name": "a", "quantity": "arm.q", "reset": {SLIDE: "arm.m"}}]},
            "/events/0/reset/slide.x",
        ),
        ("loop-states", {"prescribed": {SLIDE: "arm.m"}}, "/prescribed/slide.x"),
        ("linearisations", {"q": [0, 0], "outputs": {"y": "arm.m - arm.l"}}, "/outputs/y"),
    ],
)
def test_contradictions_in_expressions_are_refused(model: Model, name: str, body: Plain, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        ANALYSES[name].read(body, model)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, "unit-mismatch")]


@pytest.mark.parametrize(
    "q", [measured(1, "km^99/mm^99"), measured([1], "km^99/mm^99"), measured([1e300], "km^9/mm^9")]
)
def test_units_beyond_the_range_of_doubles_are_refused(model: Model, filled: TestClient, q: Plain) -> None:
    body = {"quantities": ["forces"], "q": [0.1], "parameters": {"arm.m": q | {"unit": f"kg*{q['unit']}"}}}
    answer = filled.post("/v1/trees/cell/evaluations", json=body)
    assert answer.status_code == 422, answer.text
    where = "/parameters/arm.m/value"
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [(where, "number-not-finite")]
    with pytest.raises(InvalidInput) as caught:
        evaluate(model, ["forces"], q=[0.1, 0.2], parameters=body["parameters"])
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(where, "number-not-finite")]


def test_the_factor_of_a_unit_may_be_beyond_the_range_of_doubles() -> None:
    small = [Decimal(0), 1e-300]
    assert si_values(measured(small, "km^99/mm^99"), "", "/q") == [0.0, 1e294]
    assert read_unit("km^99/mm^99").scale == float("inf")
    tiny = si_values(measured([1e300, 2e300], "mm^60/km^60"), "", "/q")
    assert tiny == [pytest.approx(1e-60, rel=1e-15), pytest.approx(2e-60, rel=1e-15)]
    with pytest.raises(ValidationError, match="below the range"):
        Distribution.model_validate({"values": [1e300], "unit": "mm^60/km^60"})
    with pytest.raises(ValidationError, match="in SI a number is not finite"):
        Distribution.model_validate({"values": [1.0], "unit": "km^99/mm^99"})


def test_the_science_takes_units_too(model: Model) -> None:
    q = [measured(90, "deg"), measured(250, "mm")]
    given, plain = (evaluate(model, ["forces"], q=x)["forces"] for x in (q, [pi / 2, 0.25]))
    assert np.array_equal(given, plain)
