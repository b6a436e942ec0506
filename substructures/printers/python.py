"""A Python module that needs numpy only: ``model(x) -> {"metric": array, ...}``."""

from __future__ import annotations

from substructures.printers.code import Code, indented
from substructures.printers.language import Listing, Piece
from substructures.printers.symmetry import assignments

_IMPORT = ['"""Generated code: numbers of a mechanism from its formulas."""', "", "import numpy as np", ""]
_READ = [
    "x = [x[name] for name in INPUTS] if isinstance(x, dict) else list(x)",
    "if len(x) != len(INPUTS):",
    '    raise ValueError(f"{len(INPUTS)} inputs expected, not {len(x)}")',
    "x = [np.asarray(v, dtype=float) for v in x]",
    "batch = np.broadcast_shapes(*(v.shape for v in x))",
]


class Python(Code):
    """Python; inputs may be arrays (batches), outputs have their shape in front."""

    media = "text/x-python; charset=utf-8"
    infinity = "np.inf"
    power_sign = "**"

    def pi(self) -> Piece:
        """The constant of numpy."""
        return Piece("np.pi")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function of numpy, some of which have longer names there."""
        names = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"}
        return Piece(f"np.{names.get(op, op)}({', '.join(a.text for a in args)})")

    def render(self, listing: Listing, name: str) -> str:
        """A module with one function, whose arrays have the axes of a batch first."""
        function = self.function_name(name)
        inputs = [f"    {s.name!a}," for s in self.program.symbols]
        lines = [*_IMPORT, *self.comments(name), "", "INPUTS = (", *inputs, ")", "", "", f"def {function}(x):"]
        lines.append(
            '    """Values of all outputs by name; x: values by position or by name, floats or arrays of one shape."""'
        )
        body = [f"t{n} = {text}" for n, text in listing.temporaries]
        for output in self.program.outputs:
            body += self._fill(output, listing.entries[output])
        pairs = ", ".join(f"{n!a}: {v}" for n, v in self.variables.items())
        lines += [*indented(_READ), '    with np.errstate(all="ignore"):', *indented(body or ["pass"], " " * 8)]
        return "\n".join([*lines, f"    return {{{pairs}}}"]) + "\n"

    def _fill(self, output: str, texts: tuple[str, ...]) -> list[str]:
        array, v = self.program.outputs[output], self.variables[output]
        lines = [f"{v} = np.zeros(batch + {array.shape!r})"]
        pairs = assignments(array, texts, lambda index: f"{v}[{', '.join(['...', *map(str, index)])}]")
        lines += [f"{element} = {text}" for element, text in pairs]
        return lines
