"""Words that an option may have. Those of formulas are names in tables whose modules write them: they are not imported
for their names.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import typer

from substructures.errors import among

#: of functions, where none is given
NAME = "model"
#: as substructures.export.FORMATS in order, and substructures.printers.FORMS
FORMATS = (
    "c",
    "cpp",
    "fortran",
    "fricas",
    "jax",
    "json",
    "julia",
    "latex",
    "latex-document",
    "maple",
    "mathematica",
    "mathml",
    "matlab",
    "maxima",
    "modelica",
    "python",
    "reduce",
    "rust",
    "sympy",
    "text",
)
FORMS = ("readable", "textbook", "compact", "expanded")


def one_of(words: Iterable[str], **more: Any) -> Any:
    """An option that is one of these words."""
    known = tuple(words)

    def checked(given: str | None) -> str | None:
        """Raises BadParameter."""
        if given is not None and given not in known:
            raise typer.BadParameter(f"'{given}' is not known{among(given, known)}")
        return given

    return typer.Option(callback=checked, autocompletion=lambda: list(known), **more)


Format = Annotated[str, one_of(FORMATS, help=f"Of formulas: {', '.join(FORMATS)}.")]
Form = Annotated[str, one_of(FORMS, help=f"Of formulas: {', '.join(FORMS)}.")]
