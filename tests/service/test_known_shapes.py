"""Trees of one shape are coupled and certified once, for those on whose behalf that was done, and for nobody else."""

from __future__ import annotations

import re
from copy import deepcopy
from typing import Any

import pytest

from service.jobs.kinds import run
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.shapes import SHARE
from substructures import Definition, Part, catalogue, derive
from substructures.tree import model

ITEM: dict[str, Any] = {"nodes": 100_000}


def _varied(name: str, k: int) -> Part:
    document = deepcopy(catalogue.load(name)) | {"name": f"{name}-{k}"}
    for i, each in enumerate(document["parameters"].values()):
        each["value"] = round(0.1017 + 0.013 * i + 0.00171 * k, 9)
    return derive(Definition.read(document))


def _item(arm: Part, hand: Part, **more: Any) -> tuple[dict[str, Any], dict[str, bytes]]:
    instances = [
        {"name": name, "substructure": f"{part.name}@{part.definition.digest}", "at": at}
        for name, part, at in (("arm", arm, "world"), ("hand", hand, "arm.flange"))
    ]
    tree = {"name": "t", "gravity": [0, 0, -9], "instances": instances}
    blobs = {part.definition.digest: part.definition.canonical() for part in (arm, hand)}
    blobs |= {part.program.digest: part.program.to_bytes() for part in (arm, hand)}
    programs = {part.definition.digest: part.program.digest for part in (arm, hand)}
    return {"tree": tree, "programs": programs, **ITEM, **more}, blobs


@pytest.fixture
def certified(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The trees that are compared with their documents, by digest of their programs."""
    found: list[str] = []
    slow = model.certified

    def noted(*given: Any) -> Any:
        found.append(given[3].digest)
        return slow(*given)

    monkeypatch.setattr(model, "certified", noted)
    return found


def test_a_job_couples_each_shape_once_and_says_what_the_slow_way_says(certified: list[str]) -> None:
    pairs = [(_varied("planar-2r", k), _varied("simple-pendulum", m)) for k in (0, 10) for m in range(3)]
    fast = [_files(*pair, share="job once") for pair in pairs]
    assert len(certified) == 1
    assert [_files(*pair) for pair in pairs] == fast
    assert len(certified) == 1 + len(pairs)
    assert len({summary["mass"] for summary, _ in fast}) == len(pairs)


def test_nobody_learns_what_shapes_others_have(certified: list[str]) -> None:
    pair = _varied("planar-2r", 7), _varied("planar-2r", 8)
    for share, count in (("owner a", 1), ("owner b", 2), ("owner a", 2), ("job a", 3)):
        _files(*pair, share=share)
        assert len(certified) == count


def test_a_program_is_read_once_for_all_parts_that_have_it() -> None:
    one, other = _varied("planar-2r", 11), _varied("planar-2r", 12)
    assert one.program.digest == other.program.digest
    read = []
    for part in (one, other):
        blobs = {part.definition.digest: part.definition.canonical(), part.program.digest: part.program.to_bytes()}
        read.append(part_of(part.definition.digest, part.program.digest, blobs))
    assert read[0].program is read[1].program
    assert [part.parameters for part in read] == [one.parameters, other.parameters]


def _files(arm: Part, hand: Part, share: str | None = None) -> tuple[dict[str, Any], dict[str, bytes]]:
    """What comes of an item, without the time that it took."""
    item, blobs = _item(arm, hand, **({} if share is None else {SHARE: share}))
    outcome = run("assemble", item, blobs, lambda _: None)
    assert outcome.problem is None
    files = dict(outcome.files)
    files["summary"] = re.sub(rb'"seconds":\{[^}]*\}', b"", files["summary"])
    return dict(outcome.summary), files
