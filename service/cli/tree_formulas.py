"""Formulas of a tree that was coupled here, and what follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from service.cli.tree_files import local_source
from service.models.formulas import QUANTITIES, made
from service.models.formulas.entry import Options
from service.models.printing import (
    Style,
    check_quantity,
    described,
    made_text,
    source_glossary,
    text_of,
    with_numbers,
    with_options,
)
from substructures.export import interface_of_model


def of_tree(path: Path, what: str, how: Mapping[str, str], chosen: Options) -> bytes:
    """A quantity of a tree document, or what follows from it. Raises InvalidInput, Refused, TooLarge."""
    style = Style(**how)
    source = local_source(path)
    interface = interface_of_model(source.model, digest=source.digest)
    if what in QUANTITIES:
        return made_text(made(source, what, chosen), what, interface, source, style).encode()
    check_quantity(source.model, what)
    sources = with_options(source.sources, what, chosen)
    members, parameters = described(sources, what)
    program = with_numbers(sources.formulas(what), parameters, source.model.inputs, style)
    named_steps = source_glossary(source, style, parameters)
    return text_of(program, style, what, interface, members, glossary=named_steps).encode()
