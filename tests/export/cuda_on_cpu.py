"""The logic of exported CUDA on the CPU: the same file as a library of g++."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from run_code import Values, arguments, shared, tool

from substructures.export import Exported, Function, files

STRICT = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off"]
LIMIT = 1_000_000


def library(exported: Exported, folder: Path) -> ctypes.CDLL:
    """The file as a library of an ordinary compiler."""
    source = folder / f"{exported.name}.cpp"
    source.write_bytes(files(exported, "cuda", LIMIT)[f"{exported.name}.cu"])
    return shared([source], STRICT, tool("g++"))


def columns(function: Function, states: Sequence[Values], common: bool) -> dict[str, Any]:
    """The arguments with the number of the state as the last axis; those of the first state where all share them."""
    given = [arguments(function, values) for values in states]
    found = {symbol: np.ascontiguousarray(np.array([g[symbol] for g in given]).T) for symbol in function.arguments}
    return found | ({"p": np.array(given[0]["p"])} if common else {})


def call(
    loaded: ctypes.CDLL, exported: Exported, function: Function, states: Sequence[Values], common: bool
) -> list[dict[str, Any]]:
    """The results of every state."""
    count, called = len(states), exported.called(function)
    text = files(exported, "cuda", LIMIT)[f"{exported.name}.cu"].decode()
    room = int(text.split(f"{called}_WORK = ")[1].split(" ")[0])
    given = columns(function, states, common)
    results = {n: np.full((*o.shape, count), np.nan) for n, o in function.program.outputs.items()}
    arrays = [*given.values(), *results.values()]
    pointers = [x.ctypes.data_as(ctypes.c_void_p) for x in arrays]
    workspace = np.full(max(1, room * count), np.nan)
    loaded[f"{called}_states"](
        ctypes.c_size_t(count), *pointers, ctypes.c_int(common), workspace.ctypes.data_as(ctypes.c_void_p)
    )
    return [{n: x[..., k] for n, x in results.items()} for k in range(count)]
