"""Exported functions as functions of a module."""

from __future__ import annotations

from substructures.export import exported
from substructures.export.webassembly.module import Argument, Function, Module, module


def webassembly(given: exported.Exported) -> Module:
    """All functions under their names. Raises TooLarge."""
    return module([_function(given, each) for each in given.functions])


def _function(given: exported.Exported, each: exported.Function) -> Function:
    arguments = tuple(Argument(each.vector(symbol).names, symbol == "t") for symbol in each.arguments)
    return Function(given.called(each), each.program, tuple(each.program.outputs), arguments)
