"""The setting for another CPU: what it takes, and that kernels of one setting are not used under another."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import target
from substructures.compile.setting import CPU, LEVELS, Setting

#: kernels of a product with a sum, in a process of its own: (compiled, x y + z, identity of the host)
ASK = """
import json, sys
from pathlib import Path
from substructures.compile import compile_program, target
from substructures.expr.graph import Graph
from substructures.expr.program import Symbol, array, program

graph = Graph()
x, y, z = (graph.symbol(name) for name in "xyz")
source = program(graph, {"f": array((), lambda: x * y + z)}, {n: Symbol(n, "parameter", "") for n in "xyz"})
kernel = compile_program(source, ["f"], Path(sys.argv[1]))
eps = 2.0**-30
found = float(kernel.evaluate({"x": 1 + eps, "y": 1 + eps, "z": -1 - 2 * eps})["f"])
print(json.dumps([kernel.compiled, found, target.host().identity if target.available() else ""]))
"""


def asked(folder: Path, cpu: str, contraction: str) -> Any:
    environment = os.environ | {"SUBSTRUCTURES_CPU": cpu, "SUBSTRUCTURES_CONTRACTION": contraction}
    command = [sys.executable, "-c", ASK, str(folder)]
    child = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60, env=environment)
    return json.loads(child.stdout)


def test_values() -> None:
    assert Setting.read({}) == Setting.read({CPU: "", "PATH": "/bin"}) == Setting("native", True)
    assert Setting.read({CPU: "x86-64-v3", "SUBSTRUCTURES_CONTRACTION": "off"}) == Setting("x86-64-v3", False)
    with pytest.raises(ValueError, match=r"SUBSTRUCTURES_CPU: 'znver4' is none of native, x86-64, .*none"):
        Setting.read({CPU: "znver4"})
    with pytest.raises(ValueError, match="SUBSTRUCTURES_CONTRACTION: 'no' is none of on, off"):
        Setting.read({"SUBSTRUCTURES_CONTRACTION": "no"})


def test_what_the_machine_cannot_run_is_refused() -> None:
    assert Setting().level([]) is None
    assert Setting("x86-64").level(["sse", "sse2"]) == LEVELS["x86-64"]
    with pytest.raises(ValueError, match=r"'x86-64-v4' needs avx512f, .* which this machine's CPU does not have"):
        Setting("x86-64-v4").level(LEVELS["x86-64-v3"].needs)


@NEEDS_MACHINE_CODE
def test_kernels_of_another_setting_are_not_used(tmp_path: Path) -> None:
    """(1 + e)^2 - 1 - 2 e is e^2 when the product is not rounded, and 0 when it is."""
    small = 2.0**-60
    expected = {("none", "on"): (False, 0)}
    if "+fma" in target.host().features.split(",") or target.host().cpu in ("x86-64-v3", "x86-64-v4"):
        expected[("x86-64-v3", "on")] = (True, small)
        expected[("x86-64-v3", "off")] = (True, 0)
    if "+sse2" in target.host().features.split(",") or target.host().cpu.startswith("x86-64"):
        expected[("x86-64", "on")] = (True, 0)
    identities = set()
    for (cpu, contraction), figures in expected.items():
        compiled, found, identity = asked(tmp_path, cpu, contraction)
        assert (compiled, found) == figures, (cpu, contraction)
        identities.add(identity)
    assert len(identities) == len(expected)
    assert len(list(tmp_path.iterdir())) == 2 * (len(expected) - 1)
    assert not Path(tmp_path, "none").exists()
