"""What gives numbers of a shape, and how much of it is coupled: neither changes them by more than rounding."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures.quantities.quantity import QUANTITIES, TABLE
from substructures.sweeps.shapes import INTERPRETER, KERNEL
from tests.sweeps.in_process import Sweep

AT = {"q": [0.3, -0.4, 0.5], "qd": [0.1, 0.2, -0.3], "qdd": [0.4, -0.2, 0.1]}
TEMPLATE: dict[str, Any] = {
    "name": "cell",
    "gravity": [0, 0, "-g"],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [
        {"name": "arm", "substructure": "planar-2r"},
        {"name": "hand", "substructure": "simple-pendulum", "at": "arm.flange"},
    ],
}
#: functions of a state that every tree has
ASKED = [
    name
    for name in QUANTITIES
    if TABLE[name].is_number and not TABLE[name].only and not {"along"} & {*TABLE[name].requires} and name != "power"
]


def _sweep(columns: dict[str, Any], count: int = 3) -> Sweep:
    samples = {"method": "random", "count": count, "of": {"g": {"uniform": [1, 10]}}}
    return Sweep({"template": TEMPLATE, "choices": {}, "samples": samples, "columns": columns})


@pytest.mark.parametrize("name", ASKED)
def test_outputs_that_are_asked_for_are_enough(name: str) -> None:
    over = {field: AT[field] for field in ("q", "qd", "qdd")}
    column = {"quantity": name, "over": over, "take": "largest_absolute"}
    if TABLE[name].fields:
        column["quantity"] = f"{name}.{TABLE[name].fields[0]}"
    few, all_ = _sweep({"x": column}), _sweep({"x": column, "all": "operations"})
    assert few.plan.columns.outputs is not None
    assert all_.plan.columns.outputs is None
    found, expected = few.rows(), all_.rows()
    assert len(found.rows) == len(expected.rows) == 3
    assert np.allclose(found.columns["x"], expected.columns["x"], rtol=1e-12, atol=1e-12)


def test_many_rows_of_a_shape_are_computed_by_machine_code() -> None:
    columns = {"M": {"quantity": "metric", "over": {"q": AT["q"]}, "take": "largest"}}
    few, many = _sweep(columns), _sweep(columns, 20_000)
    few.rows()
    found = many.rows(0, 5)
    assert (few.refusals.ways, many.refusals.ways) == ({INTERPRETER: 3}, {KERNEL: 5})
    assert np.allclose(found.columns["M"], _sweep(columns, 20_000).rows(0, 5).columns["M"], rtol=1e-15)
    for row in range(2):
        assert many.slow(row)[0]["M"] == pytest.approx(found.columns["M"][row], rel=1e-13)
