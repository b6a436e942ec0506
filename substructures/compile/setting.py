"""What machine code is made for, where the environment says so: to reproduce the last bits of another machine.

``SUBSTRUCTURES_CPU``: ``native`` (as it is when the variable is missing or empty), a level of the x86-64 family, or
``none``: the reference interpreter answers. ``SUBSTRUCTURES_CONTRACTION``: ``on``, or ``off``: no product is contracted
with the sum that it goes into. These variables describe the machine and are all that this package reads of the
environment; they are read once in a process.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

CPU, CONTRACTION = "SUBSTRUCTURES_CPU", "SUBSTRUCTURES_CONTRACTION"
VARIABLES = (CPU, CONTRACTION)
NATIVE, NONE = "native", "none"


class Level(NamedTuple):
    """``width``: doubles in a vector; ``needs``: what a CPU must have to run such code, in LLVM's words."""

    width: int
    needs: tuple[str, ...]


_V3 = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
#: the names of the x86-64 psABI, which are LLVM's: SSE2, AVX2 with fused multiply-add, AVX-512
LEVELS = {
    "x86-64": Level(2, ("sse2",)),
    "x86-64-v3": Level(4, _V3),
    "x86-64-v4": Level(8, (*_V3, "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl")),
}


@dataclass(frozen=True)
class Setting:
    """``cpu``: NATIVE, NONE or one of LEVELS; ``contraction``: whether products and sums may be fused."""

    cpu: str = NATIVE
    contraction: bool = True

    @classmethod
    def read(cls, environment: Mapping[str, str]) -> Setting:
        """Raises ValueError with the variable, its value and what was expected."""
        cpu = _one_of(environment, CPU, (NATIVE, *LEVELS, NONE))
        return cls(cpu, _one_of(environment, CONTRACTION, ("on", "off")) == "on")

    def level(self, features: Collection[str]) -> Level | None:
        """None for NATIVE. Raises ValueError where a CPU with these features cannot run such code."""
        if self.cpu == NATIVE:
            return None
        level = LEVELS[self.cpu]
        missing = [name for name in level.needs if name not in features]
        if missing:
            raise ValueError(f"{CPU}: '{self.cpu}' needs {', '.join(missing)}, which this machine's CPU does not have")
        return level


def _one_of(environment: Mapping[str, str], name: str, values: tuple[str, ...]) -> str:
    """The value of a variable; the first of ``values`` where it has none."""
    found = environment.get(name) or values[0]
    if found not in values:
        raise ValueError(f"{name}: '{found[:80]}' is none of {', '.join(values)}")
    return found


@cache
def setting() -> Setting:
    """That of this process. Raises ValueError."""
    return Setting.read(os.environ)
