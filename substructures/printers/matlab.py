"""MATLAB (and Octave): ``[metric, ...] = model(x)``.

Roots and logarithms of negative numbers, and arcs of numbers beyond 1, are NaN as everywhere, not complex.
"""

from __future__ import annotations

from substructures.expr.program import Output
from substructures.printers.code import REAL, Code, indented
from substructures.printers.language import Listing, Piece
from substructures.printers.symmetry import assignments


class Matlab(Code):
    """A function file. Vectors are columns."""

    media = "text/x-matlab; charset=utf-8"
    mark = "%"
    infinity = "Inf"
    first = 1
    end = "end"
    opening, closing = "(", ")"

    def symbol(self, n: int) -> Piece:
        """An element of the argument x, counted from 1."""
        return Piece(f"x{self.opening}{n + 1}{self.closing}")

    def head(self, name: str) -> list[str]:
        """First lines: signature and description."""
        results = ", ".join(self.variables.values())
        return [f"function [{results}] = {self.function_name(name)}(x)", *self.comments(name, "    ")]

    def tail(self) -> list[str]:
        """Last lines: the end, and the functions that are NaN where MATLAB's own are complex."""
        lines = ["end"]
        for f in self.partial():
            # 0/true is 0 and 0/false is NaN
            lines += ["", f"function y = real_{f}(x)", f"    y = {f}(x + 0/({REAL[f]}));", "end"]
        return lines

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function; by its real branch where the argument is no constant."""
        return self.real_call(op, args)

    def dimensions(self, shape: tuple[int, ...]) -> str:
        """Arguments of zeros()."""
        return ", ".join(map(str, (*shape, *(1,) * (2 - len(shape)))))

    def render(self, listing: Listing, name: str) -> str:
        """A function file."""
        body = [f"t{n} = {text};" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            body += self._fill(self.variables[output], array, listing.entries[output])
        return "\n".join([*self.head(name), *indented(body), *self.tail()]) + "\n"

    def _fill(self, v: str, array: Output, texts: tuple[str, ...]) -> list[str]:
        if not array.shape:
            return [f"{v} = {texts[0] if texts else '0.0'};"]
        lines = [f"{v} = zeros({self.dimensions(array.shape)});"]
        pairs = assignments(
            array, texts, lambda index: f"{v}{self.opening}{', '.join(str(i + 1) for i in index)}{self.closing}"
        )
        lines += [f"{element} = {text};" for element, text in pairs]
        return lines
