"""A program as a list of formulas in some language: temporaries, then the elements of the outputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from functools import reduce

from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Operation, Program, operands
from substructures.expr.replay import replay
from substructures.expr.rings.expand import LIMIT as TERMS
from substructures.expr.rings.expand import Expanded, Expander, Term
from substructures.expr.walk import reachable
from substructures.printers.language import SUM, Language, Listing, Piece
from substructures.printers.numbers import has_decimals
from substructures.printers.signs import Signed, signed


def check_size(size: int, limit: int) -> None:
    """Raises TooLarge for more nodes than the limit."""
    if size > limit:
        raise TooLarge("the printed formulas (in nodes)", size, limit)


def compact(program: Program, language: Language, limit: int) -> Listing:
    """Shared subexpressions become temporaries, others are written where they are used unless that is long."""
    needed = program.reachable()
    check_size(len(needed), limit)
    uses = _uses(program, needed, language.powers)
    language.decimals = has_decimals(_constants(program, needed))
    written: dict[int, Signed] = {}
    pieces: dict[int, Piece] = {}
    temporaries: list[tuple[int, str]] = []
    for i in needed:
        found = signed(program, i, written, language) or Signed(_operation(program, language, i, pieces))
        if i in language.meanings or (_is_long(program, language, i, uses[i], found) and not found.is_short):
            is_negative = i in language.meanings and language.meanings[i].is_negative
            temporaries.append((len(temporaries) + 1, found.times(language, is_negative).text))
            found = Signed(language.call_temporary(len(temporaries), i), is_negative)
        written[i], pieces[i] = found, found.piece
    entries = {
        name: tuple(written[e].times(language).text for e in output.entries) for name, output in program.outputs.items()
    }
    return Listing(tuple(temporaries), entries)


def _is_long(program: Program, language: Language, i: int, uses: int, found: Signed) -> bool:
    """Whether an operation is used several times, or too long to be written where it is used."""
    is_simple = program.operations[i][0] in ("int", "rat", "sym") or _is_pi(program, i)
    return not is_simple and (uses > 1 or len(found.piece.text) > language.width)


def inlined(program: Program, language: Language, limit: int) -> Listing:
    """Every element in one formula of its own, without temporaries."""
    needed = program.reachable()
    size: dict[int, int] = {}
    for i in needed:
        size[i] = 1 + sum(size[x] for x in operands(program.operations[i]))
    check_size(sum(size[e] for output in program.outputs.values() for e in output.entries), limit)
    language.decimals = has_decimals(_constants(program, needed))
    pieces: dict[int, Piece] = {}
    for i in needed:
        pieces[i] = _operation(program, language, i, pieces)
    return Listing((), {name: tuple(pieces[e].text for e in o.entries) for name, o in program.outputs.items()})


def expanded(program: Program, language: Language, limit: int) -> Listing:
    """Every element in its canonical expanded form. Raises TooLarge, and ZeroDivisionError."""
    graph = Graph()
    outputs = replay(program, graph, {})
    exprs = {name: [f.entries[i] for i in program.outputs[name].index] for name, f in outputs.items()}
    nodes = [e for some in exprs.values() for e in some if isinstance(e, Expr)]
    expander = Expander(nodes, min(limit, TERMS)) if nodes else None
    if expander:
        check_size(sum(expander.size(e) for e in nodes), limit)
    forms = {e: expander.expand(e) for e in dict.fromkeys(nodes)} if expander else {}
    terms = [t for e in nodes for t in (*forms[e].terms, *forms[e].denominator)]
    check_size(sum(1 + len(t.powers) + 2 * len(t.angle) for t in terms), limit)
    language.decimals = has_decimals(t.coefficient for t in terms)
    writer = _ExpandedWriter(program, language, terms, limit)
    texts = {e: writer.form(form).text for e, form in forms.items()}
    return Listing((), {name: tuple(texts[e] for e in some if isinstance(e, Expr)) for name, some in exprs.items()})


def _uses(program: Program, needed: Iterable[int], powers: bool) -> dict[int, int]:
    """How often every operation is written out; a square counts once where it is written as power."""
    uses = dict.fromkeys(needed, 0)
    for i in uses:
        args = operands(program.operations[i])
        square = powers and program.operations[i][0] == "mul" and args[0] == args[1]
        for x in args[:1] if square else args:
            uses[x] += 1
    for output in program.outputs.values():
        for e in output.entries:
            uses[e] += 1
    return uses


def _is_pi(program: Program, i: int) -> bool:
    operation = program.operations[i]
    return operation[0] == "acos" and program.operations[operation[1]] == ("int", "-1")


def _constants(program: Program, needed: Iterable[int]) -> Iterator[Fraction]:
    return (_constant(program.operations[i]) for i in needed if program.operations[i][0] in ("int", "rat"))


def _constant(operation: Operation) -> Fraction:
    return Fraction(*map(int, operation[1:]))


def _operation(program: Program, language: Language, i: int, pieces: Mapping[int, Piece]) -> Piece:
    operation: Operation = program.operations[i]
    op = operation[0]
    if op == "sym":
        return language.symbol(operation[1])
    if op in ("int", "rat"):
        return language.number(_constant(operation))
    if op == "powi":
        return language.power(pieces[operation[1]], operation[2])
    if op == "neg" and pieces[operation[1]].precedence == SUM and program.operations[operation[1]][0] == "sub":
        # b - a for -(a - b)
        _, a, b = program.operations[operation[1]]
        return language.sub(pieces[b], pieces[a])
    return language.pi() if _is_pi(program, i) else language.write(op, [pieces[x] for x in operation[1:]])


class _ExpandedWriter:
    """Writes canonical forms."""

    def __init__(self, program: Program, language: Language, terms: list[Term], limit: int) -> None:
        self.language = language
        self.number = {s.name: n for n, s in enumerate(program.symbols)}
        self.atoms = self._atoms({a: None for t in terms for a in t.atoms()}, limit)

    def _atoms(self, atoms: Iterable[Expr], limit: int) -> dict[Expr, Piece]:
        atoms = list(atoms)
        size: dict[Expr, int] = {}
        for node in reachable(atoms):
            size[node] = 1 + sum(size[a] for a in node.args)
        check_size(sum(size[a] for a in atoms), limit)
        pieces: dict[Expr, Piece] = {}
        for node in size:
            pieces[node] = self._node(node, pieces)
        return pieces

    def _node(self, node: Expr, pieces: Mapping[Expr, Piece]) -> Piece:
        if node.op == "sym":
            return self.language.symbol(self.number[str(node.value)])
        if node.is_number:
            return self.language.number(Fraction(node.value))
        if node is node.graph.pi:
            return self.language.pi()
        return self.language.write(node.op, [pieces[a] for a in node.args])

    def form(self, form: Expanded) -> Piece:
        """A sum of products, over its denominator if it has one."""
        numerator = self._sum(form.terms)
        return self.language.div(numerator, self._sum(form.denominator)) if form.denominator else numerator

    def _sum(self, terms: Iterable[Term]) -> Piece:
        return self._combination((t.coefficient, self._term(t)) for t in terms)

    def _combination(self, items: Iterable[tuple[Fraction, Piece]]) -> Piece:
        """The sum of pieces with the signs of the numbers."""
        result: Piece | None = None
        for c, piece in items:
            if result is None:
                result = self.language.neg(piece) if c < 0 else piece
            else:
                result = self.language.sub(result, piece) if c < 0 else self.language.add(result, piece)
        return result or self.language.number(Fraction(0))

    def _product(self, c: Fraction, factors: list[Piece]) -> Piece:
        pieces = factors if c == 1 and factors else [self.language.number(c), *factors]
        return reduce(self.language.mul, pieces)

    def _power(self, a: Expr, n: int) -> Piece:
        return self.atoms[a] if n == 1 else self.language.power(self.atoms[a], n)

    def _term(self, term: Term) -> Piece:
        below = [self._power(a, -n) for a, n in term.powers if n < 0]
        numerator = self._product(abs(term.coefficient), self._factors(term))
        return self.language.div(numerator, self._product(Fraction(1), below)) if below else numerator

    def _factors(self, term: Term) -> list[Piece]:
        factors = [self._power(a, n) for a, n in term.powers if n > 0]
        if term.trig:
            angle = self._combination((c, self._product(abs(c), [self.atoms[a]])) for a, c in term.angle)
            factors.append(self.language.call(term.trig, [angle]))
        return factors
