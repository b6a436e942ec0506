"""C99: ``void model(const double *x, double *metric, ...)``, complete arrays in row-major order."""

from __future__ import annotations

from collections.abc import Mapping
from math import prod
from typing import ClassVar

from substructures.printers.code import Code, indented
from substructures.printers.language import Listing, Piece
from substructures.printers.symmetry import assignments

_SIGN = "static double sign_of(double v) { return v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : v; }"


class C(Code):
    """C99, needs the mathematical library only."""

    media = "text/x-c; charset=utf-8"
    mark = "//"
    infinity = "HUGE_VAL"
    functions: ClassVar[Mapping[str, str]] = {"abs": "fabs", "sign": "sign_of"}

    def pi(self) -> Piece:
        """pi as a double: C99 has no constant for it."""
        return Piece("3.141592653589793")

    def power(self, a: Piece, n: int) -> Piece:
        """``pow``, which is exact for integer exponents of small numbers."""
        return Piece(f"pow({a.text}, {float(n)!r})")

    def render(self, listing: Listing, name: str) -> str:
        """A source file with one function; arrays are zeroed first where elements are zero."""
        head = ["// C99. Inputs and outputs are described here by the names that the user gave them."]
        head += [*self.comments(name), "#include <math.h>", "#include <stddef.h>", ""]
        if any(op[0] == "sign" for op in self.program.operations):
            head += [_SIGN, ""]
        arguments = ", ".join(["const double *x", *(f"double *{v}" for v in self.variables.values())])
        body = ["(void)x;"]
        body += [f"const double t{n} = {text};" for n, text in listing.temporaries]
        for output in self.program.outputs:
            body += self._fill(output, listing.entries[output])
        return "\n".join([*head, f"void {self.function_name(name)}({arguments}) {{", *indented(body), "}"]) + "\n"

    def _fill(self, output: str, texts: tuple[str, ...]) -> list[str]:
        array, v = self.program.outputs[output], self.variables[output]
        size = prod(array.shape)
        pairs = list(assignments(array, texts, lambda index: f"{v}[{flat(index, array.shape)}]"))
        lines = [f"for (size_t i = 0; i < {size}; ++i) {v}[i] = 0.0;"] if len(pairs) < size else []
        lines += [f"{element} = {text};" for element, text in pairs]
        return lines


def flat(index: tuple[int, ...], shape: tuple[int, ...]) -> int:
    """Position in row-major order."""
    result = 0
    for i, size in zip(index, shape, strict=True):
        result = result * size + i
    return result
