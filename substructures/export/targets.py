"""The targets: which files each consists of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import orjson

from substructures.errors import InvalidArgument, meant
from substructures.export import written
from substructures.export.c_files import c_files
from substructures.export.casadi import casadi
from substructures.export.exported import Exported
from substructures.export.fmu import fmu
from substructures.export.kits import KITS, kit
from substructures.export.languages.c import C
from substructures.export.languages.code import Code
from substructures.export.languages.cuda import Cuda
from substructures.export.languages.matlab import structures
from substructures.export.reference import reference
from substructures.export.render import LANGUAGES, definitions, text_of
from substructures.export.simulink import simulink
from substructures.export.software import SOFTWARE
from substructures.export.webassembly import glue
from substructures.export.webassembly.functions import webassembly
from substructures.export.webassembly.selftest import selftest

Files = dict[str, bytes]
READ = "nothing: it is read"


@dataclass(frozen=True)
class Target:
    """``make``: its files by name, of functions and the most nodes to be printed; ``executed``: with what the tests run
    them, empty where they are not executed."""

    make: Callable[[Exported, int], Files]
    executed: str = ""


def files(exported: Exported, target: str, limit: int) -> Files:
    """The files of a target. Raises InvalidArgument for an unknown one, TooLarge for more than ``limit`` nodes."""
    if target not in TARGETS:
        message = f"{target[:40]!r} is not one of {', '.join(TARGETS)}{meant(target, TARGETS)}"
        raise InvalidArgument.at("/target", "unknown-target", message)
    made = TARGETS[target].make(exported, limit)
    return made | kit(exported, target, next(iter(made))) if target in KITS else made


def _interface(exported: Exported, _: int) -> Files:
    document = orjson.dumps(exported.document(SOFTWARE), option=orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE)
    return {f"{exported.name}_interface.json": document}


def _one_file(language: type[Code]) -> Target:
    def make(exported: Exported, limit: int) -> Files:
        """All functions in one file, and the self-test."""
        made = {f"{exported.name}{language.stem}{language.suffix}": text_of(exported, language, limit)}
        made |= language.selftest(exported, reference(exported))
        return {name: text.encode() for name, text in made.items()}

    return Target(make, language.executed)


def _function_files(exported: Exported, limit: int) -> Files:
    """MATLAB: a file for each function."""
    matlab = LANGUAGES["matlab"]
    found: dict[str, str] = {}
    for function, lines in zip(exported.functions, definitions(exported, matlab, limit), strict=True):
        alone = Exported(exported.name, exported.interface, (function,), exported.form)
        found[f"{exported.called(function)}.m"] = matlab.file(alone, [lines], SOFTWARE)
    found |= matlab.selftest(exported, reference(exported)) | structures(exported)
    return {name: text.encode() for name, text in found.items()}


def _javascript(exported: Exported, _: int) -> Files:
    made = webassembly(exported)
    document = exported.document(SOFTWARE)
    text, declared = glue.javascript(exported.name, document, made.heap), glue.types(document)
    return {
        f"{exported.name}.wasm": made.content,
        f"{exported.name}.mjs": text.encode(),
        f"{exported.name}.d.mts": declared.encode(),
        f"{exported.name}_selftest.mjs": selftest(exported).encode(),
    }


def _casadi(exported: Exported, limit: int) -> Files:
    return {f"{exported.name}_casadi.c": casadi(exported, limit).encode()}


def _fmu(version: str) -> Callable[[Exported, int], Files]:
    def make(exported: Exported, limit: int) -> Files:
        """One file."""
        return {f"{exported.name}.fmu": fmu(exported, version, limit)}

    return make


TARGETS: Mapping[str, Target] = {
    "cuda": _one_file(Cuda),
    "javascript": Target(_javascript, "Node"),
    "interface": Target(_interface, "read by callers in C and Octave"),
    "c": Target(c_files, C.executed),
    "simulink": Target(simulink),
    "fmu": Target(_fmu("3.0"), "FMPy"),
    "fmu2": Target(_fmu("2.0"), "FMPy"),
    "casadi": Target(_casadi, "CasADi"),
    "matlab": Target(_function_files, LANGUAGES["matlab"].executed),
    "text": Target(written.text, READ),
    "latex": Target(written.latex, "LaTeX"),
    "mathml": Target(written.mathml, READ),
    **{name: _one_file(language) for name, language in LANGUAGES.items() if name not in ("c", "matlab")},
}
