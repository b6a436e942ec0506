"""The digests that stand beside the shipped catalogue are those of its entries; a new entry: run this file as a script.

What a store has of these digests is neither read from its file nor derived when a server starts.
"""

from __future__ import annotations

import json
from pathlib import Path

from substructures import catalogue
from substructures.part.definition import Definition


def found() -> dict[str, str]:
    """The digest of every entry."""
    return {name: Definition.read(catalogue.load(name)).digest for name in catalogue.names()}


def test_digests_are_those_of_the_entries() -> None:
    assert catalogue.digests() == found(), (
        "run `python -m tests.catalogue.test_shipped_digests`, which writes them anew"
    )


if __name__ == "__main__":
    Path(catalogue.__file__).with_name("digests.json").write_text(json.dumps(found(), indent=1) + "\n")
