"""Programs: canonical bytes, the golden file, refusal of damaged ones, select and count."""

from __future__ import annotations

import copy
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from random_expressions import collected, sample

from substructures.errors import InvalidProgram
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Output, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.expr.trigonometry import cos, sin

GOLDEN = Path(__file__).parent / "golden" / "program-1.json"
DIGEST = "sha256:830bad7530729a8a99cf2b60dc407e10935f30b7e621db748012af47b0b159fc"


def two_link_arm() -> Program:
    g = Graph()
    q, i1, i2, m, length, c = (g.symbol(n) for n in ("arm.q2", "I1", "I2", "m2", "l1", "lc2"))
    k, h = m * length * c * cos(q), -m * length * c * sin(q)
    outputs = {
        "metric": Formulas((2, 2), {(0, 0): i1 + i2 + m * length**2 + 2 * k, (0, 1): i2 + k, (1, 1): i2}, "symmetric"),
        "christoffel": Formulas((2, 2, 2), {(0, 0, 1): h, (0, 1, 1): h, (1, 0, 1): g.zero}, "christoffel"),
        "others": array((3,), lambda i: [g.function("atan2", q, c) / 3, g.pi, g.zero][i]),
    }
    kinds = {"arm.q2": "coordinate", "m2": "inertia"}
    symbols = {
        n: Symbol(n, kinds.get(n, "parameter"), "kg") for n in ("arm.q2", "I1", "I2", "m2", "l1", "lc2", "unused")
    }
    return program(g, outputs, symbols)


POINT = {"arm.q2": 0.7, "I1": 0.3, "I2": 0.2, "m2": 1.5, "l1": 0.9, "lc2": 0.4}


def test_golden_file_is_read_for_ever() -> None:
    data = GOLDEN.read_bytes().rstrip(b"\n")
    stored = Program.from_bytes(data)
    assert stored.digest == DIGEST
    assert stored.to_bytes() == data
    values = interpret(stored, POINT)
    k, h = 1.5 * 0.9 * 0.4 * np.cos(0.7), -1.5 * 0.9 * 0.4 * np.sin(0.7)
    np.testing.assert_allclose(values["metric"], [[0.5 + 1.5 * 0.81 + 2 * k, 0.2 + k], [0.2 + k, 0.2]], rtol=1e-14)
    np.testing.assert_allclose(values["christoffel"], [[[0, h], [h, h]], [[-h, 0], [0, 0]]], rtol=1e-14)
    np.testing.assert_allclose(values["others"], [np.arctan2(0.7, 0.4) / 3, np.pi, 0], rtol=1e-14)


def test_bytes_are_stable_and_canonical() -> None:
    first, second = two_link_arm(), two_link_arm()
    assert first.to_bytes() == second.to_bytes()
    assert first.digest == second.digest == DIGEST
    document = json.loads(first.to_bytes())
    text = json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    assert first.to_bytes() == text.encode()
    assert [s["name"] for s in document["symbols"]] == sorted(s["name"] for s in document["symbols"])
    assert Program.from_bytes(first.to_bytes()) == first


def test_zero_elements_are_left_out() -> None:
    p = two_link_arm()
    assert p.outputs["christoffel"].index == ((0, 0, 1), (0, 1, 1))
    assert p.outputs["others"].index == ((0,), (1,))
    assert "unused" not in {s.name for s in p.symbols}


def test_select_keeps_what_is_needed() -> None:
    p = two_link_arm()
    part = p.select(["christoffel"])
    assert {s.name for s in part.symbols} == {"arm.q2", "m2", "l1", "lc2"}
    assert len(part) == len(p.reachable(["christoffel"])) < len(p)
    np.testing.assert_array_equal(interpret(part, POINT)["christoffel"], interpret(p, POINT)["christoffel"])
    assert Program.from_bytes(part.to_bytes()) == part
    assert p.select(list(p.outputs)).digest == p.digest
    with pytest.raises(KeyError):
        p.select(["nothing"])


def test_count() -> None:
    counts = two_link_arm().count(["christoffel"])
    assert counts == {"mul": 3, "neg": 1, "sin": 1, "total": 3}
    assert two_link_arm().count()["atan2"] == 1


