"""Bodies of evaluations are read by one model: fields are checked, numbers stay as they came."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from service.schemas.numbers import EvaluationRequest
from substructures.errors import InvalidDocument
from substructures.quantities.derivative_directions import Direction


def test_arrays_pass_as_they_are() -> None:
    q, mass = np.zeros((100_000, 6)), np.ones(100_000)
    request = EvaluationRequest.read({"quantities": ["metric"], "q": q, "parameters": {"arm.m": mass}})
    arguments = request.arguments()
    assert arguments["q"] is q
    assert arguments["parameters"]["arm.m"] is mass
    assert request.given().keys() == {"quantities", "q", "parameters"}


def test_a_direction_becomes_one_of_the_science() -> None:
    plain: dict[str, Any] = {"quantities": ["metric"], "q": [0], "along": {"q": [1], "inputs": {"u": 2}}}
    request = EvaluationRequest.read(plain)
    assert request.arguments()["along"] == Direction(q=[1], inputs={"u": 2})
    assert request.given() == plain


@pytest.mark.parametrize(
    ("body", "faults"),
    [
        ([], [("", "object-expected")]),
        ({"q": [0]}, [("/quantities", "missing")]),
        ({"quantities": 1, "q": [0]}, [("/quantities", "missing")]),
        ({"quantities": ["metric"], "speed": 1}, [("/speed", "unknown-field")]),
        ({"quantities": ["mass"], "a/b": 1}, [("/a~1b", "unknown-field"), ("/quantities/0", "unknown-quantity")]),
        ({"quantities": ["metric"], "along": {"p": [1]}}, [("/along/p", "unknown-field")]),
        ({"quantities": ["metric"], "along": [1]}, [("/along", "missing")]),
    ],
)
def test_faults_of_fields(body: Any, faults: list[tuple[str, str]]) -> None:
    with pytest.raises(InvalidDocument) as error:
        EvaluationRequest.read(body)
    assert [(fault.pointer, fault.code) for fault in error.value.faults] == faults
