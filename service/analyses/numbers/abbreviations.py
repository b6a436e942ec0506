"""Abbreviated formulas."""

from __future__ import annotations

from service.analyses.abbreviations import abbreviated
from service.analyses.numbers.analysis import Analysis
from service.analyses.results import JSON
from service.schemas.abbreviations import AbbreviationRequest

ANALYSES = {
    "abbreviations": Analysis(
        AbbreviationRequest,
        abbreviated,
        "A quantity with what is negligible over given ranges left out, and a proven bound of the error",
        (JSON,),
        needs_parts=True,
    ),
}
