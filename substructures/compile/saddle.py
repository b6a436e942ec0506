"""LLVM assembly that solves the equations of motion with closures by Gauss's elimination with partial pivoting.

    [g G^T; G 0] [q''; -lambda] = [Q - Gamma q'q'; -c]

for independent rows of G and c, and the columns of the coordinates that move: all others have q'' = 0. It is backward
stable also where g alone is singular, as the LU factors of LAPACK are (N. J. Higham, Accuracy and Stability of
Numerical Algorithms, 2002, chapter 9); without a solution q'' is not finite.

Contacts have other columns C than G^T beside their rows (see :mod:`.pressing`). The power q' . C y of the forces of
rows that move counts, where that is wanted.
"""

from __future__ import annotations

from contextlib import AbstractContextManager

from substructures.compile.assembler import AssemblyWriter

#: words of a saddle point: addresses of g (n, n), G (m, n), c (m,), Q, Gamma q'q' (n,), of the numbers of the r rows
#: and of the k coordinates that move, and of a matrix (k + r, stride), whose rows are filled up to whole vectors;
#: columns C (r, n) of contacts, y (r,); q' and the power that theirs is added to, or 0; n, k, k + r, stride, the place
#: of q'' in what is written, and the table of contacts, or 0
SADDLE = (
    *("metric", "jacobian", "acceleration", "forces", "bias", "rows", "moving", "matrix"),
    *("columns", "pressed", "velocities", "power"),
    *("n", "free", "size", "stride", "first", "contacts"),
)


def saddle_point(width: int) -> str:
    """The function saddle_point of a table of words SADDLE and of where q'' (n,) is written."""
    return _SaddlePoint(width).text()


