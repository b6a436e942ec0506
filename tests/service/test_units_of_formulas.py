"""Formulas for people say the units of what they are about."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from service.cli.tree_files import coupled_source
from service.models.formulas import made
from service.models.printing import Style, made_text
from substructures import Definition, TreeSpec, catalogue, derive
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.velocity_constraints import Linear
from substructures.export import interface_of_model

REFERENCE = Path(__file__).parents[1] / "reference"
#: how a line of each format begins that tells a unit: name of the symbol, unit
LINES = {
    "text": r"^# (\S+) is base parameter \[(.*)\]$",
    "latex": r"^% (\S+): base parameter \[(.*)\], ",
    "mathml": r"<td>([\w.]+)</td><td>base parameter</td><td>(.*?)</td>",
}
#: by what the name of a parameter begins with
UNITS = {"m": "kg", "s": "kg m", "J": "kg m^2"}


def tree_of(name: str) -> dict[str, Any]:
    if name == "two links":
        document: dict[str, Any] = json.loads((REFERENCE / "two-link-symbolic-lengths.json").read_text())
        return document
    return {
        "name": name,
        "gravity": [0, 0, "-981/100"],
        "instances": [{"name": "a", "definition": catalogue.load(name)}],
    }


@pytest.mark.parametrize(("name", "count"), [("two links", 6), ("puma560", 36)])
def test_base_parameters_have_their_own_units(name: str, count: int) -> None:
    """Names in their order and units in another were put together: 16 of 36 were wrong."""
    spec = TreeSpec.read(tree_of(name))
    definition = spec.instances[0].definition
    assert definition is not None
    source = coupled_source(spec, {spec.instances[0].name: derive(definition)})
    found, interface = made(source, "base_parameters", {}), interface_of_model(source.model)
    for form, line in LINES.items():
        text = made_text(found, "base_parameters", interface, source, Style(form, "readable"))
        told = re.findall(line, text, re.MULTILINE)
        assert len(told) == count, form
        assert dict(told) == {symbol: UNITS[symbol.rpartition(".")[2][0]] for symbol, _ in told}


def test_accelerations_of_velocity_equations_have_units() -> None:
    """x moves [m/s], th turns [rad/s]."""
    joint = {"type": "planar", "coordinate": ["x", "y", "th"]}
    body = {
        "name": "b",
        "parent": "base",
        "joint": joint,
        "mass": 1,
        "com": [0.2, 0.1, 0],
        "inertia": {"xx": 0.5, "yy": 0.5, "zz": 1},
    }
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "s", "definition": {"name": "d", "bodies": [body]}}]})
    source = coupled_source(spec, {"s": derive(Definition.read({"name": "d", "bodies": [body]}))})
    edge = Linear("edge", "sin(s.th)*s.x' - cos(s.th)*s.y'")
    symbols = quasi_velocity_equations(source.model, [edge], independent=["s.x", "s.th"]).program.symbols
    units = {symbol.name: symbol.unit for symbol in symbols if symbol.kind == "acceleration"}
    assert units == {"s.x''": "m/s^2", "s.th''": "rad/s^2"}
