"""LaTeX as a document: what symbols mean, then the formulas on lines that fit the page; plain LaTeX compiles it."""

from __future__ import annotations

from substructures.printers.language import Listing
from substructures.printers.latex import Latex
from substructures.printers.names import comment

HEAD = r"""\documentclass[a4paper]{article}
\usepackage{amsmath,longtable}
\usepackage[margin=25mm]{geometry}
\allowdisplaybreaks
\setlength{\parindent}{0pt}
\begin{document}"""
_TABLE = r"""\begin{longtable}{@{}llll@{}}
symbol & name & kind & unit \\ \hline"""
_WORDS = {
    "metric": "Mass matrix",
    "christoffel": "Christoffel symbols of the first kind",
    "forces": "Generalised forces",
    "gravity": "Forces of gravity",
    "forward_dynamics": "Accelerations",
}

#: characters of a name in the table
LONGEST = 40


class LatexDocument(Latex):
    """A document of the class ``article``; needs amsmath, longtable and geometry (texlive-latex-base)."""

    def render(self, listing: Listing, name: str) -> str:
        """Title, table of symbols, abbreviations, and a section for every output."""
        lines = [HEAD, rf"\section*{{{prose(name)}}}"]
        lines += [line for x in (self.remark, *self.legend) if x for line in (f"{prose(x)}.", "")]
        if self.described:
            lines += [_TABLE, *self._symbols(), r"\end{longtable}"]
        return "\n".join([*lines, *self.formulas(listing), r"\end{document}"]) + "\n"

    def formulas(self, listing: Listing) -> list[str]:
        """The sections of a document."""
        lines = []
        for title, said, rows in self._sections(listing):
            lines += [rf"\section*{{{title}}}", *said]
            lines += [r"\begin{align*}", " \\\\\n".join(rows), r"\end{align*}"]
        return lines

    def _symbols(self) -> list[str]:
        return [
            " & ".join((f"${_shown(self.names[n])}$", *(prose(x[:LONGEST]) for x in (s.name, s.kind, s.unit)))) + r" \\"
            for n, s in self.described
        ]

    def _sections(self, listing: Listing) -> list[tuple[str, list[str], list[str]]]:
        """Title, what is said before them, and the rows of every section."""
        sections = []
        if listing.definitions:
            said = [rf"${name}$ stands for {prose(note)}." for name, _, note in listing.definitions if note]
            sections.append(("Grouped parameters", ["\n\n".join(said)], self.defined(listing)))
        before = self.abbreviated(listing)
        if before:
            sections.append(("Abbreviations", list[str](), before))
        for output, array in self.program.outputs.items():
            title = _WORDS.get(output, prose(output[:LONGEST]))
            said = ["Indices count from 1; elements that are not listed are 0."] if array.shape else []
            sections.append((title, said, self.rows(output, array, listing.entries[output])))
        return sections


def _shown(written: str) -> str:
    """What is written for a symbol, unless it is too long for a table."""
    return written if len(written) < 4 * LONGEST else r"\ldots"


def prose(text: str) -> str:
    """Any text as it stands, in paragraphs."""
    special = {"_": r"\_", "^": r"\^{}", "<": "$<$", ">": "$>$"}
    return "".join(special.get(c, c) for c in comment(text))
