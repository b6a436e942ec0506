"""Pareto fronts and conditions, against what they are by definition."""

from __future__ import annotations

import numpy as np
import pytest

from substructures.errors import InvalidDocument
from substructures.sweeps.conditions import read_condition, read_expression
from substructures.sweeps.front import front


@pytest.mark.parametrize("columns", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", ["random", "ties", "all on it"])
def test_front_by_definition(columns: int, kind: str) -> None:
    values = np.random.default_rng(columns).normal(size=(1500, columns))
    if kind == "ties":
        values = np.round(values)
    if kind == "all on it" and columns > 1:
        values[:, 1] = -values[:, 0]
    less = (values[:, None, :] <= values[None, :, :]).all(axis=2) & (values[:, None, :] < values[None, :, :]).any(
        axis=2
    )
    assert front(values).tolist() == np.flatnonzero(~less.any(axis=0)).tolist()


def test_nothing_has_no_front() -> None:
    assert len(front(np.zeros((0, 2)))) == 0


def test_conditions() -> None:
    columns = {"m": np.array([1.0, 2.0, np.nan, 4.0]), "arm.l": np.array([1.0, 1.0, 1.0, 3.0])}
    held = {
        "m < 3": [True, True, False, False],
        "m/2 >= arm.l and arm.l != 3": [False, True, False, False],
        "m == 1 or arm.l > 2": [True, False, False, True],
        "1 <= m < 2*(arm.l + 1)": [True, True, False, True],
        "": [True] * 4,
    }
    for text, expected in held.items():
        assert read_condition(text, columns, "/where").holds(columns, 4).tolist() == expected, text
    quotient = read_expression("sqrt(m)/(arm.l - 1)", columns, "").of(columns, 4)
    assert np.isinf(quotient[0])
    assert quotient[3] == 1


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("m", "comparison-expected"),
        ("m < 3 and", "comparison-expected"),
        ("m < mas", "unknown-column"),
        ("m < 2*", "bad-expression"),
        ("m < 1/0", "bad-expression"),
    ],
)
def test_what_is_no_condition(text: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as error:
        read_condition(text, ["m", "mass"], "/where")
    assert [(fault.pointer, fault.code) for fault in error.value.faults] == [("/where", code)]


def test_comparisons_have_no_parentheses() -> None:
    with pytest.raises(InvalidDocument, match="no parentheses around comparisons"):
        read_condition("(m < 1) or (m > 2)", ["m"], "/where")
