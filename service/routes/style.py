"""How formulas are asked for: ``format``, ``form``, ``bind``."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends, Header, Query

from service.messages.negotiation import MEDIA_TYPES, choose_form, choose_format
from service.models.exporting import NAME
from service.models.printing import Style
from substructures.printers import FORMS


async def style_of(
    format: Annotated[  # noqa: A002 -- the name in the contract
        str | None,
        Query(max_length=40, description="wins over Accept", json_schema_extra={"enum": [*MEDIA_TYPES, None]}),
    ] = None,
    form: Annotated[
        str,
        Query(
            description="textbook (collected, factored, cancelled), compact (shared subexpressions), expanded, or "
            "readable: textbook in text, LaTeX and MathML where that is quick and can be read, otherwise compact",
            json_schema_extra={"enum": [*FORMS]},
        ),
    ] = FORMS[0],
    bind: Annotated[
        str, Query(max_length=50_000, description="name:value,... or defaults; a value may be 1200 mm")
    ] = "",
    name: Annotated[
        str, Query(max_length=80, description="prefix of functions, where the format is a language")
    ] = NAME,
    document: Annotated[bool, Query(description="LaTeX as a whole document, with a table of symbols")] = False,
    accept: Annotated[str, Header()] = "*/*",
) -> Style:
    """The style that a request asks for."""
    wanted = choose_format(format, accept)
    wanted = "latex-document" if document and wanted == "latex" else wanted
    return Style(wanted, choose_form(form), bind, name)


StyleOf = Annotated[Style, Depends(style_of)]
