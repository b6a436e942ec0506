"""Search, filters and pages of a server whose catalogue has 100,000 parts: CPU time of the server, and wall time.

python -m benchmarks.catalogue [--quick | --parts N] [--jobs] [--database URL] [--json FILE]

An SQLite file, or the empty database at the URL, is filled as submissions fill it, but for the derivation: the parts
are those of the shipped catalogue under other names and titles, and there is a tree for every five of them. With
``--jobs`` the parts are submitted as thousands of definitions are, by jobs of the kind ``derive``; without it this is
measured of a thousand small ones. ``catalogue_*_cpu_ms`` is CPU of the server for one request (that of PostgreSQL is
not counted), ``..._p95_ms`` the wall time that one of twenty exceeds.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from compileall import compile_dir
from dataclasses import replace
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

import service
import substructures
from benchmarks.http import cpu_seconds, serving
from benchmarks.report import keep, options
from benchmarks.store import sizes
from service.content.summaries import PartContent, part_content
from service.content.tree_content import TreeContent
from service.content.tree_summaries import tree_summary
from service.database.connections import Database
from service.database.packed import pack
from service.messages.viewer import ANYBODY
from service.operations import trees
from service.operations.catalogue import PartSubmission, submit
from service.schemas.entries import PLAIN
from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.client import Client
from substructures.tree.plausibility import Plausibility

AT_A_TIME, ASKED, OF_A_JOB, SMALL = 500, 60, 1000, 3
WORDS = ("steel", "light", "left", "right", "long", "short", "test", "old", "blue", "north", "pilot", "series")
REQUESTS = {
    "page": "/v1/substructures",
    "page_of_200": "/v1/substructures?page_size=200",
    "name": "/v1/substructures?q=scara-004242",
    "word": "/v1/substructures?q=pilot",
    "two_words": "/v1/substructures?q=gripper%20north",
    "two_letters": "/v1/substructures?q=r6",
    "two_common_letters": "/v1/substructures?q=of",
    "one_letter": "/v1/substructures?q=p",
    "slip": "/v1/substructures?q=grippper",
    "nothing": "/v1/substructures?q=xylophone",
    "tag": "/v1/substructures?tag=gripper",
    "dof": "/v1/substructures?dof_min=3&dof_max=4&sort=-dof",
    "dof_by_name": "/v1/substructures?dof_min=1&dof_max=20",
    "joints": "/v1/substructures?joints=RRRRRR",
    "joints_of_none": "/v1/substructures?joints=RRRPPP",
    "owner_of_none": "/v1/substructures?owner=nobody",
    "port": "/v1/substructures?port=bob",
    "port_of_many": "/v1/substructures?port=flange",
    "ports": "/v1/substructures?port=wrist&port=flange&sort=-created",
    "mass": "/v1/substructures?mass_min=1&mass_max=2",
    "mass_of_none": "/v1/substructures?mass_min=1e9",
    "source": "/v1/substructures?source=corke",
    "word_and_mass": "/v1/substructures?q=pilot&mass_min=1&mass_max=5",
    "newest": "/v1/substructures?sort=-created",
    "facets": "/v1/substructures?facets=true",
    "first_page": "/",
    "trees": "/v1/trees",
    "tree_word": "/v1/trees?q=cell",
    "tree_slip": "/v1/trees?q=cel-004242",
    "tree_uses": "/v1/trees?uses=puma560-of-trees",
    "tree_mass": "/v1/trees?mass_min=1e9",
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


def definitions(count: int) -> Iterator[dict[str, Any]]:
    """So many small definitions, all different."""
    small = [each for each in map(catalogue.load, catalogue.names()) if len(each["bodies"]) <= SMALL]
    for k in range(count):
        document = small[k % len(small)]
        yield {**document, "name": f"{document['name']}-{k:06d}"}


def fill_by_jobs(client: Client, count: int) -> float:
    """Submit so many definitions by jobs, one after the other; parts per second, from the first to the last result."""
    made, start = definitions(count), perf_counter()
    while items := list(islice(made, OF_A_JOB)):
        view = client.wait(client.submit_job({"kind": "derive", "items": items})["id"])
        if view["state"] != "succeeded":
            raise RuntimeError(f"the job {view['state']}: {view['error']}")
    rate = count / (perf_counter() - start)
    print(f"{count:,} definitions of at most {SMALL} bodies by jobs: {rate:.0f} parts/s")
    return rate


def tree_content(shipped: Sequence[str], database: Database) -> TreeContent:
    """What is stored of a tree of shipped parts under other names, which are stored."""
    parts = {}
    for name in shipped:
        part = derive(Definition.read({**catalogue.load(name), "name": f"{name}-of-trees"}))
        content = part_content(part)
        parts[name.partition("-")[0]] = part
        with database.write() as connection:
            submit(connection, ANYBODY, PartSubmission(part.name, content.digest, content))
    instances = [{"name": name, "substructure": f"{x.name}@{x.definition.digest}"} for name, x in parts.items()]
    spec = TreeSpec.read({"name": "cell", "gravity": [0, 0, "-9.81"], "instances": instances})
    model, digests = couple(spec, parts), {name: part.definition.digest for name, part in parts.items()}
    mass = Plausibility(spec, {name: part.definition for name, part in parts.items()}).mass
    figures = model.program.digest, len(model.program), model.dof, model.joints, mass
    made = tree_summary(spec, model), digests, pack(model.program)
    return TreeContent("cell", spec.canonical(), *figures, *made)


def fill_trees(database: Database, count: int) -> None:
    """Store so many trees, of a robot with a gripper and of a pendulum."""
    kinds = [tree_content(shipped, database) for shipped in (("puma560", "parallel-gripper"), ("simple-pendulum",))]
    for start in range(0, count, AT_A_TIME):
        with database.write() as connection:
            for k in range(start, min(start + AT_A_TIME, count)):
                name, kind = f"cell-{k:06d}", kinds[k % 2]
                spec = kind.spec.replace(b'"name":"cell"', f'"name":"{name}"'.encode())
                trees.store(connection, ANYBODY, replace(kind, name=name, spec=spec), PLAIN)


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
    parser.add_argument("--parts", metavar="N", type=int, default=100_000, help="so many, by default 100,000")
    parser.add_argument("--jobs", action="store_true", help="submit them by jobs, which also derive them")
    arguments = parser.parse_args()
    figures: dict[str, float] = {}
    count = 2_000 if arguments.quick else arguments.parts
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as other:
        address = arguments.database or f"sqlite:///{folder}/bench.db"
        database = Database(address)
        if not arguments.jobs:
            fill(database, count)
        fill_trees(database, count // 5)
        database.close()
        settings = {} if arguments.database is None else {"database": address}
        for package in (service, substructures):  # as in an installed one
            compile_dir(Path(package.__file__ or "").parent, quiet=1)
        for figure, what in (("first_start", "with the shipped catalogue to be stored"), ("start", "again")):
            start = perf_counter()
            with serving(folder, **settings):
                figures[f"catalogue_{figure}_s"] = seconds = perf_counter() - start
                print(f"started in {seconds:.1f} s, {what}")
        with serving(folder, **settings) as (client, _):
            figures["catalogue_jobs_parts_per_s"] = fill_by_jobs(client, count if arguments.jobs else OF_A_JOB)
            asked(client, figures)
            figures["catalogue_submit_cpu_ms"] = submitted(client)
        with serving(other) as (client, _):
            figures["catalogue_submit_to_little_cpu_ms"] = submitted(client)
        print(
            f"a submission: {figures['catalogue_submit_cpu_ms']:.1f} ms CPU,"
            f" to the shipped catalogue alone {figures['catalogue_submit_to_little_cpu_ms']:.1f}"
        )
    keep(figures, arguments.json)


def asked(client: Client, figures: dict[str, float]) -> None:
    """Print what every request takes."""
    for name, path in REQUESTS.items():
        cpu, wall = ask(client, path)
        figures |= {f"catalogue_{name}_cpu_ms": cpu, f"catalogue_{name}_p95_ms": wall}
        print(f"{path:66} {cpu:6.1f} ms CPU, p95 {wall:6.1f} ms")


if __name__ == "__main__":
    main()
