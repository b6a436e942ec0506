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


def values(given: Iterable[str] | None) -> dict[str, Any]:
    """``NAME=VALUE`` with values as documents have them: texts, and ``500 mm`` as a number with its unit."""
    found = {name: (with_unit(text) or quantity_of(text)) for name, text in pairs(given).items()}
    return {name: x.model_dump() if isinstance(x, Quantity) else x for name, x in found.items()}
