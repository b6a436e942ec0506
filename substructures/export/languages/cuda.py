"""CUDA: functions of one state, and of many states with one thread for each, of the same tiles.

Element i of a vector stands at ``i * stride``: 1 for one state, the number of states for many, so that neighbouring
threads read and write neighbouring numbers. What crosses from one tile to the next waits in a workspace: on the stack
for one state, in the memory of the device for many. Any other C++ compiler takes the same file and runs the states one
after the other.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan, prod
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.c import C, argument, indices
from substructures.export.languages.code import head, indented
from substructures.export.languages.pieces import LENGTH, Pieces, split
from substructures.export.reference import Reference
from substructures.expr.operations import Output, flat
from substructures.printers.language import Listing

_USE = (
    "NAME(...) is for one state. NAME_states(count, ..., common, w) is for many, one thread for each: element i of",
    "state k of any vector or array stands at [i * count + k], the time of state k at t[k]. common: 1 for parameters",
    "that are the same for all states, 0 for parameters by state. w: NAME_WORK * count doubles of workspace.",
)
_OPENING = """\
#ifndef SUBSTRUCTURES_CUDA
#define SUBSTRUCTURES_CUDA
#ifndef __CUDACC_RTC__
#include <math.h>
#include <stddef.h>
#endif
#ifdef __CUDACC__
#define SUBSTRUCTURES_ONE inline __host__ __device__
#define SUBSTRUCTURES_TILE static __host__ __device__ __noinline__
#define SUBSTRUCTURES_MANY extern "C" __global__
#define SUBSTRUCTURES_EACH \\
    const size_t lane = (size_t)blockIdx.x * blockDim.x + threadIdx.x; \\
    if (lane < count)
#else
#define SUBSTRUCTURES_ONE inline
#define SUBSTRUCTURES_TILE static inline
#define SUBSTRUCTURES_MANY extern "C"
#define SUBSTRUCTURES_EACH for (size_t lane = 0; lane < count; ++lane)
#endif
#ifdef _MSC_VER
#define SUBSTRUCTURES_ALONE __restrict
#else
#define SUBSTRUCTURES_ALONE __restrict__
#endif
#endif"""
_SIGN = """\
#ifndef SUBSTRUCTURES_SIGN
#define SUBSTRUCTURES_SIGN
SUBSTRUCTURES_ONE double substructures_sign(double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : v; }
#endif"""


