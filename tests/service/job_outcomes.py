"""What comes of the items of a job that are computed in place, for the tests of its kinds."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from service.jobs.engines.engine import Outcome
from service.jobs.kinds import run
from service.settings import Limits
from substructures.documents import read_json, write_json
from substructures.errors import InvalidInput
from substructures.formats.arrays import read_npz
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.tree.model import Model

from .conftest import PENDULUM, SLIDER, TREE
from .jobs_library import MemoryLibrary

LIMITED: dict[str, Any] = {
    **SLIDER,
    "name": "limited",
    "bodies": [{**SLIDER["bodies"][0], "joint": {"type": "prismatic", "coordinate": "x", "limits": ["-1/4", 2]}}],
}


FREE: dict[str, Any] = {"name": "free", "instances": [{"name": "a", "substructure": "slider"}]}


BOUNDED: dict[str, Any] = {
    "name": "bounded",
    "instances": [
        {"name": "a", "substructure": "limited"},
        {"name": "p", "substructure": "pendulum", "at": "a.top"},
    ],
}


def known_library() -> MemoryLibrary:
    """A library with a few definitions and trees."""
    return MemoryLibrary([PENDULUM, SLIDER, LIMITED], [TREE, FREE, BOUNDED])


def quiet(_fraction: float) -> None:
    """Nobody listens."""


def outcomes(
    library: MemoryLibrary, kind: str, request: Mapping[str, Any], limits: Limits | None = None
) -> list[Outcome]:
    """What comes of a submission; items pass through their stored form."""
    items = [read_json(write_json(item)) for item in library.items(kind, request, limits)]
    return [run(kind, item, library.blobs, quiet) for item in items]


def evaluated(library: MemoryLibrary, name: str, request: Mapping[str, Any]) -> Evaluation:
    tree = library.tree(name)
    assert tree is not None
    return evaluate(Model.load(read_json(tree.summary.encode()), library.blobs[tree.program]), **request)


def joined(made: list[Outcome], name: str) -> Any:
    assert all(outcome.problem is None for outcome in made), made
    return np.concatenate([read_npz(io.BytesIO(outcome.files["result"]), 2**26)[name] for outcome in made])


def faults(library: MemoryLibrary, kind: str, request: Mapping[str, Any], limits: Limits | None = None) -> set[Any]:
    """Pointer and code of what is wrong with a submission."""
    with pytest.raises(InvalidInput) as caught:
        library.items(kind, request, limits)
    return {(fault.pointer, fault.code) for fault in caught.value.faults}
