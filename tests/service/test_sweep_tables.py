"""Tables of sweeps take rows when they are shown, so that a page costs a page."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest

from service.operations.jobs.tables import Table, chosen, distribution
from service.views.tables import rows_view

ROWS = 200_000


@pytest.fixture(scope="module")
def table() -> Table:
    source = np.random.default_rng(2)
    columns: dict[str, Any] = {"row": np.arange(ROWS)} | {name: source.normal(size=ROWS) for name in "abcdefgh"}
    unused: Any = None
    return Table(unused, columns | {"k": np.arange(ROWS) % 7}, {})


def test_pages_of_what_is_filtered_and_sorted(table: Table) -> None:
    given = table.columns
    holds = np.flatnonzero(given["a"] > 0)
    order = holds[np.lexsort((given["b"][holds], -given["k"][holds]))]
    shown = chosen(table, "a > 0", "-k,b", ["b", "k"])
    assert (shown.count, list(shown.columns)) == (len(order), ["row", "b", "k"])
    for start, stop in ((0, 3), (len(order) - 2, len(order) + 5), (len(order) + 1, len(order) + 9)):
        items = rows_view(shown, start, stop)["items"]
        assert [(each["row"], each["b"]) for each in items] == [(k, given["b"][k]) for k in order[start:stop]]
    assert [each["row"] for each in rows_view(table, 5, 7)["items"]] == [5, 6]


def test_a_page_is_no_copy_of_the_table(table: Table) -> None:
    tracemalloc.start()
    rows_view(chosen(table, "", "-a", []), 0, 50)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < table.weight / 2


@pytest.mark.parametrize(
    "values", [[1.0, np.nextafter(1, 2)], [0, 5e-324], [1e17, 1e17], [-1, 2], [3.0], [-1e16, 2 - 1e16]]
)
def test_columns_that_are_alike_but_for_rounding_have_histograms(values: list[float]) -> None:
    unused: Any = None
    found = distribution(Table(unused, {"a": np.array(values)}, {}), "a", 1000)
    edges, counts = found["histogram"]["edges"], found["histogram"]["counts"]
    assert sum(counts) == len(values)
    assert edges[0] <= min(values) <= max(values) <= edges[-1]
    assert np.all(np.diff(edges) > 0)
