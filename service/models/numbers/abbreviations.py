"""Abbreviated formulas."""

from __future__ import annotations

from service.models.abbreviations import abbreviated
from service.models.numbers.analysis import Analysis
from service.models.results import JSON
from service.schemas.analyses.abbreviations import AbbreviationRequest

ANALYSES = {
    "abbreviations": Analysis(
        AbbreviationRequest,
        abbreviated,
        "A quantity with what is negligible over given ranges left out, and a proven bound of the error",
        (JSON,),
        needs_parts=True,
    ),
}
