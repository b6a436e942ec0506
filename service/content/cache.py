"""A small cache of decoded values: least recently used first out, bounded by weight, safe between threads."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from concurrent.futures import Future
from threading import Lock
from typing import Generic, TypeVar

V = TypeVar("V")


class Cache(Generic[V]):
    """Values by immutable key, so an entry can never be out of date."""

    def __init__(self, capacity: int, weight: Callable[[V], int]) -> None:
        self.capacity, self.weight = capacity, weight
        self._entries: OrderedDict[Hashable, V] = OrderedDict()
        self._pending: dict[Hashable, Future[V]] = {}
        self._total = 0
        self._lock = Lock()

    def get(self, key: Hashable) -> V | None:
        """The value, or None."""
        with self._lock:
            value = self._entries.get(key)
            if value is not None:
                self._entries.move_to_end(key)
            return value

    def once(self, key: Hashable, make: Callable[[], V]) -> V:
        """The value, made where there is none; who asks meanwhile waits for that. Raises what ``make`` does."""
        value = self.get(key)
        if value is not None:
            return value
        with self._lock:
            pending, mine = self._pending.get(key), Future[V]()
            if pending is None:
                self._pending[key] = mine
        if pending is not None:
            return pending.result()
        try:
            value = make()
            self.put(key, value)
            mine.set_result(value)
        except BaseException as error:
            mine.set_exception(error)
            raise
        finally:
            with self._lock:
                del self._pending[key]
        return value

    def put(self, key: Hashable, value: V) -> None:
        """Remember a value; one heavier than the whole cache is not kept."""
        with self._lock:
            if key in self._entries or self.weight(value) > self.capacity:
                return
            self._entries[key] = value
            self._total += self.weight(value)
            while self._total > self.capacity:
                _, oldest = self._entries.popitem(last=False)
                self._total -= self.weight(oldest)
