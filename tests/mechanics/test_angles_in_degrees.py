"""Warnings of plain numbers that are meant in degrees, wherever an angle stands."""

from __future__ import annotations

from typing import Any

import pytest
from bad_documents import GOOD, TREE, Plain, changed, good

from substructures.part.definition import Definition
from substructures.part.topology import topology
from substructures.part.units import check_units
from substructures.tree.document import TreeSpec
from substructures.tree.units import check_tree_units

FIRST, LAST = ("bodies", 0, "joint"), ("bodies", 2, "joint")


def warned(document: Plain) -> dict[str, str]:
    definition = Definition.read(document)
    found = check_units(definition, topology(definition)).warnings
    return {each["pointer"]: each["message"] for each in found if each["code"] == "angle-in-degrees"}


@pytest.mark.parametrize(
    ("path", "value", "pointer", "words"),
    [
        ((*FIRST, "psi"), 90, "/bodies/0/joint/psi", "psi = 90 rad is 14.3 turns"),
        ((*FIRST, "phi"), -45, "/bodies/0/joint/phi", "phi = -45 rad is 7.2 turns"),
        ((*FIRST, "theta"), "90", "/bodies/0/joint/theta", '{"value": 90, "unit": "deg"}'),
        ((*FIRST, "rest"), 30, "/bodies/0/joint/rest", "rest = 30 rad"),
        ((*FIRST, "limits"), [-3, 180], "/bodies/0/joint/limits/1", "limits = 180 rad"),
        ((*LAST, "placement"), {"rpy": [0, 90, 0]}, "/bodies/2/joint/placement/rpy/1", "rpy = 90 rad"),
        (("ports", 0, "rotation", "rpy", 2), 90, "/ports/0/rotation/rpy/2", "rpy = 90 rad"),
        (("parameters", "a"), {"value": 90, "unit": "rad"}, "/parameters/a/value", "a = 90 rad"),
    ],
)
def test_plain_degrees_are_warned_of(path: Any, value: Any, pointer: str, words: str) -> None:
    found = warned(changed(GOOD, (path, value)))
    assert list(found) == [pointer]
    assert words in found[pointer]


def test_a_parameter_that_stands_for_an_angle_is_one() -> None:
    document = changed(GOOD, (("parameters", "turned"), {"value": 90}), ((*FIRST, "theta"), "turned"))
    assert list(warned(document)) == ["/parameters/turned/value"]


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ((*LAST, "limits"), [-100, 180]),
        ((*LAST, "rest"), 100),
        ((*LAST, "tau"), 100),
        ((*FIRST, "theta"), {"value": 90, "unit": "deg"}),
        ((*FIRST, "theta"), "20*pi/180"),
        ((*FIRST, "friction"), {"coulomb": 1, "velocity": 1, "load": {"coefficient": 100}}),
        (("parameters", "ratio"), {"value": 100, "unit": "1"}),
        (("parameters", "ratio"), {"value": 100}),
        (("parameters", "a"), {"value": 90, "unit": "deg"}),
    ],
)
def test_what_is_no_angle_in_radians_is_not(path: Any, value: Any) -> None:
    assert warned(changed(GOOD, (path, value))) == {}


def test_placements_and_bindings_of_trees_are_looked_at() -> None:
    tree = changed(
        TREE,
        (("instances", 0, "placement"), {"rpy": [0, 0, 90]}),
        (("instances", 1, "parameters", "l"), 90),
        (("parameters", "turned"), {"value": 45, "unit": "rad"}),
    )
    described = {name: {**good().parameters, "l": {"value": 1, "unit": "rad"}} for name in ("one", "two")}
    definitions = dict.fromkeys(("one", "two"), good().definition)
    warnings = check_tree_units(TreeSpec.read(tree), described, definitions).warnings
    found = [each["pointer"] for each in warnings if each["code"] == "angle-in-degrees"]
    assert found == ["/instances/0/placement/rpy/2", "/instances/1/parameters/l", "/parameters/turned/value"]
