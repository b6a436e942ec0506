"""Programs as machine code: :func:`compile_program` makes a :class:`Kernel` that answers for batches of states."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # what is imported when it is first asked for
    from substructures.compile.compiled import compile_program
    from substructures.compile.kernel import Kernel

__all__ = ["Kernel", "compile_program"]

_WHERE = {"Kernel": "kernel", "compile_program": "compiled"}


def __getattr__(name: str) -> Any:
    """A public name, imported when it is first asked for: who reads settings compiles nothing."""
    if name not in _WHERE:
        raise AttributeError(f"module 'substructures.compile' has no attribute '{name}'")
    return getattr(import_module(f"substructures.compile.{_WHERE[name]}"), name)
