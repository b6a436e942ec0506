"""Words that an option may have, out of the tables of the science."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import typer

from substructures.errors import among
from substructures.export import FORMATS
from substructures.printers import FORMS


def one_of(words: Iterable[str], **more: Any) -> Any:
    """An option that is one of these words."""
    known = tuple(words)

    def checked(given: str | None) -> str | None:
        """Raises BadParameter."""
        if given is not None and given not in known:
            raise typer.BadParameter(f"'{given}' is not known{among(given, known)}")
        return given

    return typer.Option(callback=checked, autocompletion=lambda: list(known), **more)


Format = Annotated[str, one_of(sorted(FORMATS), help=f"Of formulas: {', '.join(sorted(FORMATS))}.")]
Form = Annotated[str, one_of(FORMS, help=f"Of formulas: {', '.join(FORMS)}.")]
