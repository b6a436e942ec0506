"""Generated code calls coordinates, inputs and parameters by their names."""

from __future__ import annotations

from typing import Any

import pytest
from catalogue_entries import shipped_part

from substructures import couple, render
from substructures.export import interface_of_model

TREE: dict[str, Any] = {
    "name": "crane",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [
        {"name": "trolley", "substructure": "linear-rail"},
        {"name": "load", "substructure": "simple-pendulum", "at": "trolley.mount"},
    ],
}
LANGUAGES = ("c", "cpp", "fortran", "jax", "julia", "matlab", "python", "rust")


def code(tree: dict[str, Any], language: str) -> str:
    parts = {each["name"]: shipped_part(each["substructure"]) for each in tree["instances"]}
    model = couple(tree, parts)
    return render(model.program.select(["metric", "forces"]), language, interface=interface_of_model(model))


@pytest.mark.parametrize("language", LANGUAGES)
def test_formulas_have_the_names_of_the_tree(language: str) -> None:
    text = code(TREE, language)
    for name in ("load_m", "load_l", "load_q1", "trolley_x_dot", "tau_load_q1", "trolley_J"):
        assert text.count(name) >= 2, name  # where it is declared, and where it is used
    formulas = [line for line in text.splitlines() if "sin(load_q1)" in line.replace("sin(double(load_q1))", "")]
    assert formulas


@pytest.mark.parametrize("language", LANGUAGES)
def test_another_parameter_changes_no_formula(language: str) -> None:
    """Places of elements change, names do not."""
    more = {**TREE, "parameters": {**TREE["parameters"], "a0": {"value": 1, "unit": "m"}}}
    lines = [
        [line.strip() for line in code(tree, language).splitlines() if "cos(" in line or "sin(" in line]
        for tree in (TREE, more)
    ]
    assert lines[0] == lines[1] != []


def test_names_that_a_compiler_would_not_take_stay_places() -> None:
    odd = {
        **TREE,
        "instances": [
            {"name": "L", "substructure": "linear-rail"},
            {"name": "l", "substructure": "simple-pendulum", "at": "L.mount"},
        ],
    }
    text = code(odd, "c")
    # L_m and l_m differ in capitals alone, which Fortran does not tell apart: one of them has its name
    declared = [line.split()[2] for line in text.splitlines() if line.startswith("    const double ")]
    assert len({name.lower() for name in declared}) == len(declared)
    assert {"L_m", "l_m"} & set(declared)
