"""The files of the target C: header, source and self-test."""

from __future__ import annotations

from substructures.export.exported import Exported
from substructures.export.languages import c
from substructures.export.languages.c import C
from substructures.export.reference import reference
from substructures.export.render import definitions
from substructures.export.software import SOFTWARE


def c_core(exported: Exported, limit: int) -> dict[str, bytes]:
    """``NAME.h`` and ``NAME.c``. Raises TooLarge for more than ``limit`` nodes."""
    guard, about = f"{exported.name.upper()}_H", c.head_of(exported, SOFTWARE)
    header = [*about, f"#ifndef {guard}", f"#define {guard}", "#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    header += [*c.declarations(exported), "", "#ifdef __cplusplus", "}", "#endif", "#endif", ""]
    lines = c.source(exported, definitions(exported, C, limit))
    text = [about[0], "", f'#include "{exported.name}.h"', "", *lines, ""]
    found = {f"{exported.name}.h": "\n".join(header), f"{exported.name}.c": "\n".join(text)}
    return {name: each.encode() for name, each in found.items()}


def c_files(exported: Exported, limit: int) -> dict[str, bytes]:
    """The same with a program that compares with reference values."""
    tests = C.selftest(exported, reference(exported))
    return c_core(exported, limit) | {name: each.encode() for name, each in tests.items()}
