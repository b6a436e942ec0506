"""Programs as text for people; :func:`substructures.export.render` prints a program in any format.

Sizes are known before anything is printed. User names appear in formulas in the escaped form of
:mod:`substructures.printers.names`.
"""

from __future__ import annotations

from substructures.printers.render import FORMATS, FORMS, entries
from substructures.printers.symmetry import symmetry_rule

__all__ = ["FORMATS", "FORMS", "entries", "symmetry_rule"]
