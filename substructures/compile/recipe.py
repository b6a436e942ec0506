"""How a kernel runs its functions: everything but the machine code, as plain data that can be stored beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from substructures.compile.lowering import Lowered, Stage, Step
from substructures.expr.program import Program


@dataclass(frozen=True)
class StageRecipe:
    """Names of the inputs (places 0, 1, ...), steps, vectors in the scratch array."""

    inputs: tuple[str, ...]
    steps: tuple[Step, ...]
    size: int

    @classmethod
    def of(cls, stage: Stage, program: Program) -> StageRecipe:
        """From a lowered stage."""
        return cls(tuple(program.symbols[s].name for s in stage.inputs), tuple(stage.steps), stage.size)

    @classmethod
    def read(cls, data: Any) -> StageRecipe:
        """From plain data."""
        steps = tuple(Step(str(f), *map(int, numbers)) for f, *numbers in data["steps"])
        return cls(tuple(map(str, data["inputs"])), steps, int(data["size"]))

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        return {"inputs": self.inputs, "steps": [list(asdict(s).values()) for s in self.steps], "size": self.size}


@dataclass(frozen=True)
class Recipe:
    """Both stages; ``outputs``: operations in the places 1, 2, ... of the results; ``parts``: number of functions."""

    parameters: StageRecipe
    states: StageRecipe
    outputs: tuple[int, ...]
    parts: int

    @classmethod
    def of(cls, lowered: Lowered, program: Program) -> Recipe:
        """From a lowered program."""
        first, second = (StageRecipe.of(stage, program) for stage in (lowered.parameters, lowered.states))
        return cls(first, second, tuple(lowered.outputs), len(lowered.parts))

    @classmethod
    def read(cls, data: Any) -> Recipe:
        """From plain data. Raises KeyError, TypeError or ValueError when it is something else."""
        first, second = (StageRecipe.read(data[name]) for name in ("parameters", "states"))
        return cls(first, second, tuple(map(int, data["outputs"])), int(data["parts"]))

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        stages = {"parameters": self.parameters.plain(), "states": self.states.plain()}
        return {**stages, "outputs": self.outputs, "parts": self.parts}

    @property
    def functions(self) -> list[str]:
        """Names of the functions in the object code."""
        return [f"part{k}" for k in range(self.parts)]


def needed_symbols(program: Program, names: Sequence[str]) -> list[str]:
    """Symbols that the outputs depend on, in the order of the program."""
    ops = program.operations
    return [program.symbols[ops[i][1]].name for i in program.reachable(names) if ops[i][0] == "sym"]
