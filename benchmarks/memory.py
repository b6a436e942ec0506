"""Memory of a server over thousands of distinct parts and trees, each stored, evaluated, printed and drawn once.

python -m benchmarks.memory [--count 5000] [--json FILE]

Every part is a chain of its own shape and numbers, every tree couples two of them. Printed: the resident memory in MiB
of the process that answers, and of those that compute, after each tenth. What is kept decoded is bounded so that it
is full after the first tenths; the exit status is 1 where the process that answers grows by more than 5 % over the last
half.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from benchmarks.kills import children
from benchmarks.mixed import memory, served
from benchmarks.report import keep
from substructures.client import Client

Plain = dict[str, Any]
TENTHS = 10
MOST_GROWTH = 1.05
KEPT = {"SUBSTRUCTURES_CACHE_NODES": "200000"}


def part(number: int) -> Plain:
    """A chain of 1 to 3 joints with random rows, which no other number has."""
    chance = random.Random(number)  # noqa: S311 -- a simulation
    bodies = [
        {
            "name": f"b{k}",
            "parent": f"b{k - 1}" if k else "base",
            "joint": {
                "type": chance.choice(("revolute", "revolute", "prismatic")),
                "coordinate": f"q{k}",
                "theta": chance.choice((0, "pi/2", 0.3)),
                **{row: round(chance.uniform(0.1, 1), 3) for row in ("psi", "d", "sigma")},
            },
            "mass": round(chance.uniform(0.5, 3), 3),
            "com": [round(chance.uniform(-0.3, 0.3), 3) for _ in range(3)],
            "inertia": {axis: round(chance.uniform(0.1, 0.15), 4) for axis in ("xx", "yy", "zz")},
        }
        for k in range(chance.randint(1, 3))
    ]
    return {"name": f"part{number}", "bodies": bodies, "ports": [{"name": "tip", "body": bodies[-1]["name"]}]}


def used_once(client: Client, number: int) -> None:
    """A part and a tree of it and the one before, each stored and asked for what a person asks for."""
    client.submit(part(number))
    instances: list[Plain] = [{"name": "a", "substructure": f"part{number}"}]
    if number:
        instances.append({"name": "b", "substructure": f"part{number - 1}", "at": "a.tip"})
    tree = client.create_tree({"name": f"tree{number}", "gravity": [0, 0, -9.81], "instances": instances})
    place = f"/v1/trees/tree{number}"
    state = {"quantities": ["metric", "forces"], "q": [0.1] * len(tree["coordinates"])}
    client.request("POST", f"{place}/evaluations", state)
    for path in (f"{place}/metric?format=latex", f"{place}/picture", f"/trees/tree{number}"):
        client.request("GET", path)


def main() -> None:
    """Store, ask, and print what is used."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=5000, help="of parts, and of trees")
    parser.add_argument("--json", type=Path, help="add the figures to this file")
    given = parser.parse_args()
    found: list[float] = []
    with ExitStack() as opened:
        os.environ |= KEPT
        folder = opened.enter_context(tempfile.TemporaryDirectory())
        port, process = opened.enter_context(served(f"sqlite:///{folder}/store.db", 1))
        client = opened.enter_context(Client(f"http://127.0.0.1:{port}", timeout=120))
        for number in range(given.count):
            used_once(client, number)
            if (number + 1) % -(-given.count // TENTHS) == 0:
                answering, below = memory(process.pid), sum(map(memory, children(process.pid)))
                found.append(answering)
                print(f"{number + 1:6} {answering:8.0f} {below:8.0f}", flush=True)
    keep({f"memory_{(k + 1) * 100 // len(found)}_percent_mb": x for k, x in enumerate(found)}, given.json)
    sys.exit(found[-1] > MOST_GROWTH * found[len(found) // 2])


if __name__ == "__main__":
    main()
