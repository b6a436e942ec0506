"""LLVM assembly of what all kernels share: input, sines and cosines, library calls, output, and the driver loop.

Widths are fixed by the host, so this module is compiled once. Its functions take addresses in tables of 64-bit words;
compiled objects contain no address and no name to be resolved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from struct import pack, unpack

from substructures.compile.assembler import AssemblyWriter, attributes, literal
from substructures.compile.order import REGIONS
from substructures.compile.sincos import LIMIT, sincos_body
from substructures.compile.transposition import gather, scatter, scatter_some, scratch_row, spread

#: words of the driver's context; ``counters``: of the groups that were taken of every part of the batch, which has
#: ``turns`` groups, LINE bytes apart; the word behind the first one is not zero when a result of any state is not
#: finite. A thread begins with the part ``own``
CONTEXT = (
    *(word for region in REGIONS for word in (region, f"{region}_stride")),
    *("o", "o_stride", "o_advance", "last", "counters", "own", "parts", "turns"),
    *("inputs", "n_inputs", "steps", "n_steps", "outputs", "n_outputs", "group", "n_results"),
)
#: words of a row of the table of steps
STEP = ("stage", "function", "a", "b", "c", "count", "extra")


def runtime(width: int) -> str:
    """The module: sincos, unary, binary, drive, drive_one."""
    body = [
        _sincos(width),
        _library(width, 1),
        _library(width, 2),
        gather(width),
        scatter(width),
        scatter_some(width),
        _look(width),
        _drive(width),
        _drive_one(width),
    ]
    return "\n".join(body) + attributes(width)


#: results that are looked at together, a power of 2, and sums in which they are
LOOKED, CHAINS = 16, 4

#: bytes that no two threads should write to at a time: two cache lines, which some processors fetch together
LINE = 128

BATCH = "ptr %a, ptr %b, ptr %c, i64 %count, ptr %extra"


def _sincos(width: int) -> str:
    """Sines of ``count`` vectors from a to b, cosines to c; ``extra``: addresses of the C library's sin and cos, which
    answer at the end where numbers are beyond the limit.
    """
    w, size, integers = AssemblyWriter(width, has_table=True), 8 * width, f"<{width} x i64>"
    # negative in a lane where |x|, as bits, is beyond the limit, or no number
    beyond = w.do(f"alloca {integers}, align {size}")
    w.put(f"store {integers} zeroinitializer, ptr {beyond}, align {size}")
    limit, plain = (f"<{', '.join([f'i64 {n}'] * width)}>" for n in (unpack("<q", pack("<d", LIMIT))[0], 2**63 - 1))
    with w.loop("0", "%count") as i:
        at = w.arithmetic("mul", i, size)
        x = w.do(f"load {w.kind}, ptr {w.offset('%a', at)}, align {size}")
        for result, target in zip(sincos_body(w, x), ("%b", "%c"), strict=True):
            w.put(f"store {w.kind} {result}, ptr {w.offset(target, at)}, align {size}")
        magnitude = w.do(f"and {integers} {w.do(f'bitcast {w.kind} {x} to {integers}')}, {plain}")
        before = w.do(f"load {integers}, ptr {beyond}, align {size}")
        every = w.do(f"or {integers} {before}, {w.do(f'sub {integers} {limit}, {magnitude}')}")
        w.put(f"store {integers} {every}, ptr {beyond}, align {size}")
    every = w.do(f"load {integers}, ptr {beyond}, align {size}")
    mask = w.do(f"bitcast <{width} x i1> {w.do(f'icmp slt {integers} {every}, zeroinitializer')} to i{width}")
    with w.when(w.do(f"icmp ne i{width} {mask}, 0")), w.loop("0", w.arithmetic("mul", "%count", width)) as i:
        one = w.do(f"load double, ptr {w.offset('%a', i, 'double')}")
        magnitude = w.do(f"call double @llvm.fabs.f64(double {one})")
        with w.when(w.do(f"fcmp ugt double {magnitude}, {LIMIT:.1f}")):
            for k, target in enumerate(("%b", "%c")):
                function = w.do(f"load ptr, ptr {w.offset('%extra', k, 'ptr')}")
                value = w.do(f"call double {function}(double {one})")
                w.put(f"store double {value}, ptr {w.offset(target, i, 'double')}")
    return "declare double @llvm.fabs.f64(double)\n" + w.function("sincos", BATCH)


def _library(width: int, arguments: int) -> str:
    """The C function ``extra`` of every number at a (and b), to c."""
    w = AssemblyWriter(width)
    with w.loop("0", w.arithmetic("mul", "%count", width)) as i:
        given = [w.do(f"load double, ptr {w.offset(x, i, 'double')}") for x in ("%a", "%b")[:arguments]]
        value = w.do(f"call double %extra({', '.join(f'double {x}' for x in given)})")
        w.put(f"store double {value}, ptr {w.offset('%c', i, 'double')}")
    return w.function(("unary", "binary")[arguments - 1], BATCH)


def _look(width: int) -> str:
    """Sets the word ``seen`` when one of the ``count`` results at o is not finite, for which 0 x is not a number."""
    w = AssemblyWriter(width)

    def look(i: str, count: int) -> None:
        """At so many results at once, in CHAINS sums of 0 x."""
        zero, sums = literal(0.0, width), [literal(0.0, width)] * min(CHAINS, count)
        for k in range(count):
            place = w.offset("%o", w.arithmetic("mul", w.arithmetic("add", i, k), 8 * width))
            x = w.do(f"load {w.kind}, ptr {place}, align 8")
            sums[k % CHAINS] = w.fused("fadd", w.fused("fmul", x, zero), sums[k % CHAINS])
        while len(sums) > 1:
            sums.append(w.real("fadd", sums.pop(0), sums.pop(0)))
        bad = w.do(f"fcmp uno {w.kind} {sums[0]}, {sums[0]}")
        mask = w.do(f"bitcast <{width} x i1> {bad} to i{width}")
        with w.when(w.do(f"icmp ne i{width} {mask}, 0")):
            w.put("store i64 1, ptr %seen, align 8")

    # behind the zero
    end = w.arithmetic("add", "%count", 1)
    several = w.arithmetic("sub", end, w.arithmetic("and", "%count", LOOKED - 1))
    with w.loop("1", several, LOOKED) as i:
        look(i, LOOKED)
    with w.loop(several, end) as i:
        look(i, 1)
    return w.function("look", "ptr %o, i64 %count, ptr %seen")


def _drive(width: int) -> str:
    """The states [0, last) in groups of vectors: inputs, every step for the whole group, outputs.

    Taking a function for several vectors in turn keeps its instructions in the cache. Several threads may drive the
    same batch, each with scratch of its own: they share the counters of groups. Each begins with a part of its own, so
    that no two write to one page of the results, and goes on with what others have left.
    """
    w = AssemblyWriter(width)
    c = w.words("%context", CONTEXT)
    tables = {n: w.pointer(c[n]) for n in ("counters", "inputs", "steps", "outputs", *REGIONS, "o")}
    final = w.arithmetic("sub", c["last"], 1)
    advance = w.arithmetic("mul", c["group"], width)

    def row(base: str, region: str, block: str) -> str:
        """The address of a block's row in a region."""
        return w.offset(base, w.arithmetic("mul", block, c[f"{region}_stride"]))

    with w.loop("0", c["parts"]) as k, _turns(w, c, tables["counters"], k, advance) as start:
        # results stay in scratch, or move on through an array of the caller
        moved = w.offset(tables["o"], w.arithmetic("mul", w.arithmetic("sdiv", start, width), c["o_advance"]))

        def rows(block: str, moved: str = moved) -> list[str]:
            """The addresses of a block's rows in all regions, and in the outputs."""
            return [*(row(tables[region], region, block) for region in REGIONS), row(moved, "o", block)]

        rest = w.arithmetic("add", w.arithmetic("sub", c["last"], start), width - 1)
        blocks = w.do(f"call i64 @llvm.smin.i64(i64 {w.arithmetic('sdiv', rest, width)}, i64 {c['group']})")
        with w.loop("0", blocks) as block:
            state = w.arithmetic("add", start, w.arithmetic("mul", block, width))
            arguments = f"ptr {tables['inputs']}, i64 {c['n_inputs']}, i64 {state}, i64 {final}"
            w.put(f"call void @gather({arguments}, ptr %context, i64 {block})")
        _steps(w, tables["steps"], c["n_steps"], blocks, rows)
        with w.loop("0", blocks) as block:
            results = row(moved, "o", block)
            seen = w.offset(tables["counters"], 8)
            w.put(f"call void @look(ptr {results}, i64 {c['n_results']}, ptr {seen})")
            _rows(w, c, tables["outputs"], results, (start, block))
    return "declare i64 @llvm.smin.i64(i64, i64)\n" + w.function("drive", "ptr %context")


