"""LLVM assembly of embedded Runge-Kutta methods that choose their steps, around the driver of kernels.

Step sizes are those of E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I, II.4 and II.10
(DOP853), as SciPy has them: the same steps, but for the order of sums.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.compile.assembler import AssemblyWriter, attributes, literal
from substructures.compile.pressing import pressing
from substructures.compile.runtime import CONTEXT
from substructures.compile.saddle import saddle_point
from substructures.compile.tables import tables_at

#: words of a run: addresses, sizes, and how many steps are tried at most
RUN = (
    *("calls", "n_calls", "time", "state", "written", "power", "n_copied", "n_written", "size", "rows"),
    *("pow", "numbers", "y", "stages", "new", "steps", "saddle", "tables", "n_tables", "most"),
)
#: squares of the two errors, summed up
SUMS = ("first", "second")
#: doubles that are read and written: where the run is, its next step, and what it may do
NUMBERS = ("t", "h", "end", "longest", "relative", "absolute", *SUMS)
#: words behind them: accepted steps of this call, evaluations, RUNNING or how it ended, a step was refused, f is known
WORDS = ("accepted", "evaluations", "status", "refused", "begun")
RUNNING, FAILED, FINISHED = 0, 1, 2
#: of a row of steps, before the state: time, and evaluations up to there
HEAD = 2
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0


@dataclass(frozen=True)
class Tableau:
    """x_new = x + h sum_j b_j k_j, k_s = f(t + c_s h, x + h sum_j a_sj k_j); k behind the last is f at the new state.

    ``e``, ``e3``: estimates of the error h sum_j e_j k_j; the second one, zeros for most, corrects the size of the
    first: |e|^2 / sqrt(|e|^2 + 0.01 |e3|^2). A step changes by the power ``exponent`` of the error.
    """

    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    c: tuple[float, ...]
    e: tuple[float, ...]
    e3: tuple[float, ...]
    exponent: float

    @property
    def stages(self) -> int:
        """Evaluations of a step."""
        return len(self.b)


def stepping(tableau: Tableau, width: int) -> str:
    """The module: advance, which tries ``most`` steps of a run (words RUN) and writes those that are accepted."""
    declared = "declare double @llvm.fabs.f64(double)\ndeclare double @llvm.sqrt.f64(double)\n"
    called = pressing(width) + saddle_point(width) + tables_at(width) + _rates(width)
    return declared + called + _Advance(tableau, width).text() + attributes(width)


def _rates(width: int) -> str:
    """x' of (t, x): numbers of x behind these, what the calls of a run and its saddle point write, and the power.
    Tables of the time come first.
    """
    w = AssemblyWriter(width)
    c = w.words("%run", RUN)
    at = {name: w.pointer(c[name]) for name in ("calls", "time", "state", "written", "power")}
    w.put(f"store double %t, ptr {at['time']}, align 8")
    width_of_x = w.arithmetic("add", c["n_copied"], c["n_written"])
    w.copy("%x", at["state"], width_of_x)
    w.put(f"call void @tables_at(ptr {w.pointer(c['tables'])}, i64 {c['n_tables']}, double %t)")
    with w.loop("0", c["n_calls"]) as k:
        words = w.words(w.offset(at["calls"], w.arithmetic("mul", k, 16)), ("drive", "context"))
        drive, context = w.pointer(words["drive"]), w.pointer(words["context"])
        place = w.offset(context, CONTEXT.index("counters"), "i64")
        w.put(f"store i64 0, ptr {w.pointer(w.do(f'load i64, ptr {place}, align 8'))}, align 8")
        w.put(f"call void {drive}(ptr {context})")
    with w.when(w.do(f"icmp ne i64 {c['saddle']}, 0")):
        w.put(f"call void @saddle_point(ptr {w.pointer(c['saddle'])}, ptr {at['written']})")
    w.copy(w.offset("%x", c["n_copied"], "double"), "%f", c["n_copied"])
    w.copy(at["written"], w.offset("%f", c["n_copied"], "double"), c["n_written"])
    w.copy(at["power"], w.offset("%f", width_of_x, "double"), w.arithmetic("sub", c["size"], width_of_x))
    return w.function("rates", "ptr %run, double %t, ptr %x, ptr %f")


class _Advance:
    """Writes the loop over steps. What lives from one step to the next is in memory."""

    def __init__(self, tableau: Tableau, width: int) -> None:
        self.tableau, self.w = tableau, AssemblyWriter(width)
        w = self.w
        self.c = w.words("%run", RUN)
        self.numbers = w.pointer(self.c["numbers"])
        self.y, self.new, self.steps, k = (w.pointer(self.c[name]) for name in ("y", "new", "steps", "stages"))
        row = w.arithmetic("shl", self.c["rows"], 3)
        self.k = [w.offset(k, w.arithmetic("mul", row, s)) for s in range(tableau.stages + 1)]

    def text(self) -> str:
        """The function."""
        w = self.w
        with w.when(w.do(f"icmp eq i64 {self._word('begun')}, 0")):
            self._set_word("begun", "1")
            self._count(1)
            self._rates(self._number("t"), self.y, self.k[0])
        with w.loop("0", self.c["most"]), w.when(w.do(f"icmp eq i64 {self._word('status')}, {RUNNING}")):
            self._try()
        return w.function("advance", "ptr %run")

    def _try(self) -> None:
        """One step from t, which is accepted or made smaller."""
        w, t, h = self.w, self._number("t"), self._number("h")
        refused = w.do(f"icmp ne i64 {self._word('refused')}, 0")
        least = self._resolution(t)
        longest = self._number("longest")
        bounded = self._least(self._most(h, least), longest)
        h = w.do(f"select i1 {refused}, double {h}, double {bounded}")
        small = w.do(f"fcmp olt double {h}, {least}")
        with w.when(small):
            self._set_word("status", str(FAILED))
        with w.when(w.do(f"xor i1 {small}, true")):
            end = self._number("end")
            new = self._least(self._real("fadd", t, h), end)
            h = self._real("fsub", new, t)
            self._stages(t, new, h)
            self._decide(new, end, h, refused, self._error(h))

    def _resolution(self, t: str) -> str:
        """Ten times the distance of t from the next number."""
        w = self.w
        plain = self._real("fadd", t, self._literal(0.0))
        bits = w.do(f"bitcast double {plain} to i64")
        change = w.do(f"select i1 {w.do(f'icmp slt i64 {bits}, 0')}, i64 -1, i64 1")
        following = w.do(f"bitcast i64 {w.arithmetic('add', bits, change)} to double")
        return self._real("fmul", self._literal(10.0), self._real("fsub", following, plain))

    def _stages(self, t: str, new: str, h: str) -> None:
        """All k, and the new state."""
        tableau = self.tableau
        for s in range(1, tableau.stages):
            self._sum(tableau.a[s][:s], h)
            self._rates(self._real("fadd", t, self._real("fmul", self._literal(tableau.c[s]), h)), self.new, self.k[s])
        self._sum(tableau.b, h)
        self._rates(new, self.new, self.k[-1])
        self._count(tableau.stages)

    def _sum(self, factors: Sequence[float], h: str) -> None:
        """new = y + h sum_j factor_j k_j, in vectors: rows are filled up."""
        w = self.w
        size = 8 * w.width
        step = w.do(f"insertelement {w.kind} undef, double {h}, i32 0")
        mask = f"<{w.width} x i32> zeroinitializer"
        step = w.do(f"shufflevector {w.kind} {step}, {w.kind} undef, {mask}")
        with w.loop("0", self.c["rows"], w.width) as i:
            total = ""
            for factor, k in zip(factors, self.k, strict=False):
                if not factor:
                    continue
                x = w.do(f"load {w.kind}, ptr {w.offset(k, i, 'double')}, align {size}")
                term = w.fused("fmul", x, literal(factor, w.width))
                total = w.fused("fadd", total, term) if total else term
            y = w.do(f"load {w.kind}, ptr {w.offset(self.y, i, 'double')}, align {size}")
            y = w.fused("fadd", y, w.fused("fmul", step, total))
            w.put(f"store {w.kind} {y}, ptr {w.offset(self.new, i, 'double')}, align {size}")

    def _error(self, h: str) -> str:
        """The norm of the error in units of the tolerance."""
        w = self.w
        for name in SUMS:
            self._set_number(name, self._literal(0.0))
        with w.loop("0", self.c["size"]) as i:
            sizes = [
                w.do(f"call double @llvm.fabs.f64(double {self._load(w.offset(x, i, 'double'))})")
                for x in (self.y, self.new)
            ]
            # the new one where that is no number
            larger = self._most(*sizes)
            scale = self._real("fadd", self._number("absolute"), self._real("fmul", larger, self._number("relative")))
            for name, factors in zip(SUMS, (self.tableau.e, self.tableau.e3), strict=True):
                total = self._literal(0.0)
                for factor, k in zip(factors, self.k, strict=True):
                    if factor:
                        x = self._load(w.offset(k, i, "double"))
                        total = self._real("fadd", total, self._real("fmul", x, self._literal(factor)))
                ratio = self._real("fdiv", total, scale)
                self._set_number(name, self._real("fadd", self._number(name), self._real("fmul", ratio, ratio)))
        first, second = map(self._number, SUMS)
        both = self._real("fadd", first, self._real("fmul", self._literal(0.01), second))
        count = w.do(f"sitofp i64 {self.c['size']} to double")
        root = w.do(f"call double @llvm.sqrt.f64(double {self._real('fmul', both, count)})")
        norm = self._real("fdiv", self._real("fmul", h, first), root)
        none = w.do(f"fcmp oeq double {both}, 0.0")
        return w.do(f"select i1 {none}, double 0.0, double {norm}")

    def _decide(self, new: str, end: str, h: str, refused: str, error: str) -> None:
        w = self.w
        exponent = self._literal(self.tableau.exponent)
        power = w.do(f"call double {w.pointer(self.c['pow'])}(double {error}, double {exponent})")
        factor = self._real("fmul", self._literal(SAFETY), power)
        good = w.do(f"fcmp olt double {error}, 1.0")
        with w.when(good):
            most = w.do(f"select i1 {refused}, double 1.0, double {self._literal(MOST)}")
            self._set_number("h", self._real("fmul", h, self._least(factor, most)))
            self._set_number("t", new)
            self._set_word("refused", "0")
            self._accept(new)
            with w.when(w.do(f"fcmp oge double {new}, {end}")):
                self._set_word("status", str(FINISHED))
        with w.when(w.do(f"xor i1 {good}, true")):
            # the least also where the error is no number
            self._set_number("h", self._real("fmul", h, self._most(factor, self._literal(LEAST))))
            self._set_word("refused", "1")

    def _accept(self, new: str) -> None:
        """The new state is the state; a row of the steps."""
        w, accepted = self.w, self._word("accepted")
        row = w.offset(self.steps, w.arithmetic("mul", accepted, w.arithmetic("add", self.c["size"], HEAD)), "double")
        self._store(new, row)
        self._store(w.do(f"sitofp i64 {self._word('evaluations')} to double"), w.offset(row, 1, "double"))
        for source, target in ((self.k[-1], self.k[0]), (self.new, self.y), (self.new, w.offset(row, HEAD, "double"))):
            w.copy(source, target, self.c["size"])
        self._set_word("accepted", w.arithmetic("add", accepted, 1))

    def _rates(self, t: str, x: str, f: str) -> None:
        self.w.put(f"call void @rates(ptr %run, double {t}, ptr {x}, ptr {f})")

    def _count(self, evaluations: int) -> None:
        self._set_word("evaluations", self.w.arithmetic("add", self._word("evaluations"), evaluations))

    def _least(self, a: str, b: str) -> str:
        return self.w.do(f"select i1 {self.w.do(f'fcmp ogt double {a}, {b}')}, double {b}, double {a}")

    def _most(self, a: str, b: str) -> str:
        """b where a is no number."""
        return self.w.do(f"select i1 {self.w.do(f'fcmp ogt double {a}, {b}')}, double {a}, double {b}")

    def _real(self, op: str, a: str, b: str) -> str:
        return self.w.do(f"{op} double {a}, {b}")

    def _literal(self, value: float) -> str:
        return literal(value, 1)[1:-1].removeprefix("double ")

    def _load(self, place: str) -> str:
        return self.w.do(f"load double, ptr {place}, align 8")

    def _store(self, value: str, place: str) -> None:
        self.w.put(f"store double {value}, ptr {place}, align 8")

    def _number(self, name: str) -> str:
        return self._load(self.w.offset(self.numbers, NUMBERS.index(name), "double"))

    def _set_number(self, name: str, value: str) -> None:
        self._store(value, self.w.offset(self.numbers, NUMBERS.index(name), "double"))

    def _place(self, name: str) -> str:
        return self.w.offset(self.numbers, len(NUMBERS) + WORDS.index(name), "i64")

    def _word(self, name: str) -> str:
        return self.w.do(f"load i64, ptr {self._place(name)}, align 8")

    def _set_word(self, name: str, value: str) -> None:
        self.w.put(f"store i64 {value}, ptr {self._place(name)}, align 8")
