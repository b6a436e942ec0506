"""Trees of a known shape beside trees of new ones: by POST, and 64 arms with each of 64 tools as a job.

python -m benchmarks.shapes [--quick] [--json FILE]

POST: a server in a process of its own with one worker, on an SQLite file; median wall time. A new shape has its hand
where another expression says; a known one has an arm with other numbers. Items: CPU time of the work of an item of the
kind ``assemble`` in this process, and the bytes of what it stores; ``slow``: no shape is known, for a part of the
items; and of as many with numbers bound in instances, with the hand elsewhere, with gravity in other directions, and
with other names of instances. Motions: CPU time of 1 s of trees of 6 + 6 dof, the first of their shapes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from copy import deepcopy
from statistics import median
from time import perf_counter, process_time
from typing import Any

from benchmarks.http import server
from benchmarks.report import keep, options
from service.jobs.kinds import run
from service.jobs.kinds.shapes import SHARE
from substructures import Definition, Part, catalogue, couple, derive, simulate
from substructures.client import Client

ARM, HAND = "puma560", "spherical-wrist"
SLOW = 64  # items


def varied(name: str, k: int) -> dict[str, Any]:
    """An entry with other numbers."""
    document = deepcopy(catalogue.load(name)) | {"name": f"{name}-{k}"}
    for i, each in enumerate(document["parameters"].values()):
        each["value"] = round(0.1017 + 0.013 * i + 0.00171 * k, 9)
    return document


def tree(name: str, arm: str, hand: str, place: float = 0) -> dict[str, Any]:
    """A hand on an arm."""
    placement = {"placement": {"position": [0, 0, f"{place}/1"]}} if place else {}
    instances = [
        {"name": "arm", "substructure": arm},
        {"name": "hand", "substructure": hand, "at": "arm.flange", **placement},
    ]
    return {"name": name, "gravity": [0, 0, -9.81], "instances": instances}


def posted(client: Client, trees: Sequence[dict[str, Any]]) -> float:
    """The median wall time of a POST, in ms."""
    found = []
    for each in trees:
        start = perf_counter()
        client.create_tree(each)
        found.append(perf_counter() - start)
    return median(found) * 1e3


def posts(count: int, figures: dict[str, float]) -> None:
    """Known and new shapes by POST."""
    with tempfile.TemporaryDirectory() as folder, server(folder, workers="1") as client:
        for k in range(count):
            client.submit(varied(ARM, k))
        new = [tree(f"new-{k}", f"{ARM}-0", HAND, 0.01171 + 0.00131 * k) for k in range(count)]
        figures["post_new_ms"] = posted(client, new)
        client.create_tree(tree("first", f"{ARM}-0", HAND))
        figures["post_known_ms"] = posted(client, [tree(f"known-{k}", f"{ARM}-{k}", HAND) for k in range(1, count)])
    print(f"POST: new shape {figures['post_new_ms']:.1f} ms, known shape {figures['post_known_ms']:.1f} ms")


def worked(items: Sequence[dict[str, Any]], blobs: dict[str, bytes], **more: Any) -> tuple[float, float]:
    """CPU time [ms] and bytes of an item."""
    start, size = process_time(), 0
    for item in items:
        outcome = run("assemble", {**item, **more}, blobs, lambda _: None)
        if outcome.problem is not None:
            raise RuntimeError(str(outcome.problem))
        size += sum(map(len, outcome.files.values()))
    return (process_time() - start) * 1e3 / len(items), size / len(items)


def items_of(arms: Sequence[Part], hands: Sequence[Part]) -> tuple[list[dict[str, Any]], dict[str, bytes]]:
    """Every arm with every hand, pinned, and what these items refer to."""
    blobs = {part.definition.digest: part.definition.canonical() for part in (*arms, *hands)}
    blobs |= {part.program.digest: part.program.to_bytes() for part in (*arms, *hands)}
    names = {part.name: f"{part.name}@{part.definition.digest}" for part in (*arms, *hands)}
    items = [
        {
            "tree": tree(f"t-{i}-{k}", names[arm.name], names[hand.name]),
            "programs": {part.definition.digest: part.program.digest for part in (arm, hand)},
            "nodes": 10**6,
        }
        for i, arm in enumerate(arms)
        for k, hand in enumerate(hands)
    ]
    return items, blobs


def bound_items(items: Sequence[dict[str, Any]], hand: Part) -> list[dict[str, Any]]:
    """The first item with other numbers bound in its instances, as many as there are items."""
    found = []
    name = next(iter(hand.parameters))
    for k in range(len(items)):
        item = deepcopy(items[0])
        item["tree"]["name"] = f"bound-{k}"
        for instance, parameter in zip(item["tree"]["instances"], ("m2", name), strict=True):
            instance["parameters"] = {parameter: round(0.2017 + 0.00131 * k, 6)}
        found.append(item)
    return found


def elsewhere(items: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The first item with its hand at other places, as many as there are items."""
    found = []
    for k in range(len(items)):
        item = deepcopy(items[0])
        item["tree"]["name"] = f"elsewhere-{k}"
        item["tree"]["instances"][1]["placement"] = {"position": [0, 0, round(0.1017 + 0.0013 * k, 5)]}
        found.append(item)
    return found


