"""Machine code in memory: wherever there is room, and gone when nobody holds it."""

from __future__ import annotations

import gc
import subprocess
import sys
import weakref
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import compile_program
from substructures.expr.graph import Graph
from substructures.expr.program import Program

pytestmark = NEEDS_MACHINE_CODE
linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc and maps memory as Linux does")

#: areas of 3 GiB, all gaps between them closed; before a kernel is loaded a page becomes free in each of them
FRAGMENTED = """
import ctypes
from pathlib import Path
from substructures.compile import target

libc = ctypes.CDLL(None, use_errno=True)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_long]
libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
PAGE, AREA, PRIVATE_WITHOUT_RESERVE, JUST_THERE = 4096, 3 << 30, 0x4022, 0x100000

def reserve(size, place=None):
    return libc.mmap(place, size, 0, PRIVATE_WITHOUT_RESERVE | (JUST_THERE if place else 0), -1, 0)

TEXT = "define double @f(double %x) {{\\n%y = fadd double %x, {}.5\\nret double %y\\n}}"
codes = [target.assemble(TEXT.format(number)) for number in range(20)]
areas = [reserve(AREA) for _ in range(60)]
mapped = [line.split()[0].split("-") for line in Path("/proc/self/maps").read_text().splitlines()]
bounds = [(int(a, 16), int(b, 16)) for a, b in mapped if min(areas) <= int(a, 16) < 1 << 47]
for (_, end), (start, _) in zip(bounds, bounds[1:]):
    if end < start:
        reserve(start - end, end)
kept = []
for number, code in enumerate(codes):
    for area in areas:
        libc.munmap(area + (AREA >> 1) + 2 * PAGE * number, PAGE)
    loaded = target.Loaded.load(code, ["f"])
    kept.append(loaded)
    assert ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(loaded.names["f"])(1.0) == number + 1.5
print(len(kept))
"""

#: the same object code loaded and dropped; what the process holds after the first turns and after many more
REPEATED = """
import gc, sys
from pathlib import Path
from substructures.compile import target

text = "define double @f(double %x) {\\n%y = fadd double %x, 0.5\\nret double %y\\n}"
code = target.assemble(text)

def turns(count):
    for _ in range(count):
        target.Loaded.load(code, ["f"])
    gc.collect()
    return 4096 * int(Path("/proc/self/statm").read_text().split()[1])

print(turns(300), turns(2000))
"""


def run(script: str) -> list[str]:
    found = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]
    return found.stdout.split()


@linux
def test_memory_in_pieces_far_apart() -> None:
    """LLVM's own memory manager puts code and constants into two of them, and ends the process."""
    assert run(FRAGMENTED) == ["20"]


@linux
def test_what_is_dropped_is_unloaded() -> None:
    """2,000 engines are 100 MB."""
    first, last = map(int, run(REPEATED))
    assert last - first < 10e6


def spring(collected: Callable[..., Program]) -> Program:
    g = Graph()
    m, x = g.symbol("m"), g.symbol("x")
    return collected(g, {"m": "parameter"}, force=g.function("sin", m * x) / (m + x * x))


def test_a_kernel_is_unloaded_with_its_last_holder(collected: Callable[..., Program]) -> None:
    kernel = compile_program(spring(collected), ["force"])
    engine = weakref.ref(kernel._code.engine)
    kernel.evaluate({"m": 2.0, "x": np.linspace(-1, 1, 21)})
    assert engine() is not None
    del kernel
    gc.collect()
    assert engine() is None


def test_what_a_kernel_holds(collected: Callable[..., Program], tmp_path: Path) -> None:
    """More for more results, the same from the folder."""
    one = spring(collected)
    g = Graph()
    x = g.symbol("x")
    many = collected(g, {}, **{f"y{k}": g.function("sin", x + k) * x for k in range(200)})
    small, large = compile_program(one, ["force"], tmp_path), compile_program(many, list(many.outputs))
    assert 10_000 < small.held < large.held < 10e6
    assert compile_program(one, ["force"], tmp_path).held == small.held
