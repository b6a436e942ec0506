"""What ``/metrics`` shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from prometheus_client import (
    CONTENT_TYPE_LATEST,
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Metric,
    ProcessCollector,
    generate_latest,
)

CONTENT_TYPE = CONTENT_TYPE_LATEST


class _Labelled(CollectorRegistry):
    """A registry whose samples all have the label ``process``."""

    def __init__(self, process: str) -> None:
        super().__init__()
        self._process = process

    def collect(self) -> Iterator[Metric]:
        """All metrics, with the label."""
        for metric in super().collect():
            metric.samples = [
                each._replace(labels={"process": self._process, **each.labels}) for each in metric.samples
            ]
            yield metric


class Metrics:
    """The counters of one app, in a registry of its own.

    ``process``: its number where a server has several; each shows its own counters, under this label.
    """

    def __init__(self, process: str = "") -> None:
        self._registry = _Labelled(process) if process else CollectorRegistry()
        ProcessCollector(registry=self._registry)  # CPU time, memory, descriptors
        self._requests = Counter(
            "substructures_requests", "Requests answered", ["method", "route", "status"], registry=self._registry
        )
        self._seconds = Histogram(
            "substructures_request_seconds", "Time to answer", ["method", "route"], registry=self._registry
        )
        self._series: dict[tuple[str, str, int], tuple[Counter, Histogram]] = {}
        self._cache = Counter(
            "substructures_cache", "Look-ups of decoded programs", ["kind", "result"], registry=self._registry
        )

        self._items = Counter(
            "substructures_job_items",
            "Changes of items by new state (queued: again)",
            ["state"],
            registry=self._registry,
        )
        self._queue = Gauge(
            "substructures_queue", "Jobs and items by state", ["what", "state"], registry=self._registry
        )

    def observe(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count a request; ``route`` is the pattern, so that the number of series stays small."""
        known = method if method in ("GET", "HEAD", "POST", "PUT", "DELETE", "OPTIONS", "PATCH") else "other"
        series = self._series.get((known, route, status))
        if series is None:
            series = self._requests.labels(known, route, str(status)), self._seconds.labels(known, route)
            self._series[known, route, status] = series
        series[0].inc()
        series[1].observe(seconds)

    def cache(self, kind: str, hit: bool) -> None:
        """Count a look-up in the cache of decoded programs."""
        self._cache.labels(kind, "hit" if hit else "miss").inc()

    def items(self, states: Mapping[str, int]) -> None:
        """Count items of jobs by the state that they have come into; queued means tried again."""
        for state, number in states.items():
            self._items.labels(state).inc(number)

    def queue(self, counts: Mapping[str, Mapping[str, int]]) -> None:
        """Show how many jobs and items there are in which state."""
        for kind, states in counts.items():
            for state, number in states.items():
                self._queue.labels(kind, state).set(number)

    def text(self) -> bytes:
        """The Prometheus exposition."""
        return generate_latest(self._registry)
