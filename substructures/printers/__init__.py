"""Programs as text in several languages: ``render(program, "latex")``.

Sizes are known before anything is printed. User names appear in formulas of ``text`` and ``latex`` only, in the
escaped form of :mod:`substructures.printers.names`; generated code uses ``x[3]`` and ``t17``, with the names in
comments and in string literals.
"""

from __future__ import annotations

from substructures.printers.render import FORMATS, entries, render
from substructures.printers.symmetry import symmetry_rule

__all__ = ["FORMATS", "entries", "render", "symmetry_rule"]
