"""Compiled kernels, recognised by what they were made from."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from substructures.compile import Kernel, compile_program
from substructures.expr.program import Program
from substructures.tree.model import Model


@dataclass(frozen=True)
class Known:
    """Something with a digest, as key of a cache: equal when the digests are."""

    digest: str
    source: Any = field(compare=False)


def known_model(model: Model) -> Known:
    """A model: its program, and the names of the rows of its closures."""
    return Known(f"{model.program.digest} {model.closures}", model)


@lru_cache(maxsize=64)
def _kernel(known: Known, folder: Path | None) -> Kernel:
    return compile_program(known.source, tuple(known.source.outputs), folder)


def program_kernel(source: Program, folder: Path | None = None) -> Kernel:
    """A compiled program with all its outputs; the same object for the same program."""
    return _kernel(Known(source.digest, source), folder)
