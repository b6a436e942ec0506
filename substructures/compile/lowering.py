"""Program -> staged, split straight-line code: what is computed when, where every value lives. Knows no LLVM.

A program becomes four *stages*: operations of parameters only ("p"), then of positions and the time ("q"), of
velocities ("v"), of accelerations and inputs ("a"). A batch runs the leading stages whose inputs do not vary once, all
others for every state. Each stage is a list of *steps*: functions of about PART operations, and batches of sines,
cosines and library functions, which run as loops over contiguous arguments. Values that cross a function boundary live
in numbered vector places of the stage's scratch array; places are reused when their value has been read for the last
time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from substructures.compile.order import REGIONS, depth_first, sharp, stage_of
from substructures.compile.signs import negatives
from substructures.expr.construction.exact import MAX_EXPONENT
from substructures.expr.interpret import constant
from substructures.expr.operations import BINARY
from substructures.expr.program import Operation, Program, operands

#: operations in one function: LLVM's register allocation grows faster than linearly, its overhead per function is small
PART = 1000
#: larger exponents go through the C library: repeated products would lose more than a few ulp
MAX_PRODUCT = 8
#: evaluated in batches: sin and cos in vectors, the others by the C library
BATCHED = frozenset(("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log"))
LEAVES = frozenset(("sym", "int", "rat"))
#: (region, number of the vector in it); regions: those of the stages, "o" outputs
Place = tuple[str, int]


@dataclass(slots=True)
class StageFunction:
    """One function: operands to load, operations in order, values to store (one value at several places possible)."""

    operations: list[int]
    loads: dict[int, Place] = field(default_factory=dict)
    stores: list[tuple[int, Place]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class ProgramStep:
    """Call of a function of the program ("part", its number), or a batch of ``count`` vectors.

    sincos reads a, writes sines to b and cosines to c; library functions read a (and b) and write c.
    """

    function: str
    number: int = 0
    a: int = 0
    b: int = 0
    c: int = 0
    count: int = 0


@dataclass
class Stage:
    """Inputs (symbol numbers, at the places 0, 1, ...), steps, size of the scratch array in vectors, results."""

    region: str
    inputs: list[int] = field(default_factory=list)
    steps: list[ProgramStep] = field(default_factory=list)
    size: int = 0
    results: list[int] = field(default_factory=list)

    def new(self, count: int) -> int:
        """First of ``count`` new contiguous places."""
        self.size += count
        return self.size - count


@dataclass(frozen=True)
class Lowered:
    """Stages, and the functions of all. The stages' results are at the places 1, 2, ... of the region "o".

    ``sharp``: operations of which nothing may be contracted; ``minus``: those that are kept as their negatives.
    """

    stages: tuple[Stage, ...]
    parts: list[StageFunction]
    literals: dict[int, float]
    sharp: set[int]
    minus: set[int]


def lower(program: Program, names: Sequence[str], part: int = PART, fused: bool = True) -> Lowered:
    """Stages of the named outputs; ``fused``: for machines where a product and a sum are one instruction.

    Raises KeyError for an unknown name.
    """
    ops = program.operations
    entries = {e for name in names for e in program.outputs[name].entries}
    needed = depth_first(ops, sorted(entries))
    literals = {i: constant(ops[i]) for i in needed if ops[i][0] in ("int", "rat")}
    stage = stage_of(program, needed)
    # values that cross from one stage to another
    kept = {x for i in needed for x in operands(ops[i]) if stage[x] < stage[i]}
    stages, parts, place, number = list[Stage](), list[StageFunction](), dict[int, Place](), 1
    for k, region in enumerate(REGIONS):
        mine = [i for i in needed if stage[i] == k]
        # in the order of computation, so that results are written one after the other
        found = [i for i in mine if i in entries]
        builder = _Builder(ops, Stage(region, results=found), parts, place, literals)
        builder.build(mine, kept, {i: ("o", number + j) for j, i in enumerate(found)}, part)
        stages.append(builder.stage)
        place, number = builder.place, number + len(found)
    exact = sharp(ops, needed)
    return Lowered(tuple(stages), parts, literals, exact, negatives(ops, needed, entries | exact, fused))


def batch_name(operation: Operation) -> str | None:
    """Name of the batch that evaluates the operation, if any: sine and cosine share one."""
    op: str = operation[0]
    if op in BATCHED:
        return "sincos" if op in ("sin", "cos") else op
    return "pow" if op == "powi" and abs(operation[2]) > MAX_PRODUCT else None


@dataclass(slots=True)
class _Segment:
    """A future function and the batches to run after it."""

    compute: list[int]
    copies: list[tuple[int, Place]] = field(default_factory=list)
    steps: list[ProgramStep] = field(default_factory=list)


class _Builder:
    """Builds one stage. ``place``: where values live between functions, those of the stages before included."""

    def __init__(
        self,
        ops: Sequence[Operation],
        stage: Stage,
        parts: list[StageFunction],
        place: dict[int, Place],
        literals: dict[int, float],
    ) -> None:
        self.ops, self.stage, self.parts, self.place, self.literals = ops, stage, parts, dict(place), literals
        self.expiring: dict[int, list[int]] = {}

    def build(self, needed: list[int], kept: set[int], results: dict[int, Place], size: int) -> None:
        """``kept``: values that a later stage reads; ``results``: values with a place among the outputs."""
        for i in needed:
            if self.ops[i][0] == "sym":
                self.place[i] = (self.stage.region, self.stage.new(1))
                self.stage.inputs.append(self.ops[i][1])
        segments = list(self._segments(needed, size))
        computed = {i for segment in segments for i in segment.compute}
        segments[-1].copies += [(i, place) for i, place in results.items() if i not in computed]
        used = [self._used(segment) for segment in segments]
        last = {x: k for k, some in enumerate(used) for x in some} | dict.fromkeys(kept, len(segments))
        free: list[int] = []
        for k, segment in enumerate(segments):
            expired = self._function(segment, used[k], k, last, results, free)
            self.stage.steps += segment.steps
            free += expired

    def _segments(self, needed: Iterable[int], size: int) -> Iterator[_Segment]:
        for plain, batch in self._levels(needed):
            pieces = [plain[j : j + size] for j in range(0, len(plain), size)] or [[]]
            yield from (_Segment(piece) for piece in pieces[:-1])
            last = _Segment(pieces[-1])
            for name in dict.fromkeys(str(batch_name(self.ops[i])) for i in batch):
                self._batch(name, [i for i in batch if batch_name(self.ops[i]) == name], last)
            yield last

    def _levels(self, needed: Iterable[int]) -> list[tuple[list[int], list[int]]]:
        """(plain operations, batched operations) by the number of batches that must have run before."""
        level: dict[int, int] = {}
        levels: list[tuple[list[int], list[int]]] = [([], [])]
        for i in needed:
            operation = self.ops[i]
            if operation[0] in LEAVES:
                continue
            if operation[0] in BINARY:
                a, b = level.get(operation[1], 0), level.get(operation[2], 0)
                at, is_batched = a if a > b else b, False
            else:
                at = max([level.get(x, 0) for x in operands(operation)])
                is_batched = batch_name(operation) is not None
            level[i] = at + is_batched
            if level[i] == len(levels):
                levels.append(([], []))
            levels[at][is_batched].append(i)
        return levels

    def _batch(self, name: str, batch: list[int], segment: _Segment) -> None:
        """Contiguous places for arguments and results; the function before copies the arguments there."""
        region, stage = self.stage.region, self.stage
        if name == "sincos":
            arguments = list(dict.fromkeys(self.ops[i][1] for i in batch))
            count = len(arguments)
            a, b, c = (stage.new(count) for _ in range(3))
            at = {x: j for j, x in enumerate(arguments)}
            self.place |= {i: (region, (b if self.ops[i][0] == "sin" else c) + at[self.ops[i][1]]) for i in batch}
        else:
            count = len(batch)
            arguments = [self.ops[i][1] for i in batch]
            a, b, c = (stage.new(count) for _ in range(3))
            self.place |= {i: (region, c + j) for j, i in enumerate(batch)}
            if name == "atan2":
                segment.copies += [(self.ops[i][2], (region, b + j)) for j, i in enumerate(batch)]
            elif name == "pow":
                segment.copies += [(self._exponent(self.ops[i][2]), (region, b + j)) for j, i in enumerate(batch)]
        segment.copies += [(x, (region, a + j)) for j, x in enumerate(arguments)]
        segment.steps.append(ProgramStep(name, 0, a, b, c, count))

    def _exponent(self, exponent: int) -> int:
        """A literal beyond the numbers of the operations."""
        number = len(self.ops) + MAX_EXPONENT + exponent
        self.literals[number] = float(exponent)
        return number

    def _used(self, segment: _Segment) -> set[int]:
        """What a segment needs of others, and of itself."""
        found = {x for x, _ in segment.copies}
        return found.union(*[operands(self.ops[i]) for i in segment.compute])

    def _function(
        self,
        segment: _Segment,
        used: set[int],
        k: int,
        last: dict[int, int],
        results: dict[int, Place],
        free: list[int],
    ) -> list[int]:
        """Adds the function of a segment; returns the places that are free after it."""
        if not segment.compute and not segment.copies:
            return []
        part = StageFunction(segment.compute, stores=list(segment.copies))
        outside = used.difference(segment.compute, self.literals)
        part.loads = {x: self.place[x] for x in outside}
        for i in segment.compute:
            if i in results:
                part.stores.append((i, results[i]))
            if last.get(i, k) > k:
                self.place[i] = (self.stage.region, free.pop() if free else self.stage.new(1))
                part.stores.append((i, self.place[i]))
                self.expiring.setdefault(last[i], []).append(self.place[i][1])
        self.stage.steps.append(ProgramStep("part", len(self.parts)))
        self.parts.append(part)
        return self.expiring.pop(k, [])
