"""Samples: any range of rows is the same by itself, and they are distributed as they should be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest, qmc

from substructures.documents import read_model
from substructures.ensembles.samples import Sampler, Samples, permuted
from substructures.errors import InvalidDocument

OF: dict[str, Any] = {"a": {"uniform": [2, 5]}, "b": {"normal": [1, 0.5]}, "c": {"values": [1, 2, 4]}}
GRID: dict[str, Any] = {"a": {"uniform": [2, 5], "count": 7}, "b": {"normal": [1, 0.5], "count": 5}, "c": OF["c"]}


def sampler(method: str, **more: Any) -> Sampler:
    return Sampler(read_model(Samples, {"method": method, "of": GRID if method == "grid" else OF, **more}))


@pytest.mark.parametrize("method", ["grid", "random", "sobol", "latin-hypercube"])
def test_parts_are_what_the_whole_is(method: str) -> None:
    made = sampler(method, **({} if method == "grid" else {"count": 1000, "seed": 7}))
    whole = made.rows(0, made.size)
    for start, stop in ((0, 1), (3, 50), (made.size - 2, made.size)):
        part = made.rows(start, stop)
        assert all(np.array_equal(part[name], whole[name][start:stop]) for name in ("a", "b", "c"))


@pytest.mark.parametrize("method", ["random", "sobol", "latin-hypercube"])
def test_distributions(method: str) -> None:
    rows = sampler(method, count=4096, seed=3).rows(0, 4096)
    assert kstest(rows["a"], "uniform", (2, 3)).pvalue > 1e-3
    assert kstest(rows["b"], "norm", (1, 0.5)).pvalue > 1e-3
    assert np.bincount(rows["c"].astype(int), minlength=5)[[1, 2, 4]] == pytest.approx(4096 / 3, rel=0.1)
    assert abs(np.corrcoef(rows["a"], rows["b"])[0, 1]) < 0.06
    assert not np.array_equal(rows["a"], sampler(method, count=4096, seed=4).rows(0, 4096)["a"])


def test_a_latin_hypercube_has_one_row_in_each_interval() -> None:
    rows = sampler("latin-hypercube", count=777, seed=1).rows(0, 777)
    assert sorted(np.floor((rows["a"] - 2) / 3 * 777).astype(int)) == list(range(777))


@pytest.mark.parametrize("size", [1, 2, 3, 5, 1000, 4097])
def test_permutations_are_permutations(size: int) -> None:
    found = permuted(np.arange(size, dtype=np.uint64), size, 5, 3)
    assert sorted(found.tolist()) == list(range(size))


def test_sobol_points_are_those_of_scipy() -> None:
    found = sampler("sobol", count=64, seed=9).rows(0, 64)["a"]
    points = qmc.Sobol(3, rng=np.random.default_rng(9)).random(64)[:, 0]
    assert found == pytest.approx(2 + 3 * points)


def test_grids_lists_and_units() -> None:
    grid = {"x": {"values": [1, 2], "unit": "mm"}, "y": {"uniform": [0, 1], "count": 3}}
    rows = Sampler(read_model(Samples, {"of": grid})).rows(0, 6)
    assert rows["x"].tolist() == [0.001] * 3 + [0.002] * 3
    assert rows["y"].tolist() == [0, 0.5, 1] * 2
    pairs = {"x": {"values": [1, 2]}, "y": {"values": [5, 6]}}
    rows = Sampler(read_model(Samples, {"method": "list", "of": pairs})).rows(1, 2)
    assert {name: x.tolist() for name, x in rows.items()} == {"x": [2], "y": [6]}


@pytest.mark.parametrize(
    "bad",
    [
        {"method": "sobol", "of": {"x": {"uniform": [0, 1]}}},
        {"of": {"x": {"uniform": [0, 1]}}},
        {"of": {"x": {"uniform": [0, 1], "normal": [0, 1], "count": 2}}},
        {"of": {"x": {}}},
        {"of": {"x": {"values": [1], "unit": "furlongs/fish"}}},
        {"method": "list", "of": {"x": {"values": [1]}, "y": {"values": [1, 2]}}},
        {"of": {}},
        {"of": {"x": {"values": [True, "3"]}}},
        {"of": {"x": {"uniform": [-1e308, 1e308], "count": 3}}},
    ],
)
def test_samples_that_cannot_be_made(bad: dict[str, Any]) -> None:
    with pytest.raises(InvalidDocument):
        read_model(Samples, bad)
