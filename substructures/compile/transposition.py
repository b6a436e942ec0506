"""LLVM assembly between arrays of rows, (states) by (elements), and vectors of states by their places: inputs from
rows to vectors, results from vectors to rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from substructures.compile.assembler import AssemblyWriter

#: words of a row of the table of inputs; its array's columns in pairs (byte offsets: of the first in a row of the
#: array, of both among the inputs of the stage), and single ones
INPUT = ("base", "stride", "stage", "pairs", "n_pairs", "singles", "n_singles")
#: elements of a row written at once
TILE = 4
#: words of a row of the table of outputs
OUTPUT = ("base", "stride", "groups", "n_groups", "singles", "n_singles")

COLUMNS = "ptr %table, i64 %count, i64 %first, i64 %final, ptr %context, i64 %block"
ROWS = "ptr %table, i64 %count, i64 %first, ptr %o"


def gather(width: int) -> str:
    """Inputs of the states first, first + 1, ... into the scratch arrays; the last state fills a vector up."""
    w = AssemblyWriter(width)
    ahead = list[str]()
    for lane in range(1, width):
        beyond = w.do(f"icmp sgt i64 {w.arithmetic('add', '%first', lane)}, %final")
        ahead.append(w.do(f"select i1 {beyond}, i64 0, i64 -1"))
    with w.loop("0", "%count") as i:
        row = w.words(w.offset("%table", w.arithmetic("mul", i, 8 * len(INPUT))), INPUT)
        starts = [w.offset(w.pointer(row["base"]), w.arithmetic("mul", "%first", row["stride"]))]
        for mask in ahead:
            starts.append(w.offset(starts[-1], w.arithmetic("and", row["stride"], mask)))
        target = scratch_row(w, row["stage"], "%block")
        with w.loop("0", row["n_pairs"]) as g:
            at, *targets = _column(w, row["pairs"], g, target, 2)
            _pair(w, [w.offset(start, at) for start in starts], targets)
        with w.loop("0", row["n_singles"]) as g:
            at, to = _column(w, row["singles"], g, target, 1)
            value = "undef"
            for lane, start in enumerate(starts):
                one = w.do(f"load double, ptr {w.offset(start, at)}, align 8")
                value = w.do(f"insertelement {w.kind} {value}, double {one}, i32 {lane}")
            w.put(f"store {w.kind} {value}, ptr {to}, align {8 * width}")
    return w.function("gather", COLUMNS)


def spread(w: AssemblyWriter, table: str, count: str) -> None:
    """Inputs of one state into all lanes of the scratch arrays; ``%context``: of the driver."""
    with w.loop("0", count) as i:
        row = w.words(w.offset(table, w.arithmetic("mul", i, 8 * len(INPUT))), INPUT)
        start, target = w.pointer(row["base"]), scratch_row(w, row["stage"], "0")
        for name, columns in (("pairs", 2), ("singles", 1)):
            with w.loop("0", row[f"n_{name}"]) as g:
                at, *targets = _column(w, row[name], g, target, columns)
                for k, to in enumerate(targets):
                    one = w.do(f"load double, ptr {w.offset(w.offset(start, at), k, 'double')}, align 8")
                    first = w.do(f"insertelement {w.kind} undef, double {one}, i32 0")
                    every = f"{w.kind} {first}, {w.kind} undef, <{w.width} x i32> zeroinitializer"
                    w.put(f"store {w.kind} {w.do(f'shufflevector {every}')}, ptr {to}, align {8 * w.width}")


def scratch_row(w: AssemblyWriter, stage: str, block: str) -> str:
    """Scratch row of a stage for a vector of the group."""
    row = w.words(w.offset("%context", w.arithmetic("mul", stage, 16)), ("base", "stride"))
    return w.offset(w.pointer(row["base"]), w.arithmetic("mul", block, row["stride"]))


def _column(w: AssemblyWriter, table: str, g: str, target: str, count: int) -> list[str]:
    """Offset of a column, or the first of a pair, in a row of the array, and the addresses of their vectors."""
    row = w.offset(w.pointer(table), w.arithmetic("mul", g, 8 * (count + 1)))
    at, *places = (w.do(f"load i64, ptr {w.offset(row, k, 'i64')}, align 8") for k in range(count + 1))
    return [at, *(w.offset(target, place) for place in places)]


def _pair(w: AssemblyWriter, sources: list[str], targets: list[str]) -> None:
    """Two neighbouring columns: pairs of even and of odd lanes in a vector each, from which every second one is one."""
    pairs = [w.do(f"load <2 x double>, ptr {source}, align 8") for source in sources]
    sides, size = [pairs[::2], pairs[1::2]], 2
    while len(sides[0]) > 1:
        whole = range(2 * size)
        sides = [[_mixed(w, f"<{size} x double>", *x, whole) for x in zip(s[::2], s[1::2], strict=True)] for s in sides]
        size *= 2
    for k, target in enumerate(targets):
        order = [lane + k + odd for lane in range(0, w.width, 2) for odd in (0, w.width)]
        value = _mixed(w, w.kind, sides[0][0], sides[1][0], order)
        w.put(f"store {w.kind} {value}, ptr {target}, align {8 * w.width}")


def _mixed(w: AssemblyWriter, kind: str, a: str, b: str, order: Sequence[int]) -> str:
    """A shuffle of the elements of two vectors."""
    indices = ", ".join(f"i32 {k}" for k in order)
    return w.do(f"shufflevector {kind} {a}, {kind} {b}, <{len(order)} x i32> <{indices}>")


def scatter(width: int) -> str:
    """Outputs of one full vector of states from the places of o to the rows of the caller's arrays.

    Square tiles are transposed in registers: ``tile`` neighbouring elements of a row come from ``tile`` places.
    """
    w = AssemblyWriter(width)
    tile = min(width, TILE)
    with w.loop("0", "%count") as i:
        row = w.words(w.offset("%table", w.arithmetic("mul", i, 8 * len(OUTPUT))), OUTPUT)
        starts = [w.offset(w.pointer(row["base"]), w.arithmetic("mul", "%first", row["stride"]))]
        for _ in range(1, width):
            starts.append(w.offset(starts[-1], row["stride"]))
        groups, singles = w.pointer(row["groups"]), w.pointer(row["singles"])
        with w.loop("0", row["n_groups"]) as g:
            _group(w, w.offset(groups, w.arithmetic("mul", g, 8 * (tile + 2))), starts, tile)
        with w.loop("0", row["n_singles"]) as g, w.loop("0", str(width)) as lane:
            single = w.offset(singles, w.arithmetic("mul", g, 24))
            start = w.offset(starts[0], w.arithmetic("mul", lane, row["stride"]))
            _element(w, single, start, lane, "0")
    return w.function("scatter", ROWS)


def scatter_some(width: int) -> str:
    """The same for the first ``some`` lanes, element by element."""
    w = AssemblyWriter(width)
    tile = min(width, TILE)
    with w.loop("0", "%count") as i:
        row = w.words(w.offset("%table", w.arithmetic("mul", i, 8 * len(OUTPUT))), OUTPUT)
        for table, elements in (("groups", tile), ("singles", 1)):
            rows = w.pointer(row[table])
            with w.loop("0", row[f"n_{table}"]) as g, w.loop("0", "%some") as lane, w.loop("0", str(elements)) as k:
                group = w.offset(rows, w.arithmetic("mul", g, 8 * (elements + 2)))
                state = w.arithmetic("add", "%first", lane)
                start = w.offset(w.pointer(row["base"]), w.arithmetic("mul", state, row["stride"]))
                _element(w, group, start, lane, k)
    return w.function("scatter_some", ROWS + ", i64 %some")


def _element(w: AssemblyWriter, group: str, start: str, lane: str, k: str) -> None:
    """Element k of a group, one lane."""
    at, signs = (w.do(f"load i64, ptr {w.offset(group, n, 'i64')}") for n in (0, 1))
    source = w.do(f"load i64, ptr {w.offset(w.offset(group, 16), k, 'i64')}")
    bits = w.do(f"load i64, ptr {w.offset(w.offset('%o', source), lane, 'i64')}")
    sign = w.arithmetic("shl", w.arithmetic("lshr", signs, k), 63)
    target = w.offset(w.offset(start, at), k, "double")
    w.put(f"store i64 {w.arithmetic('xor', bits, sign)}, ptr {target}, align 8")


def _group(w: AssemblyWriter, group: str, starts: list[str], tile: int) -> None:
    """All tiles of a group (width / tile of them, one below the other); signs only where there are some."""
    at, signs = (w.do(f"load i64, ptr {w.offset(group, n, 'i64')}") for n in (0, 1))
    sources = [w.offset("%o", w.do(f"load i64, ptr {w.offset(group, 2 + k, 'i64')}")) for k in range(tile)]
    with w.when(w.do(f"icmp eq i64 {signs}, 0")):
        _tiles(w, sources, None, [w.offset(start, at) for start in starts])
    with w.when(w.do(f"icmp ne i64 {signs}, 0")):
        bits = [w.arithmetic("shl", w.arithmetic("lshr", signs, k), 63) for k in range(tile)]
        _tiles(w, sources, bits, [w.offset(start, at) for start in starts])


def _tiles(w: AssemblyWriter, sources: list[str], signs: list[str] | None, targets: list[str]) -> None:
    tile = len(sources)
    integers = f"<{tile} x i64>"
    for first in range(0, w.width, tile):
        columns = [w.do(f"load {integers}, ptr {w.offset(s, first, 'i64')}, align 16") for s in sources]
        for k, sign in enumerate(signs or ()):
            one = w.do(f"insertelement {integers} undef, i64 {sign}, i32 0")
            every = w.do(f"shufflevector {integers} {one}, {integers} undef, <{tile} x i32> zeroinitializer")
            columns[k] = w.do(f"xor {integers} {columns[k]}, {every}")
        for target, values in zip(targets[first : first + tile], _transposed(w, columns), strict=True):
            w.put(f"store {integers} {values}, ptr {target}, align 8")


def _transposed(w: AssemblyWriter, rows: list[str]) -> list[str]:
    """A square of 2 or 4 vectors, by exchanging blocks."""
    kind = f"<{len(rows)} x i64>"

    mixed = partial(_mixed, w, kind)

    if len(rows) == 2:
        return [mixed(rows[0], rows[1], (0, 2)), mixed(rows[0], rows[1], (1, 3))]
    a, b, c, d = rows
    low, high = (0, 4, 2, 6), (1, 5, 3, 7)
    even, odd = (mixed(a, b, low), mixed(c, d, low)), (mixed(a, b, high), mixed(c, d, high))
    left, right = (0, 1, 4, 5), (2, 3, 6, 7)
    return [mixed(*even, left), mixed(*odd, left), mixed(*even, right), mixed(*odd, right)]
