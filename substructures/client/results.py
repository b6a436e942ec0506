"""What items of jobs have found: read from their files, and joined."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from substructures.client.answers import Answer
from substructures.client.numbers import Evaluation, arrays_of, motion_of
from substructures.client.problems import ProblemError
from substructures.formats import arrow
from substructures.formats.arrays import MEDIA_TYPE as NPZ
from substructures.formats.arrays import as_answer, flat, nested, placed, view_npz


def require_result(item: Mapping[str, Any]) -> None:
    """Raises ProblemError for an item that failed, unless a part of its result is there, or was cancelled."""
    if item["result"] is not None:
        return
    if item["problem"] is not None:
        raise ProblemError(item["problem"]["status"], item["problem"])
    if item["state"] != "succeeded":
        raise ProblemError(409, {"detail": f"the item {item['position']} was {item['state']}"})


def part_of(item: Mapping[str, Any], content: bytes) -> Evaluation:
    """An item of an evaluation; ``range`` says of which states."""
    if item["files"][0]["media_type"] == NPZ:
        found = as_answer(view_npz(np.frombuffer(content, np.uint8)))
    else:
        found = nested(next(arrow.read_tables(io.BytesIO(content))))
    return Evaluation({**found, "range": item["result"]["range"]})


def result_of(kind: str, item: Mapping[str, Any], content: bytes | None) -> Any:
    """What an item of a job of any kind has found: evaluations, motions and arrays as such, JSON as Answer, other files
    as bytes; without a file what the item tells.
    """
    if content is None:
        return Answer(item["result"] or {})
    media_type = item["files"][0]["media_type"]
    if kind == "evaluate":
        return part_of(item, content)
    if media_type == NPZ:
        return motion_of(content) if item["result"].get("analysis") == "simulations" else Answer(arrays_of(content))
    return Answer(json.loads(content)) if media_type == "application/json" else content


def joined_parts(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The parts of an evaluation as one answer."""
    columns = [flat(part) for part in parts]
    arrays = {
        name: np.concatenate([each[name] for each in columns])
        for name, value in columns[0].items()
        if isinstance(value, np.ndarray)
    }
    told = {name: _noted(parts, name) for name in ("failures", "warnings")}
    whole = nested({**columns[0], **arrays})
    return {**whole, "count": sum(part["count"] for part in parts), **told}


def _noted(parts: Sequence[Mapping[str, Any]], name: str) -> list[dict[str, Any]]:
    """What the parts say about their states, with the places of the states in the whole; the same is said once."""
    told = [placed(note, part["range"][0]) for part in parts for note in part.get(name, ())]
    return [note for i, note in enumerate(told) if "state" in note or note not in told[:i]]
