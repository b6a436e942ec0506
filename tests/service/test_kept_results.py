"""Results of items by their keys: the first good one stays, one of an item that failed makes room."""

from __future__ import annotations

from service.queries.jobs.results import Result, get_file, put_results
from service.store.store import Store


def test_good_results_replace_those_of_items_that_failed(store: Store) -> None:
    kept = []
    with store.database.write() as connection:
        for told, is_good in ((b"wrong", False), (b"right", True), (b"wrong again", False), (b"later", True)):
            put_results(connection, [Result("sha256:a", "simulate", "{}", {"result": told}, is_good=is_good)])
            kept.append(get_file(connection, "sha256:a", "result"))
    assert kept == [b"wrong", b"right", b"right", b"right"]
