"""Programs in the stored format, also of canonical sums and of textbook forms."""

from __future__ import annotations

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program
from substructures.expr.program import program as collect
from substructures.expr.replay import replay
from substructures.expr.rings.expand import LIMIT as TERMS
from substructures.expr.rings.expand import Expander
from substructures.printers.listing import check_size
from substructures.textbook.forms import to_expr
from substructures.textbook.reading import read


def stored_form(program: Program, form: str, limit: int) -> str:
    """The program in the stored format; expanded, a program that computes the canonical sums."""
    if form == "expanded":
        graph, new = Graph(), Graph()
        outputs = replay(program, graph, {})
        nodes = [e for f in outputs.values() for e in f.entries.values() if isinstance(e, Expr)]
        expander = Expander(nodes, min(limit, TERMS)) if nodes else None
        if expander:
            check_size(sum(expander.size(e) for e in nodes), limit)
        forms = {e: expander.expand(e) for e in dict.fromkeys(nodes)} if expander else {}
        check_size(sum(len(t.powers) + 2 for e in nodes for t in forms[e].terms), limit)
        rebuilt = {e: form.to_expr(new) for e, form in forms.items()}
        formulas = {
            n: Formulas(f.shape, {i: rebuilt[e] for i, e in f.entries.items() if isinstance(e, Expr)}, f.symmetry)
            for n, f in outputs.items()
        }
        program = collect(new, formulas, {s.name: s for s in program.symbols})
    if form == "textbook":
        program = _textbook_program(program)
    check_size(len(program), limit)
    return program.to_bytes().decode()


def _textbook_program(program: Program) -> Program:
    """A program that computes the textbook forms."""
    reading, new = read(program), Graph()
    moved = reading.atoms_in(new)
    formulas = {}
    for name, output in program.outputs.items():
        entries = {i: to_expr(f, new, moved) for i, f in zip(output.index, reading.outputs[name], strict=True)}
        formulas[name] = Formulas(output.shape, entries, output.symmetry)
    return collect(new, formulas, {s.name: s for s in program.symbols})
