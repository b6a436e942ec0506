"""LLVM: the host's CPU, assembly -> object code, object code -> callable functions."""

from __future__ import annotations

import ctypes
import ctypes.util
import sys
from dataclasses import dataclass
from functools import cache
from typing import Any

try:
    import llvmlite
    import llvmlite.binding as llvm
except ImportError:  # no wheel for this platform: the reference interpreter answers
    llvmlite = llvm = None

#: of LLVM's code generator: 1 gives the same code as 2 and 3 for straight lines, in half of the time
LEVEL = 1


def available() -> bool:
    """Whether machine code can be made here."""
    return llvm is not None


@dataclass(frozen=True)
class Host:
    """What compiled code depends on. ``width``: states in a vector."""

    triple: str
    cpu: str
    features: str
    compiler: str
    width: int

    @property
    def identity(self) -> str:
        """One line of text; equal for equal machine code."""
        return "\n".join((self.triple, self.cpu, self.features, self.compiler, str(self.width)))


@cache
def host() -> Host:
    """This machine: 8 doubles for AVX-512, 4 for AVX2, 2 otherwise."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    try:
        features = llvm.get_host_cpu_features()
    except RuntimeError:  # LLVM does not know them on this platform: what every such CPU has
        features = llvm.FeatureMap()
    width = 8 if features.get("avx512f") else 4 if features.get("avx2") else 2
    compiler = f"llvmlite {llvmlite.__version__}, LLVM {'.'.join(map(str, llvm.llvm_version_info))}, level {LEVEL}"
    return Host(llvm.get_process_triple(), llvm.get_host_cpu_name(), features.flatten(), compiler, width)


def new_machine() -> Any:
    """A target machine for the host; an engine takes its own over."""
    target = llvm.Target.from_triple(host().triple)
    return target.create_target_machine(
        cpu=host().cpu, features=host().features, opt=LEVEL, reloc="pic", codemodel="small", jit=True
    )


machine = cache(new_machine)


def assemble(text: str) -> bytes:
    """Object code of a module in LLVM assembly."""
    with llvm.create_context() as context, llvm.parse_assembly(text, context) as module:
        module.triple = host().triple
        return bytes(machine().emit_object(module))


@dataclass(frozen=True)
class Loaded:
    """Object code in executable memory; it is freed with this value."""

    engine: Any
    names: dict[str, int]

    @classmethod
    def load(cls, code: bytes, names: list[str]) -> Loaded:
        """The addresses of the named functions. Raises RuntimeError when one is missing."""
        # in LLVM's global context: the collector of garbage could dispose of another one before the engine
        empty = llvm.parse_assembly(f'target triple = "{host().triple}"')
        engine = llvm.create_mcjit_compiler(empty, new_machine())
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
