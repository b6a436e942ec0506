"""Deriving and coupling do not look for garbage in between, and leave the collector as it was."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from substructures import Definition, InvalidDocument, TreeSpec, catalogue, couple, derive, linearise, simulate
from substructures.expr.garbage import without_collections
from substructures.expr.graph import Expr, Graph
from substructures.mechanics.frame_choice import _chosen
from substructures.quantities.formulas import derived

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


def first_results(name: str) -> Callable[[], None]:
    """The first motion of a catalogue entry at the world; where it has no ball joints its linearisation, and a quantity
    that is asked for.
    """
    model = couple({"name": "t", "instances": [{"name": "a", "substructure": name}]}, {"a": derive(name)})

    def work() -> None:
        assert simulate(model, {q: float(q == "a.qw") for q in model.positions}, (0, 0.1)).is_right
        if not model.balls:
            linearise(model, [0.1] * model.dof)
            derived(model, "christoffel_second_kind")

    return work


@pytest.mark.parametrize("name", ["humanoid-arm", "satellite-wheels"])
def test_first_results_do_not_look_for_garbage(name: str, collections: list[int]) -> None:
    work = first_results(name)
    first_results("simple-pendulum")()  # what is imported
    gc.collect()
    collections.clear()
    work()
    assert len(collections) <= 4


def nodes() -> int:
    """How many there are, those that other tests left among them."""
    return sum(isinstance(x, Expr) for x in gc.get_objects())


@pytest.mark.parametrize("name", ["ur5", "humanoid-pelvis-floating"])
def test_formulas_of_first_results_leave_no_nodes(name: str) -> None:
    work = first_results(name)
    gc.collect()
    gc.disable()
    try:
        before = nodes()
        work()
        assert nodes() - before < 150
    finally:
        gc.enable()


def test_the_choice_of_frames_leaves_no_garbage() -> None:
    part = derive(ARM)
    _chosen.cache_clear()
    gc.collect()
    gc.disable()
    try:
        couple(TREE, {"a": part})
        assert gc.collect() < 1000
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
