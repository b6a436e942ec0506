"""Formulas in base parameters: those of the model, with fewer operations and with definitions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_parts

from substructures import Model, TreeSpec, catalogue, couple
from substructures.analysis.identification import grouped
from substructures.analysis.identification.base_parameters import base_parameters
from substructures.analysis.identification.grouped import OUTPUTS, Grouped, grouped_model, sum_of
from substructures.errors import VerificationFailed
from substructures.export import render
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.printers.definitions import Definitions
from substructures.quantities.formulas import derived
from substructures.quantities.regressor import regressor

G = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
#: a body with two frames out of line, on whose first one parts with heavy bases are mounted
BENT: dict[str, Any] = {
    "name": "bent",
    "parameters": {
        "m": {"value": 2.0, "unit": "kg"},
        "a": {"value": 0.3, "unit": "m"},
        "M": {"value": 3, "unit": "kg"},
    },
    "bodies": [
        {"name": "foot", "parent": "base", "joint": {"type": "fixed"}, "mass": "M", "com": [0.1, "a", 0.2]},
        {
            "name": "beam",
            "parent": "base",
            "joint": {
                "type": "revolute",
                "coordinate": "q",
                "placement": {"position": ["a", 0, 0.1], "rpy": [0.4, 0.2, 0]},
                "axis": [1, 0, 0],
            },
            "mass": "m",
            "com": ["a", 0.1, 0.2],
            "inertia": {"xx": 0.3, "yy": 0.4, "zz": 0.35, "xy": 0.02},
        },
        {
            "name": "slide",
            "parent": "beam",
            "joint": {"type": "prismatic", "coordinate": "x", "theta": "pi/3", "d": "a", "armature": 0.2},
            "mass": "m/2",
            "com": [0.1, "a", 0.05],
            "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1},
        },
    ],
    "ports": [{"name": "end", "body": "slide", "position": [0.1, 0.2, "a"], "rotation": {"rpy": [0.1, 0, 0.3]}}],
    "loads": [{"type": "joint", "coordinate": "x", "force": "-m*x"}],
}
CHAIN = G | {
    "instances": [
        {"name": "one", "substructure": "bent"},
        {"name": "two", "substructure": "bent", "at": "one.end", "placement": {"position": [0.1, 0, 0]}},
        {"name": "three", "substructure": "bent", "at": "two.beam", "parameters": {"a": "one.a"}},
    ]
}


def alone(name: str) -> dict[str, Any]:
    return G | {"instances": [{"name": "x", "substructure": name}]}


def grouping_of(tree: dict[str, Any], definitions: Mapping[str, Any]) -> tuple[Model, Grouped]:
    spec, parts = tree_parts({"name": "t", **tree}, definitions)
    model = couple(spec, parts)
    return model, grouped_model(spec, parts, model, base_parameters(regressor(spec, parts)))


@pytest.mark.parametrize(
    ("tree", "definitions"),
    [
        (CHAIN, {"bent": BENT}),
        *((alone(n), {n: catalogue.load(n)}) for n in ("puma560", "furuta-pendulum", "satellite", "gantry")),
    ],
    ids=["chain", "puma560", "furuta-pendulum", "satellite", "gantry"],
)
def test_it_is_the_model_for_other_values_of_the_parameters(
    tree: dict[str, Any], definitions: Mapping[str, Any]
) -> None:
    model, found = grouping_of(tree, definitions)
    rng = np.random.default_rng(3)
    names = {s.name for p in (model.program, found.definitions) for s in p.symbols}
    at = {name: float(rng.uniform(0.5, 1.5)) for name in sorted(names)}
    beta = {name: float(x) for name, x in interpret(found.definitions, at).items()}
    told = interpret(found.model.program, {**at, **beta})
    wanted = interpret(model.program.select(list(told)), at)
    assert set(told) == set(OUTPUTS)
    for name, x in wanted.items():
        np.testing.assert_allclose(told[name], x, rtol=1e-10, atol=1e-10, err_msg=name)


@pytest.mark.parametrize("missing", ["nonlinear_effects", "christoffel"])
def test_a_model_that_lacks_an_output_is_grouped_without_it(missing: str) -> None:
    """As models are that older versions stored, or that have too many Christoffel symbols."""
    spec, parts = tree_parts({"name": "t", **CHAIN}, {"bent": BENT})
    model = couple(spec, parts)
    outputs = {name: x for name, x in model.program.outputs.items() if name != missing}
    old = replace(model, program=replace(model.program, outputs=outputs))
    found = grouped_model(spec, parts, old, base_parameters(regressor(spec, parts)))
    assert set(found.model.program.outputs) == set(OUTPUTS) - {missing}
    assert derived(found.model, "forward_dynamics").outputs["forward_dynamics"].shape == (model.dof,)


def test_the_double_pendulum_as_in_a_textbook() -> None:
    model, found = grouping_of(alone("double-pendulum"), {"double-pendulum": catalogue.load("double-pendulum")})
    assert {s.name: s.formula for s in found.symbols} == {
        "x.Jxx_lower": "x.m2*x.l2^2",
        "x.Jxx_upper": "(x.m1 + x.m2)*x.l1^2",
        "x.sx_lower": "x.m2*x.l2",
        "x.sx_upper": "(x.m1 + x.m2)*x.l1",
    }
    told = {s.name: sum_of(s.standard) for s in found.symbols}
    assert told["x.Jxx_upper"] == "x.upper.Jxx + x.upper.Jyy + x.l1^2*x.lower.m"
    definitions = Definitions(found.definitions, told)
    lines = render(found.model.program.select(["metric"]), "text", "textbook", definitions=definitions).splitlines()
    assert "metric[1, 1] = Jxx_lower + Jxx_upper + 2*sx_lower*l1*cos(q2)" in lines
    at = lines.index("Jxx_upper = (m1 + m2)*l1^2")
    assert lines[at - 1] == "# Jxx_upper stands for x.upper.Jxx + x.upper.Jyy + x.l1^2*x.lower.m"
    assert not [line for line in lines if line.startswith("sx_upper")], "it does not occur in the metric"
    assert found.model.operations["total"] < model.operations["total"]


def test_names_that_are_taken_are_left_alone() -> None:
    part = catalogue.load("double-pendulum")
    part["parameters"]["Jxx_lower"] = {"value": 1, "unit": "kg"}
    _, found = grouping_of(alone("double-pendulum"), {"double-pendulum": part})
    assert "x.Jxx_lower_b" in {s.name for s in found.symbols}


def test_wrong_formulas_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = grouped._coupled

    def wrong(*given: Any) -> Program:
        """The outputs without the last element of the metric."""
        program = right(*given)
        metric = program.outputs["metric"]
        less = type(metric)(metric.shape, metric.index[:-1], metric.entries[:-1], metric.symmetry)
        return Program(program.symbols, program.operations, {**program.outputs, "metric": less})

    monkeypatch.setattr(grouped, "_coupled", wrong)
    with pytest.raises(VerificationFailed, match="grouped formulas: metric"):
        grouping_of(alone("furuta-pendulum"), {"furuta-pendulum": catalogue.load("furuta-pendulum")})


def test_constant_angles_are_written_in_textbook_forms() -> None:
    tree = G | {"instances": [{"name": "x", "substructure": "pan-tilt", "placement": {"rpy": [0.1, 0, 0]}}]}
    spec, parts = tree_parts({"name": "t", **tree}, {"pan-tilt": catalogue.load("pan-tilt")})
    text = render(couple(spec, parts).program.select(["gravity"]), "text", "textbook")
    assert "sin(0.1)" in text
    assert isinstance(spec, TreeSpec)
