"""Trees of one shape are coupled and certified once, for those on whose behalf that was done, and for nobody else."""

from __future__ import annotations

import re
from copy import deepcopy
from dataclasses import replace
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.jobs.engines.engine import AttemptReport, Outcome, Work
from service.jobs.kinds import run
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.shapes import SHARE
from service.store.store import Store
from substructures import Definition, Part, catalogue, derive
from substructures.tree import couple

from .conftest import TREE
from .fake_engine import FakeEngine, finished, items, running, submitted

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
    slow = couple.certified

    def noted(*given: Any) -> Any:
        found.append(given[3].digest)
        return slow(*given)

    monkeypatch.setattr(couple, "certified", noted)
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


def test_what_is_stored_is_not_sent_again(filled: TestClient, store: Store) -> None:
    """A program and the form of its summaries leave the runner once; an item that wrongly counts on it fails alone."""
    sent: list[tuple[str, frozenset[str]]] = []

    class Noting(FakeEngine):
        def compute(self, work: Work) -> Outcome:
            lost = "sha256:" + 64 * "0"
            outcome = super().compute(work)
            if work.item["tree"]["name"] == "t4":
                outcome = replace(outcome, summary={**outcome.summary, "program": lost})
            sent.append((work.item["tree"]["name"], frozenset(outcome.files) & {"program", "form"}))
            return outcome

    trees = [{**TREE, "name": f"t{k}", "parameters": {"g": {"value": 9 + k}}} for k in range(6)]
    with running(store, Noting(slots=1)):
        first = finished(filled, submitted(filled, {"kind": "assemble", "items": trees[:1]}))
        job = submitted(filled, {"kind": "assemble", "items": trees[1:]})
        assert first["state"] == "succeeded"
        finished(filled, job)
    by_name = dict(sent)
    assert by_name["t0"] == by_name["t1"] == {"program", "form"}  # each job for itself
    assert by_name["t5"] == frozenset()
    told = items(filled, job)
    assert [each["state"] for each in told] == [*["succeeded"] * 3, "failed", "succeeded"]
    assert told[3]["problem"]["code"] == "missing-content"
    for k in (0, 1, 5):
        assert filled.get(f"/v1/trees/t{k}").json()["parameters"]["g"]["value"] == 9 + k


def test_trees_of_the_same_parts_share_what_is_sent(
    filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What requests of one owner have in common leaves the runner once, and is stored although it was removed."""
    sent: list[frozenset[str]] = []
    compute = store.workers.compute

    def noted(share: str, work: Work, seconds: float) -> AttemptReport:
        report = compute(share, work, seconds)
        if work.kind == "assemble" and report.outcome is not None:
            sent.append(frozenset(report.outcome.files) & {"program", "form"})
        return report

    monkeypatch.setattr(store.workers, "compute", noted)
    for k in range(3):
        tree = {**TREE, "name": f"t{k}", "parameters": {"g": {"value": 9 + k}}}
        answer = filled.post("/v1/trees", json=tree)
        assert answer.status_code == 201
        assert answer.json() == filled.get(f"/v1/trees/t{k}").json()
        assert answer.json()["parameters"]["g"]["value"] == 9 + k
        assert answer.json()["coordinates"]
        if k == 1:
            for name in ("t0", "t1"):
                assert filled.delete(f"/v1/trees/{name}").status_code == 204
    assert sent == [{"program", "form"}, frozenset(), frozenset()]


def test_trees_of_one_program_keep_their_own_words(filled: TestClient) -> None:
    told = []
    for name, words in (("earth", "on Earth"), ("moon", "on the Moon"), ("again", "on Earth")):
        gravity = {"value": 9, "unit": "m/s^2", "description": words}
        assert filled.post("/v1/trees", json={**TREE, "name": name, "parameters": {"g": gravity}}).status_code == 201
        found = filled.get(f"/v1/trees/{name}").json()
        told.append((found["program"], found["parameters"]["g"]["description"]))
    assert len({program for program, _ in told}) == 1
    assert [words for _, words in told] == ["on Earth", "on the Moon", "on Earth"]


def _files(arm: Part, hand: Part, share: str | None = None) -> tuple[dict[str, Any], dict[str, bytes]]:
    """What comes of an item, without the time that it took."""
    item, blobs = _item(arm, hand, **({} if share is None else {SHARE: share}))
    outcome = run("assemble", item, blobs, lambda _: None)
    assert outcome.problem is None
    files = dict(outcome.files)
    files["summary"] = re.sub(rb'\{"couple":[^}]*\}', b"", files["summary"])
    files["summary.digests"] = files["summary.digests"].partition(b" ")[2]  # of the times, too
    return dict(outcome.summary), files
