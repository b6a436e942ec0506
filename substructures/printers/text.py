"""Plain text for people; formulas in the grammar of :mod:`substructures.expr.parse`."""

from __future__ import annotations

from functools import cached_property

from substructures.expr.program import Program
from substructures.printers.language import Language, Listing, Piece
from substructures.printers.names import comment, formula_name, prefix
from substructures.printers.symmetry import elements_rule


class Text(Language):
    """Text. Indices count from 1."""

    first = 1
    is_for_people = True

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self.names = [formula_name(s.name) for s in program.symbols]
        self.prefix = prefix(self.names)

    def symbol(self, n: int) -> Piece:
        """The user's name, as formulas write it."""
        return Piece(self.names[n])

    def temporary(self, n: int) -> Piece:
        """A prefix that no symbol has, with a number."""
        return Piece(f"{self.prefix}{n}")

    @cached_property
    def taken(self) -> frozenset[str]:
        """Names, and those within instances: c2 of an instance is not c2 = cos(q2), either."""
        return frozenset(x for s in self.program.symbols for x in (s.name, s.name.rpartition(".")[2]))

    def render(self, listing: Listing, name: str) -> str:
        """Lines ``name[indices] = formula``; comments say what symbols are and how symmetric elements follow."""
        lines = [f"# {comment(x)}" for x in (name, self.remark, *self.legend) if x]
        lines += [f"# {self.names[n]} is {s.kind} [{comment(s.unit)}]" for n, s in self.described]
        for name, text, note in listing.definitions:
            lines += [f"# {name} stands for {comment(note)}"] if note else []
            lines.append(f"{name} = {text}")
        lines += [f"{name} = {text}" for name, text in listing.abbreviations]
        lines += [f"{self.step(n).text} = {text}" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            title = comment(output)
            if array.shape:
                shape = " x ".join(map(str, array.shape))
                lines.append(f"# {title}: {shape}, indices from 1; {elements_rule(array, title)}")
            elif "[" in output:
                lines.append(f"# {title}: one element, indices from 1")
            for index, text in zip(array.index, listing.entries[output], strict=True):
                place = "[" + ", ".join(str(i + 1) for i in index) + "]" if index else ""
                lines.append(f"{title}{place} = {text}")
            if not array.shape and not array.index:
                lines.append(f"{title} = 0")
        return "\n".join(lines) + "\n"
