"""Programs out: one calling convention (:mod:`.interface`), and languages that write functions on it.

``files(exported, "c")`` is what a target consists of, by file name; ``archive`` packs several files, the same bytes for
the same files. Generated code calls coordinates ``q[3]`` and temporaries ``t17``; names that users gave stand in
comments, escaped, and in the names of indices where they are identifiers. :mod:`.robots` writes the mechanism itself.
"""

from __future__ import annotations

from substructures.export.archive import archive
from substructures.export.exported import Exported, Function, exported_model, exported_part
from substructures.export.interface import Interface, Vector
from substructures.export.render import FORMATS, first_index, render
from substructures.export.sources import interface_of_model, interface_of_part
from substructures.export.targets import TARGETS, Target, files

__all__ = [
    "FORMATS",
    "TARGETS",
    "Exported",
    "Function",
    "Interface",
    "Target",
    "Vector",
    "archive",
    "exported_model",
    "exported_part",
    "files",
    "first_index",
    "interface_of_model",
    "interface_of_part",
    "render",
]
