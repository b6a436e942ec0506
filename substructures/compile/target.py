"""LLVM: the host's CPU, assembly -> object code, object code -> callable functions."""

from __future__ import annotations

import ctypes
import ctypes.util
import sys
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

from substructures.compile.setting import NONE, setting

#: of LLVM's code generator: 1 gives the same code as 2 and 3 for straight lines, in half of the time; 0 in a quarter of
#: that, by code that takes a third longer, and the same bits
LEVEL, QUICK = 1, 0
#: at level 0 LLVM would select instructions without contracting products and sums
SELECTION = ("-fast-isel=false", "-global-isel=false")


@cache
def library() -> Any:
    """llvmlite.binding, imported where something is compiled; None where this platform has no wheel of it: the
    reference interpreter answers there.
    """
    try:
        return import_module("llvmlite.binding")
    except ImportError:
        return None


def available() -> bool:
    """Whether machine code can be made here, and is wanted. Raises ValueError for a setting that is unknown."""
    return setting().cpu != NONE and library() is not None


@dataclass(frozen=True)
class Host:
    """What compiled code depends on. ``width``: states in a vector; ``contraction``: of products with sums."""

    triple: str
    cpu: str
    features: str
    compiler: str
    width: int
    contraction: bool = True

    @property
    def identity(self) -> str:
        """A text; equal for equal machine code."""
        words = (self.triple, self.cpu, self.features, self.compiler, str(self.width))
        return "\n".join(words if self.contraction else (*words, "no contraction"))

    @property
    def fused(self) -> bool:
        """Whether a product and a sum are one instruction: among x86 those with wide vectors have it."""
        return self.contraction and (self.width > 2 or not self.triple.startswith(("x86", "i686")))


@cache
def host() -> Host:
    """This machine, or as much of it as the setting takes: 8 doubles for AVX-512, 4 for AVX2, 2 otherwise.

    Raises ValueError where this CPU cannot run what the setting asks for.
    """
    llvm = library()
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    for option in SELECTION:
        llvm.set_option("", option)
    try:
        features = llvm.get_host_cpu_features()
    except RuntimeError:  # LLVM does not know them on this platform: what every such CPU has
        features = llvm.FeatureMap()
    version = import_module("llvmlite").__version__
    compiler = f"llvmlite {version}, LLVM {'.'.join(map(str, llvm.llvm_version_info))}, level {LEVEL}"
    triple, wanted = llvm.get_process_triple(), setting()
    level = wanted.level([name for name, there in features.items() if there])
    if level is not None:
        return Host(triple, wanted.cpu, "", compiler, level.width, wanted.contraction)
    width = 8 if features.get("avx512f") else 4 if features.get("avx2") else 2
    return Host(triple, llvm.get_host_cpu_name(), features.flatten(), compiler, width, wanted.contraction)


def new_machine(level: int = LEVEL) -> Any:
    """A target machine for the host; an engine takes its own over."""
    target = library().Target.from_triple(host().triple)
    return target.create_target_machine(
        cpu=host().cpu, features=host().features, opt=level, reloc="pic", codemodel="small", jit=True
    )


machine = cache(new_machine)


def assemble(text: str, level: int = LEVEL) -> bytes:
    """Object code of a module in LLVM assembly."""
    if not host().contraction:  # the word is a flag only: names and numbers of the assembly do not contain it
        text = text.replace(" contract ", " ")
    llvm = library()
    with llvm.create_context() as context, llvm.parse_assembly(text, context) as module:
        module.triple = host().triple
        return bytes(machine(level).emit_object(module))


@dataclass(frozen=True)
class Loaded:
    """Object code in executable memory; it is freed with this value."""

    engine: Any
    names: dict[str, int]

    @classmethod
    def load(cls, code: bytes, names: list[str]) -> Loaded:
        """The addresses of the named functions. Raises RuntimeError when one is missing."""
        llvm = library()
        # in LLVM's global context: the collector of garbage could dispose of another one before the engine
        empty = llvm.parse_assembly(f'target triple = "{host().triple}"')
        # in one area of memory: LLVM's own manager looks for a place for each section, and code that finds its
        # constants more than 2 GiB away ends the process
        engine = llvm.create_mcjit_compiler(empty, new_machine(), use_lmm=True)
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        engine.finalize_object()
        addresses = {name: int(engine.get_function_address(name)) for name in names}
        if not all(addresses.values()):
            raise RuntimeError("the object code lacks a function")
        return cls(engine, addresses)


@cache
def math_library() -> dict[str, int]:
    """Addresses of the C library's mathematical functions."""
    name = "ucrtbase" if sys.platform == "win32" else ctypes.util.find_library("m")
    functions = ctypes.CDLL(name)
    wanted = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "pow")
    return {f: int(ctypes.cast(getattr(functions, f), ctypes.c_void_p).value or 0) for f in wanted}