def test_operations_of_many_groups_of_entries() -> None:
    """More groups and more different sets of them than are counted at a time: 6000 products, each in two groups."""
    groups: list[list[int]] = [[] for _ in range(1100)]
    for i in range(6000):
        for k in {i % 1100, (7 * i + i // 1100) % 1100}:
            groups[k].append(i + 1)
    operations = (("sym", 0), *[("mul", 0, 0)] * 6000, ("neg", 5))
    program = Program((Symbol("x", "parameter"),), operations, {})
    assert program.totals_of([*groups, [6001], []]) == [*map(len, groups), 1, 0]


def test_replay_gives_the_same_functions() -> None:
    for seed in range(20):
        s = sample(seed)
        first = collected(s.graph, **{f"e{i}": e for i, e in enumerate(s.exprs)})
        graph = Graph()
        again = collected(graph, **replay(first, graph, {}))
        one, two = interpret(first, s.point), interpret(again, s.point)
        assert all(two[n] == pytest.approx(one[n], rel=1e-9, abs=1e-9) for n in one)
        assert again.count()["total"] <= first.count()["total"]


def test_symmetric_elements_are_filled_in() -> None:
    output = Output((3, 3, 3), ((0, 0, 1), (0, 1, 2), (1, 0, 2)), (0, 1, 2), "christoffel")
    signs = {index: (entry, sign) for index, entry, sign in output.expanded()}
    # x[a,b,c] = x[a,c,b];  x[c,b,a] = -x[a,b,c] for b <= a, c
    assert signs == {
        (0, 0, 1): (0, 1), (0, 1, 0): (0, 1), (1, 0, 0): (0, -1),
        (0, 1, 2): (1, 1), (0, 2, 1): (1, 1),
        (1, 0, 2): (2, 1), (1, 2, 0): (2, 1), (2, 0, 1): (2, -1), (2, 1, 0): (2, -1),
    }  # fmt: skip


BASE: dict[str, Any] = {
    "format": "substructures.program",
    "version": 1,
    "symbols": [{"name": "x", "kind": "parameter", "unit": ""}],
    "operations": [["sym", 0], ["rat", "1", "2"], ["mul", 1, 0], ["powi", 2, -3], ["sin", 3]],
    "outputs": {"f": {"shape": [2], "symmetry": "none", "index": [[0]], "entries": [4]}},
}


@pytest.mark.parametrize(
    "operation",
    [
        [], None, 7, "sin", {}, [[]], [["sym"], 0], ["sym"], ["sym", 1], ["sym", -1], ["sym", True],
        ["sym", "x"], ["sym", 0, 0],
        ["eval", 0], ["sin", 1], ["sin", 2], ["sin", -1], ["sin", 0.0], ["sin", True], ["sin"],
        ["sin", 0, 0], ["add", 0],
        ["add", 0, None], ["add", 0, 1], ["mul", 2, 0], ["sub", -1, 0], ["div", 0, True], ["add", 0.0, 0],
        ["int", 1], ["int", "01"], ["int", "-0"], ["int", "1.5"], ["int", "+1"],
        ["int", ""], ["int", "1_0"],
        ["int", "\u0663"], ["int", "9" * 5000], ["int", "1", "2"], ["rat", "1", "0"], ["rat", "1", "-2"],
        ["rat", "1"],
        ["powi", 0], ["powi", 0, 65], ["powi", 0, 1.0], ["powi", 0, True], ["powi", 0, "2"], ["powi", 1, 2],
    ],
)  # fmt: skip
def test_damaged_operations_are_refused_with_their_position(operation: Any) -> None:
    document = copy.deepcopy(BASE)
    document["operations"][1] = operation
    with pytest.raises(InvalidProgram) as caught:
        Program.from_bytes(json.dumps(document).encode())
    assert caught.value.position == 1


@pytest.mark.parametrize("more", [["sin", 0], ["powi", 0, 64], ["int", "7"]])
def test_operations_that_no_output_needs_are_refused(more: list[Any]) -> None:
    """At the end or before others; the first of them is named."""
    document = copy.deepcopy(BASE)
    document["operations"].append(more)
    with pytest.raises(InvalidProgram, match="no output needs it") as caught:
        Program.from_bytes(json.dumps(document).encode())
    assert caught.value.position == 5
    document["outputs"]["f"]["entries"] = [3]
    with pytest.raises(InvalidProgram) as caught:
        Program.from_bytes(json.dumps(document).encode())
    assert caught.value.position == 4


def growing(first: list[Any], step: Callable[[int], list[Any]], count: int) -> bytes:
    """A program whose one output is what comes of so many steps, each of the one before it."""
    operations = [first, *map(step, range(count))]
    output = {"shape": [], "symmetry": "none", "index": [[]], "entries": [count]}
    return json.dumps({**BASE, "operations": operations, "outputs": {"f": output}}).encode()


@pytest.mark.parametrize(
    ("first", "step", "most"),
    [
        (["sym", 0], lambda i: ["powi", i, 64], 682),  # 64^682 = 2^4092
        (["sym", 0], lambda i: ["powi", i, -64], 682),
        (["sym", 0], lambda i: ["mul", i, i], 4096),
        (["int", "3"], lambda i: ["powi", i, 64], 1),  # 2 bits of 3, 128, 8192
        (["int", "-3"], lambda i: ["mul", i, i], 11),
        (["rat", "1", "3"], lambda i: ["add", i, i], 10),  # 2, 5, 11, ..., 3 * 2^10 - 1
    ],
)
def test_powers_and_numbers_without_bound_are_refused(first: Any, step: Any, most: int) -> None:
    """Also where an output needs them: exponents and numbers have 4096 bits at most."""
    assert len(Program.from_bytes(growing(first, step, most))) == most + 1
    with pytest.raises(InvalidProgram, match="of more than 4096 bits") as caught:
        Program.from_bytes(growing(first, step, most + 1))
    assert caught.value.position == most + 1


def test_long_sums_and_functions_are_no_powers() -> None:
    for step in (lambda i: ["add", i, i], lambda i: ["sin", i], lambda i: ["neg", i]):
        assert len(Program.from_bytes(growing(["sym", 0], step, 20_000))) == 20_001


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["format"], "other"), (["version"], 2), (["version"], "1"), (["version"], None),
        (["version"], True), (["version"], 1.0),
        (["symbols"], None), (["symbols"], [1]), (["symbols", 0, "name"], 3), (["symbols", 0, "kind"], "secret"),
        (["symbols", 0, "kind"], []), (["symbols", 0, "extra"], 1), (["symbols"], BASE["symbols"] * 2),
        (["operations"], None),
        (["operations"], 3), (["outputs"], []), (["outputs", "f", "entries"], [5]),
        (["outputs", "f", "entries"], [-1]),
        (["outputs", "f", "entries"], [True]), (["outputs", "f", "entries"], []),
        (["outputs", "f", "entries"], ["4"]),
        (["outputs", "f", "index"], [[2]]), (["outputs", "f", "index"], [[-1]]),
        (["outputs", "f", "index"], [[0, 0]]),
        (["outputs", "f", "index"], [[0.0]]), (["outputs", "f", "shape"], [-1]), (["outputs", "f", "shape"], ["2"]),
        (["outputs", "f", "shape"], [2.0]), (["outputs", "f", "shape"], [True]),
        (["outputs", "f", "shape"], [10**12]),
        (["outputs", "f", "symmetry"], "skew"), (["outputs", "f", "symmetry"], "symmetric"),
        (["outputs", "f", "symmetry"], "christoffel"), (["outputs", "f", "symmetry"], []), (["outputs", "f"], None),
        (["outputs", "f", "more"], 1),
    ],
)  # fmt: skip
def test_damaged_documents_are_refused(path: list[Any], value: Any) -> None:
    document = copy.deepcopy(BASE)
    place = document
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(InvalidProgram):
        Program.from_bytes(json.dumps(document).encode())


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"operations": ...}, "'operations' is missing"),
        ({"symbols": [{"name": "x"}]}, "symbol {'name': 'x'}: it has a name, a unit and one of the kinds coordinate"),
        ({"outputs": {"f": {"shape": []}}}, "output 'f': shape, symmetry, index and entries are needed"),
    ],
)
def test_what_is_wrong_with_a_document_is_said(changes: dict[str, Any], message: str) -> None:
    document = {name: value for name, value in {**BASE, **changes}.items() if value is not ...}
    with pytest.raises(InvalidProgram, match=re.escape(message)):
        Program.from_bytes(json.dumps(document).encode())


