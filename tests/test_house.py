"""The house stays as easy to read as it is: rooms of a folder, chains of imports, branches, lines, files of a quantity.

Figures above what the style asks for are recorded beside this file, and may only fall: a change that raises one fails,
one that lowers it asks to write the file anew: run this file as a script.
"""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest
from radon.complexity import cc_visit_ast

from benchmarks import house

ROOT = Path(__file__).parent.parent
FILE = Path(__file__).with_name("house.json")
#: independent paths through a function (McCabe), as radon counts them: conditions in comprehensions, too
COMPLEXITY = 20
#: of a new quantity: its row, its formulas, what these have to be, and one more
FILES = 4


def test_rooms_chains_and_lines_only_become_fewer() -> None:
    recorded, found = json.loads(FILE.read_text()), house.bounds(ROOT)
    for kind, most in recorded.items():
        least = house.ROOMS if kind == "rooms" else 0
        worse = {name: (n, most.get(name, least)) for name, n in found[kind].items() if n > most.get(name, least)}
        assert not worse, f"{kind}, now and at most: {worse}; `python -m benchmarks.house --json FILE` names them"
    assert found == recorded, "fewer than recorded: run `python -m tests.test_house`, which writes house.json anew"


def test_functions_have_few_branches() -> None:
    blocks = {file: cc_visit_ast(ast.parse(file.read_text())) for file in house.sources(ROOT)}
    many = [f"{file}:{b.lineno} {b.name}" for file, some in blocks.items() for b in some if b.complexity > COMPLEXITY]
    assert not many, "split them into functions that have names of their own"


@pytest.mark.parametrize("quantity", house.NEWEST)
def test_a_quantity_is_named_in_few_files(quantity: str) -> None:
    assert 0 < len(house.naming(ROOT, quantity)) <= FILES


if __name__ == "__main__":
    FILE.write_text(json.dumps(house.bounds(ROOT), indent=1) + "\n")