def tilted(items: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The first item on mounts that are tilted, as many as there are items."""
    found = []
    for k in range(len(items)):
        item = deepcopy(items[0])
        item["tree"] |= {"name": f"tilted-{k}", "gravity": [round(0.1017 + 0.0013 * k, 5), 0, "-9.7"]}
        found.append(item)
    return found


def named(items: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The first item with other names of its instances, as many as there are items."""
    found = []
    for k in range(len(items)):
        item = deepcopy(items[0])
        item["tree"]["name"] = f"named-{k}"
        arm, hand = item["tree"]["instances"]
        arm["name"], hand["name"], hand["at"] = f"arm{k}", f"hand{k}", f"arm{k}.flange"
        found.append(item)
    return found


def jobs(count: int, figures: dict[str, float]) -> None:
    """So many arms with as many hands."""
    parts = [[derive(Definition.read(varied(name, k))) for k in range(count)] for name in (ARM, HAND)]
    items, blobs = items_of(*parts)
    slow, size = worked(items[:: max(1, len(items) // SLOW)], blobs)
    fast, _ = worked(items, blobs, **{SHARE: "benchmark"})
    bound, _ = worked(bound_items(items, parts[1][0]), blobs, **{SHARE: "benchmark"})
    figures |= {"item_slow_ms": slow, "item_ms": fast, "item_bound_ms": bound, "item_bytes": size, "items": len(items)}
    ways = {"elsewhere": elsewhere(items), "tilted": tilted(items), "named": named(items)}
    for name, others in ways.items():
        figures[f"item_{name}_ms"], _ = worked(others, blobs, **{SHARE: "benchmark"})
        print(f"as many {name}: an item {figures[f'item_{name}_ms']:.2f} ms")
    total = f"{fast * len(items) / 1e3:.1f} s of CPU, slow {slow * len(items) / 1e3:.0f} s"
    print(f"{len(items):,} trees of one shape: {total}; an item {fast:.2f} ms, slow {slow:.1f} ms; {size:,.0f} bytes")
    print(f"as many with numbers bound in instances: {bound * len(items) / 1e3:.1f} s of CPU, an item {bound:.2f} ms")


def motions(count: int, figures: dict[str, float]) -> None:
    """First motions of so many new shapes, behind one that makes what all have in common."""
    parts = {"arm": derive(catalogue.load("ur5")), "hand": derive(catalogue.load(ARM))}
    models = [couple(tree("first", "ur5", ARM, 0.01171 + 0.00131 * k), parts) for k in range(count + 1)]
    found = []
    for model in models:
        start = process_time()
        simulate(model, [0.3] * model.dof, (0, 1))
        found.append(process_time() - start)
    figures["first_motion_ms"] = median(found[1:]) * 1e3
    print(f"first motion of a new shape, 6 + 6 dof: {figures['first_motion_ms']:.0f} ms of CPU")


def main() -> None:
    """Measure."""
    given = options(__doc__, "fewer trees").parse_args()
    figures: dict[str, float] = {}
    posts(10 if given.quick else 30, figures)
    jobs(8 if given.quick else 64, figures)
    motions(8 if given.quick else 16, figures)
    keep(figures, given.json)


if __name__ == "__main__":
    main()
