"""Values by name, as options give them: ``--set m='2 kg'``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import typer

from substructures.documents.fields import Quantity, quantity_of, with_unit


def pairs(given: Iterable[str] | None) -> dict[str, str]:
    """``NAME=VALUE``, each once."""
    found: dict[str, str] = {}
    for text in given or ():
        name, sign, value = (each.strip() for each in text.partition("="))
        if not sign or not name or not value:
            raise typer.BadParameter(f"NAME=VALUE is needed, found '{text}'")
        if name in found:
            raise typer.BadParameter(f"'{name}' is given twice")
        found[name] = value
    return found


def value(text: str) -> Any:
    """A value as documents have it: ``500 mm`` is a number with its unit, all else a text."""
    found = with_unit(text) or quantity_of(text)
    return found.model_dump() if isinstance(found, Quantity) else found


def values(given: Iterable[str] | None) -> dict[str, Any]:
    """``NAME=VALUE`` with values as documents have them."""
    return {name: value(text) for name, text in pairs(given).items()}


def number(text: str) -> float | dict[str, Any]:
    """A number, or one with its unit. Raises ValueError."""
    given = value(text)
    return {**given, "value": float(given["value"])} if isinstance(given, dict) else float(given)
