"""How a kernel runs its functions: everything but the machine code, as plain data that can be stored beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from substructures.compile.lowering import Lowered, ProgramStep, Stage
from substructures.compile.order import REGIONS
from substructures.expr.program import Program


@dataclass(frozen=True)
class StageRecipe:
    """Names of the inputs (places 0, 1, ...), steps, vectors in the scratch array, results (operations)."""

    inputs: tuple[str, ...]
    steps: tuple[ProgramStep, ...]
    size: int
    results: tuple[int, ...]

    @classmethod
    def of(cls, stage: Stage, program: Program) -> StageRecipe:
        """From a lowered stage."""
        names = tuple(program.symbols[s].name for s in stage.inputs)
        return cls(names, tuple(stage.steps), stage.size, tuple(stage.results))

    @classmethod
    def read(cls, data: Any) -> StageRecipe:
        """From plain data."""
        steps = tuple(ProgramStep(str(f), *map(int, numbers)) for f, *numbers in data["steps"])
        return cls(tuple(map(str, data["inputs"])), steps, int(data["size"]), tuple(map(int, data["results"])))

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        return {**asdict(self), "steps": [list(asdict(s).values()) for s in self.steps]}


@dataclass(frozen=True)
class Recipe:
    """All stages; ``parts``: number of functions."""

    stages: tuple[StageRecipe, ...]
    parts: int

    @classmethod
    def of(cls, lowered: Lowered, program: Program) -> Recipe:
        """From a lowered program."""
        return cls(tuple(StageRecipe.of(stage, program) for stage in lowered.stages), len(lowered.parts))

    @classmethod
    def read(cls, data: Any) -> Recipe:
        """From plain data. Raises KeyError, TypeError or ValueError when it is something else."""
        stages = tuple(StageRecipe.read(stage) for stage in data["stages"])
        if len(stages) != len(REGIONS):
            raise ValueError(f"{len(stages)} stages")
        return cls(stages, int(data["parts"]))

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        return {"stages": [stage.plain() for stage in self.stages], "parts": self.parts}

    @property
    def outputs(self) -> tuple[int, ...]:
        """Operations in the places 1, 2, ... of the results."""
        return tuple(i for stage in self.stages for i in stage.results)

    @property
    def functions(self) -> list[str]:
        """Names of the functions in the object code."""
        return [f"part{k}" for k in range(self.parts)]


def needed_symbols(program: Program, names: Sequence[str]) -> list[str]:
    """Symbols that the outputs depend on, in the order of the program."""
    ops = program.operations
    return [program.symbols[ops[i][1]].name for i in program.reachable(names) if ops[i][0] == "sym"]