class Cuda(C):
    """A file for nvcc, NVRTC and other C++ compilers."""

    suffix = ".cu"
    infinity = "(1.0 / 0.0)"
    executed: ClassVar[str] = "g++; compiled by NVRTC; run on a GPU by benchmarks/gpu.py"
    functions: ClassVar[dict[str, str]] = {"abs": "fabs", "sign": "substructures_sign"}

    def element(self, vector: str, n: int) -> str:
        """Element n of an argument."""
        return vector if vector == "t" else f"{vector}[{_at(n, 'stride_p' if vector == 'p' else 'stride')}]"

    def place(self, variable: str, array: Output, index: tuple[int, ...]) -> str:
        """An element of an output."""
        return f"{variable}[{_at(flat(index, array.shape), 'stride')}]"

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """One file."""
        told = [*head(exported, cls.first, software, cls.executed), *_USE]
        lines = [*cls.commented(told), *_OPENING.splitlines(), ""]
        lines += indices(exported)
        values = enumerate(exported.interface.vectors["p"].defaults)
        defaults = [f"p[{i}] = {'(0.0 / 0.0)' if isnan(x) else repr(x)};" for i, x in values]
        lines += [f"SUBSTRUCTURES_ONE void {exported.name}_defaults(double *p)", "{"]
        lines += [*indented(["(void)p;", *defaults]), "}", ""]
        text = "\n".join(line for each in functions for line in (*each, ""))
        lines += [*_SIGN.splitlines(), ""] if "substructures_sign(" in text else []
        return "\n".join([*lines, text])

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:  # noqa: ARG003 -- of the base
        """None: it would need a device."""
        return {}

    def define(self, listing: Listing) -> list[str]:
        """The tiles, the function of one state, and that of many."""
        zeros: list[str] = []
        assigned: list[tuple[str, str]] = []
        for output, array in self.program.outputs.items():
            pairs, v, size = self.pairs(output, listing), self.variables[output], prod(array.shape)
            if len(pairs) < size:
                zeros.append(f"for (size_t i = 0; i < {size}; ++i) {v}[i * stride] = 0.0;")
            assigned += pairs
        pieces = split(listing.temporaries, assigned, LENGTH)
        return [*self._tiles(pieces, zeros), *self._one(pieces), "", *self._many(pieces)]

    def _tiles(self, pieces: Pieces, zeros: list[str]) -> list[str]:
        # no array overlaps another
        pointers = [*self._declared(), "double *w"]
        alone = [given.replace("*", "*SUBSTRUCTURES_ALONE ") for given in pointers]
        head_ = ", ".join(["size_t stride", "size_t stride_p", *alone])
        unused = [f"(void){v};" for v in ("stride", "stride_p", *self._names(), "w")]
        lines = []
        for k, body in enumerate(pieces.bodies):
            statements = [*unused, *(zeros if k == 0 else ())]
            named = self.named(text for _, text, _ in body.statements)
            statements += [f"const double {name} = {element};" for name, element in named]
            statements += [f"const double t{n} = w[{_at(slot, 'stride')}];" for n, slot in body.taken]
            statements += [f"{'const double ' * is_new}{name} = {text};" for name, text, is_new in body.statements]
            statements += [f"w[{_at(slot, 'stride')}] = t{n};" for n, slot in body.given]
            lines += [f"SUBSTRUCTURES_TILE void {self.called}_{k + 1}({head_})", "{", *indented(statements), "}", ""]
        return lines

    def _one(self, pieces: Pieces) -> list[str]:
        calls = [f"double w[{max(1, pieces.slots)}];", *self._tile_calls(pieces, "1, 1", self._names(), "w")]
        return [f"SUBSTRUCTURES_ONE void {self.called}({', '.join(self._declared())})", "{", *indented(calls), "}"]

    def _many(self, pieces: Pieces) -> list[str]:
        given = [f"const double *{v}" for v in self.function.arguments]
        given += [f"double *{v}" for v in self.variables.values()]
        shifted = [
            "t[lane]" if v == "t" else "p + lane_p" if v == "p" else f"{v} + lane"
            for v in (*self.function.arguments, *self.variables.values())
        ]
        inner = [
            "const size_t stride_p = common ? 1 : count, lane_p = common ? 0 : lane;",
            "(void)lane_p;",
            *self._tile_calls(pieces, "count, stride_p", shifted, "w + lane"),
        ]
        head_ = ", ".join(["size_t count", *given, "int common", "double *w"])
        return [
            f"enum {{ {self.called}_WORK = {pieces.slots} }};",
            f"SUBSTRUCTURES_MANY void {self.called}_states({head_})",
            "{",
            "    SUBSTRUCTURES_EACH {",
            *indented(inner, " " * 8),
            "    }",
            "}",
        ]

    def _declared(self) -> list[str]:
        return [*(argument(v) for v in self.function.arguments), *(f"double *{v}" for v in self.variables.values())]

    def _names(self) -> list[str]:
        return [*self.function.arguments, *self.variables.values()]

    def _tile_calls(self, pieces: Pieces, strides: str, names: Iterable[str], workspace: str) -> list[str]:
        given = ", ".join([strides, *names, workspace])
        return [f"{self.called}_{k + 1}({given});" for k in range(len(pieces.bodies))]


def _at(n: int, stride: str) -> str:
    """The place of element n."""
    return "0" if n == 0 else stride if n == 1 else f"{n} * {stride}"
