"""Submissions of jobs that cannot be resolved are refused with a pointer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from service.settings import Limits

from .conftest import HAND, PENDULUM, TREE
from .job_outcomes import FREE, faults, known_library
from .jobs_library import MemoryLibrary


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return known_library()


def with_body(fields: Mapping[str, Any]) -> dict[str, Any]:
    """A definition with other fields of its first body."""
    return {**PENDULUM, "bodies": [{**PENDULUM["bodies"][0], **fields}]}


EVALUATION: dict[str, Any] = {"tree": "cell", "request": {"quantities": ["metric"]}}


@pytest.mark.parametrize(
    ("kind", "request_", "expected"),
    [
        ("dance", {"items": [{}]}, ("/kind", "unknown-kind")),
        ("verify", {}, ("/items", "one-source")),
        ("verify", {"items": []}, ("/items", "too-short")),
        ("verify", {"items": {}}, ("/items/0/substructure", "one-source")),
        ("verify", {"items": [{}], "template": {}}, ("/items", "one-source")),
        ("verify", {"items": [{}], "priority": 1}, ("/priority", "extra-forbidden")),
        ("verify", {"items": [{"substructure": "pendulum"}] * 101}, ("/items", "too-many-items")),
        ("verify", {"items": [{"substructure": "pendulum"}, 5]}, ("/items/1", "object-expected")),
        ("verify", {"items": [{"substructure": "pendulum"}, {}]}, ("/items/1/substructure", "one-source")),
        ("verify", {"items": [{"substructure": "pendulum", "x": 1}]}, ("/items/0/x", "extra-forbidden")),
        ("verify", {"items": [{"substructure": "nothing"}]}, ("/substructure", "unknown-substructure")),
        ("verify", {"items": [{"substructure": {}}]}, ("/items/0/substructure", "string-type")),
        ("assemble", {"items": [{"name": "BAD"}]}, ("/name", "string-pattern-mismatch")),
        (
            "assemble",
            {"items": [FREE | {"instances": [{"name": "a", "substructure": "x"}]}]},
            ("/instances/0/substructure", "unknown-substructure"),
        ),
        (
            "assemble",
            {"items": [FREE | {"instances": [{"name": "a", "substructure": "pendulum", "parameters": {"x": 1}}]}]},
            ("/instances/0/parameters/x", "unknown-parameter"),
        ),
        (
            "assemble",
            {"items": [{**TREE, "instances": [*TREE["instances"], HAND | {"at": "arm.nose"}]}]},
            ("/instances/1/at", "unknown-port"),
        ),
        (
            "assemble",
            {"items": [{**TREE, "instances": TREE["instances"] * 2}]},
            ("/instances/1/name", "duplicate-name"),
        ),
        ("assemble", {"items": [{**TREE, "instances": [HAND]}]}, ("/instances/0/at", "unknown-instance")),
        ("assemble", {"items": [{**TREE, "instances": [{**HAND, "at": "tip"}]}]}, ("/instances/0/at", "place")),
        ("derive", {"items": [with_body({"mass": "nope"})]}, ("/bodies/0/mass", "unknown-name")),
        ("derive", {"items": [with_body({"com": [0, "l*(", 0]})]}, ("/bodies/0/com/1", "bad-expression")),
        ("derive", {"items": [with_body({"parent": "nobody"})]}, ("/bodies/0/parent", "unknown-parent")),
        ("assemble", {"template": TREE}, ("/choices", "no-choices")),
        ("assemble", {"template": TREE, "choices": {"arm": []}}, ("/choices/arm", "too-short")),
        ("assemble", {"template": TREE, "choices": {"leg": ["x"]}}, ("/choices/leg", "unknown-choice")),
        (
            "assemble",
            {"template": TREE, "choices": {"/instances/7/at": ["x"]}},
            ("/choices/~1instances~17~1at", "unknown-choice"),
        ),
        ("assemble", {"template": TREE, "choices": {"arm.l": list(range(101))}}, ("/choices", "too-many-items")),
        ("assemble", {"template": [], "choices": {"arm": ["x"]}}, ("/template", "dict-type")),
        *(
            (
                "assemble",
                {"template": FREE | {"instances": [{"name": "a", "parameters": given}]}, "choices": {"a.m": [1, 2]}},
                ("/choices/a.m", "unknown-choice"),
            )
            for given in (None, "s", [])
        ),
        (
            "evaluate",
            {"template": EVALUATION, "choices": {"/request": [1], "/request/q": [[0]]}},
            ("/choices/~1request~1q", "unknown-choice"),
        ),
        (
            "evaluate",
            {
                "template": {"tree": "cell", "request": {"q": [0, 0]}},
                "choices": {"/request/q": [[]], "/request/q/1": [0, 1]},
            },
            ("/choices/~1request~1q~11", "unknown-choice"),
        ),
        (
            "assemble",
            {"template": FREE, "choices": {"/instances": [[]], "a": ["slider"]}},
            ("/choices/a", "unknown-choice"),
        ),
        ("derive", {"items": [{"name": "x", "bodies": 3}]}, ("/bodies", "tuple-type")),
        ("export", {"items": [{"tree": "cell"}]}, ("/items/0/quantity", "missing")),
        ("export", {"items": [{"tree": "no", "quantity": "metric", "format": "c"}]}, ("/tree", "unknown-tree")),
        (
            "export",
            {"items": [{"tree": "cell", "quantity": "metric", "format": "x"}]},
            ("/items/0/format", "unknown-format"),
        ),
        (
            "export",
            {"items": [{"tree": "cell", "quantity": 5, "format": "c"}]},
            ("/items/0/quantity", "string-type"),
        ),
        ("evaluate", {"items": [{"tree": "no", "request": {}}]}, ("/items/0/tree", "unknown-tree")),
        ("evaluate", {"items": [{"tree": "cell", "request": []}]}, ("/items/0/request", "dict-type")),
        ("evaluate", {"items": [{"tree": "cell", "request": {}}]}, ("/items/0/request/quantities", "missing")),
        (
            "evaluate",
            {"items": [{"tree": "cell", "request": {"quantities": [{}]}}]},
            ("/items/0/request/quantities/0", "unknown-quantity"),
        ),
        ("evaluate", {"items": [EVALUATION | {"grid": {}}]}, ("/items/0/grid", "too-short")),
        ("evaluate", {"items": [EVALUATION | {"grid": {"arm.x": [1]}}]}, ("/items/0/grid/arm.x", "unknown-name")),
        (
            "evaluate",
            {"items": [EVALUATION | {"grid": {"arm.q": [1, "x"]}}]},
            ("/items/0/grid/arm.q/1", "number-expected"),
        ),
        ("evaluate", {"items": [EVALUATION | {"grid": {"arm.q": {"from": 0}}}]}, ("/items/0/grid/arm.q", "axis")),
        (
            "evaluate",
            {"items": [EVALUATION | {"grid": {"arm.q": {"from": 0, "to": 1, "count": 0}}}]},
            ("/items/0/grid/arm.q/count", "count"),
        ),
        (
            "evaluate",
            {
                "items": [
                    EVALUATION
                    | {
                        "grid": {
                            "arm.q": {"from": 0, "to": 1, "count": 10000},
                            "arm.m": {"from": 0, "to": 1, "count": 10000},
                        }
                    }
                ]
            },
            ("/items/0/grid", "too-many-states"),
        ),
        ("evaluate", {"items": [EVALUATION | {"sample": {}}]}, ("/items/0/sample/count", "count")),
        ("evaluate", {"items": [EVALUATION | {"sample": {"count": 1, "seed": -1}}]}, ("/items/0/sample/seed", "seed")),
        (
            "evaluate",
            {"items": [EVALUATION | {"sample": {"count": 1, "ranges": {"arm.q": [2, 1]}}}]},
            ("/items/0/sample/ranges/arm.q", "range"),
        ),
        (
            "evaluate",
            {"items": [EVALUATION | {"sample": {"count": 1, "ranges": {"arm.q": [-1e308, 1e308]}}}]},
            ("/items/0/sample/ranges/arm.q", "range"),
        ),
        (
            "evaluate",
            {"items": [EVALUATION | {"grid": {"arm.q": {"from": 1e308, "to": -1e308, "count": 3}}}]},
            ("/items/0/grid/arm.q", "range"),
        ),
        (
            "evaluate",
            {"items": [{**EVALUATION, "tree": "free", "sample": {"count": 1}}]},
            ("/items/0/sample/ranges", "missing"),
        ),
        (
            "evaluate",
            {"items": [EVALUATION | {"sample": {"count": 1}, "grid": {"arm.q": 0}}]},
            ("/items/0/request", "states"),
        ),
        ("evaluate", {"items": [EVALUATION | {"format": "x"}]}, ("/items/0/format", "unknown-format")),
        ("evaluate", {"items": [EVALUATION | {"states": "sha256:0"}]}, ("/items/0/states", "extra-forbidden")),
    ],
)
def test_what_cannot_be_resolved_is_refused_with_a_pointer(
    library: MemoryLibrary, kind: str, request_: dict[str, Any], expected: tuple[str, str]
) -> None:
    assert expected in faults(library, kind, request_, Limits(job_items=100, job_states=100))
