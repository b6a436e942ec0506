"""What makes the formulas of a quantity, and what is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from service.models.source import Source
from substructures.expr.program import Program

Options = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class Made:
    """A program, and what there is to say about it beside the formulas."""

    program: Program
    members: Mapping[str, Any] = field(default_factory=dict)
    value: Any = None


@dataclass(frozen=True)
class Quantity:
    """``outputs``: those of the program that are shown, default all; ``called``: what the science calls an option;
    ``needs_parts``: of the tree, beside its formulas.
    """

    make: Callable[[Source, Options], Made]
    options: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    called: Mapping[str, str] = field(default_factory=dict)
    needs_parts: bool = False

    def pointer(self, given: str) -> str:
        """The place in the query that a pointer of the science means."""
        first, *rest = given.removeprefix("/cost").split("/")[1:] or [""]
        option = next((name for name, called in self.called.items() if called == first), first)
        return "/".join(["/query", option, *rest]).rstrip("/")
