"""What a certificate says, and that a wrong formula gets none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures import Definition, TreeSpec, couple, derive
from substructures.part.certificate import TOLERANCE, VerificationFailed, compare

PART: dict[str, Any] = {
    "name": "x",
    "parameters": {"l": {"value": 2, "unit": "m"}, "w": {"value": 1, "unit": "m"}, "m": {"value": 1, "unit": "kg"}},
    "bodies": [
        {
            "name": "a",
            "parent": "base",
            "joint": {"type": "revolute", "d": "sqrt(l^2-3*w^2)"},
            "mass": "m",
            "com": ["l", 0, 0],
        },
        {
            "name": "b",
            "parent": "a",
            "joint": {"type": "revolute", "d": "sqrt(l^2-3*w^2)"},
            "mass": "m",
            "com": [1, 0, 0],
        },
    ],
}


def with_parameter(name: str, value: Any) -> dict[str, Any]:
    return {**PART, "parameters": {**PART["parameters"], name: {"value": value}}}


def test_formulas_that_do_not_exist_everywhere_are_checked_at_the_defaults() -> None:
    part = derive(Definition.read(PART))
    tree = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "x"}]})
    for certificate in (part.certificate, couple(tree, {"x": part}).certificate):
        errors = certificate["direct_form"]["max_relative_error"]
        assert all(error is not None and error <= TOLERANCE for error in errors.values())


def test_definiteness_is_said() -> None:
    assert derive(Definition.read(PART)).certificate["positive_definite"] is True
    assert derive(Definition.read(with_parameter("m", 0))).certificate["positive_definite"] is False
    assert derive(Definition.read(with_parameter("m", None))).certificate["positive_definite"] is None


def test_a_wrong_formula_gets_no_certificate() -> None:
    right = {"metric": np.eye(2), "christoffel": np.zeros((2, 2, 2))}
    assert compare(right, right)["max_relative_error"] == {"metric": 0.0, "christoffel": 0.0}
    with pytest.raises(VerificationFailed, match="christoffel"):
        compare({**right, "christoffel": np.full((2, 2, 2), 1e-8)}, right)
    assert compare({**right, "metric": np.full((2, 2), np.nan)}, right)["max_relative_error"]["metric"] is None
