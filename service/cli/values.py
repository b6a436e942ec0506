"""Values by name, as options give them: ``--set m='2 kg'``."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import typer

from substructures.documents.fields import Quantity, quantity_of, with_unit

#: options of a state, of parameters and of inputs: see `numbers_in` and `numbers_by_name`
Numbers = Annotated[
    str | None, typer.Option(metavar="X,Y,...", help="In the order of the coordinates, also '30 deg' (zeros).")
]
Parameters = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter, also '500 mm'; may be repeated."),
]
Inputs = Annotated[
    list[str] | None, typer.Option("--input", metavar="NAME=VALUE", help="An input, also '5 N'; may be repeated.")
]


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


def numbers_in(option: str, text: str) -> list[Any]:
    """Numbers between commas, also with their units."""
    try:
        return [number(each) for each in text.split(",")]
    except ValueError:
        message = "numbers between commas are needed, in SI units or with their units, as in '30 deg,0.2'"
        raise typer.BadParameter(f"{option}: {message}; found '{text}'") from None


def numbers_by_name(given: Iterable[str] | None) -> dict[str, Any]:
    """``NAME=VALUE`` with numbers, and those that have one with their units."""
    found: dict[str, Any] = {}
    for name, text in pairs(given).items():
        try:
            found[name] = number(text)
        except ValueError:
            message = f"a number is needed for '{name}', in SI units or with its unit, as in {name}='500 mm'"
            raise typer.BadParameter(f"{message}; found '{text}'") from None
    return found
