"""Constant angles as symbols of their own: ``cos(q - 1.8031)`` has the angles q and 1.8031.

Were 1.8031 a multiple of a unit, it would be 18,031 times 1/10,000, and a product of cosines a polynomial of that
degree. So every number that is added to an angle, and is no multiple of a twelfth of pi, is a symbol while the form is
found, and a number again where it is written.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from substructures.expr.graph import Expr, Graph
from substructures.expr.rings.generators import ANGULAR
from substructures.expr.walk import build, reachable
from substructures.textbook.forms import Factor, Sum, Term, Trig

#: radians, and multiples of pi
Constant = tuple[Fraction, Fraction]
#: what the names of the symbols begin with, behind all others in any order
_FIRST = "\uffff"


def named(exprs: Sequence[Expr]) -> tuple[list[Expr], dict[str, Constant]]:
    """The expressions with symbols for constant angles, and what these are; as they are where there are none."""
    nodes = reachable(exprs)
    split = {node: found for node in nodes if node.op in ANGULAR and any((found := _split(node.args[0]))[1])}
    if not split:
        return list(exprs), {}
    values = sorted({_positive(constant)[1] for _, constant in split.values()})
    names = {constant: f"{_FIRST}{n}" for n, constant in enumerate(values)}
    graph, new = Graph(), dict[Expr, Expr]()
    for node in nodes:
        if node in split:
            terms, (sign, constant) = split[node][0], _positive(split[node][1])
            angle = graph.sum(new[x] if s > 0 else -new[x] for x, s in terms)
            symbol = graph.symbol(names[constant])
            new[node] = build(graph, node.op, [angle + symbol if sign > 0 else angle - symbol])
        elif node.op == "sym":
            new[node] = graph.symbol(str(node.value))
        elif node.is_number:
            new[node] = graph.number(node.value)
        else:
            new[node] = build(graph, node.op, [new[a] for a in node.args])
    return [new[e] for e in exprs], {name: constant for constant, name in names.items()}


def _split(angle: Expr) -> tuple[list[tuple[Expr, int]], Constant]:
    """The terms of a sum with their signs, and the constant among them; a twelfth of pi is a term."""
    terms, radians, turns = list[tuple[Expr, int]](), Fraction(0), Fraction(0)
    stack = [(angle, 1)]
    while stack:
        node, sign = stack.pop()
        if node.op in ("add", "sub", "neg"):
            last = -sign if node.op != "add" else sign
            stack += [(node.args[-1], last), *((x, sign) for x in node.args[:-1])]
        elif node.is_number:
            radians += sign * Fraction(node.value)
        elif (part := _part_of_pi(node)) is not None and (12 * part).denominator != 1:
            turns += sign * part
        else:
            terms.append((node, sign))
    return terms, (radians, turns)


def _part_of_pi(node: Expr) -> Fraction | None:
    """c of c*pi."""
    if node is node.graph.pi:
        return Fraction(1)
    if node.op in ("mul", "div") and node.args[-1].is_number:
        number, part = Fraction(node.args[-1].value), _part_of_pi(node.args[0])
        return None if part is None else part * number if node.op == "mul" else part / number
    if node.op == "mul" and node.args[0].is_number and (part := _part_of_pi(node.args[1])) is not None:
        return Fraction(node.args[0].value) * part
    return None


def _positive(constant: Constant) -> tuple[int, Constant]:
    """A sign, and the constant that begins without one."""
    is_negative = (constant[0] or constant[1]) < 0
    return (-1, (-constant[0], -constant[1])) if is_negative else (1, constant)


def restored(form: Sum, constants: Mapping[str, Constant]) -> Sum:
    """The form with numbers for the symbols."""
    return Sum(tuple(_term(term, constants) for term in form.terms)) if constants else form


def _term(term: Term, constants: Mapping[str, Constant]) -> Term:
    c, factors = term.coefficient, list[tuple[Factor, int]]()
    for factor, n in term.factors:
        found: Factor = factor
        if isinstance(factor, Sum):
            found = restored(factor, constants)
        elif isinstance(factor, Trig):
            is_turned, found = _trig(factor, constants)
            c = -c if is_turned and factor.op == "sin" and n % 2 else c
        factors.append((found, n))
    return Term(c, tuple(factors))


def _trig(trig: Trig, constants: Mapping[str, Constant]) -> tuple[bool, Trig]:
    """Whether the sign of its angle was changed, and the cosine or sine."""
    angles: dict[Expr, Fraction] = {}
    for angle, n in trig.angle:
        constant = constants.get(str(angle.value)) if angle.op == "sym" else None
        graph = angle.graph
        parts = [(angle, n)] if constant is None else [(graph.one, n * constant[0]), (graph.pi, n * constant[1])]
        for part, c in parts:
            angles[part] = angles.get(part, Fraction(0)) + c
    left = [(a, c) for a, c in angles.items() if c]
    is_turned = bool(left) and left[0][1] < 0
    return is_turned, Trig(trig.op, tuple((a, -c if is_turned else c) for a, c in left))


def bindings(constants: Mapping[str, Constant], graph: Graph) -> dict[str, Expr]:
    """What the symbols are in a graph."""
    return {name: graph.number(c) + graph.number(turns) * graph.pi for name, (c, turns) in constants.items()}