class _SaddlePoint:
    def __init__(self, width: int) -> None:
        self.w = w = AssemblyWriter(width)
        c = w.words("%table", SADDLE)
        self.at = {name: w.pointer(c[name]) for name in SADDLE[:12]}
        self.n, self.free, self.size, self.stride, self.first, self.contacts = (c[name] for name in SADDLE[12:])
        self.press, self.works = (w.do(f"icmp ne i64 {word}, 0") for word in (self.contacts, c["power"]))
        #: where the largest number of a column is
        self.place = w.do("alloca i64, align 8")

    def text(self) -> str:
        """The function."""
        w = self.w
        with w.when(self.press):
            w.put(f"call void @pressing(ptr {w.pointer(self.contacts)})")
        self._fill()
        with w.loop("0", self.size) as k:
            self._exchange(k)
            first = w.arithmetic("and", k, -w.width)
            pivot, following = self._load(self._entry(k, k)), w.arithmetic("add", k, 1)
            with w.loop(following, self.size) as i:
                factor = w.do(f"fdiv double {self._load(self._entry(i, k))}, {pivot}")
                self._subtract(i, k, factor, first)
        self._substitute()
        found = w.offset("%x", self.first, "double")
        with w.loop("0", self.n) as i:
            self._store("0.0", w.offset(found, i, "double"))
        with w.loop("0", self.free) as i:
            self._store(self._load(self._entry(i, self.size)), w.offset(found, self._number("moving", i), "double"))
        with w.when(self.works), w.loop(self.free, self.size) as i:
            self._work(i)
        return w.function("saddle_point", "ptr %table, ptr %x")

    def _fill(self) -> None:
        """The matrix, and the right-hand side in the column behind it."""
        w, at = self.w, self.at
        with w.loop("0", self.free) as i:
            a = self._number("moving", i)
            with w.loop("0", self.free) as j:
                self._store(self._load(self._element(at["metric"], a, self._number("moving", j))), self._entry(i, j))
            Q, bias = (self._load(w.offset(at[name], a, "double")) for name in ("forces", "bias"))
            self._store(w.do(f"fsub double {Q}, {bias}"), self._entry(i, self.size))
        with w.loop(self.free, self.size) as i:
            kept = w.arithmetic("sub", i, self.free)
            row = self._number("rows", kept)
            with w.loop("0", self.free) as j:
                a = self._number("moving", j)
                self._store(self._load(self._element(at["jacobian"], row, a)), self._entry(i, j))
                self._store(self._load(self._column(kept, row, a)), self._entry(j, i))
            with w.loop(self.free, self.size) as j:
                self._store("0.0", self._entry(i, j))
            c = self._load(w.offset(at["acceleration"], row, "double"))
            self._store(w.do(f"fneg double {c}"), self._entry(i, self.size))

    def _work(self, i: str) -> None:
        """y of a column, which is that of -y in the matrix, and the power of its force."""
        w, at = self.w, self.at
        kept = w.arithmetic("sub", i, self.free)
        row = self._number("rows", kept)
        y = w.do(f"fneg double {self._load(self._entry(i, self.size))}")
        self._store(y, w.offset(at["pressed"], kept, "double"))
        with w.loop("0", self.n) as a:
            velocity = self._load(w.offset(at["velocities"], a, "double"))
            force = w.do(f"fmul double {self._load(self._column(kept, row, a))}, {y}")
            power = w.do(f"fmul double {force}, {velocity}")
            self._store(w.do(f"fadd double {self._load(at['power'])}, {power}"), at["power"])

    def _exchange(self, k: str) -> None:
        """The largest number of what is left of column k comes to row k."""
        w = self.w
        w.put(f"store i64 {k}, ptr {self.place}, align 8")
        with w.loop(w.arithmetic("add", k, 1), self.size) as i:
            sizes = [self._magnitude(self._entry(row, k)) for row in (i, self._pivot())]
            with w.when(w.do(f"fcmp ogt double {sizes[0]}, {sizes[1]}")):
                w.put(f"store i64 {i}, ptr {self.place}, align 8")
        largest = self._pivot()
        with w.when(w.do(f"icmp ne i64 {largest}, {k}")), self._vectors(w.arithmetic("and", k, -w.width)) as j:
            places = [self._entry(row, j) for row in (k, largest)]
            numbers = [self._vector(place) for place in places]
            for number, place in zip(numbers, reversed(places), strict=True):
                self._put(number, place)

    def _subtract(self, i: str, k: str, factor: str, first: str) -> None:
        """Row i less so many times row k; what is before column k is not needed any more."""
        w = self.w
        one = w.do(f"insertelement {w.kind} undef, double {factor}, i32 0")
        factors = w.do(f"shufflevector {w.kind} {one}, {w.kind} undef, <{w.width} x i32> zeroinitializer")
        with self._vectors(first) as j:
            product = w.fused("fmul", factors, self._vector(self._entry(k, j)))
            place = self._entry(i, j)
            self._put(w.fused("fsub", self._vector(place), product), place)

    def _substitute(self) -> None:
        """x_i = (b_i - sum_(j > i) u_ij x_j) / u_ii from the last to the first, in place of b."""
        w = self.w
        last = w.arithmetic("sub", self.size, 1)
        with w.loop("0", self.size) as k:
            i = w.arithmetic("sub", last, k)
            place = self._entry(i, self.size)
            with w.loop(w.arithmetic("add", i, 1), self.size) as j:
                u, x = self._load(self._entry(i, j)), self._load(self._entry(j, self.size))
                product = w.do(f"fmul contract double {u}, {x}")
                self._store(w.do(f"fsub contract double {self._load(place)}, {product}"), place)
            self._store(w.do(f"fdiv double {self._load(place)}, {self._load(self._entry(i, i))}"), place)

    def _vectors(self, first: str) -> AbstractContextManager[str]:
        """Columns from ``first`` on, a vector at a time."""
        return self.w.loop(first, self.stride, self.w.width)

    def _entry(self, i: str, j: str) -> str:
        w = self.w
        return w.offset(self.at["matrix"], w.arithmetic("add", w.arithmetic("mul", i, self.stride), j), "double")

    def _column(self, kept: str, row: str, a: str) -> str:
        """Of C, or of G^T where there are no contacts."""
        own, other = self._element(self.at["jacobian"], row, a), self._element(self.at["columns"], kept, a)
        return self.w.do(f"select i1 {self.press}, ptr {other}, ptr {own}")

    def _element(self, base: str, i: str, j: str) -> str:
        """Of a matrix with n columns."""
        w = self.w
        return w.offset(base, w.arithmetic("add", w.arithmetic("mul", i, self.n), j), "double")

    def _number(self, name: str, k: str) -> str:
        """The k-th of the rows or of the coordinates."""
        return self.w.do(f"load i64, ptr {self.w.offset(self.at[name], k, 'i64')}, align 8")

    def _pivot(self) -> str:
        return self.w.do(f"load i64, ptr {self.place}, align 8")

    def _magnitude(self, place: str) -> str:
        return self.w.do(f"call double @llvm.fabs.f64(double {self._load(place)})")

    def _load(self, place: str) -> str:
        return self.w.do(f"load double, ptr {place}, align 8")

    def _store(self, value: str, place: str) -> None:
        self.w.put(f"store double {value}, ptr {place}, align 8")

    def _vector(self, place: str) -> str:
        return self.w.do(f"load {self.w.kind}, ptr {place}, align {8 * self.w.width}")

    def _put(self, value: str, place: str) -> None:
        self.w.put(f"store {self.w.kind} {value}, ptr {place}, align {8 * self.w.width}")
