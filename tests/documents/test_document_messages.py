"""What is said of documents that cannot be read: one fault for one mistake, in words, with what is wanted instead."""

from __future__ import annotations

import re
from typing import Any

import pytest
from bad_documents import GOOD, TREE, Plain, changed

from substructures.errors import InvalidDocument
from substructures.part.definition import Definition
from substructures.part.topology import topology
from substructures.tree.document import TreeSpec

SPRING = {"type": "spring", "from": {"body": "base"}, "to": {"body": "b2"}, "stiffness": 3}
UNTYPED = {name: value for name, value in SPRING.items() if name != "type"}
TYPES = "there are force, torque, spring, bushing, cable, joint, potential, friction"
COORDINATE = ("bodies", 0, "joint", "coordinate")
LIMITS = ("bodies", 0, "joint", "limits")
NAME = "a name is a letter and up to 63 letters, digits and '_'"
TAG = "a tag is up to 32 of a to z, 0 to 9 and '-', the first no '-'"


def said(kind: Any, document: Plain) -> str:
    with pytest.raises(InvalidDocument) as caught:
        kind.read(document)
    return "\n".join(map(str, caught.value.faults))


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ({**SPRING, "type": "sprng"}, f"/type: unknown type 'sprng'; {TYPES}; did you mean 'spring'?"),
        ({**SPRING, "type": 3}, f"/type: unknown type 3; {TYPES}"),
        ({**SPRING, "type": None}, f"/type: unknown type null; {TYPES}"),
        (UNTYPED, f"/type: 'type' is needed; {TYPES}"),
        ({**UNTYPED, "typ": "spring"}, f"/type: 'type' is needed, found 'typ'; {TYPES}"),
        ("spring", ": an object with a 'type' is needed, found \"spring\""),
        ({**SPRING, "to": {"body": "b2", "at": 3}}, "/to/at: a list is needed, as in [1, 2, 3], found 3"),
    ],
)
def test_loads_of_no_type_are_told_which_there_are(load: Any, message: str) -> None:
    assert said(Definition, changed(GOOD, (("loads", 0), load))) == f"/loads/0{message}"


def test_so_are_loads_of_trees() -> None:
    told = said(TreeSpec, {**TREE, "loads": [{"name": "a", "type": "sprng", "to": "one.tip"}, {"name": "b"}]})
    assert "/loads/0/type: unknown type 'sprng'" in told
    assert "did you mean 'spring'?\n/loads/1/type: 'type' is needed; there are spring, bushing" in told


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (COORDINATE, "q-1", f": {NAME}; for example 'q_1', found \"q-1\""),
        (COORDINATE, ["a", "q-1"], f"/1: {NAME}; for example 'q_1', found \"q-1\""),
        (COORDINATE, 3, ": a text is needed, found 3"),
        (LIMITS, [1], "/1: an entry is missing here"),
        (LIMITS, [1, 2, 3], ": at most 2 entries are allowed, found [1,2,3]"),
        (LIMITS, [[1, 2], [1]], "/1/1: an entry is missing here"),
        (LIMITS, 1, ": a list is needed, as in [1, 2, 3], found 1"),
        (("bodies", 0, "joint", "rest"), [{"x": 1}], "/0: expected a number, an expression, or 'value' and 'unit', "),
        (("tags",), ["Ölig"], f"/0: {TAG}; for example 'olig', found \"Ölig\""),
    ],
)
def test_only_the_alternative_that_was_meant_is_spoken_of(path: Any, value: Any, message: str) -> None:
    told = said(Definition, changed(GOOD, (path, value)))
    assert told.startswith(f"/{'/'.join(map(str, path))}{message}")
    assert "\n" not in told


def test_a_spherical_joint_of_wrong_names_has_one_fault() -> None:
    joint = {"type": "spherical", "coordinate": ["a", "b", "c-d"]}
    told = said(Definition, changed(GOOD, (("bodies", 1, "joint"), joint)))
    assert told == f"/bodies/1/joint/coordinate/2: {NAME}; for example 'c_d', found \"c-d\""


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("spherical", "has 3 coordinate(s), 1 given: give 3, or leave 'coordinate' out"),
        ("fixed", "has 0 coordinate(s), 1 given: leave 'coordinate' out"),
    ],
)
def test_joints_of_wrong_numbers_of_coordinates_are_told_what_to_do(kind: str, told: str) -> None:
    joint = {"type": kind, "coordinate": "a"}
    with pytest.raises(InvalidDocument, match=re.escape(told)):
        topology(Definition.read(changed(GOOD, (("bodies", 1, "joint"), joint))))


def test_places_and_references_are_described() -> None:
    closure = {"name": "loop", "type": "pin", "from": "tip"}
    told = said(TreeSpec, {**TREE, "closures": [closure], "instances": [{"name": "a", "substructure": "Wrong Part"}]})
    assert "a name with its instance is needed, as 'instance.name'; for example 'arm.tip'" in told
    assert "a reference is a name with its version, as in arm@2, or a name alone" in told