def _drive_one(width: int) -> str:
    """The same for one state, whose inputs are in all lanes: many calls one after the other, as along a motion."""
    w = AssemblyWriter(width)
    c = w.words("%context", CONTEXT)
    rows = [w.pointer(c[region]) for region in (*REGIONS, "o")]
    spread(w, w.pointer(c["inputs"]), c["n_inputs"])
    _steps(w, w.pointer(c["steps"]), c["n_steps"], "1", lambda _: rows)
    w.put(f"call void @scatter_some(ptr {w.pointer(c['outputs'])}, i64 {c['n_outputs']}, i64 0, ptr {rows[-1]}, i64 1)")
    return w.function("drive_one", "ptr %context")


@contextmanager
def _turns(w: AssemblyWriter, c: dict[str, str], counters: str, k: str, advance: str) -> Iterator[str]:
    """While there are groups that no other thread has taken in the k-th part from the own one: their first states."""
    place = w.arithmetic("add", c["own"], k)
    around = w.do(f"icmp slt i64 {place}, {c['parts']}")
    part = w.do(f"select i1 {around}, i64 {place}, i64 {w.arithmetic('sub', place, c['parts'])}")
    counter = w.offset(counters, w.arithmetic("mul", part, LINE))
    before = w.arithmetic("mul", part, c["turns"])
    with w.forever() as leave:
        turn = w.do(f"atomicrmw add ptr {counter}, i64 1 monotonic, align 8")
        start = w.arithmetic("mul", w.arithmetic("add", before, turn), advance)
        leave(w.do(f"icmp sge i64 {turn}, {c['turns']}"))
        leave(w.do(f"icmp sge i64 {start}, {c['last']}"))
        yield start


