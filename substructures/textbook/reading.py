"""The textbook forms of all elements of all outputs of a program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from graphlib import TopologicalSorter
from itertools import islice

from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Program, Symbol
from substructures.expr.replay import replay
from substructures.expr.rings.expand import Expanded, Expander
from substructures.expr.rings.generators import natural
from substructures.expr.walk import reachable, transfer
from substructures.textbook.atoms import Atoms, Monomial, ordered
from substructures.textbook.constants import Constant, bindings, named, restored
from substructures.textbook.field import WORK, Field, unit_of
from substructures.textbook.forms import Sum, Trig, atoms_of, leaves
from substructures.textbook.harmonics import Mode
from substructures.textbook.layout import Layout
from substructures.textbook.quotients import Quotients
from substructures.textbook.tidy import Tidy
from substructures.textbook.work import Work

#: of work for every term before it is collected
UNITS = 125


@dataclass(frozen=True)
class Limits:
    """``terms`` of all elements before they are collected, and ``work`` of rational functions: products of terms."""

    terms: int = 10_000
    work: int = WORK


#: what is read, and what is read where nobody asked for it
LIMITS, AT_ONCE = Limits(), Limits(4000, 300_000)


@dataclass(frozen=True)
class Reading:
    """The forms of the elements of every output in the order of its index; atoms are nodes of one graph.

    ``functions``: for every atom that is a function of something the forms of its arguments; ``constants``: what the
    symbols in atoms are that are none of the program.
    """

    outputs: Mapping[str, Sequence[Sum]]
    functions: Mapping[Expr, Sequence[Sum]]
    constants: Mapping[str, Constant]

    def atoms_in(self, graph: Graph) -> dict[Expr, Expr]:
        """All atoms in another graph."""
        atoms = atoms_of(self.forms)
        return dict(zip(atoms, transfer(atoms, graph, bindings(self.constants, graph)), strict=True))

    @cached_property
    def inside_out(self) -> list[Expr]:
        """The functions, those that others are made of first."""
        below = {f: [a for a in atoms_of(some) if a in self.functions] for f, some in self.functions.items()}
        return list(TopologicalSorter(below).static_order())

    @property
    def size(self) -> int:
        """How many factors and numbers are written, those in functions every time that they are."""
        sizes: dict[Expr, int] = {}
        for function in self.inside_out:
            sizes[function] = 1 + sum(self._size(f, sizes) for f in self.functions[function])
        return sum(self._size(f, sizes) for some in self.outputs.values() for f in some)

    @staticmethod
    def _size(form: Sum, sizes: Mapping[Expr, int]) -> int:
        atoms = [a for x in leaves(form) for a in ([a for a, _ in x.angle] if isinstance(x, Trig) else [x])]
        return len(form) + sum(sizes[a] for a in atoms if a in sizes)

    @property
    def forms(self) -> list[Sum]:
        """All of them."""
        return [f for some in (*self.outputs.values(), *self.functions.values()) for f in some]


def read(program: Program, limits: Limits = LIMITS) -> Reading:
    """The forms of all elements of a program.

    Raises TooLarge (size, limits.terms) before anything large is formed, ZeroDivisionError.
    """
    graph = Graph()
    outputs = replay(program, graph, {})
    exprs = {n: [graph.lift(f.entries[i]) for i in program.outputs[n].index] for n, f in outputs.items()}
    symbols = {s.name: s for s in program.symbols}
    found, constants = named([e for some in exprs.values() for e in some])
    forms = _forms(found, symbols, limits)
    functions: dict[Expr, Sequence[Sum]] = {}
    new = _functions(forms.values())
    while new:
        inner = _forms([a for f in new for a in f.args], symbols, limits)
        functions |= {f: [inner[a] for a in f.args] for f in new}
        new = [f for f in _functions(inner.values()) if f not in functions]
    functions = {f: [restored(form, constants) for form in some] for f, some in functions.items()}
    every = iter([restored(forms[e], constants) for e in found])
    return Reading({n: list(islice(every, len(some))) for n, some in exprs.items()}, functions, constants)


def _forms(exprs: Sequence[Expr], symbols: Mapping[str, Symbol], limits: Limits) -> dict[Expr, Sum]:
    every = list(dict.fromkeys(exprs))
    divided = _divided(every)
    forms = _polynomials([e for e in every if e not in divided], symbols, limits)
    return forms | _ratios([e for e in every if e in divided], symbols, limits)


def _functions(forms: Iterable[Sum]) -> list[Expr]:
    """The atoms of forms that are functions."""
    return [atom for atom in atoms_of(forms) if atom.args and atom is not atom.graph.pi]


def _divided(exprs: Sequence[Expr]) -> set[Expr]:
    """The expressions that divide by sums, or by functions of angles."""
    plain: dict[Expr, bool] = {}
    inside: dict[Expr, bool] = {}
    for node in reachable(exprs):
        op = node.op
        plain[node] = op in ("sym", "int", "rat") or (
            op in ("mul", "neg", "div", "sqrt") and all(plain[a] for a in node.args)
        )
        inside[node] = op == "tan" or (op == "div" and not plain[node.args[1]]) or any(inside[a] for a in node.args)
    return {e for e in exprs if inside[e]}


def _polynomials(exprs: Sequence[Expr], symbols: Mapping[str, Symbol], limits: Limits) -> dict[Expr, Sum]:
    if not exprs:
        return {}
    expander = Expander(exprs)
    size = sum(expander.size(e) for e in exprs)
    if size > limits.terms:
        raise TooLarge("the textbook form (in terms before they are collected)", size, limits.terms)
    found = {e: expander.expand(e) for e in exprs}
    atoms = ordered((a for f in found.values() for t in f.terms for a, _ in t.powers), symbols)
    work = Work(UNITS * limits.terms)
    return {e: _laid_out(f, atoms, work) for e, f in found.items()}


def _laid_out(found: Expanded, atoms: Atoms, work: Work) -> Sum:
    multiples: dict[Expr, list[Fraction]] = {}
    for term in found.terms:
        for angle, c in term.angle:
            multiples.setdefault(angle, []).append(c)
    angles = sorted(multiples, key=_angle_key)
    units = [unit_of(multiples[a]) for a in angles]
    content: dict[Monomial, dict[Mode, tuple[Fraction, Fraction]]] = {}
    for term in found.terms:
        monomial = tuple(sorted((atoms.place[a], n) for a, n in term.powers))
        given = dict(term.angle)
        mode = tuple(int(given.get(a, 0) / u) for a, u in zip(angles, units, strict=True))
        harmonics = content.setdefault(monomial, {})
        a, b = harmonics.get(mode, (Fraction(0), Fraction(0)))
        c = term.coefficient
        harmonics[mode] = (a, b + c) if term.trig == "sin" else (a + c, b)
    return Tidy(atoms)(Layout(atoms, angles, units, work)(content))


def _ratios(exprs: Sequence[Expr], symbols: Mapping[str, Symbol], limits: Limits) -> dict[Expr, Sum]:
    if not exprs:
        return {}
    field = Field(exprs, Work(limits.work))
    atoms = ordered((field.generators.atoms[i] for i in field.plain), symbols)
    quotients, tidy = Quotients(field, atoms), Tidy(atoms)
    return {e: tidy(quotients(e)) for e in exprs}


def _angle_key(angle: Expr) -> tuple[object, ...]:
    return (0, natural(str(angle.value))) if angle.op == "sym" else (1, angle.index)
