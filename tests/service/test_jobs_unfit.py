"""Items that fit their tree in shape, but not in names and lengths, are refused when they are submitted."""

from __future__ import annotations

from typing import Any

import pytest

from .job_outcomes import faults, known_library
from .jobs_library import MemoryLibrary


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return known_library()


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({}, "/q"),
        ({"q": "x"}, "/q"),
        ({"q": []}, "/q"),
        ({"q": {"arm.q": []}}, "/q"),
        ({"q": [[0], [0, 1]]}, "/q"),
        ({"q": {"leg.q": 0}}, "/q/leg.q"),
        ({"q": [[0], [1]], "qd": [[0]] * 3}, "/qd"),
        ({"q": [[0], [1]], "t": [0, 1, 2]}, "/t"),
        ({"q": [0], "parameters": {"arm.nose": 1}}, "/parameters/arm.nose"),
        ({"q": [0], "parameters": [1]}, "/parameters"),
        ({"q": [0], "quantities": ["inverse_dynamics"]}, "/qdd"),
        ({"q": [0], "quantities": ["forward_dynamics_derivative"]}, "/along"),
    ],
)
def test_evaluations_that_cannot_be_computed_are_refused(
    library: MemoryLibrary, given: dict[str, Any], pointer: str
) -> None:
    item = {"tree": "cell", "request": {"quantities": ["metric"], **given}}
    found = faults(library, "evaluate", {"items": [item]})
    assert f"/items/0/request{pointer}" in {place for place, _ in found}


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"t": [0, 1]}, "/request/t"),
        ({"qdd": [[0], [1]]}, "/request/qdd"),
        ({"inputs": [1]}, "/request/inputs"),
        ({"parameters": [1]}, "/request/parameters"),
        ({"parameters": {"arm.m": 2}}, "/grid/arm.m"),
        ({"inputs": {"tau.arm.q": 2}}, "/grid/tau.arm.q"),
        ({"quantities": ["inverse_dynamics"]}, "/request/qdd"),
    ],
)
def test_what_does_not_fit_a_grid_is_refused(library: MemoryLibrary, given: dict[str, Any], pointer: str) -> None:
    request = {"quantities": ["metric"], **given}
    item = {"tree": "cell", "request": request, "grid": {"arm.q": [0, 1, 2], "arm.m": 1, "tau.arm.q": 1}}
    found = faults(library, "evaluate", {"items": [item]})
    assert [place for place, _ in found] == [f"/items/0{pointer}"]


def test_a_sample_over_a_parameter_that_is_given_is_refused(library: MemoryLibrary) -> None:
    request = {"quantities": ["metric"], "parameters": {"arm.m": 1}}
    item = {"tree": "cell", "request": request, "sample": {"count": 2, "ranges": {"arm.m": [1, 2]}}}
    assert faults(library, "evaluate", {"items": [item]}) == {("/items/0/sample/ranges/arm.m", "given-twice")}


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({"quantity": "beauty"}, "/quantity", "unknown-quantity"),
        ({"quantity": "total"}, "/quantity", "unknown-quantity"),
        ({"bind": "arm.m"}, "/bind", "bind"),
        ({"bind": "arm.m:1+"}, "/bind", "bind"),
        ({"bind": "defaults,nose:1"}, "/bind", "unknown-parameter"),
        ({"options": {"inputs": ["tau.arm.q"]}}, "/options/inputs", "unknown-option"),
        ({"quantity": "state_space", "options": {"nose": ["x"]}}, "/options/nose", "unknown-option"),
        ({"format": ["npz"]}, "/items/0/format", "string-type"),
    ],
)
def test_exports_that_cannot_be_made_are_refused(
    library: MemoryLibrary, given: dict[str, Any], pointer: str, code: str
) -> None:
    item = {"tree": "cell", "quantity": "metric", "format": "text", **given}
    assert faults(library, "export", {"items": [item]}) == {(pointer, code)}
