"""The page about the stored format says what is read and written."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import TreeSpec, couple
from substructures.expr.construction.exact import MAX_BITS, MAX_EXPONENT
from substructures.expr.interpret import interpret
from substructures.expr.operations import ARITY, KINDS, MAX_ELEMENTS, SYMMETRIES, VERSION
from substructures.expr.program import Program

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "format.md").read_text()
EXAMPLE: dict[str, Any] = json.loads(PAGE.split("```json\n")[1].split("```")[0])


def rows(header: str) -> dict[str, list[str]]:
    """By the names in its first column, the columns of every row of the table with this header."""
    found = {}
    for row in PAGE.split(f"| {header} |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]:
        columns = row.split("|")[1:-1]
        found |= dict.fromkeys(re.findall(r"`([^`]+)`", columns[0]), columns[1:])
    return found


def test_the_example() -> None:
    stored = Program.from_bytes(json.dumps(EXAMPLE).encode())
    assert f"`{stored.digest}`" in PAGE
    written = json.dumps(EXAMPLE, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()
    assert stored.to_bytes() == written
    x = 0.9 * np.cos(0.7)
    values = interpret(stored, {"q1": 0.7, "l": 0.9})
    np.testing.assert_allclose(values["metric"], [[x * x, x / 3], [x / 3, 0]], rtol=1e-14)
    h = 0.9 * np.sin(0.7)
    np.testing.assert_allclose(values["christoffel"], [[[0, h], [h, 0]], [[-h, 0], [0, 0]]], rtol=1e-14)


def test_operations_kinds_and_symmetries() -> None:
    operations = rows("operation")
    assert set(operations) == {*ARITY, "int", "rat", "sym", "powi"}
    assert all(len(operations[name][0].split(",")) == arity for name, arity in ARITY.items())
    assert set(rows("kind")) >= set(KINDS)
    assert tuple(rows("symmetry")) == SYMMETRIES
    assert f"{MAX_ELEMENTS:,} elements" in PAGE
    assert f"{MAX_BITS // 3} characters" in PAGE
    assert f"at most {MAX_EXPONENT} either way" in PAGE
    assert f"exponents of more than {MAX_BITS} bits" in PAGE
    assert EXAMPLE["version"] == VERSION


@pytest.mark.parametrize("name", ["puma560", "quadrotor", "trolley-crane"])
def test_outputs_of_parts(name: str) -> None:
    """All are listed, and their shapes."""
    part = shipped_part(name)
    loads = sum(load.type in ("force", "torque") for load in part.definition.loads)
    sizes = {"n": part.dof, "frames": len(part.frames), "ports": len(part.ports), "loads": loads}
    table = section_rows("Formulas of a stored")
    assert {n: output.shape for n, output in part.program.outputs.items()} == {
        n: tuple(sizes[x] if x in sizes else int(x) for x in shape) for n, shape in table.items()
    }


@pytest.mark.parametrize("closed", [False, True])
def test_outputs_of_trees(closed: bool) -> None:
    closure = {"name": "rod", "type": "rod", "from": "x.tip", "length": 1}
    data = {"name": "t", "instances": [{"name": "x", "substructure": "acrobot"}], "closures": [closure] * closed}
    model = couple(TreeSpec.read(data), {"x": shipped_part("acrobot")})
    sizes = {"n": model.dof, "frames": len(model.frames), "rows": 1}
    table = {n: shape for n, shape in section_rows("Formulas of a **tree**").items() if closed or n[:8] != "closure."}
    assert {n: output.shape for n, output in model.program.outputs.items()} == {
        n: tuple(sizes[x] if x in sizes else int(x) for x in shape) for n, shape in table.items()
    }


def section_rows(begin: str) -> dict[str, list[str]]:
    """Outputs and their shapes from the table behind these words; a row has one shape for all, or one for each."""
    found = {}
    table = PAGE.split(begin, 1)[1].split("\n|---", 1)[1].split("\n\n", 1)[0].splitlines()[1:]
    for row in table:
        names, shapes = re.findall(r"`([^`]+)`", row.split("|")[1]), row.split("|")[2].split(",")
        shapes = shapes * len(names) if len(shapes) == 1 else shapes
        found |= {n: [x for x in shape.split() if x != "-"] for n, shape in zip(names, shapes, strict=True)}
    return found
