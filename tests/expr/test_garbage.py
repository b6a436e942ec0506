"""Deriving and coupling do not look for garbage in between, and leave the collector as it was."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from typing import Any

import pytest

from substructures import Definition, InvalidDocument, TreeSpec, catalogue, couple, derive, simulate
from substructures.expr.garbage import without_collections
from substructures.expr.graph import Expr, Graph

ARM = Definition.read(catalogue.load("puma560"))
TREE = TreeSpec.read({"name": "t", "instances": [{"name": "a", "substructure": "puma560"}]})


@pytest.fixture
def collections() -> Iterator[list[int]]:
    """The generations that were collected."""
    seen: list[int] = []

    def note(phase: str, info: dict[str, Any]) -> None:
        if phase == "start":
            seen.append(info["generation"])

    gc.callbacks.append(note)
    yield seen
    gc.callbacks.remove(note)


@pytest.mark.parametrize("coupled", [False, True])
def test_nothing_is_collected_meanwhile(coupled: bool, collections: list[int]) -> None:
    part = derive(ARM)
    gc.collect()
    collections.clear()
    if coupled:
        couple(TREE, {"a": part})
    else:
        derive(ARM)
    # at the end the nodes that were made are looked through, once
    assert len(collections) <= 2
    assert gc.isenabled()


def test_first_motions_do_not_look_for_garbage(collections: list[int]) -> None:
    model = couple(TREE, {"a": derive(ARM)})
    gc.collect()
    collections.clear()
    assert simulate(model, [0.1] * 6, (0, 0.1)).is_right
    assert len(collections) <= 4


def test_formulas_of_motions_leave_no_nodes() -> None:
    model = couple({"name": "t", "instances": [{"name": "a", "substructure": "ur5"}]}, {"a": derive("ur5")})
    gc.collect()
    gc.disable()
    try:
        assert simulate(model, [0.1] * model.dof, (0, 0.1)).is_right
        assert sum(isinstance(x, Expr) for x in gc.get_objects()) < 250
    finally:
        gc.enable()


def test_the_graph_is_found_at_once() -> None:
    graphs: list[weakref.ref[Graph]] = []

    @without_collections
    def work() -> None:
        graph = Graph()
        x = graph.symbol("x")
        for _ in range(1000):
            x = x * x + 1
        graphs.append(weakref.ref(graph))

    work()
    gc.collect(0)
    assert graphs[0]() is None


def test_the_collector_is_left_as_it_was() -> None:
    with pytest.raises(InvalidDocument):
        derive(
            Definition.read(
                {**catalogue.load("puma560"), "loads": [{"type": "joint", "coordinate": "q1", "force": "1/(q1-q1)"}]}
            )
        )
    assert gc.isenabled()
    gc.disable()
    try:
        derive(ARM)
        assert not gc.isenabled()
    finally:
        gc.enable()
