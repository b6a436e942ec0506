"""A module of WebAssembly with a fixed place for every vector and result, so that a caller lays memory out once."""

from __future__ import annotations

from math import prod
from typing import Any

from substructures.export.exported import Exported
from substructures.export.webassembly.encoding import PAGE
from substructures.export.webassembly.module import Module


def layout(given: Exported, made: Module, software: str) -> dict[str, Any]:
    """The description of a module as plain data: that of the target ``interface``, where ``at`` is the address in bytes
    of every vector and result, all doubles, row-major; ``t`` is a number, not an address. ``pages``: of 64 KiB, what
    the memory has to have. A function is called with the addresses of its ``arguments``, then of its ``outputs``.
    """
    document = given.document(software)
    at = -(-made.heap // 8) * 8
    for symbol, vector in document["vectors"].items():
        if symbol != "t":
            vector["at"], at = at, at + 8 * vector["length"]
    for function in document["functions"]:
        if "x" in function:
            function["x"]["at"], at = at, at + 8 * function["x"]["length"]
        for output in function["outputs"]:
            output["at"], at = at, at + 8 * prod(output["shape"])
    return {**document, "format": "substructures.program", "heap": made.heap, "pages": -(-at // PAGE)}
