"""Options of quantities that follow from a model, as query parameters; lists are separated by commas or repeated."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import Depends, Query

from service.models.formulas import OPTIONS
from service.models.formulas.entry import Options

Texts = list[Annotated[str, Query(max_length=5_000)]] | None


def _query(name: str) -> Any:
    return Query(description=OPTIONS[name], max_length=1000)


async def options_of(
    inputs: Annotated[Texts, _query("inputs")] = None,
    zero: Annotated[Texts, _query("zero")] = None,
    degree: Annotated[Texts, _query("degree")] = None,
    cyclic: Annotated[Texts, _query("cyclic")] = None,
    outputs: Annotated[Texts, _query("outputs")] = None,
    parameters: Annotated[Texts, _query("parameters")] = None,
    quantities: Annotated[Texts, _query("quantities")] = None,
    controls: Annotated[Texts, _query("controls")] = None,
    running: Annotated[Texts, _query("running")] = None,
    terminal: Annotated[Texts, _query("terminal")] = None,
    independent: Annotated[Texts, _query("independent")] = None,
    drives: Annotated[Texts, _query("drives")] = None,
    joints: Annotated[Texts, _query("joints")] = None,
) -> Options:
    """The options of a request; those that are not given are left out."""
    given = {
        "inputs": inputs, "zero": zero, "degree": degree, "cyclic": cyclic, "outputs": outputs,
        "parameters": parameters, "quantities": quantities, "controls": controls, "running": running,
        "terminal": terminal, "independent": independent, "drives": drives, "joints": joints,
    }  # fmt: skip
    return {name: tuple(_split(texts)) for name, texts in given.items() if texts}


def _split(texts: list[str]) -> list[str]:
    return [item.strip() for text in texts for item in text.split(",") if item.strip()]


OptionsOf = Annotated[Options, Depends(options_of)]
