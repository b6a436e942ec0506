"""Kernels of programs: compiled, or out of a cache."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from pathlib import Path

from substructures.compile import cache, target
from substructures.compile.angles import by_addition_theorem
from substructures.compile.emission import assembly
from substructures.compile.engine import shared_runtime
from substructures.compile.kernel import InterpretedKernel, Kernel
from substructures.compile.lowering import lower
from substructures.compile.machine import MachineKernel
from substructures.compile.recipe import Recipe
from substructures.expr.program import Program

#: states in a vector where they are asked for one by one
NARROW = 2


def compile_program(
    program: Program,
    outputs: Sequence[str],
    folder: Path | None = None,
    width: int | None = None,
    single: bool = False,
) -> Kernel:
    """A kernel for the named outputs; the reference interpreter where llvmlite is missing.

    ``folder``: a cache of compiled kernels, found by program, outputs, CPU and compiler (see
    :mod:`substructures.compile.cache`). ``width``: states in a vector, 2, 4 or 8; default: the host's. ``single``: for
    states that are asked for one by one, as along a motion: short vectors, of code that is made in a quarter of the
    time and gives the same bits; it takes no longer for one state, but much longer for many.
    Raises KeyError for an unknown output.
    """
    names = tuple(dict.fromkeys(outputs))
    if not target.available():
        return InterpretedKernel(program, names)
    source = by_addition_theorem(program, names)
    runtime = shared_runtime(width or (NARROW if single else target.host().width), folder)
    level = target.QUICK if single else target.LEVEL
    if folder is None:
        return MachineKernel(source, names, *_compiled(source, names, runtime.width, level), runtime)
    wanted = cache.key(program.digest, names, f"{target.host().identity} {runtime.width} {level}")
    found = cache.read(folder, wanted)
    # whatever else is wrong with an entry: it is made anew
    with contextlib.suppress(KeyError, TypeError, ValueError, RuntimeError):
        if found is not None:
            return MachineKernel(source, names, Recipe.read(found[0]), found[1], runtime)
    recipe, code = _compiled(source, names, runtime.width, level)
    cache.write(folder, wanted, recipe.plain(), code)
    return MachineKernel(source, names, recipe, code, runtime)


def _compiled(program: Program, names: Sequence[str], width: int, level: int) -> tuple[Recipe, bytes]:
    lowered = lower(program, names, fused=target.host().fused)
    return Recipe.of(lowered, program), target.assemble(assembly(lowered, program.operations, width), level)