@pytest.mark.parametrize(
    ("shape", "symmetry", "index"),
    [
        ([2, 2], "symmetric", [[0, 1], [1, 0]]),
        ([2, 3], "symmetric", [[0, 1]]),
        ([2, 2], "none", [[0, 1], [0, 1]]),
        ([2, 2, 2], "christoffel", [[1, 0, 1]]),
        ([2, 2, 2], "christoffel", [[0, 2, 1]]),
        ([3, 3, 3], "christoffel", [[0, 1, 2], [0, 2, 1]]),
        ([4], "symmetric", [[0]]),
    ],
)
def test_elements_that_contradict_the_symmetry_are_refused(shape: Any, symmetry: Any, index: Any) -> None:
    document = copy.deepcopy(BASE)
    document["outputs"]["f"] = {"shape": shape, "symmetry": symmetry, "index": index, "entries": [4] * len(index)}
    with pytest.raises(InvalidProgram):
        Program.from_bytes(json.dumps(document).encode())


@pytest.mark.parametrize(
    "data", [b"", b"{", b"[]", b"null", b"\xff\xfe", b"[" * 100_000, b'{"format": 1e999}', b"1" * 5000]
)
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(InvalidProgram):
        Program.from_bytes(data)


def test_the_undamaged_one_is_read() -> None:
    p = Program.from_bytes(json.dumps(BASE).encode())
    assert interpret(p, {"x": 0.5})["f"] == pytest.approx([np.sin(64.0), 0])


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of memory is set as on Linux")
def test_a_lack_of_memory_is_not_a_damaged_program() -> None:
    """orjson calls it a wrong document; it happens in a process of its own, whose memory is limited."""
    code = (
        "import resource, pathlib\n"
        "from substructures.expr.program import Program\n"
        "data = b'[' + b'0,' * 1_000_000 + b'0]'\n"
        "size = int(pathlib.Path('/proc/self/statm').read_text().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (size + 8_000_000, -1))\n"
        "try:\n    Program.from_bytes(data)\nexcept MemoryError:\n    print('memory')\n"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "memory\n"
