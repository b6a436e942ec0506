"""The files of the target C: header, source and self-test."""

from __future__ import annotations

from substructures.export.exported import Exported
from substructures.export.languages import c
from substructures.export.languages.c import C
from substructures.export.reference import reference
from substructures.export.render import definitions
from substructures.export.software import SOFTWARE


def c_core(exported: Exported, limit: int, stem: str = "") -> dict[str, bytes]:
    """``NAME.h`` and ``NAME.c``, or files of another stem. Raises TooLarge for more than ``limit`` nodes."""
    stem = stem or exported.name
    guard, about = f"{stem.upper()}_H", c.head_of(exported, SOFTWARE)
    functions = definitions(exported, C, limit)
    header = [*about, f"#ifndef {guard}", f"#define {guard}", "#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    header += [*c.declarations(exported, functions), "", "#ifdef __cplusplus", "}", "#endif", "#endif", ""]
    text = [about[0], "", f'#include "{stem}.h"', "", *c.source(exported, functions), ""]
    found = {f"{stem}.h": header, f"{stem}.c": text}
    return {name: c.as_standard(exported, lines).encode() for name, lines in found.items()}


def c_files(exported: Exported, limit: int) -> dict[str, bytes]:
    """The same with a program that compares with reference values."""
    tests = C.selftest(exported, reference(exported))
    return c_core(exported, limit) | {name: each.encode() for name, each in tests.items()}
