"""Abbreviated formulas."""

from __future__ import annotations

from service.models.abbreviations import abbreviated
from service.models.numbers.analysis import Analysis
from service.schemas.analyses.abbreviations import AbbreviationRequest

ANALYSES = {
    "abbreviations": Analysis(
        AbbreviationRequest,
        abbreviated,
        needs_parts=True,
    ),
}
