"""LLVM assembly that writes results, (vectors of states) by (places), to arrays of rows, (states) by (elements)."""

from __future__ import annotations

from substructures.compile.assembler import AssemblyWriter

#: elements of a row written at once
TILE = 4
#: words of a row of the table of outputs
OUTPUT = ("base", "stride", "groups", "n_groups", "singles", "n_singles")

ROWS = "ptr %table, i64 %count, i64 %first, ptr %o"


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

    def mixed(a: str, b: str, order: tuple[int, ...]) -> str:
        """A shuffle of the elements of two vectors."""
        indices = ", ".join(f"i32 {k}" for k in order)
        return w.do(f"shufflevector {kind} {a}, {kind} {b}, <{len(order)} x i32> <{indices}>")

    if len(rows) == 2:
        return [mixed(rows[0], rows[1], (0, 2)), mixed(rows[0], rows[1], (1, 3))]
    a, b, c, d = rows
    low, high = (0, 4, 2, 6), (1, 5, 3, 7)
    even, odd = (mixed(a, b, low), mixed(c, d, low)), (mixed(a, b, high), mixed(c, d, high))
    left, right = (0, 1, 4, 5), (2, 3, 6, 7)
    return [mixed(*even, left), mixed(*odd, left), mixed(*even, right), mixed(*odd, right)]
