"""States a second on a GPU, of the exported CUDA (benchmarks/gpu_files.py).

Needs numpy, CuPy and g++ alone; the results of the GPU and of g++ are compared with those of the interpreter.
"""

from __future__ import annotations

import ctypes
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cupy
import numpy as np

#: states at most, and bytes of all arrays at most, on the GPU and on the host
COUNT, BYTES = (1_048_576, 8_192), (8 * 2**30, 2**30)


def run(folder: Path) -> None:
    """The table."""
    rows = json.loads((folder / "functions.json").read_text())
    print(f"{'function':28}{'operations':>11}{'states/s':>15}{'worst error':>13}")
    for name in dict.fromkeys(row["model"] for row in rows):
        source = (folder / f"{name}.cu").read_text()
        begun = time.perf_counter()
        module = cupy.RawModule(code=source, backend="nvrtc")
        module.get_function(f"{name}_metric_states")
        compiled = time.perf_counter() - begun
        host = _library(folder, name)
        print(f"{name}: compiled by NVRTC in {compiled:.1f} s")
        for row in (r for r in rows if r["model"] == name):
            _row(module, host, source, row, dict(np.load(folder / f"{row['called']}.npz")))


def _library(folder: Path, name: str) -> ctypes.CDLL:
    path = folder / f"{name}.so"
    flags = ["-O2", "-march=native", "-shared", "-fPIC", "-x", "c++"]
    subprocess.run(["/usr/bin/g++", *flags, "-o", str(path), str(folder / f"{name}.cu")], check=True)
    return ctypes.CDLL(str(path.resolve()))


def _row(module: Any, host: ctypes.CDLL, source: str, row: Any, data: dict[str, Any]) -> None:
    called = row["called"] + "_states"
    room = int(source.split(f"{row['called']}_WORK = ")[1].split(" ")[0])

    def arrays(space: Any, count: int) -> list[Any]:
        """Arguments, results, the flag of common parameters, the workspace."""
        given = [np.resize(data[f"in_{s}"].T, (count, len(data[f"in_{s}"]))).T for s in row["arguments"] if s != "p"]
        given = [space.ascontiguousarray(space.asarray(x)) for x in given] + [space.asarray(data["in_p"])]
        results = [space.full((*shape, count), np.nan) for shape in row["outputs"].values()]
        return [*given, *results, np.int32(1), space.empty(max(1, room * count))]

    doubles = sum(x.size // x.shape[-1] for x in data.values()) + room
    count, fewer = (min(c, b // (8 * doubles)) for c, b in zip(COUNT, BYTES, strict=True))
    on_gpu, on_host = arrays(cupy, count), arrays(np, fewer)
    kernel, threads = module.get_function(called), 128

    def launch() -> None:
        """All states on the GPU."""
        kernel((-(-count // threads),), (threads,), (np.uint64(count), *on_gpu))
        cupy.cuda.Stream.null.synchronize()

    pointers = [x if np.ndim(x) == 0 else x.ctypes.data_as(ctypes.c_void_p) for x in on_host]
    pointers = [ctypes.c_int(int(x)) if isinstance(x, np.int32) else x for x in pointers]

    def call() -> None:
        """Some states on the host."""
        host[called](ctypes.c_size_t(fewer), *pointers)

    rate = count / _seconds(launch)
    call()
    worst = 0.0
    for k, name in enumerate(row["outputs"]):
        wanted = data[f"out_{name}"]
        known = wanted.shape[-1]
        at = len(row["arguments"]) + k
        for found in (on_gpu[at].get(), on_host[at]):
            for part in (found[..., :known], found[..., known : 2 * known]):
                worst = max(worst, float(np.max(np.abs(part - wanted)) / np.max(np.abs(wanted))))
    print(f"{row['called']:28}{row['operations']:>11,}{rate:>15,.0f}{worst:>13.1e}")


def _seconds(work: Callable[[], None]) -> float:
    """The median of five, after one."""
    work()
    times = []
    for _ in range(5):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return float(np.median(times))


if __name__ == "__main__":
    run(Path(sys.argv[1]))