def _steps(w: AssemblyWriter, table: str, count: str, blocks: str, rows: Callable[[str], list[str]]) -> None:
    """Functions of the program (stage -1) get all rows of a vector, batches three places of their stage's."""
    with w.loop("0", count) as k:
        row = w.words(w.offset(table, w.arithmetic("mul", k, 8 * len(STEP))), STEP)
        function, extra = w.pointer(row["function"]), w.pointer(row["extra"])
        is_part = w.do(f"icmp slt i64 {row['stage']}, 0")
        with w.when(is_part), w.loop("0", blocks) as block:
            w.put(f"call void {function}({', '.join(f'ptr {x}' for x in rows(block))})")
        with w.when(w.do(f"xor i1 {is_part}, true")), w.loop("0", blocks) as block:
            base = scratch_row(w, row["stage"], block)
            a, b, c = (w.offset(base, row[n]) for n in "abc")
            w.put(f"call void {function}(ptr {a}, ptr {b}, ptr {c}, i64 {row['count']}, ptr {extra})")


def _rows(w: AssemblyWriter, c: dict[str, str], table: str, o: str, place: tuple[str, str]) -> None:
    """Outputs of one vector of states; the last one may be partial."""
    state = w.arithmetic("add", place[0], w.arithmetic("mul", place[1], w.width))
    some = w.arithmetic("sub", c["last"], state)
    full = w.do(f"icmp sge i64 {some}, {w.width}")
    arguments = f"ptr {table}, i64 {c['n_outputs']}, i64 {state}, ptr {o}"
    with w.when(full):
        w.put(f"call void @scatter({arguments})")
    with w.when(w.do(f"xor i1 {full}, true")):
        w.put(f"call void @scatter_some({arguments}, i64 {some})")
