"""Base parameters of an arm whose axes lie obliquely, by decimals: coefficients are numbers, not long formulas."""

from __future__ import annotations

import numpy as np
import pytest
from random_trees import Plain

from substructures import Definition, TreeSpec, derive
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.told import base_symbols
from substructures.export import render
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.printers.definitions import Definitions
from substructures.quantities.regressor import regressor


def _body(k: int) -> Plain:
    tensor = {a: f"{a}{k}" for a in ("xx", "yy", "zz", "xy", "xz", "yz")}
    placement = {"position": [0.1 * k, 0.05, 0.2], "rpy": [0.3 * k, 0.7, 0.123]}
    joint = {"type": "revolute", "axis": [0.361, 0.48, 0.8], "placement": placement}
    return {
        "name": f"b{k}",
        "parent": f"b{k - 1}" if k > 1 else "base",
        "joint": joint,
        "mass": f"m{k}",
        "com": [f"x{k}", f"y{k}", f"z{k}"],
        "inertia": tensor,
    }


@pytest.fixture(scope="module")
def base() -> BaseParameters:
    values = {
        "m": 2,
        "x": 0.1,
        "y": 0.03,
        "z": 0.2,
        "xx": 0.3,
        "yy": 0.3,
        "zz": 0.2,
        "xy": 0.01,
        "xz": 0.02,
        "yz": 0.01,
    }
    parameters = {f"{name}{k}": {"value": x} for k in (1, 2, 3) for name, x in values.items()}
    part = derive(Definition.read({"name": "arm", "parameters": parameters, "bodies": [_body(k) for k in (1, 2, 3)]}))
    instances = [{"name": "x", "substructure": "arm"}]
    tree = TreeSpec.read({"name": "t", "gravity": [0.1, 0.2, -9.81], "instances": instances})
    return base_parameters(regressor(tree, {"x": part}, 100_000))


def test_combinations_are_numbers(base: BaseParameters) -> None:
    """Each is the element of [1 C] that the formulas give in floats."""
    grouping = interpret(base.program, {}, ["grouping"])["grouping"]
    found = base.combinations()
    assert set(found) == set(base.names)
    written = [
        (b, base.standard.index(name), c) for b, name in enumerate(base.names) for name, c in found[name].items()
    ]
    assert len(written) == len(base.program.outputs["grouping"].entries)
    numbers = 0
    for b, i, text in written:
        assert len(text) < 80
        try:
            value = float(text)
        except ValueError:  # a short formula
            continue
        numbers += 1
        assert value == pytest.approx(grouping[b, i], rel=1e-9, abs=1e-12)
    assert numbers > len(written) / 2


def test_people_read_them(base: BaseParameters) -> None:
    symbols, called, notes = base_symbols(base)
    text = render(Program(called, (), {}), "text", "readable", definitions=Definitions(symbols, notes))
    assert "Jxx_b3 = " in text
    assert len(text) < 20_000
    made, exact = (interpret(p, {s.name: 0.7 for s in p.symbols}, None) for p in (symbols, base.program))
    np.testing.assert_allclose([made[s.name] for s in called], exact["base_parameters"], rtol=1e-12)
