"""CPU seconds (user and system) of commands of the command line, the best of three, as a table.

    python -m benchmarks.commands

A bare interpreter and the two libraries that every command talks through stand before them, for scale. Each command
runs once before, so that what Python compiles is there already.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from service.server import background
from service.settings import Settings
from substructures import catalogue
from substructures.documents import write_json

TREE = {"name": "swing", "gravity": [0, 0, -9.81], "instances": [{"name": "arm", "substructure": "simple-pendulum"}]}
MOTION = {"q": [0.5], "span": [0, 1]}
SCALE = ("pass", "import typer, httpx2")
HERE = (
    "--help",
    "derive pendulum.json",
    "derive pendulum.json --show metric",
    "evaluate swing.json metric",
    "export swing.json --target c --out swing.zip",
    "analyse swing.json metric",
    "analyse swing.json first_integrals",
    "analyse swing.json equilibria",
    "simulate swing.json motion.json",
    "same pendulum.json pendulum.json",
)
THERE = ("list", "search pendulum", "show simple-pendulum", "versions simple-pendulum", "submit pendulum.json")
BEST_OF = 3


def seconds(words: Sequence[str], folder: Path, server: str = "") -> float:
    """CPU of one process and those that it starts. Raises CalledProcessError where it fails."""
    given = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    if server:
        given["SUBSTRUCTURES_SERVER"] = server
    before = os.times()
    subprocess.run([sys.executable, *words], cwd=folder, env=given, check=True, capture_output=True)
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


def best(words: Sequence[str], folder: Path, server: str = "") -> float:
    """The least of some times, the first of which does not count."""
    return min([seconds(words, folder, server) for _ in range(1 + BEST_OF)][1:])


def main() -> None:
    """Print the table."""
    with TemporaryDirectory() as made:
        folder = Path(made)
        documents = {"pendulum": catalogue.load("simple-pendulum"), "swing": TREE, "motion": MOTION}
        for name, document in documents.items():
            (folder / f"{name}.json").write_bytes(write_json(document))
        for program in SCALE:
            print(f"{best(['-c', program], folder):5.2f}  python -c '{program}'")
        for command in HERE:
            print(f"{best(['-m', 'service.cli.main', *command.split()], folder):5.2f}  substructures {command}")
        with background(Settings(database=f"sqlite:///{folder / 'store.db'}", workers=1)) as address:
            for command in THERE:
                words = ["-m", "service.cli.main", *command.split()]
                print(f"{best(words, folder, address):5.2f}  substructures {command}")


if __name__ == "__main__":
    main()
