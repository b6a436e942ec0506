"""Instances of FMUs of version 3.0, by FMPy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy


@contextmanager
def instance(path: Path, kind: str = "CoSimulation", **values: float) -> Iterator[tuple[Any, dict[str, int]]]:
    """An FMU of version 3.0 after its initialisation, and the references of its variables."""
    description = fmpy.read_model_description(str(path))
    folder = fmpy.extract(str(path))
    made = {"CoSimulation": fmpy.fmi3.FMU3Slave, "ModelExchange": fmpy.fmi3.FMU3Model}[kind]
    one = made(guid=description.guid, unzipDirectory=folder, modelIdentifier=description.coSimulation.modelIdentifier)
    references = {v.name: v.valueReference for v in description.modelVariables}
    one.instantiate()
    one.setFloat64([references[n] for n in values], list(values.values())) if values else None
    one.enterInitializationMode(startTime=0.0)
    one.exitInitializationMode()
    try:
        yield one, references
    finally:
        one.freeInstance()
