"""LLVM assembly of what contacts press with: columns of their forces beside the rows that they keep.

Of contacts with rows G (k, 3, n), one along the normal and two tangents, and velocities v = G q' + G_0:

    F = G,    F_N = G_N - mu d . G_T    with    d = v_T / max(|v_T|, v_0), or a way that is given

Where rows depend on each other, columns are F^T D^-1 G S G_r^T of the independent ones, r, in place of F_r^T.
"""

from __future__ import annotations

from substructures.compile.assembler import AssemblyWriter

#: words of contacts: addresses of G (3 k, n), G_0 (3 k,), q' (n,), of mu, v_0 and the way given (k, 4), of F (3 k, n),
#: of the numbers of the m rows that are held, of 1/D (m,), S (n,), of m shares (m, r) of each independent one, of
#: columns (r, n) and the numbers of their rows; n, k, m, 0 where none depends on others, and r
PRESSING = (
    *("jacobian", "rate", "velocities", "laws", "forces", "held", "inverse", "scales", "shares", "columns", "rows"),
    *("n", "contacts", "m", "r"),
)


def pressing(width: int) -> str:
    """The function pressing of a table of words PRESSING."""
    return _Pressing(width).text()


class _Pressing:
    def __init__(self, width: int) -> None:
        self.w = w = AssemblyWriter(width)
        c = w.words("%table", PRESSING)
        self.at = {name: w.pointer(c[name]) for name in PRESSING[:11]}
        self.n, self.contacts, self.m, self.r = (c[name] for name in PRESSING[11:])
        self.sums = [w.do("alloca double, align 8") for _ in range(2)]

    def text(self) -> str:
        """The function."""
        w = self.w
        with w.loop("0", self.contacts) as i:
            self._forces(i)
        is_alone = w.do(f"icmp eq i64 {self.m}, 0")
        with w.loop("0", self.r) as j, w.when(is_alone), w.loop("0", self.n) as a:
            value = self._load(self._row("forces", self._number("rows", j), a))
            self._store(value, self._row("columns", j, a))
        with w.when(w.do(f"xor i1 {is_alone}, true")), w.loop("0", self.r) as j:
            self._blend(j)
        return w.function("pressing", "ptr %table")

    def _forces(self, i: str) -> None:
        """The rows of F of a contact."""
        w = self.w
        first = w.arithmetic("mul", i, 3)
        rows = [w.arithmetic("add", first, k) for k in range(3)]
        law = w.offset(self.at["laws"], w.arithmetic("mul", i, 4), "double")
        mu, slow, *given = (self._load(w.offset(law, k, "double")) for k in range(4))
        for row, place in zip(rows[1:], self.sums, strict=True):
            self._store(self._load(w.offset(self.at["rate"], row, "double")), place)
            with w.loop("0", self.n) as a:
                velocity = self._load(w.offset(self.at["velocities"], a, "double"))
                self._add(place, self._load(self._row("jacobian", row, a)), velocity)
        v = [self._load(place) for place in self.sums]
        squares = [self._real("fmul", x, x) for x in v]
        speed = w.do(f"call double @llvm.sqrt.f64(double {self._real('fadd', *squares)})")
        is_fast = w.do(f"fcmp ogt double {speed}, {slow}")
        most = w.do(f"select i1 {is_fast}, double {speed}, double {slow}")
        turns = w.do(f"fcmp ogt double {slow}, 0.0")
        drags = list[str]()
        for x, way in zip(v, given, strict=True):
            d = w.do(f"select i1 {turns}, double {self._real('fdiv', x, most)}, double {way}")
            drags.append(self._real("fmul", mu, d))
        with w.loop("0", self.n) as a:
            normal, *across = (self._load(self._row("jacobian", row, a)) for row in rows)
            for row, x, drag in zip(rows[1:], across, drags, strict=True):
                self._store(x, self._row("forces", row, a))
                normal = self._real("fsub", normal, self._real("fmul", drag, x))
            self._store(normal, self._row("forces", rows[0], a))

    def _blend(self, j: str) -> None:
        """A column of all that is held, with its shares."""
        w, place = self.w, self.sums[0]
        own = self._number("rows", j)
        with w.loop("0", self.n) as a:
            self._store("0.0", self._row("columns", j, a))
        with w.loop("0", self.m) as i:
            row = self._number("held", i)
            self._store("0.0", place)
            with w.loop("0", self.n) as a:
                scaled = self._real(
                    "fmul",
                    self._load(self._row("jacobian", own, a)),
                    self._load(w.offset(self.at["scales"], a, "double")),
                )
                self._add(place, self._load(self._row("jacobian", row, a)), scaled)
            share = self._real("fmul", self._load(place), self._load(w.offset(self.at["inverse"], i, "double")))
            width = w.arithmetic("add", w.arithmetic("mul", i, self.r), j)
            self._store(share, w.offset(self.at["shares"], width, "double"))
            with w.loop("0", self.n) as a:
                self._add(self._row("columns", j, a), share, self._load(self._row("forces", row, a)))

    def _row(self, name: str, i: str, a: str) -> str:
        """Of a matrix with n columns."""
        w = self.w
        return w.offset(self.at[name], w.arithmetic("add", w.arithmetic("mul", i, self.n), a), "double")

    def _number(self, name: str, k: str) -> str:
        return self.w.do(f"load i64, ptr {self.w.offset(self.at[name], k, 'i64')}, align 8")

    def _add(self, place: str, a: str, b: str) -> None:
        """place += a b."""
        self._store(self._real("fadd", self._load(place), self._real("fmul", a, b)), place)

    def _real(self, op: str, a: str, b: str) -> str:
        return self.w.do(f"{op} double {a}, {b}")

    def _load(self, place: str) -> str:
        return self.w.do(f"load double, ptr {place}, align 8")

    def _store(self, value: str, place: str) -> None:
        self.w.put(f"store double {value}, ptr {place}, align 8")
