"""Piecewise polynomials of the time in machine code, whose values kernels read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from substructures.array import Array
from substructures.compile.assembler import AssemblyWriter
from substructures.compile.engine import address

#: words of a table: addresses of the beginnings of its pieces, of their coefficients and of its value; how many pieces
#: there are, how often these are halved until one is left, and numbers of a piece
TABLE = ("times", "coefficients", "value", "pieces", "halvings", "length")


class TimeTables:
    """Tables (times (m + 1,), coefficients (m, d + 1), highest power first, in the time from the beginning of a piece)
    whose values at the present time are written into ``values``, an array (1,) each.
    """

    def __init__(self, values: Sequence[Array], tables: Sequence[tuple[Array, Array]]) -> None:
        self.values, self._tables = values, tables
        self.words = np.zeros((len(tables), len(TABLE)), dtype=np.int64)
        for k, (times, _) in enumerate(tables):
            self.take(k, 0, len(times) - 1)

    def take(self, k: int, first: int, count: int) -> None:
        """Of table k so many pieces from one on, of which those at the ends go on beyond them."""
        times, coefficients = self._tables[k]
        length = coefficients.shape[1]
        at = [address(times) + 8 * first, address(coefficients) + 8 * first * length, address(self.values[k])]
        self.words[k] = [*at, count, count.bit_length(), length]


def tables_at(width: int) -> str:
    """The function tables_at of so many tables of words TABLE and the time: their values are written."""
    w = AssemblyWriter(width)
    low, high, sum_ = (w.do(f"alloca {kind}, align 8") for kind in ("i64", "i64", "double"))
    with w.loop("0", "%count") as k:
        c = w.words(w.offset("%tables", w.arithmetic("mul", k, len(TABLE)), "i64"), TABLE)
        times, coefficients = w.pointer(c["times"]), w.pointer(c["coefficients"])
        w.put(f"store i64 0, ptr {low}, align 8")
        w.put(f"store i64 {c['pieces']}, ptr {high}, align 8")
        with w.loop("0", c["halvings"]):
            both = [w.do(f"load i64, ptr {place}, align 8") for place in (low, high)]
            middle = w.arithmetic("lshr", w.arithmetic("add", *both), 1)
            is_begun = w.do(f"fcmp ole double {_load(w, w.offset(times, middle, 'double'))}, %t")
            w.put(f"store i64 {w.do(f'select i1 {is_begun}, i64 {middle}, i64 {both[0]}')}, ptr {low}, align 8")
            w.put(f"store i64 {w.do(f'select i1 {is_begun}, i64 {both[1]}, i64 {middle}')}, ptr {high}, align 8")
        piece = w.do(f"load i64, ptr {low}, align 8")
        x = w.do(f"fsub double %t, {_load(w, w.offset(times, piece, 'double'))}")
        first = w.arithmetic("mul", piece, c["length"])
        w.put(f"store double 0.0, ptr {sum_}, align 8")
        # Horner: s(t) = (... (c_0 x + c_1) x + ...) x + c_d with x = t - t_k
        with w.loop("0", c["length"]) as j:
            factor = _load(w, w.offset(coefficients, w.arithmetic("add", first, j), "double"))
            product = w.do(f"fmul double {_load(w, sum_)}, {x}")
            w.put(f"store double {w.do(f'fadd double {product}, {factor}')}, ptr {sum_}, align 8")
        w.put(f"store double {_load(w, sum_)}, ptr {w.pointer(c['value'])}, align 8")
    return w.function("tables_at", "ptr %tables, i64 %count, double %t")


def _load(w: AssemblyWriter, place: str) -> str:
    return w.do(f"load double, ptr {place}, align 8")
