"""What a certificate says, and that a wrong formula gets none."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from substructures import Definition, TreeSpec, couple, derive
from substructures.expr.program import Program
from substructures.part.certificate import TOLERANCE, VerificationFailed, compare
from substructures.part.outputs import over_formulas
from substructures.part.part import recheck
from substructures.tree.assembly import assemble
from substructures.tree.certificate import certify_tree
from substructures.tree.coupling import couple_parts
from substructures.tree.model import rate_symbols

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


ARM: dict[str, Any] = {
    "name": "arm",
    "bodies": [
        {
            "name": name,
            "parent": parent,
            "joint": {"type": "revolute", "theta": 0.7, "d": 0.5, "armature": 0.3},
            "mass": 2,
            "com": [0.3, 0.2, 0.1],
            "inertia": {"xx": 0.2, "yy": 0.3, "zz": 0.4},
        }
        for name, parent in (("a", "base"), ("b", "a"))
    ],
}


def with_a_doubled_entry(program: Program, name: str) -> Program:
    """The program with twice its value at the last element of an output, as if a formula had been derived wrongly."""
    output, n = program.outputs[name], len(program.operations)
    wrong = replace(output, entries=(*output.entries[:-1], n))
    operations = (*program.operations, ("add", output.entries[-1], output.entries[-1]))
    return replace(program, operations=operations, outputs={**program.outputs, name: wrong})


def test_formulas_that_do_not_exist_everywhere_are_checked_at_the_defaults() -> None:
    part = derive(Definition.read(PART))
    tree = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "x"}]})
    whole = {"metric", "christoffel"}
    for certificate, checked in (
        (part.certificate, whole),
        (couple(tree, {"x": part}).certificate, whole | {"gravity", "bias"}),
    ):
        errors = certificate["direct_form"]["max_relative_error"]
        assert errors.keys() == checked
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


@pytest.mark.parametrize("name", ["metric", "christoffel"])
def test_a_part_with_one_wrong_element_is_refused(name: str) -> None:
    part = derive(Definition.read(ARM))
    assert recheck(part)["direct_form"]["max_relative_error"].keys() == {"metric", "christoffel"}
    with pytest.raises(VerificationFailed, match=name):
        recheck(replace(part, program=with_a_doubled_entry(part.program, name)))


@pytest.mark.parametrize("name", ["metric", "christoffel", "gravity", "bias"])
def test_a_tree_with_one_wrong_element_is_refused(name: str) -> None:
    part = derive(Definition.read(ARM))
    mounts = [{"name": "x", "substructure": "arm"}, {"name": "y", "substructure": "arm", "at": "x.b"}]
    spec = TreeSpec.read({"name": "t", "gravity": [1, 2, -9], "instances": mounts})
    parts = {"x": part, "y": part}
    model, assembly = couple(spec, parts), assemble(spec, parts)
    couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity)
    rate_symbols(assembly)
    wrong = with_a_doubled_entry(model.program, name)
    with pytest.raises(VerificationFailed, match=name):
        certify_tree(assembly, model.coordinates, wrong, 0.0)
