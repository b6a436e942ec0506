"""Metric and forces of 10^7 states of the UR5 in batches: states a second, and the peak of memory of this process.

python -m benchmarks.stream
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.compile import compile_program
from substructures.quantities.numbers.defaults import default_number

STATES, BATCH = 10_000_000, 10_000


def main() -> None:
    """Prints the figures as JSON."""
    instances = [{"name": "x", "substructure": "ur5", "at": "world"}]
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances})
    model = couple(spec, {"x": derive(Definition.read(catalogue.load("ur5")))})
    numbers = {n: default_number(p["value"]) for n, p in model.parameters.items()}
    numbers |= {s.name: 0.0 for s in model.program.symbols if s.kind in ("input", "velocity", "time")}
    kernel = compile_program(model.program, ["metric", "forces"])
    first = np.random.default_rng(0).uniform(-3, 3, (BATCH, model.dof))

    def batches() -> Iterator[Any]:
        for k in range(STATES // BATCH):
            yield numbers, [(model.coordinates, first + 1e-6 * k)]

    start = perf_counter()
    states = sum(len(found["metric"]) for found in kernel.stream(batches()))
    seconds = perf_counter() - start
    print(json.dumps({"states": states, "states_per_s": states / seconds, "mib": peak() / 1024}))


def peak() -> int:
    """KiB. Not ru_maxrss, which a child has from its parent."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))


if __name__ == "__main__":
    main()
