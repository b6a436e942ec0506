"""Long functions are cut into pieces that compile in linear time, with the same numbers and a bounded stack."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

import pytest
from exported_models import LIMIT, exported_of, tree_of, write
from run_code import STRICT, agree, call_c, shared, state, tool

from substructures.export.languages import c, pieces
from substructures.export.languages.pieces import split, uses


def test_pieces_compute_what_the_whole_does() -> None:
    """Random lists of sums, run piece by piece on a workspace that forgets what is not given on."""
    random = Random(5)  # noqa: S311 -- a test
    for length in (1, 2, 7, 50):
        temporaries = [(1, "2.0")]
        for n in range(2, 120):
            some = random.choices(range(max(1, n - 40), n), k=2)
            temporaries.append((n, f"t{some[0]} - 0.5*t{some[1]}"))
        assigned = [(f"y[{k}]", f"t{random.randrange(1, 120)}") for k in range(30)] + [("y[30]", "-y[3]")]
        whole: dict[str, float] = {}
        for n, text in temporaries:
            whole[f"t{n}"] = eval(text, {}, whole)  # noqa: S307 -- our own text
        expected = [whole[text] for _, text in assigned[:-1]]
        made = split(temporaries, assigned, length)
        workspace: list[float | None] = [None] * made.slots
        y = [0.0] * 31
        for body in made.bodies:
            local: dict[str, object] = {"y": y, **{f"t{n}": workspace[slot] for n, slot in body.taken}}
            for name, text, _ in body.statements:
                exec(f"{name} = {text}", {}, local)  # noqa: S102 -- our own text
            for n, slot in body.given:
                workspace[slot] = local[f"t{n}"]  # type: ignore[assignment]
        assert y == [*expected, -expected[3]]
        assert made.slots <= 42  # values live for 40 statements, and those that are outputs not after


def test_uses() -> None:
    assert uses("t1*sin(t23) - x[4] + t1") == {1, 23}


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_a_split_function_is_right(compiler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces.split, "__defaults__", (20,))
    monkeypatch.setattr(c, "TABLES", 1)
    exported = exported_of(tree_of("puma560"), together=True)
    sources = [p for p in write(exported, "c", tmp_path) if p.name == "demo.c"]
    text = sources[0].read_text()
    assert len(re.findall(r"^static void demo_all_\d+\(", text, re.MULTILINE)) > 10
    library = shared(sources, STRICT, tool(compiler))
    values = state(exported.interface)
    for function in exported.functions:
        agree(call_c(library, exported, function, values), function, values, 1e-11)


def test_the_stack_is_stated(tmp_path: Path) -> None:
    exported = exported_of(tree_of("kuka-iiwa-14"), together=True)
    text = next(p for p in write(exported, "c", tmp_path) if p.name == "demo.c").read_text()
    stated = [int(n) for n in re.findall(r"at most (\d+) bytes of stack", text)]
    assert stated
    assert max(stated) < 25_000
    assert len(text) < 100 * LIMIT
