"""Search, filters and pages of a server whose catalogue has 100,000 parts: CPU time of the server, and wall time.

python -m benchmarks.catalogue [--quick] [--database URL] [--json FILE]

An SQLite file, or the empty database at the URL, is filled as submissions fill it, but for the derivation: the parts
are those of the shipped catalogue under other names and titles. ``catalogue_*_cpu_ms`` is CPU of the server for one
request (that of PostgreSQL is not counted), ``..._p95_ms`` the wall time that one of twenty exceeds.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from time import perf_counter

import numpy as np

from benchmarks.http import cpu_seconds, serving
from benchmarks.report import keep, options
from benchmarks.store import sizes
from service.database.connections import Database
from service.operations.catalogue import PartSubmission, submit
from service.summaries import PartContent, part_content
from service.viewer import ANYBODY
from substructures import Definition, catalogue, derive
from substructures.client import Client

AT_A_TIME, ASKED = 500, 60
WORDS = ("steel", "light", "left", "right", "long", "short", "test", "old", "blue", "north", "pilot", "series")
REQUESTS = {
    "page": "/v1/substructures",
    "page_of_200": "/v1/substructures?page_size=200",
    "name": "/v1/substructures?q=scara-004242",
    "word": "/v1/substructures?q=pilot",
    "two_words": "/v1/substructures?q=gripper%20north",
    "two_letters": "/v1/substructures?q=r6",
    "slip": "/v1/substructures?q=grippper",
    "nothing": "/v1/substructures?q=xylophone",
    "tag": "/v1/substructures?tag=gripper",
    "dof": "/v1/substructures?dof_min=3&dof_max=4&sort=-dof",
    "newest": "/v1/substructures?sort=-created",
    "facets": "/v1/substructures?facets=true",
    "first_page": "/",
}


def contents(count: int) -> Iterator[tuple[str, PartContent]]:
    """Name and content of so many parts."""
    rng = np.random.default_rng(0)
    shipped = [catalogue.load(name) for name in catalogue.names()]
    stored = [(document, part_content(derive(Definition.read(document)))) for document in shipped]
    for k in range(count):
        document, content = stored[k % len(stored)]
        name, title = f"{document['name']}-{k:06d}", f"{document['title']}, {' '.join(rng.choice(WORDS, 3))}"
        named = Definition.read({**document, "name": name, "title": title})
        searchable = "\n".join((name, title, named.description, *named.tags)).lower()
        told = {"digest": named.digest, "definition": named.canonical().decode(), "title": title}
        yield name, replace(content, row={**content.row, **told, "searchable": searchable})


def fill(database: Database, count: int) -> None:
    """Store so many parts."""
    made, start = contents(count), perf_counter()
    while some := list(islice(made, AT_A_TIME)):
        with database.write() as connection:
            for name, content in some:
                submit(connection, ANYBODY, PartSubmission(name, content.digest, content))
    with database.read() as connection:
        size = sizes(connection).total()
    seconds = perf_counter() - start
    each, room = 1e3 * seconds / count, size / count / 1e3
    print(f"{count:,} parts stored in {seconds:.0f} s ({each:.2f} ms and {room:.1f} kB each)")


def ask(client: Client, path: str) -> tuple[float, float]:
    """CPU of the server for one request, and the wall time of one in twenty, in ms."""
    times = []
    client.request("GET", path)
    before = cpu_seconds(client)
    for _ in range(ASKED):
        start = perf_counter()
        client.request("GET", path)
        times.append(perf_counter() - start)
    return (cpu_seconds(client) - before) / ASKED * 1e3, float(np.percentile(times, 95)) * 1e3


def submitted(client: Client) -> float:
    """CPU of the server for one submission of a pendulum, in ms."""
    pendulum = catalogue.load("simple-pendulum")
    before = cpu_seconds(client)
    for k in range(ASKED):
        client.submit({**pendulum, "name": f"submitted-{k}"})
    return (cpu_seconds(client) - before) / ASKED * 1e3


def main() -> None:
    """Fill a store, and ask its server; the same submissions to one with the shipped catalogue alone."""
    parser = options(__doc__, "2,000 parts")
    parser.add_argument("--database", metavar="URL", help="an empty database")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as other:
        address = arguments.database or f"sqlite:///{folder}/bench.db"
        database = Database(address)
        fill(database, 2_000 if arguments.quick else 100_000)
        database.close()
        settings = {} if arguments.database is None else {"database": address}
        start = perf_counter()
        with serving(folder, **settings) as (client, _):
            figures["catalogue_start_s"] = perf_counter() - start
            print(f"started in {figures['catalogue_start_s']:.1f} s")
            for name, path in REQUESTS.items():
                cpu, wall = ask(client, path)
                figures |= {f"catalogue_{name}_cpu_ms": cpu, f"catalogue_{name}_p95_ms": wall}
                print(f"{path:55} {cpu:6.1f} ms CPU, p95 {wall:6.1f} ms")
            figures["catalogue_submit_cpu_ms"] = submitted(client)
        with serving(other) as (client, _):
            figures["catalogue_submit_to_little_cpu_ms"] = submitted(client)
        print(
            f"a submission: {figures['catalogue_submit_cpu_ms']:.1f} ms CPU,"
            f" to the shipped catalogue alone {figures['catalogue_submit_to_little_cpu_ms']:.1f}"
        )
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
