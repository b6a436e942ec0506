"""Nothing over HTTP, no coordinates or no states: the interpreter and kernels agree on curvatures of every size."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.store import kernels
from service.store.store import Store

from .analysis_trees import client, store

__all__ = ["client", "store"]  # fixtures

BLOCK = {"name": "block", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
MODES = ("interpreter", "kernel")
#: axes of coordinates of every member
AXES = {"riemann": 4, "ricci": 2, "scalar_curvature": 0, "inverse_metric": 2, "christoffel_second": 3}


@pytest.fixture(scope="module")
def trees(client: TestClient) -> TestClient:
    assert client.post("/v1/substructures", json=BLOCK).status_code == 201
    tree = {"name": "still", "instances": [{"name": "x", "substructure": "block"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    return client


def answers(
    trees: TestClient, store: Store, path: str, request: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> list[Any]:
    """The same request before the kernel is there, and by the kernel alone."""
    monkeypatch.setattr(store.kernels._compiler, "submit", lambda *_: None)  # not in the background meanwhile
    before = trees.post(path, json=request)
    monkeypatch.setattr(kernels, "AT_ONCE", 0)
    monkeypatch.setattr(kernels, "interpreted", None)  # kernels alone can answer now
    return [before, trees.post(path, json=request)]


@pytest.mark.parametrize("q", [[], [[]], [[], [], []]])
def test_nothing_moves(trees: TestClient, store: Store, q: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """All that has an axis of coordinates is empty, the scalar is zero in every state."""
    found = answers(trees, store, "/v1/trees/still/curvatures", {"q": q}, monkeypatch)
    for mode, answer in zip(MODES, found, strict=True):
        assert answer.status_code == 200, f"{mode}: {answer.text}"
        body = answer.json()
        for name, axes in AXES.items():
            one: Any = [] if axes else 0
            assert body[name] == ([one for _ in q] if q and isinstance(q[0], list) else one), f"{mode}: {name}"
    assert found[0].json() == found[1].json()


def test_no_states(trees: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two coordinates at no state at all."""
    coordinates = trees.get("/v1/trees/cart").json()["coordinates"]
    request = {"q": {name: [] for name in coordinates}}
    for mode, answer in zip(
        MODES, answers(trees, store, "/v1/trees/cart/curvatures", request, monkeypatch), strict=True
    ):
        assert answer.status_code == 200, f"{mode}: {answer.text}"
        body = answer.json()
        assert all(body[name] == [] for name in (*AXES, "failures")), mode


@pytest.mark.parametrize(("name", "more"), [("excitations", {}), ("identifications", {"tau": []})])
def test_nothing_to_identify(trees: TestClient, name: str, more: dict[str, Any]) -> None:
    """Without coordinates there is no motion that could show masses."""
    answer = trees.post(f"/v1/trees/still/{name}", json={"q": [], "qd": [], "qdd": [], **more})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["code"] == "no-coordinates"
