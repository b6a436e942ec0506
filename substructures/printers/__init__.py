"""Programs as text for people: ``render(program, "latex")``; functions in languages are in :mod:`substructures.export`.

Sizes are known before anything is printed. User names appear in formulas in the escaped form of
:mod:`substructures.printers.names`.
"""

from __future__ import annotations

from substructures.printers.render import FORMATS, FORMS, entries, render
from substructures.printers.symmetry import symmetry_rule

__all__ = ["FORMATS", "FORMS", "entries", "render", "symmetry_rule"]
