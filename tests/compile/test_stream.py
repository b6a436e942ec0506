"""Batches one after the other, in the memory of one."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import compile_program, target

ARM = (("x", "ur5", "world"),)


@pytest.mark.parametrize("compiled", [True, False])
def test_results_of_batches_in_the_same_memory(
    compiled: bool, tree: Any, states: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tree(*ARM)
    if not compiled:
        monkeypatch.setattr(target, "library", lambda: None)
    kernel = compile_program(model.program, ["metric", "forces"])
    assert kernel.compiled <= compiled
    given = [states(model, count, count) for count in (40, 100, 7, 0, 100)]
    given.append({n: v if np.ndim(v) == 0 else v.reshape(10, 10) for n, v in given[1].items()})
    given.append({n: float(np.ravel(v)[0]) for n, v in given[1].items()})
    memory = set()
    for values, found in zip(given, kernel.stream((v, ()) for v in given), strict=True):
        for name, array in kernel.evaluate(values).items():
            np.testing.assert_array_equal(found[name], array)
        memory.add(found["metric"].__array_interface__["data"][0])
    assert len(memory) == 2
    (only,) = kernel.stream([(given[0], ())], ["metric"], packed=True)
    np.testing.assert_array_equal(only["metric"], kernel.evaluate(given[0], packed=True)["metric"])
    assert set(only) == {"metric"}


MANY = """
import json
from pathlib import Path
import numpy as np
from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.compile import compile_program
from substructures.quantities.numbers.defaults import default_number

instances = [{"name": "x", "substructure": "ur5", "at": "world"}]
spec = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances})
model = couple(spec, {"x": derive(Definition.read(catalogue.load("ur5")))})
rest = {n: default_number(p["value"]) for n, p in model.parameters.items()}
rest |= {s.name: 0.0 for s in model.program.symbols if s.kind in ("input", "velocity", "time")}
kernel = compile_program(model.program, ["metric", "forces"])
rng, size, left = np.random.default_rng(0), 20_000, 10**7

def batches():
    for _ in range(left // size):
        yield rest, [(model.coordinates, rng.uniform(-3, 3, (size, 6)))]

count, finite = 0, True
for found in kernel.stream(batches()):
    count += len(found["metric"])
    finite = finite and bool(np.isfinite(found["metric"]).all() and np.isfinite(found["forces"]).all())
# not ru_maxrss, which a child has from its parent
status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
print(json.dumps({"count": count, "finite": finite, "peak": 1024 * int(status["VmHWM"].split()[0])}))
"""


@NEEDS_MACHINE_CODE
@pytest.mark.deep
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="the peak of memory is read from /proc")
def test_ten_million_states_in_less_than_one_gibibyte() -> None:
    """Their results alone would fill 3.1 GiB."""
    child = subprocess.run([sys.executable, "-c", MANY], capture_output=True, text=True, check=True, timeout=600)
    found = json.loads(child.stdout)
    assert (found["count"], found["finite"]) == (10**7, True)
    assert found["peak"] < 2**30
    print(f"peak: {found['peak'] / 2**20:.0f} MiB")
