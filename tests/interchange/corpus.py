"""Robot files that nobody here wrote, out of installed packages, beside the engine that reads them, too.

python tests/interchange/corpus.py          # the table of all of them
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from substructures import Definition, TreeSpec, couple, derive
from substructures.errors import InvalidInput
from substructures.interchange.importing import import_file
from substructures.quantities.numbers.evaluation import evaluate

sys.path.insert(0, str(Path(__file__).parents[1] / "tools"))
sys.path.insert(0, str(Path(__file__).parent))
from engines import Reduced, deviation
from package_files import included, mjcf_files, more_files, urdf_files
from related import joints_of, reduction
from with_mujoco import MujocoTwin
from with_pinocchio import PinocchioTwin

QUANTITIES = ["metric", "gravity", "bias", "inverse_dynamics", "forward_dynamics"]
GRAVITY = (0.3, -0.4, -9.81)
STATES = 2


@dataclass
class Row:
    """What came of a file: ``refused`` says why, ``unread`` why the other engine does not read it."""

    file: str
    dof: int = 0
    seconds: float = 0.0
    error: float = 0.0
    singular: bool = False
    refused: str = ""
    unread: str = ""

    def __str__(self) -> str:
        told = (
            self.refused
            or self.unread
            or f"{self.dof:>4} {self.seconds:>7.2f} s {self.error:>9.1e}{'  metric singular' * self.singular}"
        )
        return f"{self.file:<58} {told}"


def compared(name: str, path: Path, twin_of: Callable[..., Any]) -> Row:
    """Imported, derived, coupled at the world and evaluated, beside the other engine."""
    start = process_time()
    try:
        found = import_file(path.read_bytes(), file=path.name, included=included(path))
    except InvalidInput as error:
        return Row(name, refused=f"refused: {error}")
    instance = {"name": "x", "definition": found.definition}
    spec = TreeSpec.read({"name": "tree", "gravity": list(GRAVITY), "instances": [instance]})
    model = couple(spec, {"x": derive(Definition.read(found.definition))})
    seconds = process_time() - start
    rng = np.random.default_rng(len(name))
    states = {key: rng.uniform(-1.2, 1.2, (STATES, model.dof)) for key in ("q", "qd", "qdd")}
    answer = evaluate(model, QUANTITIES, **states)
    left, order = [c.removeprefix("x.") for c in model.coordinates], list(joints_of(found.definition))
    try:
        twin = twin_of(path, found.names, order, GRAVITY)
    except ValueError as error:
        return Row(name, model.dof, seconds, unread=f"not read there: {error}")
    if "relations" in found.definition:
        twin = Reduced(twin, *reduction(found.definition, order, left))
    else:
        assert order == left
    expected = [twin.numbers(*(states[k][i] for k in states)) for i in range(STATES)]
    errors = [deviation(answer, numbers, i) for i, numbers in enumerate(expected)]
    return Row(name, model.dof, seconds, max(errors), any(x.forward_dynamics is None for x in expected))


@cache
def all_files() -> dict[str, Path]:
    """Of all packages, by their path in it; what a package lists is looked for on the disk, which takes 0.2 s."""
    return {**urdf_files(), **mjcf_files(), **more_files()}


def compared_file(name: str) -> Row:
    """A URDF file beside Pinocchio, an MJCF file beside MuJoCo."""
    path = all_files()[name]
    return compared(name, path, PinocchioTwin if path.suffix == ".urdf" else MujocoTwin)


if __name__ == "__main__":
    for file in all_files():
        if not sys.argv[1:] or sys.argv[1] in file:
            print(compared_file(file), flush=True)
